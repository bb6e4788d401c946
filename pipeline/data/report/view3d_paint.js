// Two painters of the same scene: three.js on WebGL, and a canvas of two dimensions that paints from back to front.
//
// A scene is {model, faces: null | Float32Array of colours a vertex, lines: [{points, colour, width, ghost}], theme};
// a sight is {frame: [right, up, towards], centre, scale: px per mm, shift: [x, y] px, width, height, radius: mm, ratio}.
//
// Each has its canvas.  That of WebGL, and the programs of its graphics, serve one part after the other: to begin with
// them takes longer than a part does, on a machine without a graphics card by far.
"use strict";
(function () {
  const { unit, dot } = window.planishPlaces;
  const LIGHT = unit([-0.45, 0.55, 0.7]);
  const FRONT = [0.78, 0.88, 0.96], BACK = [0.93, 0.87, 0.74], SHADE = 0.38, FIELD_SHADE = 0.22, DARK = 0.86;
  const SEAM = 1.1;   // px by which triangles overlap: else the ground shines through between them
  const MANY = 10000;   // triangles: with fewer a canvas is quicker than WebGL by the processor, with 1440 three times
  const LIFT = 0.05;   // how far lines are brought forward, as a share of the radius: half of a cell lies before its own far edge

  const dim = (colour, theme) => theme === "dark" ? colour.map((one) => one * DARK) : colour;

  // Where a point is seen: px from the left, px from the top, and mm towards the viewer.
  function seen(sight, x, y, z) {
    const p = [x - sight.centre[0], y - sight.centre[1], z - sight.centre[2]], [right, up, towards] = sight.frame;
    return [
      sight.width / 2 + sight.shift[0] + sight.scale * dot(p, right),
      sight.height / 2 + sight.shift[1] - sight.scale * dot(p, up),
      dot(p, towards),
    ];
  }

  function placed(sight, points) {
    const found = new Float64Array(points.length);
    for (let i = 0; i < points.length; i += 3) found.set(seen(sight, points[i], points[i + 1], points[i + 2]), i);
    return found;
  }

  class Flat {
    constructor() { this.canvas = document.createElement("canvas"); this.kind = "canvas"; this.pen = this.canvas.getContext("2d"); }
    load(scene) { this.scene = scene; }
    moved() {}
    recoloured() {}

    draw(sight) {
      const { pen, scene } = this, ratio = sight.ratio, queue = [];
      this.canvas.width = Math.round(sight.width * ratio);
      this.canvas.height = Math.round(sight.height * ratio);
      pen.setTransform(ratio, 0, 0, ratio, 0, 0);
      pen.lineCap = pen.lineJoin = "round";
      this.faces(sight, queue);
      for (const line of scene.lines) this.pieces(sight, line, queue);
      queue.sort((a, b) => a.depth - b.depth);
      for (const one of queue) this.paint(one);
      pen.globalAlpha = 0.3;
      for (const one of queue) if (one.ghost) this.paint({ ...one, width: 0.8 });
      pen.globalAlpha = 1;
    }

    faces(sight, queue) {
      const { model, faces, theme } = this.scene, t = model.triangles, at = placed(sight, model.positions);
      const [front, back] = [dim(FRONT, theme), dim(BACK, theme)], shade = faces ? FIELD_SHADE : SHADE;
      for (let i = 0; i < t.length; i += 3) {
        const [a, b, c] = [3 * t[i], 3 * t[i + 1], 3 * t[i + 2]];
        const turn = (at[b] - at[a]) * (at[c + 1] - at[a + 1]) - (at[b + 1] - at[a + 1]) * (at[c] - at[a]);
        const n = unit([0, 1, 2].map((k) => model.normal[a + k] + model.normal[b + k] + model.normal[c + k]));
        const lit = 1 - shade * (1 - Math.abs(sight.frame.reduce((sum, axis, k) => sum + LIGHT[k] * dot(axis, n), 0)));
        const own = faces ? [0, 1, 2].map((k) => (faces[a + k] + faces[b + k] + faces[c + k]) / 3) : turn < 0 ? front : back;
        const colour = `rgb(${own.map((one) => Math.round(255 * one * lit)).join()})`;
        const depth = (at[a + 2] + at[b + 2] + at[c + 2]) / 3;
        queue.push({ depth, at, corners: [a, b, c], colour, width: SEAM });
      }
    }

    pieces(sight, line, queue) {
      const at = placed(sight, line.points), lift = LIFT * sight.radius * (line.ghost ? 2 : 1);
      for (let i = 0; i + 5 < at.length; i += 6) {
        const depth = Math.max(at[i + 2], at[i + 5]) + lift;
        queue.push({ depth, at, corners: [i, i + 3], colour: line.colour, width: line.width, ghost: line.ghost });
      }
    }

    paint({ at, corners, colour, width }) {
      const pen = this.pen;
      pen.beginPath();
      pen.moveTo(at[corners[0]], at[corners[0] + 1]);
      for (const k of corners.slice(1)) pen.lineTo(at[k], at[k + 1]);
      if (corners.length > 2) { pen.closePath(); pen.fillStyle = colour; pen.fill(); }
      pen.strokeStyle = colour;
      pen.lineWidth = width;
      pen.stroke();
    }

    dispose() { this.canvas.remove(); this.canvas.width = this.canvas.height = 0; this.scene = null; }
  }

  const VERTEX = `attribute vec3 colour; varying vec3 vColour; varying vec3 vNormal;
    void main() { vColour = colour; vNormal = normalMatrix * normal; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`;
  const FRAGMENT = `uniform vec3 light, front, back; uniform float shade, field; varying vec3 vColour; varying vec3 vNormal;
    void main() {
      vec3 own = field > 0.5 ? vColour : gl_FrontFacing ? front : back;
      gl_FragColor = vec4(own * (1.0 - shade * (1.0 - abs(dot(normalize(vNormal), light)))), 1.0);
    }`;

  class Solid {
    constructor(three, context, slow) {
      this.slow = slow;   // by the processor
      this.canvas = context.canvas;
      this.kind = "webgl";
      this.three = three;
      this.renderer = new three.WebGLRenderer({ canvas: this.canvas, context });
      this.renderer.debug.checkShaderErrors = false;   // to ask for them is to wait until all programs are made
      this.renderer.setClearColor(0, 0);
      this.camera = new three.OrthographicCamera();
      this.camera.matrixAutoUpdate = false;
      const uniform = (value) => ({ value });
      this.paint = new three.ShaderMaterial({
        vertexShader: VERTEX, fragmentShader: FRAGMENT, side: three.DoubleSide,
        polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 4,
        uniforms: { light: uniform(LIGHT), front: uniform(FRONT), back: uniform(BACK), shade: uniform(SHADE), field: uniform(0) },
      });
      this.inks = new Map();   // kept as the paint is: with the last material of its kind a program goes
      this.owned = [];
    }

    get lost() { return this.renderer.getContext().isContextLost(); }

    own(thing) { this.owned.push(thing); return thing; }

    load(scene) {
      this.free();
      const three = this.three, { model } = scene;
      this.scene = scene;
      this.space = new three.Scene();
      const grid = this.grid = this.own(new three.BufferGeometry()), n = model.positions.length;
      grid.setAttribute("position", new three.BufferAttribute(Float32Array.from(model.positions), 3));
      grid.setAttribute("normal", new three.BufferAttribute(Float32Array.from(model.normal), 3));
      grid.setAttribute("colour", new three.BufferAttribute(new Float32Array(n), 3));
      grid.setIndex(new three.BufferAttribute(model.triangles, 1));
      this.add(new three.Mesh(grid, this.paint));
      for (const line of scene.lines) this.line(line);
      this.recoloured();
    }

    add(thing) { thing.frustumCulled = false; this.space.add(thing); }

    line(line) {
      const three = this.three, geometry = this.own(new three.LineSegmentsGeometry());
      geometry.setPositions(Float32Array.from(line.points));
      line.geometry = geometry;
      this.add(new three.LineSegments2(geometry, this.ink(line.colour, line.width, {})));
      if (line.ghost) this.add(new three.LineSegments2(geometry, this.ink(line.colour, 0.8, { transparent: true, opacity: 0.3, depthFunc: three.GreaterDepth, depthWrite: false })));
    }

    ink(color, linewidth, options) {
      const key = [color, linewidth, options.opacity].join();
      if (!this.inks.has(key)) this.inks.set(key, new this.three.LineMaterial({ color, linewidth, ...options }));
      return this.inks.get(key);
    }

    // The model has been formed anew: same places, other positions.
    moved() {
      const { model, lines } = this.scene, into = (name, values) => {
        this.grid.attributes[name].array.set(values);
        this.grid.attributes[name].needsUpdate = true;
      };
      into("position", model.positions);
      into("normal", model.normal);
      for (const { geometry, points } of lines) {
        geometry.attributes.instanceStart.data.array.set(points);
        geometry.attributes.instanceStart.data.needsUpdate = true;
      }
    }

    recoloured() {
      const { faces, theme } = this.scene, { uniforms } = this.paint;
      uniforms.field.value = faces ? 1 : 0;
      uniforms.shade.value = faces ? FIELD_SHADE : SHADE;
      uniforms.front.value = dim(FRONT, theme);
      uniforms.back.value = dim(BACK, theme);
      if (!faces) return;
      this.grid.attributes.colour.array.set(faces);
      this.grid.attributes.colour.needsUpdate = true;
    }

    draw(sight) {
      const { camera, renderer } = this, { scale, width, height, shift, centre } = sight, [r, u, t] = sight.frame;
      const size = [width, height, sight.ratio];
      if (size.join() !== this.size) renderer.setDrawingBufferSize(...size);   // made anew whenever it is set
      this.size = size.join();
      const far = 4 * sight.radius, eye = (k) => centre[k] + 2 * sight.radius * t[k];
      camera.left = (-width / 2 - shift[0]) / scale;
      camera.right = (width / 2 - shift[0]) / scale;
      camera.top = (height / 2 + shift[1]) / scale;
      camera.bottom = (-height / 2 + shift[1]) / scale;
      [camera.near, camera.far] = [0, far];
      camera.updateProjectionMatrix();
      camera.matrix.set(r[0], u[0], t[0], eye(0), r[1], u[1], t[1], eye(1), r[2], u[2], t[2], eye(2), 0, 0, 0, 1);
      camera.matrixWorldNeedsUpdate = true;
      for (const ink of this.inks.values()) ink.resolution.set(width, height);
      renderer.render(this.space, camera);
    }

    free() { for (const thing of this.owned.splice(0)) thing.dispose(); }

    dispose() {
      this.free();
      this.scene = this.space = null;
      this.canvas.remove();
      if (!kept && !this.lost) kept = this;
      else this.end();
    }

    end() {
      for (const material of [this.paint, ...this.inks.values()]) material.dispose();
      this.renderer.dispose();
      if (!this.lost) this.renderer.forceContextLoss();
    }
  }

  let kept = null, card = null;   // the painter on WebGL that no part has now; whether there is a graphics card, if tried

  // wish: "webgl", "canvas", or what is quicker here: without a graphics card a canvas, unless there are many triangles.
  function painter(wish, triangles = 0) {
    if (wish === "canvas" || !window.planishThree) return new Flat();
    const known = kept, strict = wish !== "webgl" && triangles < MANY;
    if (known && strict && known.slow) return new Flat();
    kept = null;
    if (known && !known.lost) return known;
    known?.end();
    return solid(strict) ?? new Flat();
  }

  function solid(strict) {
    if (strict && card === false) return null;
    const canvas = document.createElement("canvas");
    const context = canvas.getContext("webgl2", { antialias: true, alpha: true, failIfMajorPerformanceCaveat: strict });
    card = context !== null && !byProcessor(context);
    if (context && (card || !strict)) return new Solid(window.planishThree, context, !card);
    context?.getExtension("WEBGL_lose_context")?.loseContext();
    return null;
  }

  // Whether a processor does the work of a graphics card, by the name of who draws; not all browsers say it at once.
  function byProcessor(context) {
    const told = context.getParameter(context.RENDERER), more = told.startsWith("WebKit") && context.getExtension("WEBGL_debug_renderer_info");
    const name = more ? context.getParameter(more.UNMASKED_RENDERER_WEBGL) : told;
    return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
  }

  window.planishPaint = { painter, seen, placed };
})();
