/* The lists of the summary: filter, sort by a heading; light and dark. */

const words = new Intl.Collator(undefined, { numeric: true });
const cellKey = (row, column) => {
  const cell = row.cells[column], number = cell.querySelector("data");
  return number ? Number(number.value || -Infinity) : cell.textContent;
};

function sortTable(table, column, heading) {
  const rising = heading.ariaSort !== "ascending";
  for (const other of table.tHead.querySelectorAll("th")) other.ariaSort = "none";
  heading.ariaSort = rising ? "ascending" : "descending";
  const sign = rising ? 1 : -1;
  const compare = (a, b) => (typeof a === "number" ? a - b : words.compare(a, b));
  const keyed = [...table.tBodies[0].rows].map((row) => [cellKey(row, column), row]);
  table.tBodies[0].append(...keyed.sort((a, b) => sign * compare(a[0], b[0])).map(([, row]) => row));
}

function startList(find) {
  const table = byId(find.dataset.table), rows = [...table.tBodies[0].rows], count = find.closest(".controls").querySelector(".count");
  const filter = () => {
    const wanted = find.value.trim().toLocaleLowerCase();
    for (const row of rows) row.hidden = !row.textContent.toLocaleLowerCase().includes(wanted);
    count.textContent = `${rows.filter((row) => !row.hidden).length} of ${rows.length} listed`;
  };
  find.addEventListener("input", filter);
  filter();
  [...table.tHead.rows[0].cells].forEach((heading, column) => {
    const text = heading.textContent;
    heading.ariaSort = "none";
    heading.replaceChildren(make("button", { type: "button", text, on: { click: () => sortTable(table, column, heading) } }));
  });
}

function startTheme() {
  const root = document.documentElement, dark = matchMedia("(prefers-color-scheme: dark)");
  const set = (theme) => { root.dataset.theme = theme; };
  set(dark.matches ? "dark" : "light");
  dark.addEventListener("change", () => set(dark.matches ? "dark" : "light"));
  byId("theme").addEventListener("click", () => set(root.dataset.theme === "dark" ? "light" : "dark"));
}

startTheme();
document.querySelectorAll("input[data-table]").forEach(startList);
