// The view of objects in space: turned by dragging and by arrow keys, drawn from back to front on a canvas.

const SCALE = 96 / 72; // the styles are in points, the picture in pixels
const THIN = 0.6; // the width of edges of faces, relative to the role's width
const START = ["azimuth", "elevation", "zoom", "explode", "section"];
const INNER = "#a9cfe6"; // the color of faces that a section uncovers, unless cells have colors

const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((v) => v / (Math.hypot(...a) || 1));
const mean = (rows) => [0, 1, 2].map((k) => rows.reduce((sum, row) => sum + row[k], 0) / rows.length);
// The faces of solid cells, by their number of corners.
const FACES = {
  4: [[1, 2, 3], [2, 0, 3], [0, 1, 3], [1, 0, 2]],
  5: [[0, 3, 2, 1], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
  6: [[0, 2, 1], [3, 4, 5], [0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]],
  8: [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]],
};

// The directions right, up and toward the reader, as in space.py.
function axes(azimuth, elevation) {
  const [a, e] = [(azimuth * Math.PI) / 180, (elevation * Math.PI) / 180];
  return {
    right: [-Math.sin(a), Math.cos(a), 0],
    up: [-Math.sin(e) * Math.cos(a), -Math.sin(e) * Math.sin(a), Math.cos(e)],
    toward: [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)],
  };
}

// Of cells that a plane may hide: which are kept, and how many of all and of the kept ones have each face.
function uncovered(item, at, { normal, low, high }, share) {
  const kept = item.data.map((row) => dot(mean(row.map(at)), normal) <= low + share * (high - low));
  const [all, left] = [new Map(), new Map()];
  const name = (row, ends) => ends.map((k) => row[k]).sort((a, b) => a - b).join();
  item.data.forEach((row, j) => {
    for (const ends of FACES[row.length]) {
      const key = name(row, ends);
      all.set(key, (all.get(key) ?? 0) + 1);
      if (kept[j]) left.set(key, (left.get(key) ?? 0) + 1);
    }
  });
  return {
    kept,
    hidden: (row, ends) => left.get(name(row, ends)) > 1,
    color: (row, ends) => (all.get(name(row, ends)) > 1 ? INNER : undefined),
  };
}

// All things to be drawn, each with its corners in space, their mean, and the normal of a face.
export function primitives(scene, explode, share) {
  const made = [];
  const [x, y, z, r] = scene.ball;
  const add = (item, kind, corners, lift = 0, more = {}) =>
    made.push({ item, kind, corners, middle: mean(corners), lift: lift * r, ...more });
  const face = (item, corners, color, inside) => {
    let normal = unit(cross(sub(corners[1], corners[0]), sub(corners[2], corners[0])));
    if (inside && dot(normal, sub(corners[0], inside)) < 0) normal = normal.map((v) => -v);
    const solid = (inside && (item.opacity ?? 1) === 1) || item.closed;
    add(item, "polygons", corners, item.lift ?? 0, { color, normal, solid });
  };
  for (const item of scene.items) {
    const at = (k) => item.points[k];
    const cut = scene.section && item.kind === "cells" ? uncovered(item, at, scene.section, share) : null;
    item.data.forEach((row, j) => {
      const color = item.colors?.[j] ?? undefined;
      if (cut && !cut.kept[j]) return;
      if (item.kind === "cells") {
        const corners = row.map(at);
        const center = mean(corners);
        const shift = sub(center, [x, y, z]).map((v) => v * explode);
        const moved = corners.map((c) => c.map((v, k) => v + shift[k]));
        for (const ends of FACES[row.length]) {
          if (cut && !explode && cut.hidden(row, ends)) continue;
          const shade = color ?? (explode ? undefined : cut?.color(row, ends));
          face(item, ends.map((k) => moved[k]), shade, mean(moved));
        }
      } else if (item.kind === "polygons") face(item, row.map(at), color);
      else if (item.kind === "segments") add(item, "segments", row.map(at), 0.05);
      else if (item.kind === "points") add(item, "points", [row], 0.45);
      else if (item.kind === "labels") add(item, "labels", [row], 10, { text: item.text[j] });
      else add(item, "spheres", [row.slice(0, 3)], 9, { r: row[3] });
    });
  }
  return made;
}

// The visible things from back to front, with names last. A solid cell hides those of its faces that point away.
function ordered(things, toward) {
  const seen = things.filter((thing) => !thing.solid || dot(thing.normal, toward) > 0);
  for (const thing of seen) thing.depth = dot(thing.middle, toward) + thing.lift;
  return seen.sort((a, b) => a.depth - b.depth);
}

const parse = (hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16));

function shaded(style, color, normal, light) {
  const bright = 0.66 + 0.34 * Math.abs(dot(normal, light));
  const base = color ? parse(color) : parse(style.fill).map((v) => 255 + (v - 255) * Math.max(style.alpha, 0.35));
  return `rgb(${base.map((v) => Math.round(v * bright)).join(" ")})`;
}

