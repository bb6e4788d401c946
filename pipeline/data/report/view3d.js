// A formed part to be turned, on a page: `planishView3d.mount(host, part, options)`.
//
// Needs the other view3d_*.js before it; three.min.js is used if it is there.  Asks nothing of a network.
"use strict";
(function () {
  const { sharesOf, cross } = window.planishPlaces, { painter, seen, placed } = window.planishPaint, { INK, colour } = window.planishOver;
  const MARGIN = 42, BELOW = 40, LEAST_ZOOM = 0.3, MOST_ZOOM = 60;
  const WIDTH = { ruling: 0.8, mark: 1.2, bend: 1.4, hole: 1.4, worst: 3, c0: 2.6, c1: 2.6, start: 2.6, end: 2.6 };
  const GHOSTS = ["c0", "c1", "start", "end"], FILL = "position:absolute;inset:0;width:100%;height:100%;";

  function element(host, tag, style, text) {
    const made = document.createElement(tag);
    made.style.cssText = style;
    if (text !== undefined) made.textContent = text;
    host.append(made);
    return made;
  }

  class View {
    constructor(host, part, options) {
      this.host = host;
      this.part = part;
      this.options = options;
      this.theme = options.theme === "dark" ? "dark" : "light";
      this.model = window.planishModel.of(part);
      this.fields = this.model.fields;
      this.canForm = this.model.canForm;
      this.share = 1;
      this.drawn = 0;
      this.gone = new AbortController();
      this.build();
      this.field = this.fields.find((one) => one.name === options.field) ?? null;
      if (this.field) this.choice.value = this.field.name;
      this.reset();
      this.load();
      this.watcher = new ResizeObserver(() => this.resize());
      this.watcher.observe(host);
    }

    build() {
      this.host.style.position = "relative";
      this.host.replaceChildren();
      this.over = element(this.host, "canvas", FILL + "touch-action:none;cursor:grab;");
      this.over.tabIndex = 0;
      this.over.setAttribute("role", "img");
      this.over.setAttribute("aria-label", "Formed part. Arrow keys turn it, with shift move it, plus and minus zoom, Home resets.");
      this.note = element(this.host, "div", "position:absolute;left:8px;top:32px;font:12px system-ui,sans-serif;pointer-events:none;white-space:pre;");
      this.controls();
      this.take(painter(this.options.by, this.model.triangles.length / 3));
      this.painter.canvas.addEventListener("webglcontextlost", (event) => this.fallBack(event), { signal: this.gone.signal });
      window.planishHands.listen(this.over, this, this.gone.signal);
    }

    take(painter_) {
      this.painter = painter_;
      this.painter.canvas.style.cssText = FILL;
      this.host.prepend(this.painter.canvas);
    }

    controls() {
      const bar = this.bar = element(this.host, "div", "position:absolute;right:8px;top:6px;display:flex;gap:8px;align-items:center;font:12px system-ui,sans-serif;");
      const signal = this.gone.signal;
      if (this.fields.length) {
        this.choice = element(bar, "select", "font:inherit;");
        this.choice.setAttribute("aria-label", "Colours of the formed part");
        element(this.choice, "option", "", "two sides").value = "sides";
        for (const { name, title } of this.fields) Object.assign(element(this.choice, "option", "", name), { value: name, title });
        this.choice.addEventListener("change", () => this.setField(this.choice.value), { signal });
      }
      if (this.canForm) {
        const label = element(bar, "label", "display:flex;gap:4px;align-items:center;", "flat");
        this.slider = element(label, "input", "width:90px;");
        Object.assign(this.slider, { type: "range", min: 0, max: 1, step: 0.005, value: 1 });
        this.slider.setAttribute("aria-label", "From flat to formed");
        element(label, "span", "", "formed");
        this.slider.addEventListener("input", () => this.setForm(Number(this.slider.value)), { signal });
      }
      const again = element(bar, "button", "font:inherit;", "reset");
      again.type = "button";
      again.title = "First view (Home)";
      again.addEventListener("click", () => this.reset(), { signal });
    }

    fallBack(event) {
      event.preventDefault();
      if (this.gone.signal.aborted) return;
      this.painter.dispose();
      this.take(painter("canvas"));
      this.load();
    }

    // A canvas of WebGL is blank on paper: there the part is painted as it stands on one of two dimensions.
    toPaper(ratio) {
      if (this.paper) return;
      this.paper = painter("canvas");
      this.paper.canvas.style.cssText = FILL;
      this.painter.canvas.replaceWith(this.paper.canvas);
      this.paper.load(this.scene);
      const sight = { ...this.sight(), ratio };
      this.paper.draw(sight);
      this.drawOver(sight);
    }

    fromPaper() {
      this.paper?.canvas.replaceWith(this.painter.canvas);
      this.paper?.dispose();
      this.paper = null;
      this.ask();
    }

    orbit(around, over) {
      this.around += around;
      this.height = Math.max(-Math.PI / 2, Math.min(this.height + over, Math.PI / 2));
      this.ask();
    }

    pan(x, y) { this.shift = [this.shift[0] + x, this.shift[1] + y]; this.ask(); }

    zoom(by, at = [this.size()[0] / 2, this.size()[1] / 2]) {
      const next = Math.max(LEAST_ZOOM, Math.min(this.times * by, MOST_ZOOM)), k = next / this.times;
      const off = [at[0] - this.size()[0] / 2, at[1] - (this.size()[1] - BELOW) / 2 - MARGIN / 4];
      this.shift = this.shift.map((x, i) => off[i] + k * (x - off[i]));
      this.times = next;
      this.ask();
    }

    reset() {
      const [, , towards] = this.part.frame;
      this.around = Math.atan2(towards[1], towards[0]);
      this.height = Math.asin(Math.max(-1, Math.min(towards[2], 1)));
      this.shift = [0, 0];
      this.times = 1;
      this.ask();
    }

    frame() {
      const [a, e] = [this.around, this.height], towards = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
      const right = [-Math.sin(a), Math.cos(a), 0];
      return [right, cross(towards, right), towards];
    }

    size() { return [Math.max(this.host.clientWidth, 1), Math.max(this.host.clientHeight, 1)]; }

    // How large the part is as it stands, along the axes of the first view: so that turning it does not zoom.
    measure() {
      const axes = this.part.frame, low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity], p = this.model.positions;
      for (let i = 0; i < p.length; i += 3) {
        for (let k = 0; k < 3; k++) {
          const x = p[i] * axes[k][0] + p[i + 1] * axes[k][1] + p[i + 2] * axes[k][2];
          low[k] = Math.min(low[k], x);
          high[k] = Math.max(high[k], x);
        }
      }
      const mid = low.map((x, k) => (x + high[k]) / 2), wide = low.map((x, k) => high[k] - x);
      const centre = [0, 1, 2].map((j) => mid.reduce((sum, x, k) => sum + x * axes[k][j], 0));
      this.extent = { centre, wide, radius: Math.max(Math.hypot(...wide), 1e-9) };
    }

    sight() {
      const [width, height] = this.size(), { centre, wide, radius } = this.extent;
      const fit = Math.min((width - 2 * MARGIN) / Math.max(wide[0], 1e-9), (height - 2 * MARGIN - BELOW) / Math.max(wide[1], 1e-9));
      const shift = [this.shift[0], this.shift[1] + MARGIN / 4 - BELOW / 2];
      return { frame: this.frame(), centre, scale: Math.max(fit, 1e-6) * this.times, shift, width, height, radius, ratio: Math.min(window.devicePixelRatio || 1, 3) };
    }

    load() {
      const ink = INK[this.theme];
      const lines = this.model.drawn.map((one) => Object.defineProperty({ colour: ink[one.kind], width: WIDTH[one.kind], ghost: GHOSTS.includes(one.kind) }, "points", { get: () => one.points }));
      this.scene = { model: this.model, faces: this.faces(), lines, theme: this.theme };
      this.painter.load(this.scene);
      this.host.style.background = ink.paper;
      this.note.style.color = this.bar.style.color = ink.ink;
      this.bar.style.colorScheme = this.theme;
      this.measure();
      this.ask();
    }

    faces() {
      if (!this.field) return null;
      this.beyond = this.field.values.some((value) => Math.abs(value) > this.field.limit);
      const values = this.model.values(this.field), found = new Float32Array(3 * values.length);
      values.forEach((value, i) => found.set(colour(value / this.field.limit).map((one) => one / 255), 3 * i));
      return found;
    }

    setField(name) {
      this.field = this.fields.find((one) => one.name === name) ?? null;
      if (this.choice) this.choice.value = this.field ? this.field.name : "sides";
      this.scene.faces = this.faces();
      this.painter.recoloured();
      this.ask();
    }

    setTheme(theme) { this.theme = theme === "dark" ? "dark" : "light"; this.load(); }

    setForm(share) {
      if (!this.canForm) return;
      this.share = Math.max(0, Math.min(share, 1));
      this.slider.value = this.share;
      this.model.form(this.share);
      this.painter.moved();
      this.measure();
      this.ask();
    }

    resize() { this.ask(); }

    ask() {
      if (this.waiting || !this.scene) return;
      this.waiting = requestAnimationFrame(() => { this.waiting = 0; this.draw(); });
    }

    draw() {
      if (this.paper) return;
      const sight = this.now = this.sight();
      this.painter.draw(sight);
      this.drawOver(sight);
      this.drawn += 1;
    }

    // What is under a point of the screen, nearest to the viewer.
    pick(x, y) {
      const sight = this.now ?? this.sight(), at = placed(sight, this.model.positions), t = this.model.triangles;
      let best = null, depth = -Infinity;
      for (let i = 0; i < t.length; i += 3) {
        const [a, b, c] = [3 * t[i], 3 * t[i + 1], 3 * t[i + 2]];
        if (Math.max(at[a], at[b], at[c]) < x || Math.min(at[a], at[b], at[c]) > x) continue;
        const corners = [t[i], t[i + 1], t[i + 2]], shares = sharesOf(at, 3, corners, x, y);
        if (!shares || Math.min(...shares) < 0) continue;
        const near = shares[0] * at[a + 2] + shares[1] * at[b + 2] + shares[2] * at[c + 2];
        if (near > depth) [best, depth] = [{ corners, shares }, near];
      }
      return best && this.model.spot(best.corners, best.shares, this.field);
    }

    hover(at) { this.show(at && this.pick(...at), true); }

    show(spot, tell) {
      if (!spot && !this.spot) return;
      this.spot = spot;
      this.note.textContent = spot ? window.planishOver.words(spot, this.field) : "";
      if (this.now) this.drawOver(this.now);
      if (tell) this.options.onCursor?.(spot && { u: spot.u, v: spot.v, x: spot.x, y: spot.y, value: spot.value });
    }

    setCursor(place) { this.show(place ? this.model.find(place, this.field) : null, false); }

    drawOver(sight) {
      const { width, height, ratio } = sight, { field, model, part, spot, theme } = this, pen = this.over.getContext("2d");
      this.over.width = Math.round(width * ratio);
      this.over.height = Math.round(height * ratio);
      pen.setTransform(ratio, 0, 0, ratio, 0, 0);
      const on = (row, u) => model.at(row, u, model.rails, 3), ruled = spot?.row !== undefined;
      window.planishOver.draw(pen, sight, {
        theme, field, beyond: this.beyond,
        deviation: `shown to ${Number(part.deviation_mm.toPrecision(2))} mm (${part.evidence})`,
        spot: ruled ? on(spot.row, spot.u) : spot?.point,
        ends: ruled ? [on(spot.row, 0), on(spot.row, 1)] : null,
      });
    }

    project(point) {
      const at = point.map((x, k) => x - this.model.origin[k]);
      return seen(this.sight(), ...at).slice(0, 2);
    }

    dispose() {
      this.gone.abort();
      this.watcher.disconnect();
      cancelAnimationFrame(this.waiting);
      this.paper?.dispose();
      this.painter.dispose();
      this.host.replaceChildren();
      this.model = this.scene = this.spot = null;
    }
  }

  function mount(host, part, options = {}) {
    const view = new View(host, part, options);
    return {
      get kind() { return view.painter.kind; },
      get canForm() { return view.canForm; },
      get drawn() { return view.drawn; },
      fields: view.fields.map(({ name, title, unit, limit }) => ({ name, title, unit, limit })),
      setCursor: (place) => view.setCursor(place),
      setField: (name) => view.setField(name),
      setTheme: (theme) => view.setTheme(theme),
      setForm: (share) => view.setForm(share),
      resize: () => view.resize(),
      reset: () => view.reset(),
      project: (point) => view.project(point),
      toPaper: (ratio) => view.toPaper(ratio),
      fromPaper: () => view.fromPaper(),
      dispose: () => view.dispose(),
    };
  }

  window.planishView3d = { mount, colour };
})();
