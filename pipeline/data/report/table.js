/* The table of parts: filter, sort, keyboard.  Failures stand on top until a heading is chosen. */

const COLUMNS = [
  { title: "Part", key: (row) => row.name, text: true },
  { title: "Verdict", key: (row) => (outcome(row) === "failed" ? 0 : 1) },
  { title: "Class", key: (row) => row.class ?? "", text: true, side: true },
  { title: "Qty", key: (row) => row.quantity, number: true },
  { title: "Failed", key: (row) => row.failed, number: true, side: true },
  { title: "Findings", key: (row) => row.findings, number: true, side: true },
  { title: "Strain", key: (row) => row.strain ?? -1, number: true },
  { title: "Mass kg", key: (row) => row.mass ?? -1, number: true, side: true },
];
const SHOWN_AT_ONCE = 250;
const table = { column: -1, rising: true, most: SHOWN_AT_ONCE, current: -1 };

const words = new Intl.Collator(undefined, { numeric: true });

function ordered(rows) {
  const failures = (a, b) => COLUMNS[1].key(report.rows[a]) - COLUMNS[1].key(report.rows[b]) || report.rows[b].failed - report.rows[a].failed || a - b;
  if (table.column < 0) return rows.sort(failures);
  const { key, text } = COLUMNS[table.column];
  const sign = table.rising ? 1 : -1;
  const compare = text ? words.compare : (a, b) => a - b;
  return rows.sort((a, b) => sign * compare(key(report.rows[a]), key(report.rows[b])) || a - b);
}

function isWanted(row) {
  const found = row.name.toLocaleLowerCase().includes(byId("find").value.trim().toLocaleLowerCase());
  const show = byId("show").value;
  return found && (show === "all" || show === outcome(row) || (show === "findings" && row.findings > 0));
}

function tableRow(index) {
  const row = report.rows[index];
  const failed = outcome(row) === "failed";
  const link = make("a", { href: `#part-${index}`, text: row.name });
  const side = (text, more = "n side") => make("td", { class: more, text });
  const strain = make("td", { class: "n", text: shown(row.strain), title: exact(row.strain) });
  const verdict = make("td", { class: failed ? "fail" : "pass", text: failed ? "\u2717 fail" : "\u2713 pass" });
  return make(
    "tr", { "data-index": index, class: failed ? "failed" : "", "aria-current": index === table.current },
    make("td", {}, link), verdict, side(row.class ?? "\u2013", "side"), make("td", { class: "n", text: shown(row.quantity) }),
    side(shown(row.failed)), side(shown(row.findings)), strain, side(shown(row.mass)),
  );
}

function fillTable() {
  const rows = ordered([...report.rows.keys()].filter((i) => isWanted(report.rows[i])));
  byId("table").tBodies[0].replaceChildren(...rows.slice(0, table.most).map(tableRow));
  byId("count").textContent = `${rows.length} of ${report.rows.length} parts`;
  const more = byId("more");
  more.hidden = rows.length <= table.most;
  more.textContent = `Show ${rows.length - table.most} more`;
}

function headings() {
  const cells = COLUMNS.map((column, i) => {
    const now = i === table.column;
    const button = make("button", { type: "button", text: column.title + (now ? (table.rising ? " \u2191" : " \u2193") : ""), on: { click: () => sortBy(i) } });
    const kind = `${column.number ? "n" : ""} ${column.side ? "side" : ""}`.trim();
    return make("th", { scope: "col", class: kind, "aria-sort": now ? (table.rising ? "ascending" : "descending") : "none" }, button);
  });
  byId("table").tHead.replaceChildren(make("tr", {}, ...cells));
}

function sortBy(column) {
  table.rising = table.column === column ? !table.rising : true;
  table.column = column;
  headings();
  fillTable();
  byId("table").tHead.querySelectorAll("button")[column].focus();
}

function stepRow(event) {
  const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
  const row = event.target.closest?.("tr[data-index]");
  if (!step || !row) return;
  const next = step > 0 ? row.nextElementSibling : row.previousElementSibling;
  if (!next) return;
  event.preventDefault();
  next.querySelector("a").focus();
}

function startTable() {
  headings();
  fillTable();
  const refill = () => { table.most = SHOWN_AT_ONCE; fillTable(); };
  byId("find").addEventListener("input", refill);
  byId("show").addEventListener("change", refill);
  byId("more").addEventListener("click", () => { table.most = Infinity; fillTable(); });
  const body = byId("table").tBodies[0];
  body.addEventListener("keydown", stepRow);
  body.addEventListener("click", (event) => {
    const row = event.target.closest("tr[data-index]");
    if (!row || event.ctrlKey || event.metaKey || event.shiftKey) return;
    event.preventDefault();
    goTo(Number(row.dataset.index));
  });
}
