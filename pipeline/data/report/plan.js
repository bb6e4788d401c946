/* A drawing in mm on a canvas: fitted, zoomed and moved by wheel, fingers and keys, with a scale bar. */

const themeColour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/* headroom: px above the drawing that are to stay free, at a time. */
function openPlan(canvas, box, draw, hover, headroom = () => 0) {
  const context = canvas.getContext("2d");
  const plan = { canvas, context, k: 1, ox: 0, oy: 0, width: 0, height: 0, fitted: 1, sharpness: null };
  plan.place = (x, y) => [plan.ox + plan.k * x, plan.oy - plan.k * y];
  plan.unplace = (px, py) => [(px - plan.ox) / plan.k, (plan.oy - py) / plan.k];
  let asked = 0;
  plan.redraw = () => { if (!asked) asked = requestAnimationFrame(() => { asked = 0; paint(plan, draw); }); };
  plan.paint = () => paint(plan, draw);
  plan.fit = () => { fitPlan(plan, box, headroom()); plan.redraw(); };
  plan.refit = () => { if (Math.abs(plan.k - plan.fitted) < 1e-9 * plan.fitted) plan.fit(); else plan.redraw(); };
  plan.zoom = (factor, px = plan.width / 2, py = plan.height / 2) => { zoomPlan(plan, factor, px, py); plan.redraw(); };
  plan.move = (dx, dy) => { plan.ox += dx; plan.oy += dy; plan.redraw(); };
  const sized = () => {
    const whole = plan.width === 0 || Math.abs(plan.k - plan.fitted) < 1e-9 * plan.fitted;
    plan.width = canvas.clientWidth; plan.height = canvas.clientHeight;
    raster(plan);
    if (whole) fitPlan(plan, box, headroom());
    plan.paint();
  };
  /* sharpness: dots of the canvas to a px of the page; null: as the screen has them. */
  plan.sharpen = (sharpness) => { plan.sharpness = sharpness; raster(plan); plan.paint(); };
  const watch = new ResizeObserver(sized);
  watch.observe(canvas);
  sized();
  pointers(plan, hover);
  keys(plan);
  plan.dispose = () => { watch.disconnect(); cancelAnimationFrame(asked); };
  return plan;
}

const MARGIN = 24, FOOT = 44; // px around the drawing; the scale bar stands in the foot

function fitPlan(plan, box, headroom) {
  const room = [Math.max(plan.width - 2 * MARGIN, 20), Math.max(plan.height - headroom - MARGIN - FOOT, 20)];
  const size = [Math.max(box[2] - box[0], 1e-9), Math.max(box[3] - box[1], 1e-9)];
  plan.k = plan.fitted = Math.min(room[0] / size[0], room[1] / size[1]);
  plan.ox = plan.width / 2 - (plan.k * (box[0] + box[2])) / 2;
  plan.oy = headroom + MARGIN + room[1] / 2 + (plan.k * (box[1] + box[3])) / 2;
}

function zoomPlan(plan, factor, px, py) {
  const k = Math.min(Math.max(plan.k * factor, plan.fitted / 4), plan.fitted * 2000);
  const [x, y] = plan.unplace(px, py);
  plan.k = k; plan.ox = px - k * x; plan.oy = py + k * y;
}

const dotsPerPx = (plan) => plan.sharpness ?? (window.devicePixelRatio || 1);

function raster(plan) {
  const dots = dotsPerPx(plan);
  plan.canvas.width = Math.round(plan.width * dots);
  plan.canvas.height = Math.round(plan.height * dots);
}

function paint(plan, draw) {
  const { context, canvas } = plan;
  const dots = dotsPerPx(plan);
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.fillStyle = themeColour("--bg");
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.setTransform(dots, 0, 0, dots, 0, 0);
  draw(plan);
  scaleBar(plan);
}

function scaleBar(plan) {
  const { context } = plan;
  const most = 140 / plan.k, ten = 10 ** Math.floor(Math.log10(most));
  const long = [5, 2, 1].map((m) => m * ten).find((mm) => mm <= most);
  const x = plan.width - 16, y = plan.height - 14;
  context.strokeStyle = context.fillStyle = themeColour("--ink");
  context.lineWidth = 2;
  context.beginPath();
  context.moveTo(x - long * plan.k, y - 5); context.lineTo(x - long * plan.k, y); context.lineTo(x, y); context.lineTo(x, y - 5);
  context.stroke();
  context.font = "12px system-ui, sans-serif"; context.textAlign = "right";
  context.fillText(`${Number(long.toPrecision(1))} mm`, x, y - 8);
}

function pointers(plan, hover) {
  const down = new Map();
  const at = (event) => { const r = plan.canvas.getBoundingClientRect(); return [event.clientX - r.left, event.clientY - r.top]; };
  let moved = 0;
  plan.canvas.addEventListener("pointerdown", (event) => { plan.canvas.setPointerCapture(event.pointerId); down.set(event.pointerId, at(event)); moved = 0; });
  plan.canvas.addEventListener("pointermove", (event) => {
    const now = at(event), old = down.get(event.pointerId);
    if (!old) { hover?.(plan.unplace(...now), false); return; }
    const other = [...down].find(([id]) => id !== event.pointerId)?.[1];
    moved += Math.hypot(now[0] - old[0], now[1] - old[1]);
    if (other) {
      const span = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]);
      plan.zoom(span(now) / Math.max(span(old), 1), (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
    } else plan.move(now[0] - old[0], now[1] - old[1]);
    down.set(event.pointerId, now);
  });
  const up = (event) => { if (down.delete(event.pointerId) && event.type === "pointerup" && moved < 5) hover?.(plan.unplace(...at(event)), true); };
  plan.canvas.addEventListener("pointerup", up);
  plan.canvas.addEventListener("pointercancel", up);
  plan.canvas.addEventListener("pointerleave", () => hover?.(null, false));
  plan.canvas.addEventListener("wheel", (event) => { event.preventDefault(); plan.zoom(Math.exp(-event.deltaY / 400), ...at(event)); }, { passive: false });
}

function keys(plan) {
  const acts = {
    "+": () => plan.zoom(1.3), "=": () => plan.zoom(1.3), "-": () => plan.zoom(1 / 1.3), 0: () => plan.fit(),
    ArrowLeft: () => plan.move(40, 0), ArrowRight: () => plan.move(-40, 0), ArrowUp: () => plan.move(0, 40), ArrowDown: () => plan.move(0, -40),
  };
  plan.canvas.addEventListener("keydown", (event) => {
    if (!acts[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    acts[event.key]();
  });
}

function planControls(plan, ...more) {
  const button = (text, label, act) => make("button", { type: "button", text, "aria-label": label, on: { click: act } });
  return make("div", { class: "controls" }, button("+", "Zoom in", () => plan().zoom(1.4)), button("\u2212", "Zoom out", () => plan().zoom(1 / 1.4)),
    button("Fit", "Show all", () => plan().fit()), ...more);
}