function marker(pen, letter, x, y, s) {
  pen.beginPath();
  if (letter === "s") pen.rect(x - s / 2, y - s / 2, s, s);
  else if (letter === "*") {
    for (let k = 0; k < 10; k++) {
      const q = (k % 2 ? 0.2 : 0.5) * s;
      pen.lineTo(x + q * Math.sin((k * Math.PI) / 5), y - q * Math.cos((k * Math.PI) / 5));
    }
    pen.closePath();
  } else if (letter === "D") {
    for (const [dx, dy] of [[0, -1], [1, 0], [0, 1], [-1, 0]]) pen.lineTo(x + (dx * s) / 2, y + (dy * s) / 2);
    pen.closePath();
  } else pen.arc(x, y, letter === "." ? s / 4 : s / 2, 0, 2 * Math.PI);
  pen.fill();
  pen.stroke();
}

function paint(pen, scene, things, styles, state, size) {
  const { right, up, toward } = axes(state.azimuth, state.elevation);
  const light = unit(toward.map((v, k) => v + 0.5 * up[k] - 0.35 * right[k]));
  const [x, y, z, r] = scene.ball;
  const scale = (0.46 * size * state.zoom) / (r * (1 + state.explode));
  const flat = (p) => {
    const q = sub(p, [x, y, z]);
    return [size / 2 + scale * dot(q, right), size / 2 - scale * dot(q, up)];
  };
  pen.fillStyle = "#fff";
  pen.fillRect(0, 0, size, size);
  pen.lineJoin = "round";
  for (const thing of ordered(things, toward)) {
    const style = styles[thing.item.role];
    const points = thing.corners.map(flat);
    const [px, py] = points[0];
    pen.globalAlpha = thing.item.opacity ?? 1;
    pen.strokeStyle = style.color;
    pen.lineWidth = style.width * SCALE;
    pen.setLineDash(style.dash.map((d) => d * SCALE));
    if (thing.kind === "polygons" || thing.kind === "segments") {
      pen.beginPath();
      for (const [a, b] of points) pen.lineTo(a, b);
      if (thing.kind === "polygons") {
        pen.closePath();
        pen.fillStyle = shaded(style, thing.color, thing.normal, light);
        pen.fill();
        pen.lineWidth *= THIN;
      }
      pen.stroke();
    } else if (thing.kind === "spheres") {
      ball(pen, style, px, py, thing.r * scale, state.elevation);
    } else if (thing.kind === "points") {
      pen.fillStyle = style.color;
      pen.strokeStyle = "#fff";
      pen.lineWidth = 0.7;
      pen.setLineDash([]);
      marker(pen, style.marker, px, py, style.size * SCALE);
    } else {
      pen.font = '13px "DejaVu Sans", Verdana, sans-serif';
      pen.setLineDash([]);
      pen.strokeStyle = "#fff";
      pen.lineWidth = 3;
      pen.strokeText(thing.text, px + 6, py - 6);
      pen.fillStyle = style.ink ?? style.color; // states stored earlier have no ink
      pen.fillText(thing.text, px + 6, py - 6);
    }
  }
  pen.globalAlpha = 1;
}

// A sphere is drawn as its outline, a light fill, and its equator, which gives an impression of depth.
function ball(pen, style, x, y, r, elevation) {
  pen.beginPath();
  pen.arc(x, y, r, 0, 2 * Math.PI);
  pen.stroke();
  const alpha = pen.globalAlpha;
  pen.globalAlpha = alpha * 0.1;
  pen.fillStyle = style.fill;
  pen.fill();
  pen.globalAlpha = alpha * 0.6;
  pen.lineWidth *= 0.6;
  pen.beginPath();
  pen.ellipse(x, y, r, Math.abs(r * Math.sin((elevation * Math.PI) / 180)), 0, 0, 2 * Math.PI);
  pen.stroke();
  pen.globalAlpha = alpha;
}

function build(el) {
  el.innerHTML = `<div class="unstruct-player unstruct-space" tabindex="0" role="group" data-lm-suppress-shortcuts="true">
    <div class="unstruct-caption"></div>
    <canvas class="unstruct-picture" role="img"></canvas>
    <div class="unstruct-number"></div>
    <div class="unstruct-bar">
      <button type="button" data-do="out" aria-label="zoom out" title="zoom out">−</button>
      <button type="button" data-do="in" aria-label="zoom in" title="zoom in">+</button>
      <button type="button" data-do="reset" aria-label="reset" title="reset">↺</button>
      <label>explode <input type="range" min="0" max="1.5" step="0.05" aria-label="explode"></label>
      <label>section <input type="range" min="0" max="1" step="0.02" aria-label="section"></label>
    </div>
  </div>`;
  // JupyterLab looks for this mark only up to the first element that one of its shortcuts is for.
  for (const own of el.querySelectorAll("input, button")) own.dataset.lmSuppressShortcuts = "true";
  return el.querySelector(".unstruct-space");
}

