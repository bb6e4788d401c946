/* One part: its stages with every metric, and its views. */

let current = null; // what is open: { index, flat, solid, form }; form: builds the formed view, if it is not there yet

function metricRows(stage) {
  const failing = [...stage.metrics].sort((a, b) => Number(a.pass) - Number(b.pass));
  return failing.map((metric) => {
    const held = metric.limit !== null;
    const cell = (title, value, unit) => make("td", { class: value === null || value === undefined ? "n empty" : "n", "data-h": title, text: shown(value, unit), title: exact(value) });
    const name = make("td", { class: "wide" }, make("div", { class: "metric", text: metric.name }), make("div", { class: "means", text: report.meanings[metric.name] ?? "" }));
    const verdict = make("td", { class: metric.pass ? (held ? "pass" : "") : "fail", text: metric.pass ? (held ? "\u2713 pass" : "no limit") : "\u2717 fail" });
    return make("tr", { class: metric.pass ? "" : "failed" }, name, cell("value", metric.value), make("td", { class: metric.unit ? "" : "empty", text: metric.unit.replace("mm2", "mm\u00b2") }),
      cell("limit", metric.limit), cell("margin", metric.margin), verdict, make("td", { text: metric.evidence }));
  });
}

function findingBox(finding) {
  const where = Object.entries(finding.where ?? {}).map(([name, value]) => `${name} ${typeof value === "number" ? shown(value) : value}`).join(", ");
  return make("div", { class: finding.fatal ? "finding fatal" : "finding" }, make("strong", { class: finding.fatal ? "fail" : "", text: finding.fatal ? "fatal: " : "note: " }), finding.message,
    make("div", { class: "means", text: [finding.code, where].filter(Boolean).join(" \u00b7 ") }));
}

const STAGE_TITLES = { construct: "Construct: from the data asked for", verify: "Verify: from zero curvature", unroll: "Unroll: from isometry", nest: "Nest: from rigid motion", write: "Write: from the exact outline" };

function stageBox(name, stage) {
  const word = { pass: "\u2713 pass", fail: "\u2717 fail", skipped: "skipped" }[stage.status] ?? stage.status;
  const title = make("h3", {}, `${STAGE_TITLES[name] ?? name} `, make("span", { class: { pass: "pass", fail: "fail" }[stage.status], text: word }));
  const heads = ["Metric", "Value", "Unit", "Limit", "Margin", "Verdict", "Evidence"];
  const head = make("thead", {}, make("tr", {}, ...heads.map((text, i) => make("th", { scope: "col", class: [1, 3, 4].includes(i) ? "n" : "", text }))));
  const table_ = stage.metrics?.length ? make("div", { class: "scroll" }, make("table", { class: "stages" }, make("caption", { class: "unseen", text: `Metrics of ${name}` }), head, make("tbody", {}, ...metricRows(stage)))) : null;
  const findings = [...(stage.findings ?? [])].sort((a, b) => Number(b.fatal) - Number(a.fatal)).map(findingBox);
  return make("section", { "aria-label": name }, title, ...findings, table_);
}

function closePart() {
  current?.flat?.dispose();
  current?.solid?.dispose();
  if (current?.flat) plans.delete(current.flat);
  current = null;
}

function sides({ width, height }) {
  return `${shown(width)} \u00d7 ${shown(height)} mm`;
}

