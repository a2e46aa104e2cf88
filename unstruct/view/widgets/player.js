// Draws frames (see frames.py) as SVG and steps through them. All state is in the model of the widget,
// so that it works with a running kernel and also without one, on a static page.

const SCALE = 96 / 72; // the styles are in points, the picture in pixels
const ICONS = {
  first: "M1 1h2v10H1zM11 1v10L4 6z",
  back: "M9 1l1.5 1.5L6 6l4.5 3.5L9 11 3 6z",
  play: "M2 0.5l9.5 5.5L2 11.5z",
  pause: "M2 1h3v10H2zM7 1h3v10H7z",
  next: "M3 1L1.5 2.5 6 6 1.5 9.5 3 11l6-5z",
  last: "M9 1h2v10H9zM1 1v10l7-5z",
};
const CIRCLE = 0.06; // the largest opacity inside circles, because they overlap
let players = 0;

const escape = (text) => String(text).replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]);
const n = (value) => Number(value).toFixed(2);

// The path of a matplotlib marker of diameter s around the origin.
function marker(letter, s) {
  const r = s / 2;
  const ring = (count, turn, inner = 1) => {
    const corners = [];
    for (let k = 0; k < count; k++) {
      const a = turn + (2 * Math.PI * k) / count;
      const q = k % 2 ? r * inner : r;
      corners.push(`${n(q * Math.sin(a))} ${n(-q * Math.cos(a))}`);
    }
    return `M${corners.join("L")}Z`;
  };
  const bar = (w) => `M${-w} ${-r}H${w}V${-w}H${r}V${w}H${w}V${r}H${-w}V${w}H${-r}V${-w}H${-w}Z`;
  const q = 0.7 * r;
  const shapes = {
    s: () => `M${-q} ${-q}H${q}V${q}H${-q}Z`,
    D: () => `M0 ${-r}L${r} 0L0 ${r}L${-r} 0Z`,
    "^": () => `M0 ${-r}L${r} ${r}H${-r}Z`,
    v: () => `M0 ${r}L${r} ${-r}H${-r}Z`,
    "<": () => `M${-r} 0L${r} ${-r}V${r}Z`,
    ">": () => `M${r} 0L${-r} ${-r}V${r}Z`,
    "*": () => ring(10, 0, 0.4),
    p: () => ring(5, 0),
    h: () => ring(6, 0),
    P: () => bar(r / 3),
    X: () => `M0 ${-r / 3}L${q / 2} ${-r}L${r} ${-q / 2}L${r / 3} 0L${r} ${q / 2}L${q / 2} ${r}L0 ${r / 3}L${-q / 2} ${r}L${-r} ${q / 2}L${-r / 3} 0L${-r} ${-q / 2}L${-q / 2} ${-r}Z`,
  };
  const dot = letter === "." ? r / 2 : r;
  return (shapes[letter] ?? (() => `M${dot} 0A${dot} ${dot} 0 1 0 ${-dot} 0A${dot} ${dot} 0 1 0 ${dot} 0Z`))();
}

function hatches(styles, id) {
  const lines = { "/": "M0 7L7 0M-1 1L1 -1M6 8L8 6", x: "M0 7L7 0M0 0L7 7", ".": "M3 3.5h1" };
  return Object.entries(styles)
    .filter(([, style]) => style.hatch)
    .map(([role, style]) => `<pattern id="${id}-${role}" width="7" height="7" patternUnits="userSpaceOnUse"><path d="${lines[style.hatch]}" stroke="${style.color}" stroke-width="0.7" fill="none"/></pattern>`)
    .join("");
}

