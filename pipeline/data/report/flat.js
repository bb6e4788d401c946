/* The flat view of a part: contours, rulings, bend lines, marks, strain, places of metrics, and a linked cursor. */

const MARK_STYLES = {
  BEND_UP: { title: "bend up", light: "#8a2be2", dark: "#cfa4ff", dash: [10, 3, 2, 3] },
  BEND_DOWN: { title: "bend down", light: "#8a2be2", dark: "#cfa4ff", dash: [4, 3] },
  ROLL: { title: "roll line", light: "#6b7280", dark: "#9aa5b1", dash: [2, 5] },
  SEW: { title: "sew line", light: "#0b7a5b", dark: "#5fd3a8", dash: [1, 3] },
  CUT_SLIT: { title: "slit", light: "#14181d", dark: "#e9edf1", dash: [] },
  ENGRAVE: { title: "engraved", light: "#005a9c", dark: "#7fbfff", dash: [6, 2] },
  MARK: { title: "mark", light: "#005a9c", dark: "#7fbfff", dash: [6, 2] },
};
const isDark = () => document.documentElement.dataset.theme === "dark";

const MEASURED_BY = { strain: "max_strain", bending: "outer_fibre_strain" };

/* What failed, else the extreme of what the pattern is coloured by, else the largest strain. */
function worstPlace(part, field) {
  const places = part.view.flat.places;
  const metric = (place) => part.report.stages.find((s) => s.stage === place.stage)?.metrics.find((m) => m.name === place.metric);
  const known = places.map((place) => ({ ...place, value: metric(place) })).filter((place) => place.value);
  const named = (name) => known.find((place) => place.metric === name);
  return known.find((place) => !place.value.pass) ?? named(MEASURED_BY[field?.name]) ?? named("max_strain") ?? known[0] ?? null;
}

function openFlat(canvas, part, field, say, onCursor) {
  const flat = part.view.flat;
  const state = { flat, field, signs: true, rulings: true, worst: worstPlace(part, field), cursor: null };
  const hover = (at) => {
    state.cursor = at;
    say(at ? flatWords(state, at) : summaryWords(state));
    onCursor?.(at ? { x: at[0], y: at[1] } : null);
    plan.redraw();
  };
  const plan = openPlan(canvas, pathBox(flat.contours), (now) => drawFlat(now, state), hover, () => (state.field ? SCALE_ROOM : 0));
  plan.state = state;
  plan.setCursor = (place) => {
    state.cursor = place && place.x !== undefined ? [place.x, place.y] : null;
    say(state.cursor ? flatWords(state, state.cursor) : summaryWords(state));
    plan.redraw();
  };
  plan.colourBy = (chosen) => {
    Object.assign(state, { field: chosen, worst: worstPlace(part, chosen) });
    say(summaryWords(state));
    plan.refit();
  };
  say(summaryWords(state));
  return plan;
}

function summaryWords({ worst }) {
  return worst ? `\u25ce ${worst.metric} ${shown(worst.value.value, worst.value.unit)} (${worst.value.evidence}) at x ${shown(worst.at[0])}, y ${shown(worst.at[1])} mm` : "";
}

function flatWords(state, [x, y]) {
  const words = [`x ${x.toFixed(2)}`, `y ${y.toFixed(2)} mm`];
  const value = state.field?.at(x, y) ?? null;
  if (value !== null) words.push(`${state.field.title} ${shown(value)} (${state.field.evidence})${Math.abs(value) > state.field.limit ? ` \u25b2 ${beyondWords(state.field)}` : ""}`);
  const ruling = nearestRuling(state.flat.rulings, x, y);
  if (ruling) words.push(`nearest ruling v ${shown(ruling[4])}`);
  return words.join("   ");
}

function nearestRuling(rulings, x, y) {
  let best = null, least = Infinity;
  for (const ruling of rulings) {
    const [ax, ay, bx, by] = ruling;
    const dx = bx - ax, dy = by - ay;
    const t = Math.min(Math.max(((x - ax) * dx + (y - ay) * dy) / Math.max(dx * dx + dy * dy, 1e-12), 0), 1);
    const far = Math.hypot(ax + t * dx - x, ay + t * dy - y);
    if (far < least) { least = far; best = ruling; }
  }
  return best;
}

