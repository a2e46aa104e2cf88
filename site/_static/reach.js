// What scrolls sideways can be scrolled by keys, too: it takes the focus while it is wider than its box. (The theme
// does so for code only.)
const BOXES = ".cell_output, .cell_output .drawing, .cell_output table, .math";

function reach() {
  for (const box of document.querySelectorAll(BOXES)) {
    const scrolls = box.scrollWidth > box.clientWidth + 1 && getComputedStyle(box).overflowX === "auto";
    if (scrolls) box.tabIndex = 0;
    else box.removeAttribute("tabindex");
    if (box.localName === "table") continue; // which says itself what it is
    if (scrolls) Object.assign(box, { role: "group", ariaLabel: `${box.matches(".math") ? "formula" : "figure"}, wider than the page` });
    else for (const given of ["role", "aria-label"]) box.removeAttribute(given);
  }
}

addEventListener("load", async () => {
  await window.MathJax?.startup?.promise;
  reach();
  addEventListener("resize", reach);
});