// One item of a frame as SVG text. `to` maps a point to pixels, `unit` is the number of pixels per unit.
function draw(item, styles, to, unit, size, id) {
  const style = styles[item.role];
  const dash = style.dash.length ? ` stroke-dasharray="${style.dash.map((d) => n(d * SCALE)).join(" ")}"` : "";
  const stroke = `stroke="${style.color}" stroke-width="${n(style.width * SCALE)}" stroke-linejoin="round"${dash}`;
  const open = `<g data-kind="${item.kind}" data-role="${item.role}" opacity="${item.opacity ?? 1}"`;
  const path = (points, close) => `M${points.map((p) => to(p).map(n).join(" ")).join("L")}${close}`;
  if (item.kind === "points") {
    const shape = marker(style.marker, style.size * SCALE);
    const marks = item.data.map((p, k) => {
      const place = `transform="translate(${to(p).map(n).join(" ")})"`;
      const name = item.handles?.[k];
      const grip = name === undefined ? "" : `<circle class="unstruct-grip" data-handle="${escape(name)}" r="15" ${place}/>`;
      return `<path d="${shape}" ${place}/>${grip}`;
    });
    return `${open} fill="${style.color}" stroke="#fff" stroke-width="0.6">${marks.join("")}</g>`;
  }
  if (item.kind === "labels") {
    const texts = item.data.map((p, k) => {
      const [x, y] = to(p);
      return `<text x="${n(x + 6)}" y="${n(y - 6)}">${escape(item.text[k])}</text>`;
    });
    return `${open} class="unstruct-label" fill="${style.ink ?? style.color}">${texts.join("")}</g>`;
  }
  if (item.kind === "segments") {
    return `${open} fill="none" ${stroke}><path d="${item.data.map((s) => path(s, "")).join("")}"/></g>`;
  }
  const veil = item.kind === "circles" ? Math.min(style.alpha, CIRCLE) : style.alpha;
  const fill = `fill="${style.fill}" fill-opacity="${veil}"`;
  if (item.kind === "polygons") {
    const all = item.data.map((p) => `<path d="${path(p, "Z")}"/>`).join("");
    const over = style.hatch ? `<g fill="url(#${id}-${item.role})" fill-opacity="1" stroke="none">${all}</g>` : "";
    if (!style.dash.length || item.data.length < 2) return `${open} ${fill} ${stroke}>${all}${over}</g>`;
    const sides = `<g fill="none" ${stroke}><path d="${outline(item.data).map((s) => path(s, "")).join("")}"/></g>`;
    return `${open}><g ${fill}>${all}</g>${over}${sides}</g>`;
  }
  const round = item.data.map(([x, y, r]) => {
    const [cx, cy] = to([x, y]);
    if (r * unit < 6 * (size[0] + size[1])) return `<circle cx="${n(cx)}" cy="${n(cy)}" r="${n(r * unit)}"/>`;
    return `<path fill="none" d="${arc(cx, cy, r * unit, size)}"/>`;
  });
  return `${open} ${fill} ${stroke}>${round.join("")}</g>`;
}

// The sides of polygons. A common side of two neighbors is listed once, because dashes would fill the gaps.
function outline(polygons) {
  const sides = new Map();
  for (const corners of polygons) {
    corners.forEach((p, k) => {
      const ends = [p, corners[(k + 1) % corners.length]].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
      sides.set(ends.join(), ends);
    });
  }
  return [...sides.values()];
}

// The part of a huge circle near the picture, because browsers draw the whole slowly and inexactly.
function arc(cx, cy, r, [width, height]) {
  const middle = Math.atan2(height / 2 - cy, width / 2 - cx);
  const far = Math.hypot(height / 2 - cy, width / 2 - cx);
  const half = Math.min(Math.PI, (width + height) / r);
  const points = [];
  for (let k = -24; k <= 24; k++) {
    const a = (half * k) / 24;
    // Along the direction of the picture and across it, without subtracting huge numbers.
    const along = r - far - 2 * r * Math.sin(a / 2) ** 2;
    const across = r * Math.sin(a);
    const [c, s] = [Math.cos(middle), Math.sin(middle)];
    points.push(`${n(width / 2 + along * c - across * s)} ${n(height / 2 + along * s + across * c)}`);
  }
  return `M${points.join("L")}`;
}

