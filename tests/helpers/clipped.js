// What a reader of a page cannot see: things that stand out of what clips them, to the left even of what scrolls.
() => {
  const article = document.querySelector("article");
  const wrong = [];
  const report = (what, e, by) => wrong.push(`${what} by ${Math.round(by)}: <${e.tagName.toLowerCase()}> ${(e.textContent || "").trim().slice(0, 60)}`);
  const unseen = "mjx-assistive-mml, script, style, .unstruct-picture, .visually-hidden";
  for (const e of article.querySelectorAll("*")) {
    const box = e.getBoundingClientRect();
    if (e.closest(unseen) || e.ownerSVGElement || !box.width || !box.height) continue;
    let around = e.parentElement;
    while (around !== article && getComputedStyle(around).overflowX === "visible") around = around.parentElement;
    const room = around.getBoundingClientRect();
    const style = getComputedStyle(around);
    const scrolls = style.overflowX === "auto" || style.overflowX === "scroll";
    if (box.left < room.left - around.scrollLeft - 1) report("left", e, room.left - box.left);
    if (!scrolls && box.right > room.right + 1) report("right", e, box.right - room.right);
    const block = ["P", "DIV", "SPAN"].includes(e.tagName); // their lines are higher than what is drawn in them
    if (style.overflowY === "hidden" && !block) {
      if (box.top < room.top - 1) report("top", e, room.top - box.top);
      if (box.bottom > room.bottom + 1) report("bottom", e, box.bottom - room.bottom);
    }
  }
  // A formula may stand out of its own picture, of which the browser then shows a part.
  for (const picture of article.querySelectorAll("mjx-container > svg")) {
    const room = picture.getBoundingClientRect();
    for (const part of picture.querySelectorAll("use, rect, text")) {
      const box = part.getBoundingClientRect();
      const out = box.width ? Math.max(room.left - box.left, box.right - room.right) : 0;
      if (out > 3) report("part of a formula", picture.parentElement, out);
    }
  }
  const page = document.documentElement.scrollWidth - innerWidth;
  if (page > 0) report("the page", document.body, page);
  return wrong;
}
