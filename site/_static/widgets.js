// Draw the widgets stored in a page without a kernel: an anywidget's own script draws and steps it;
// sliders and buttons, whose work Python does, are named in a note instead of shown dead.
(function () {
  "use strict";
  const modules = new Map();

  function text(nameOrText) {
    const files = window.unstructFiles || {};
    return Object.hasOwn(files, nameOrText) ? files[nameOrText] : nameOrText;
  }

  function load(nameOrText) {
    if (!modules.has(nameOrText)) {
      // A blob, for a page opened from a disk may not import a module from a file.
      const blob = new Blob([text(nameOrText)], { type: "text/javascript" });
      modules.set(nameOrText, import(URL.createObjectURL(blob)));
    }
    return modules.get(nameOrText);
  }

  class Model {
    constructor(traits) {
      this.traits = traits;
      this.listeners = new Map();
    }
    get(name) {
      return this.traits[name];
    }
    set(name, value) {
      const changes = typeof name === "object" ? name : { [name]: value };
      for (const [key, next] of Object.entries(changes)) {
        const before = this.traits[key];
        this.traits[key] = next;
        if (before !== next) this.emit(`change:${key}`, this, next);
      }
      this.emit("change", this);
    }
    on(names, listener) {
      for (const name of names.split(" ")) {
        if (!this.listeners.has(name)) this.listeners.set(name, new Set());
        this.listeners.get(name).add(listener);
      }
    }
    off(name, listener) {
      if (!name) this.listeners.clear();
      else if (!listener) this.listeners.delete(name);
      else this.listeners.get(name)?.delete(listener);
    }
    emit(name, ...values) {
      for (const listener of [...(this.listeners.get(name) || [])]) listener(...values);
    }
    save_changes() {}
    send() {}
  }

  async function drawAnywidget(el, widget) {
    if (widget.style) {
      const style = document.createElement("style");
      style.textContent = text(widget.style);
      el.append(style);
    }
    const inner = el.appendChild(document.createElement("div"));
    const module = await load(widget.script);
    const own = typeof module.default === "function" ? await module.default() : module.default;
    const context = { model: new Model(structuredClone(widget.traits)), el: inner, experimental: {} };
    if (own.initialize) await own.initialize(context);
    await own.render(context);
  }

  async function draw(el, widget, controls) {
    if (widget.kind === "anywidget") {
      await drawAnywidget(el, widget);
    } else if (widget.kind === "text") {
      el.innerHTML = widget.value;
    } else if (widget.kind === "control") {
      controls.push(widget.description);
    } else {
      el.classList.add(`unstruct-${widget.kind}`);
      for (const child of widget.children) {
        await draw(el.appendChild(document.createElement("div")), child, controls);
      }
    }
  }

  async function start() {
    for (const place of document.querySelectorAll(".unstruct-widget")) {
      const widget = JSON.parse(place.querySelector("script").textContent);
      const controls = [];
      try {
        await draw(place.appendChild(document.createElement("div")), widget, controls);
        place.dataset.state = "drawn";
      } catch (error) {
        place.dataset.state = "failed";
        controls.push("");
        console.error(error);
      }
      if (controls.length) {
        const note = place.appendChild(document.createElement("p"));
        const named = controls.filter(Boolean).map((name) => `“${name.replace(/:$/, "")}”`).join(", ");
        note.className = "unstruct-note";
        note.textContent = `${named ? `The controls ${named} work` : "This widget works"} in the live notebook; `
          + "the pictures on this page show what it does.";
      }
    }
  }

  if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", start);
  else start();
})();