const BUTTONS = ["first", "back", "play", "next", "last"];
const KEYS = { ArrowLeft: "back", ArrowRight: "next", Home: "first", End: "last", " ": "play" };
const SEEN = ["frames", "index", "view", "alt", "variant", "variants"];

// All histories of a panel from its compressed text, in which equal items of frames are stored once.
async function unpack(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const { items, histories } = await new Response(stream).json();
  return histories.map((frames) => frames.map((frame) => ({ ...frame, items: frame.items.map((k) => items[k]) })));
}

// The sliders and lists of a panel, one for each parameter, and the button that resets them.
function controls(grid) {
  if (!grid.length) return "";
  const each = grid.map(({ label, values, list }, axis) => {
    const options = values.map((value) => `<option>${escape(value)}</option>`).join("");
    const input = list
      ? `<select data-axis="${axis}">${options}</select>`
      : `<input type="range" data-axis="${axis}" min="0" max="${values.length - 1}" step="1"><output></output>`;
    return `<label><span>${escape(label)}</span>${input}</label>`;
  });
  return `<div class="unstruct-grid">${each.join("")}<button type="button" data-do="reset">reset</button></div>`;
}

function build(el, id, grid) {
  const bar = BUTTONS.map(
    (name) => `<button type="button" data-do="${name}" aria-label="${name}" title="${name}">
      <svg viewBox="0 0 12 12"><path d="${ICONS[name]}"/></svg></button>`,
  ).join("");
  el.innerHTML = `<div id="${id}" class="unstruct-player" tabindex="0" role="group" data-lm-suppress-shortcuts="true">
    ${controls(grid)}<label class="unstruct-choice">preset <select></select></label>
    <div class="unstruct-caption" aria-live="polite"></div>
    <svg class="unstruct-picture" role="img" xmlns="http://www.w3.org/2000/svg"><defs></defs><g></g></svg>
    <div class="unstruct-number" aria-live="polite"></div>
    <div class="unstruct-bar">${bar}<input type="range" min="0" step="1" aria-label="step"><output></output></div>
  </div>`;
  // JupyterLab looks for this mark only up to the first element that one of its shortcuts is for.
  for (const own of el.querySelectorAll("input, select, button")) own.dataset.lmSuppressShortcuts = "true";
  return el.querySelector(".unstruct-player");
}

class Player {
  constructor(model, el, sets) {
    this.model = model;
    this.sets = sets; // of a panel: the frames for each combination of its parameters
    this.grid = sets ? model.get("grid") : [];
    this.id = `unstruct-player-${(players += 1)}-${Math.floor(performance.now())}`;
    this.root = build(el, this.id, this.grid);
    const names = [".unstruct-picture", ".unstruct-bar input", ".unstruct-choice select"];
    [this.svg, this.slider, this.choice] = names.map((name) => this.part(name));
    this.timer = null;
    this.listenToButtons();
    this.listenToGrid();
    this.listenToKeys();
    this.listenToDrags();
    this.heard = [
      ["change:variant", () => this.begin()],
      ["change:variants", () => this.offer()],
      ...SEEN.map((name) => [`change:${name}`, () => this.paint()]),
    ];
    for (const [event, call] of this.heard) model.on(event, call);
    this.offer();
    this.paint();
  }

  part(name) {
    return this.root.querySelector(name);
  }

  // ---- what is shown

  get history() {
    const { model, sets } = this; // the only history, or one of several
    if (sets) return { frames: sets[model.get("variant")], view: model.get("view") };
    return model.get("variants")[model.get("variant")] ?? { frames: model.get("frames"), view: model.get("view") };
  }
  get count() {
    return this.history.frames.length;
  }
  get index() {
    return Math.min(Math.max(this.model.get("index"), 0), this.count - 1);
  }

