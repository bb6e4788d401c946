/* The data of the page: rows for the table at once, a part when it is opened. */

const report = JSON.parse(byId("data").textContent);
const rowOf = new Map(report.rows.map((row, i) => [row.name, i]));
const opened = new Map();
const KEPT = 400; // parts kept read, so that sheets of many parts can be drawn; the page stays small beside them

function partAt(index) {
  let part = opened.get(index);
  if (part === undefined) {
    part = JSON.parse(report.parts[index]);
    opened.set(index, part);
    if (opened.size > KEPT) opened.delete(opened.keys().next().value);
  }
  return part;
}

const outcome = (row) => (row.class === "rejected" || row.class === "inconclusive" || row.failed > 0 ? "failed" : "passed");

function margin(metric) {
  if (typeof metric.limit !== "number" || typeof metric.value !== "number") return null;
  return metric.limit - metric.value;
}