function showPart(index) {
  closePart();
  const part = partAt(index), row = report.rows[index];
  const failed = outcome(row) === "failed";
  const section = byId("part");
  section.hidden = false;
  const views = make("div", { class: "views" });
  const one = part.report;
  section.replaceChildren(
    make("h2", { id: "part-title", text: row.name }),
    facts([["Verdict", failed ? "\u2717 fail" : "\u2713 pass"], ["Class", row.class], ["Quantity", row.quantity], ["Size", one.flat ? sides(one.flat) : null], ["Blank with allowances", one.flat?.cut ? sides(one.flat.cut) : null],
      ["Area flat", one.flat ? shown(one.flat.area, "mm2") : null], ["Formed", one.formed ? `${one.formed.size_mm.map((side) => shown(side)).join(" \u00d7 ")} mm (${one.formed.evidence})` : null], ["Area formed", one.surface?.area ? shown(one.surface.area, "mm2") : null],
      ["Mass", one.mass_kg === null ? null : shown(one.mass_kg, "kg")], ["Cut length", one.cut_length_mm === null ? null : shown(one.cut_length_mm, "mm")], ["Pierces", one.pierces]]),
    views, ...[tapeBox(one)].filter(Boolean), ...one.stages.map((stage) => stageBox(stage.stage, stage)));
  section.setAttribute("aria-labelledby", "part-title");
  current = { index, flat: null, solid: null };
  if (part.view?.flat) views.append(flatPanel(part));
  if (part.view?.formed && window.planishView3d) views.append(solidPanel(part));
  current.open?.();
  table.current = index;
  for (const tr of byId("table").tBodies[0].rows) tr.toggleAttribute("aria-current", false);
  byId("table").querySelector(`tr[data-index="${index}"]`)?.setAttribute("aria-current", "true");
}

function flatPanel(part) {
  const said = make("div", { class: "said" });
  const canvas = make("canvas", { tabindex: 0, role: "img", "aria-label": `Flat pattern of ${part.report.name}. Plus and minus zoom, arrows move, 0 shows all. Its numbers are in the tables below.` });
  const toggle = (text, key) => make("button", { type: "button", text, "aria-pressed": "true", on: { click: (event) => {
    const { state } = current.flat;
    state[key] = !state[key];
    event.currentTarget.setAttribute("aria-pressed", String(state[key]));
    current.flat.redraw();
  } } });
  const fields = fieldsOf(part), words_ = strainWords(part);
  const panel = make("div", { class: "view" }, planControls(() => current.flat, part.view.flat.rulings.length ? toggle("Rulings", "rulings") : null, colourChoice(fields)),
    make("div", { class: "stage" }, canvas), said, words_ ? make("div", { class: "legend", text: words_ }) : null, flatLegend(part));
  current.open = () => {
    current.flat = openFlat(canvas, part, shownFirst(fields), (told) => { said.textContent = told; }, (place) => current.solid?.setCursor(place));
    plans.add(current.flat);
  };
  return panel;
}

/* The colours of both views: that which is chosen here is shown formed, too. */
function colourChoice(fields) {
  if (!fields.length) return null;
  const first = shownFirst(fields), option = (field) => make("option", { value: field?.name ?? "", text: field?.title ?? "no colours", selected: field === first });
  const choose = (event) => {
    const field = fields.find(({ name }) => name === event.target.value) ?? null;
    current.flat.colourBy(field);
    current.solid?.setField(field?.name ?? null);
  };
  return make("select", { "aria-label": "Colours of the pattern", on: { change: choose } }, option(null), ...fields.map(option));
}

const PAINTER = new URLSearchParams(location.search).get("view"); // report.html?view=webgl or canvas; else what is quicker

function solidPanel(part) {
  const host = make("div", { class: "stage" });
  const here = current;
  here.form = () => {
    if (current !== here || here.solid) return;
    const onCursor = (place) => current.flat?.setCursor(place);
    here.solid = window.planishView3d.mount(host, part.view.formed, { onCursor, by: PAINTER, field: here.flat?.state.field?.name, theme: isDark() ? "dark" : "light" });
  };
  afterPaint(here.form);
  return make("div", { class: "view solid" }, host);
}

const PATIENCE_MS = 300; // for a moment when nothing else is to be done

/* Do something when what is there now has been painted: numbers and flat view are not kept waiting by it. */
function afterPaint(then) {
  const idle = window.requestIdleCallback ?? ((call) => setTimeout(call));
  requestAnimationFrame(() => setTimeout(() => idle(then, { timeout: PATIENCE_MS })));
}