  paint() {
    const { model, svg, index, count } = this;
    const frame = this.history.frames[index];
    const [x0, x1, y0, y1] = this.history.view;
    const width = Math.min(model.get("width"), (model.get("height") * (x1 - x0)) / (y1 - y0));
    const unit = width / (x1 - x0);
    const size = [width, unit * (y1 - y0)];
    const to = ([x, y]) => [(x - x0) * unit, (y1 - y) * unit];
    const styles = model.get("styles");
    svg.setAttribute("viewBox", `0 0 ${size.map(n).join(" ")}`);
    svg.style.width = `${n(width)}px`;
    this.root.style.width = `${n(Math.max(width, 330) + 10)}px`; // nothing moves when captions change
    svg.querySelector("defs").innerHTML = hatches(styles, this.id);
    svg.querySelector("g").innerHTML = frame.items.map((i) => draw(i, styles, to, unit, size, this.id)).join("");
    this.part(".unstruct-caption").textContent = frame.caption;
    this.part(".unstruct-number").textContent = frame.number;
    const where = `Step ${index + 1} of ${count}: ${frame.caption} ${frame.number}`;
    this.root.setAttribute("aria-label", model.get("alt"));
    svg.setAttribute("aria-label", `${model.get("alt")} ${where}`);
    this.tell();
  }

  tell() {
    const { index, count } = this;
    this.choice.selectedIndex = this.model.get("variant");
    this.slider.max = count - 1;
    this.slider.value = index;
    this.part(".unstruct-bar output").textContent = `${index + 1}/${count}`;
    this.part(".unstruct-bar").hidden = count < 2;
    const places = this.places(this.model.get("variant"));
    for (const control of this.root.querySelectorAll("[data-axis]")) {
      const { axis } = control.dataset;
      const value = this.grid[axis].values[places[axis]];
      if (control.localName === "select") control.selectedIndex = places[axis];
      else {
        [control.value, control.nextSibling.textContent] = [places[axis], value];
        control.setAttribute("aria-valuetext", value);
      }
    }
    for (const name of ["first", "back"]) this.part(`[data-do=${name}]`).disabled = index === 0;
    for (const name of ["next", "last"]) this.part(`[data-do=${name}]`).disabled = index === count - 1;
  }

  // Histories are chosen here and not by another widget, which would need a kernel.
  offer() {
    this.choice.replaceChildren(...this.model.get("variants").map(({ name }) => new Option(name)));
    this.part(".unstruct-choice").hidden = this.choice.length === 0;
  }

  // ---- how it moves

  change(name, value) {
    this.model.set(name, value);
    this.model.save_changes();
  }
  go(index) {
    this.change("index", Math.min(Math.max(index, 0), this.count - 1));
  }
  begin() {
    this.stop();
    this.go(this.sets ? this.index : 0);
  }
  // Which value each parameter of a panel has in a combination; the last parameter runs fastest.
  places(variant) {
    const found = [];
    for (const { values } of [...this.grid].reverse()) {
      found.unshift(variant % values.length);
      variant = Math.floor(variant / values.length);
    }
    return found;
  }
  combine(places) {
    this.change("variant", places.reduce((sum, place, axis) => sum * this.grid[axis].values.length + place, 0));
  }
  label(name) {
    const button = this.part("[data-do=play]");
    button.querySelector("path").setAttribute("d", ICONS[name]);
    button.setAttribute("aria-label", name);
    button.title = name;
  }
  stop() {
    clearInterval(this.timer);
    this.timer = null;
    this.label("play");
  }
  play() {
    if (this.timer !== null) return this.stop();
    if (this.index === this.count - 1) this.go(0);
    this.label("pause");
    const step = () => (this.index < this.count - 1 ? this.go(this.index + 1) : this.stop());
    this.timer = setInterval(step, this.model.get("interval"));
  }
  act(name) {
    if (name === "play") return this.play();
    this.stop();
    if (name === "reset") {
      this.combine(this.grid.map(({ start }) => start));
      return this.go(0);
    }
    this.go({ first: 0, back: this.index - 1, next: this.index + 1, last: this.count - 1 }[name]);
  }