function drawFlat(plan, state) {
  const { context, place } = plan;
  const { flat } = state;
  const ink = themeColour("--ink");
  context.save();
  outlinePath(context, flat.contours, place);
  context.fillStyle = state.field ? "#fff" : themeColour("--part");
  context.fill("evenodd");
  context.clip("evenodd");
  context.lineWidth = 1.5; // cells overlap, else the ground shines through between them
  state.field?.paint(context, place);
  if (state.rulings) drawRulings(context, flat.rulings, place, state.field !== null);
  if (state.field && state.signs) paintSigns(plan, state.field);
  context.restore();
  drawMarks(plan, flat, state.field !== null);
  context.setLineDash([]);
  context.strokeStyle = ink;
  context.lineWidth = 1.6;
  outlinePath(context, flat.contours, place);
  context.stroke();
  if (state.worst) drawTarget(context, place(...state.worst.at), ink);
  if (state.cursor) drawCross(context, place(...state.cursor), themeColour("--accent"));
  if (state.field) drawScale(plan, state.field);
}

function outlinePath(context, contours, place) {
  context.beginPath();
  for (const contour of contours) tracePath(context, contour, place);
}

function drawRulings(context, rulings, place, onHeat) {
  context.strokeStyle = onHeat || !isDark() ? "#7d8791" : "#71808e";
  context.lineWidth = 1;
  context.setLineDash([]);
  for (const [ax, ay, bx, by] of rulings) {
    context.beginPath();
    context.moveTo(...place(ax, ay));
    context.lineTo(...place(bx, by));
    context.stroke();
  }
}

function drawMarks(plan, flat, onHeat) {
  const { context, place } = plan;
  context.lineWidth = 1.3;
  const dark = isDark() && !onHeat;
  for (const mark of flat.marks) {
    const style = MARK_STYLES[mark.layer] ?? MARK_STYLES.MARK;
    context.strokeStyle = dark ? style.dark : style.light;
    context.setLineDash(style.dash);
    context.beginPath();
    tracePath(context, mark, place);
    context.stroke();
  }
  context.setLineDash([]);
  context.fillStyle = dark ? MARK_STYLES.MARK.dark : MARK_STYLES.MARK.light;
  for (const text of flat.texts) drawText(plan, text);
}

const CAPITAL = 0.73; // height of capitals as a share of the type size

function drawText({ context, place, k }, { text, at, height, angle }) {
  const size = (height * k) / CAPITAL;
  if (size < 5) return;
  context.save();
  context.translate(...place(...at));
  context.rotate((-angle * Math.PI) / 180);
  context.font = `${size}px system-ui, sans-serif`;
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.fillText(text, 0, 0);
  context.restore();
}

function drawTarget(context, [x, y], colour) {
  for (const [width, stroke] of [[5, themeColour("--bg")], [2, colour]]) {
    context.lineWidth = width;
    context.strokeStyle = stroke;
    context.beginPath();
    context.arc(x, y, 9, 0, 2 * Math.PI);
    context.stroke();
  }
}

function drawCross(context, [x, y], colour) {
  context.strokeStyle = colour;
  context.lineWidth = 1.5;
  context.beginPath();
  context.moveTo(x - 12, y); context.lineTo(x + 12, y);
  context.moveTo(x, y - 12); context.lineTo(x, y + 12);
  context.stroke();
}

function flatLegend(part) {
  const layers = [...new Set(part.view.flat.marks.map((mark) => mark.layer))];
  const items = layers.map((layer) => {
    const style = MARK_STYLES[layer] ?? MARK_STYLES.MARK;
    return legendLine(isDark() ? style.dark : style.light, style.dash, style.title);
  });
  if (part.view.flat.rulings.length) items.unshift(legendLine("#7d8791", [], "ruling"));
  return make("div", { class: "legend" }, legendLine("currentColor", [], "cut"), ...items, make("span", { text: "\u25ce place of the worst value" }));
}

function legendLine(colour, dash, title) {
  const line = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  const stroke = document.createElementNS("http://www.w3.org/2000/svg", "path");
  for (const [name, value] of [["width", 30], ["height", 8], ["aria-hidden", "true"]]) line.setAttribute(name, value);
  for (const [name, value] of [["d", "M0 4H30"], ["stroke", colour], ["stroke-width", 2], ["stroke-dasharray", dash.join(" ")]]) stroke.setAttribute(name, value);
  line.append(stroke);
  const item = make("span", {});
  item.append(line, title);
  return item;
}
