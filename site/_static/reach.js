// What scrolls sideways can be scrolled by keys, too: it takes the focus while it is wider than its box. (The theme
// does so for code and tables only.)
const BOXES = ".cell_output, .cell_output .drawing, div.math";

function reach() {
  for (const box of document.querySelectorAll(BOXES)) {
    const scrolls = box.scrollWidth > box.clientWidth + 1 && getComputedStyle(box).overflowX === "auto";
    const name = box.matches(".math") ? "formula" : "figure";
    if (scrolls) Object.assign(box, { tabIndex: 0, role: "region", ariaLabel: `${name}, wider than the page` });
    else if (box.tabIndex === 0) for (const given of ["tabindex", "role", "aria-label"]) box.removeAttribute(given);
  }
}

addEventListener("load", async () => {
  await window.MathJax?.startup?.promise;
  reach();
  addEventListener("resize", reach);
});
