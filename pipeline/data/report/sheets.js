/* The nested sheets: parts in their places with their names, what is left over; a click goes to the part. */

const FILLS = ["#bbd9ec", "#f6d7a8", "#bfe3d6", "#ebcfe0", "#f7f0a6", "#f3c2a5", "#d3d3d3", "#d2e9f8", "#cfe6a9", "#d8ccf0", "#e6d3b8", "#f5bfc8"];
const fillOf = (index) => FILLS[index % FILLS.length];

/* A point of the part's flat frame on the sheet: mirrored, turned, moved. */
function placedBy({ x, y, angle, mirrored }) {
  const c = Math.cos((angle * Math.PI) / 180), s = Math.sin((angle * Math.PI) / 180);
  return (px, py) => { const qx = mirrored ? -px : px; return [x + c * qx - s * py, y + s * qx + c * py]; };
}

function sheetRectangle(sheet, stock) {
  const wide = stock.kind === "roll" ? sheet.used_length_mm : stock.width_mm;
  const points = [0, 0, 0, wide, 0, 0, wide, stock.height_mm, 0, 0, stock.height_mm, 0];
  return { closed: true, points };
}

function sheetDrawing(sheet, number) {
  const stock = report.nest.stock.find((one) => one.id === sheet.stock);
  const view = report.nest.views[number] ?? {};
  const ground = view.outline ?? sheetRectangle(sheet, stock);
  const copies = sheet.placements.map((placement) => {
    const index = rowOf.get(placement.part);
    const flat = partAt(index).view?.flat;
    return { placement, index, move: placedBy(placement), contours: flat ? flat.contours : [], label: flat?.label };
  });
  return { ground, copies, defects: view.defects ?? [], zones: view.zones ?? [], offcut: sheet.offcut, over: null };
}

function drawSheet(plan, drawing) {
  const { context, place } = plan;
  const shapes = (paths, fill, dash = []) => {
    context.beginPath();
    for (const path of paths) tracePath(context, path, place);
    context.fillStyle = fill; context.fill("evenodd");
    context.strokeStyle = themeColour("--soft"); context.lineWidth = 1; context.setLineDash(dash); context.stroke();
    context.setLineDash([]);
  };
  shapes([drawing.ground], themeColour("--panel"));
  if (drawing.offcut) drawOffcut(plan, drawing.offcut);
  shapes(drawing.zones, "rgba(230,159,0,.25)", [6, 4]);
  shapes(drawing.defects, "rgba(179,38,30,.45)");
  for (const copy of drawing.copies) drawCopy(plan, copy, copy === drawing.over);
}

function drawCopy({ context, place, k }, { placement, index, move, contours, label }, over) {
  if (!contours.length) return;
  const put = (x, y) => place(...move(x, y));
  outlinePath(context, contours, put);
  context.fillStyle = fillOf(index); context.fill("evenodd");
  context.strokeStyle = over ? "#b3261e" : "#14181d"; context.lineWidth = over ? 3 : 1; context.stroke();
  const [l, b, r, t] = pathBox(contours.slice(0, 1));
  const [x, y] = label ?? [(l + r) / 2, (b + t) / 2];
  const [px, py] = put(x, y);
  const turn = (placement.angle * Math.PI) / 180, wide = Math.abs(Math.cos(turn)) * (r - l) + Math.abs(Math.sin(turn)) * (t - b);
  const size = 11, most = Math.floor((wide * k * 0.9) / (0.6 * size)); // names lie level, however the copy is turned
  const name = `${placement.part} ${placement.copy}${placement.mirrored ? " \u21c4" : ""}`;
  if (most < 3) return;
  context.font = `${size}px system-ui, sans-serif`; context.textAlign = "center"; context.textBaseline = "middle";
  context.lineWidth = 3; context.strokeStyle = fillOf(index); context.fillStyle = "#14181d";
  const written = name.length > most ? `${name.slice(0, most - 1)}\u2026` : name;
  context.strokeText(written, px, py); context.fillText(written, px, py);
  context.textBaseline = "alphabetic";
}

function drawOffcut({ context, place }, { x, y, width_mm, height_mm }) {
  const [l, t] = place(x, y + height_mm), [r, b] = place(x + width_mm, y);
  context.strokeStyle = context.fillStyle = themeColour("--soft"); context.lineWidth = 1.5;
  context.setLineDash([3, 4]); context.strokeRect(l + 2, t + 2, r - l - 4, b - t - 4); context.setLineDash([]);
  const words = `offcut ${shown(width_mm)} \u00d7 ${shown(height_mm)} mm`;
  context.font = "12px system-ui, sans-serif"; context.textAlign = "center";
  if (context.measureText(words).width < r - l - 8) context.fillText(words, (l + r) / 2, (t + b) / 2);
}