  // ---- events

  listenToButtons() {
    this.root.addEventListener("click", (event) => {
      const name = event.target.closest("button")?.dataset.do;
      if (name) this.act(name);
    });
    this.slider.addEventListener("input", () => {
      this.stop();
      this.go(Number(this.slider.value));
    });
    this.choice.addEventListener("change", () => this.change("variant", this.choice.selectedIndex));
  }

  listenToGrid() {
    this.root.addEventListener("input", ({ target }) => {
      if (target.dataset.axis === undefined) return;
      const places = this.places(this.model.get("variant"));
      places[target.dataset.axis] = target.localName === "select" ? target.selectedIndex : Number(target.value);
      this.combine(places);
    });
  }

  listenToKeys() {
    this.root.addEventListener("keydown", (event) => {
      const name = KEYS[event.key];
      const own = event.target.matches("input, select");
      if (!name || own || this.count < 2) return; // sliders and lists handle these keys themselves
      if (event.key === " " && event.target.closest("button")) return; // and so do buttons
      event.preventDefault();
      this.act(name);
    });
  }

  // Points with handles can be dragged; Python answers with new frames, a panel with those that it has.
  listenToDrags() {
    let [grabbed, waiting] = [null, false];
    this.svg.addEventListener("pointerdown", (event) => {
      grabbed = event.target.dataset?.handle ?? null;
      if (grabbed === null) return;
      event.preventDefault();
      this.svg.setPointerCapture(event.pointerId);
    });
    this.svg.addEventListener("pointermove", (event) => {
      if (grabbed === null || waiting) return;
      waiting = true; // so that there is one message per picture, not one per pixel
      const place = { handle: grabbed, ...this.place(event) };
      requestAnimationFrame(() => {
        waiting = false;
        if (this.sets) this.nearest(place);
        else this.change("dragged", place);
      });
    });
    for (const end of ["pointerup", "pointercancel"]) this.svg.addEventListener(end, () => (grabbed = null));
  }

  // Go to the combination whose frame has the handle nearest to the pointer; lists keep their values.
  nearest({ handle, x, y }) {
    const now = this.model.get("variant");
    const [held, { index }] = [this.places(now), this];
    const lists = this.grid.flatMap(({ list }, axis) => (list ? [axis] : []));
    const far = (variant) => {
      const frames = this.sets[variant];
      for (const { handles, data } of frames[Math.min(index, frames.length - 1)].items) {
        const k = handles?.indexOf(handle) ?? -1;
        if (k >= 0) return Math.hypot(data[k][0] - x, data[k][1] - y);
      }
      return Infinity;
    };
    let [best, least] = [now, far(now)];
    this.sets.forEach((_, variant) => {
      const places = this.places(variant);
      if (lists.some((axis) => places[axis] !== held[axis])) return;
      const distance = far(variant);
      if (distance < least) [best, least] = [variant, distance];
    });
    if (best !== now) this.change("variant", best);
  }

  place(event) {
    const [x0, x1, , y1] = this.history.view;
    const box = this.svg.getBoundingClientRect();
    const unit = box.width / (x1 - x0);
    return { x: x0 + (event.clientX - box.left) / unit, y: y1 - (event.clientY - box.top) / unit };
  }

  close() {
    this.stop();
    for (const [event, call] of this.heard) this.model.off(event, call);
  }
}

export default {
  render({ model, el }) {
    const start = (sets) => {
      const player = new Player(model, el, sets);
      return () => player.close();
    };
    const text = model.get("packed");
    return text ? unpack(text).then(start) : start();
  },
};
