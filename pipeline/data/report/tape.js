/* What to measure on the blank with a tape: corners by their letters, edges along and straight, diagonals. */

function tapeBox({ tape }) {
  if (!tape?.spans.length) return null;
  const cell = (title, value) => make("td", { class: value === null ? "n empty" : "n", "data-h": title, text: shown(value), title: exact(value) });
  const rows = tape.spans.map((span) => make("tr", {}, make("td", { text: `${span.from} \u2013 ${span.to}` }), make("td", { text: span.what }),
    cell("along", span.along_mm), cell("straight", span.straight_mm), make("td", { text: span.evidence })));
  const heads = ["From \u2013 to", "What", "Along the edge, mm", "Straight, mm", "Evidence"];
  const head = make("thead", {}, make("tr", {}, ...heads.map((text, i) => make("th", { scope: "col", class: i === 2 || i === 3 ? "n" : "", text }))));
  const hundredths = (mm) => (Math.abs(mm) < 0.005 ? 0 : mm).toFixed(2).replace("-", "\u2212"); // what a tape tells, and no -0
  const spots = tape.spots.map(({ letters, x, y }) => `${[...letters].join(" = ")} at x ${hundredths(x)}, y ${hundredths(y)} mm`).join("; ");
  return make("section", { "aria-label": "tape" }, make("h3", { text: "Measure on the blank" }), make("div", { class: "means", text: spots }),
    make("div", { class: "scroll" }, make("table", {}, make("caption", { class: "unseen", text: "Distances between the corners of the blank" }), head, make("tbody", {}, ...rows))));
}