class View {
  constructor(model, el) {
    this.model = model;
    this.root = build(el);
    this.canvas = this.root.querySelector("canvas");
    this.sliders = Object.fromEntries(
      ["explode", "section"].map((name) => [name, this.root.querySelector(`[aria-label=${name}]`)]),
    );
    this.first = this.state; // the state that reset restores
    this.things = null; // computed once, not for every direction
    this.due = false;
    this.listenToKeys();
    this.listenToPointer();
    this.heard = [
      ["change:scene", () => (this.things = null)],
      ...[...START, "scene", "caption", "number", "alt", "size"].map((name) => [`change:${name}`, () => this.later()]),
    ];
    for (const [event, call] of this.heard) model.on(event, call);
    this.draw();
  }

  get state() {
    return Object.fromEntries(START.map((name) => [name, this.model.get(name)]));
  }

  later() {
    if (this.due) return; // several changes are drawn in one picture
    this.due = true;
    requestAnimationFrame(() => this.draw());
  }

  draw() {
    this.due = false;
    const { model, canvas, state } = this;
    const [scene, size, sharp] = [model.get("scene"), model.get("size"), window.devicePixelRatio || 1];
    canvas.width = canvas.height = Math.round(size * sharp);
    canvas.style.width = `${size}px`;
    this.root.style.width = `${Math.max(size, 300) + 10}px`;
    const moved = `${state.explode} ${state.section}`;
    if (this.things === null || this.moved !== moved) {
      this.moved = moved;
      this.things = primitives(scene, state.explode, state.section);
    }
    const pen = canvas.getContext("2d");
    pen.scale(sharp, sharp);
    paint(pen, scene, this.things, model.get("styles"), state, size);
    const [alt, caption, number] = ["alt", "caption", "number"].map((name) => model.get(name));
    this.root.querySelector(".unstruct-caption").textContent = caption;
    this.root.querySelector(".unstruct-number").textContent = number;
    this.root.setAttribute("aria-label", alt);
    canvas.setAttribute("aria-label", `${alt} ${caption} ${number}`.trim());
    const shown = { explode: scene.items.some((item) => item.kind === "cells"), section: scene.section };
    for (const [name, slider] of Object.entries(this.sliders)) {
      slider.value = state[name];
      slider.parentElement.hidden = !shown[name];
    }
  }

  change(values) {
    for (const [name, value] of Object.entries(values)) this.model.set(name, value);
    this.model.save_changes();
  }
  turn(across, up) {
    const { azimuth, elevation } = this.state;
    const around = (((azimuth + across) % 360) + 360) % 360;
    this.change({ azimuth: around, elevation: Math.min(90, Math.max(-90, elevation + up)) });
  }
  zoom(by) {
    this.change({ zoom: Math.min(8, Math.max(0.3, this.state.zoom * by)) });
  }

  listenToKeys() {
    const acts = { in: () => this.zoom(1.25), out: () => this.zoom(0.8), reset: () => this.change(this.first) };
    const keys = {
      ArrowLeft: () => this.turn(6, 0),
      ArrowRight: () => this.turn(-6, 0),
      ArrowUp: () => this.turn(0, -6),
      ArrowDown: () => this.turn(0, 6),
      "+": acts.in,
      "=": acts.in,
      "-": acts.out,
      Home: acts.reset,
    };
    this.root.addEventListener("keydown", (event) => {
      if (!keys[event.key] || event.target.type === "range") return;
      event.preventDefault();
      keys[event.key]();
    });
    this.root.addEventListener("click", (event) => acts[event.target.closest("button")?.dataset.do]?.());
    for (const [name, slider] of Object.entries(this.sliders))
      slider.addEventListener("input", () => this.change({ [name]: Number(slider.value) }));
  }

  listenToPointer() {
    const { canvas } = this;
    let from = null;
    canvas.addEventListener("pointerdown", (event) => {
      from = [event.clientX, event.clientY];
      canvas.setPointerCapture(event.pointerId);
      this.root.focus({ preventScroll: true });
    });
    canvas.addEventListener("pointermove", (event) => {
      if (from === null) return;
      this.turn((from[0] - event.clientX) * 0.5, (event.clientY - from[1]) * 0.5);
      from = [event.clientX, event.clientY];
    });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => (from = null));
    canvas.addEventListener("wheel", (event) => {
      if (document.activeElement !== this.root) return; // otherwise the page scrolls
      event.preventDefault();
      this.zoom(event.deltaY < 0 ? 1.1 : 1 / 1.1);
    });
  }

  close() {
    for (const [event, call] of this.heard) this.model.off(event, call);
  }
}

export default {
  render({ model, el }) {
    const view = new View(model, el);
    return () => view.close();
  },
};