function copyAt(plan, drawing, [x, y]) {
  const { context } = plan;
  context.save(); context.setTransform(1, 0, 0, 1, 0, 0);
  const found = [...drawing.copies].reverse().find((copy) => {
    outlinePath(context, copy.contours, (px, py) => copy.move(px, py));
    return copy.contours.length && context.isPointInPath(x, y, "evenodd");
  });
  context.restore();
  return found ?? null;
}

function showSheet(sheet, number) {
  const title = `${sheet.stock} ${sheet.index}`;
  const canvas = make("canvas", { tabindex: 0, role: "img", "aria-label": `Sheet ${title}: ${sheet.placements.length} parts. Plus and minus zoom, arrows move; the parts are listed below.` });
  const said = make("div", { class: "said" });
  let plan = null;
  const names = new Map();
  for (const placement of sheet.placements) names.set(placement.part, (names.get(placement.part) ?? 0) + 1);
  const links = [...names].map(([name, count]) => make("li", {}, make("a", { href: `#part-${rowOf.get(name)}`, text: name }), ` \u00d7 ${count}`));
  const box = make("div", { class: "sheet" }, make("h3", { text: title }),
    facts([["Utilisation", percent(sheet.utilisation)], ["Parts", sheet.placements.length], ["Mass", sheet.mass_kg === null ? null : shown(sheet.mass_kg, "kg")],
      ["Cut length", shown(sheet.cut_length_mm, "mm")], ["Pierces", sheet.pierces], ["Cost", sheet.cost?.toFixed(2)], ["File", sheet.file],
      ["Offcut", sheet.offcut ? `${shown(sheet.offcut.width_mm)} \u00d7 ${shown(sheet.offcut.height_mm)} mm` : null]]),
    make("div", { class: "view" }, planControls(() => plan), make("div", { class: "stage" }, canvas), said),
    make("details", {}, make("summary", { text: "Parts on this sheet" }), make("ul", {}, ...links)));
  const open = () => whenParts(sheet.placements.map(({ part }) => rowOf.get(part)), drawn);
  const drawn = () => {
    const drawing = sheetDrawing(sheet, number);
    plan = openPlan(canvas, pathBox([drawing.ground]), (now) => drawSheet(now, drawing), (at, click) => {
      drawing.over = at ? copyAt(plan, drawing, at) : null;
      const over = drawing.over?.placement;
      said.textContent = over ? `${over.part}, copy ${over.copy}, turned ${shown(over.angle, "deg")}${over.mirrored ? ", turned over" : ""}: click opens it` : "";
      canvas.style.cursor = over ? "pointer" : "";
      if (click && drawing.over) goTo(drawing.over.index);
      else plan.redraw();
    });
    plans.add(plan);
    box.plan = plan;
    box.drawing = drawing;
  };
  return { box, open };
}

/* What all sheets cost together, as far as it is known. */
function costFacts({ price, offcut_credit: credit, net, cut_length_mm: length, pierces, time_s: time }) {
  return facts([["Price", price?.toFixed(2)], ["Offcuts worth", credit ? credit.toFixed(2) : null], ["Net", net?.toFixed(2)],
    ["Cut length", length === null ? null : shown(length, "mm")], ["Pierces", pierces], ["Cutting time", time === null ? null : shown(time, "s")]]);
}

function startSheets() {
  const nest = report.nest;
  if (!nest?.sheets?.length) return;
  byId("sheets").hidden = false;
  if (nest.cost) byId("nest-facts").append(costFacts(nest.cost.total));
  const waiting = new Map();
  const seen = new IntersectionObserver((entries) => entries.filter((e) => e.isIntersecting).forEach(({ target }) => { seen.unobserve(target); waiting.get(target)?.(); waiting.delete(target); }), { rootMargin: "200px" });
  const shownSheets = nest.sheets.map(showSheet);
  for (const { box, open } of shownSheets) { waiting.set(box, open); byId("sheet-list").append(box); seen.observe(box); }
  window.addEventListener("beforeprint", () => { for (const [box, open] of waiting) { seen.unobserve(box); open(); } waiting.clear(); });
}
