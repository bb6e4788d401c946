// A formed part to be turned, on a page: `planishView3d.mount(host, part, options)`.
//
// Needs view3d_model.js and view3d_paint.js before it; three.min.js is used if it is there.  Asks nothing of a network.
"use strict";
(function () {
  const { of, sharesOf, cross } = window.planishModel, { painter, seen, placed } = window.planishPaint;
  const STRETCHED = [213, 94, 0], PRESSED = [0, 114, 178], WHITE = [255, 255, 255], UNKNOWN = [150, 150, 150];
  const MARGIN = 42, BELOW = 40, TURN = 0.0087, STEP = 0.14, ZOOM = 1.2, LEAST_ZOOM = 0.3, MOST_ZOOM = 60;
  const INK = {
    light: { c0: "#0072B2", c1: "#D55E00", start: "#007D5C", end: "#555555", ruling: "#8C8C8C", mark: "#1A1A1A", hole: "#1A1A1A", bend: "#B0307A", worst: "#B0307A", ink: "#1A1A1A", paper: "#FFFFFF" },
    dark: { c0: "#3AA0DC", c1: "#F28A3C", start: "#35B58F", end: "#B8B8B8", ruling: "#6F767D", mark: "#1A1A1A", hole: "#C8C8C8", bend: "#B0307A", worst: "#B0307A", ink: "#E8E8E8", paper: "#15181C" },
  };
  const WIDTH = { ruling: 0.8, mark: 1.2, bend: 1.4, hole: 1.4, worst: 3, c0: 2.6, c1: 2.6, start: 2.6, end: 2.6 };
  const GHOSTS = ["c0", "c1", "start", "end"];

  // The colour of a share of the limit: white at 0, orange at +1, blue at -1 and beyond.
  function colour(share) {
    if (Number.isNaN(share)) return UNKNOWN;
    const end = share >= 0 ? STRETCHED : PRESSED, size = Math.min(Math.abs(share), 1);
    return WHITE.map((white, k) => white + size * (end[k] - white));
  }

  const digits = (x) => x === 0 ? "0" : Number(x.toPrecision(3)).toString();
  const told = (field, value) => field.unit === "1" ? `${digits(100 * value)} %` : `${digits(value)} ${field.unit}`;
  const radius = (field, value) => field.name === "curvature" && Math.abs(value) > 1e-12 ? `, radius ${digits(1 / Math.abs(value))} mm` : "";

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
      this.model = of(part);
      this.fields = this.model.fields;
      this.canForm = this.model.canForm;
      this.share = 1;
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
      const fill = "position:absolute;inset:0;width:100%;height:100%;";
      this.canvas = element(this.host, "canvas", fill);
      this.over = element(this.host, "canvas", fill + "touch-action:none;cursor:grab;");
      this.over.tabIndex = 0;
      this.over.setAttribute("role", "img");
      this.over.setAttribute("aria-label", "Formed part. Arrow keys turn it, with shift move it, plus and minus zoom, Home resets.");
      this.note = element(this.host, "div", "position:absolute;left:8px;top:32px;font:12px system-ui,sans-serif;pointer-events:none;white-space:pre;");
      this.controls();
      this.painter = painter(this.canvas, this.options.three !== false);
      this.canvas.addEventListener("webglcontextlost", (event) => this.fallBack(event), { signal: this.gone.signal });
      this.listen();
    }

    controls() {
      const bar = this.bar = element(this.host, "div", "position:absolute;right:8px;top:6px;display:flex;gap:8px;align-items:center;font:12px system-ui,sans-serif;");
      const signal = this.gone.signal;
      if (this.fields.length) {
        this.choice = element(bar, "select", "font:inherit;");
        this.choice.setAttribute("aria-label", "Colours of the formed part");
        for (const name of ["sides", ...this.fields.map((one) => one.name)]) element(this.choice, "option", "", name).value = name;
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
      const fresh = this.canvas.cloneNode();
      this.canvas.replaceWith(fresh);
      this.canvas = fresh;
      this.painter.dispose();
      this.painter = painter(fresh, false);
      this.load();
    }

    listen() {
      const on = (name, call) => this.over.addEventListener(name, call, { signal: this.gone.signal, passive: false });
      this.held = new Map();
      on("pointerdown", (event) => { this.over.setPointerCapture(event.pointerId); this.hold(event); this.over.style.cursor = "grabbing"; });
      on("pointermove", (event) => this.held.has(event.pointerId) ? this.drag(event) : this.hover(event));
      for (const name of ["pointerup", "pointercancel"]) on(name, (event) => this.release(event));
      on("pointerleave", () => this.show(null, true));
      on("contextmenu", (event) => event.preventDefault());
      on("dblclick", () => this.reset());
      on("wheel", (event) => { event.preventDefault(); this.zoom(ZOOM ** (-Math.sign(event.deltaY) / 2), this.local(event)); });
      on("keydown", (event) => this.key(event));
      window.addEventListener("beforeprint", () => this.draw(), { signal: this.gone.signal });
    }

    local(event) { const box = this.over.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; }
    hold(event) { this.held.set(event.pointerId, { at: this.local(event), moved: false }); }
    release(event) {
      if (event.type === "pointerup" && this.held.get(event.pointerId)?.moved === false) this.hover(event);
      this.held.delete(event.pointerId);
      this.over.style.cursor = "grab";
    }

    drag(event) {
      const mine = this.held.get(event.pointerId), before = mine.at, now = mine.at = this.local(event);
      const by = [now[0] - before[0], now[1] - before[1]];
      mine.moved = mine.moved || Math.hypot(...by) > 0;
      const other = [...this.held].find(([id]) => id !== event.pointerId)?.[1].at;
      if (other) {
        const far = (at) => Math.max(Math.hypot(at[0] - other[0], at[1] - other[1]), 1);
        this.zoom(far(now) / far(before), now.map((x, k) => (x + other[k]) / 2));
        this.pan(by[0] / 2, by[1] / 2);
      } else if (event.shiftKey || event.buttons & 6) this.pan(...by);
      else this.orbit(-TURN * by[0], TURN * by[1]);
    }

    key(event) {
      const arrow = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      if (arrow && event.shiftKey) this.pan(-20 * arrow[0], 20 * arrow[1]);
      else if (arrow) this.orbit(STEP * arrow[0], STEP * arrow[1]);
      else if (event.key === "+" || event.key === "=") this.zoom(ZOOM);
      else if (event.key === "-") this.zoom(1 / ZOOM);
      else if (event.key === "Home" || event.key === "0") this.reset();
      else return;
      event.preventDefault();
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
      const sight = this.now = this.sight();
      this.painter.draw(sight);
      this.drawOver(sight);
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

    hover(event) { this.show(this.pick(...this.local(event)), true); }

    show(spot, tell) {
      if (!spot && !this.spot) return;
      this.spot = spot;
      this.note.textContent = spot ? this.words(spot) : "";
      if (this.now) this.drawOver(this.now);
      if (tell) this.options.onCursor?.(spot && { u: spot.u, v: spot.v, x: spot.x, y: spot.y, value: spot.value });
    }

    words(spot) {
      const place = spot.u === undefined ? [] : [`u ${spot.u.toFixed(3)}`, `v ${spot.v.toFixed(3)}`];
      if (spot.x !== undefined) place.push(`x ${spot.x.toFixed(1)}`, `y ${spot.y.toFixed(1)} mm flat`);
      if (this.field && spot.value !== undefined) place.push(`${this.field.name} ${told(this.field, spot.value)}${radius(this.field, spot.value)}`);
      return place.join("   ");
    }

    setCursor(place) { this.show(place ? this.model.find(place, this.field) : null, false); }

    drawOver(sight) {
      const { width, height, ratio } = sight, pen = this.over.getContext("2d"), ink = INK[this.theme];
      this.over.width = Math.round(width * ratio);
      this.over.height = Math.round(height * ratio);
      pen.setTransform(ratio, 0, 0, ratio, 0, 0);
      pen.font = "11px system-ui, sans-serif";
      pen.fillStyle = pen.strokeStyle = ink.ink;
      this.axes(pen, sight);
      this.scaleBar(pen, sight);
      if (this.field) this.legend(pen, sight);
      else this.said(pen, sight);
      if (this.spot) this.cursor(pen, sight);
    }

    cursor(pen, sight) {
      if (this.spot.row !== undefined) {
        const ends = [0, 1].map((u) => seen(sight, ...this.model.at(this.spot.row, u, this.model.rails, 3)));
        pen.lineWidth = 1.5;
        pen.setLineDash([5, 3]);
        pen.beginPath();
        pen.moveTo(ends[0][0], ends[0][1]);
        pen.lineTo(ends[1][0], ends[1][1]);
        pen.stroke();
        pen.setLineDash([]);
      }
      const [x, y] = seen(sight, ...(this.spot.row === undefined ? this.spot.point : this.model.at(this.spot.row, this.spot.u, this.model.rails, 3)));
      for (const [r, tone] of [[6, "#FFFFFF"], [4.5, "#B0307A"]]) {
        pen.beginPath();
        pen.arc(x, y, r, 0, 7);
        pen.fillStyle = tone;
        pen.fill();
      }
      pen.fillStyle = INK[this.theme].ink;
    }

    axes(pen, sight) {
      const [x, y] = [30, sight.height - 30];
      pen.lineWidth = 1.3;
      "xyz".split("").forEach((name, k) => {
        const [dx, dy] = [20 * sight.frame[0][k], -20 * sight.frame[1][k]], far = Math.hypot(dx, dy) || 1;
        pen.beginPath();
        pen.moveTo(x, y);
        pen.lineTo(x + dx, y + dy);
        pen.stroke();
        pen.textAlign = "center";
        pen.fillText(name, x + dx + 8 * dx / far, y + dy + 8 * dy / far + 4);
      });
    }

    scaleBar(pen, sight) {
      const most = Math.min(140, sight.width / 4) / sight.scale, power = 10 ** Math.floor(Math.log10(most));
      const long = [5, 2, 1].find((one) => one * power <= most) * power, [x, y] = [sight.width - 16, sight.height - 14];
      pen.lineWidth = 1.5;
      pen.beginPath();
      pen.moveTo(x - long * sight.scale, y - 5);
      pen.lineTo(x - long * sight.scale, y);
      pen.lineTo(x, y);
      pen.lineTo(x, y - 5);
      pen.stroke();
      pen.textAlign = "right";
      pen.fillText(`${digits(long)} mm`, x, y - 9);
    }

    said(pen, sight) {
      pen.textAlign = "left";
      pen.fillText(`shown to ${digits(this.part.deviation_mm)} mm (${this.part.evidence})`, 66, sight.height - 14);
    }

    legend(pen, sight) {
      const field = this.field, [x, y, wide] = [66, sight.height - 30, Math.max(90, Math.min(240, sight.width - 250))];
      for (let i = 0; i < wide; i++) {
        pen.fillStyle = `rgb(${colour(2 * (i + 0.5) / wide - 1).map(Math.round).join()})`;
        pen.fillRect(x + i, y, 1.5, 9);
      }
      pen.strokeStyle = pen.fillStyle = INK[this.theme].ink;
      pen.lineWidth = 0.7;
      pen.strokeRect(x, y, wide, 9);
      const scale = field.unit === "1" ? 100 : 1, sign = field.unit === "1" ? " %" : "";
      [-1, 0, 1].forEach((share, k) => {
        pen.textAlign = ["left", "center", "right"][k];
        pen.fillText(`${share > 0 ? "+" : ""}${digits(share * scale * field.limit)}${share ? sign : ""}`, x + wide * (share + 1) / 2, y + 21);
      });
      pen.textAlign = "left";
      pen.fillText(`${field.title}${field.unit === "1" ? "" : `, ${field.unit}`} (${field.evidence})`, x, y - 6);
    }

    project(point) {
      const at = point.map((x, k) => x - this.model.origin[k]);
      return seen(this.sight(), ...at).slice(0, 2);
    }

    dispose() {
      this.gone.abort();
      this.watcher.disconnect();
      cancelAnimationFrame(this.waiting);
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
      fields: view.fields.map(({ name, title, unit, limit }) => ({ name, title, unit, limit })),
      setCursor: (place) => view.setCursor(place),
      setField: (name) => view.setField(name),
      setTheme: (theme) => view.setTheme(theme),
      setForm: (share) => view.setForm(share),
      resize: () => view.resize(),
      reset: () => view.reset(),
      project: (point) => view.project(point),
      dispose: () => view.dispose(),
    };
  }

  window.planishView3d = { mount, colour };
})();
