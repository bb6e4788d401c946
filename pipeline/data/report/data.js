/* The data of the page: rows for the table at once, a part when it is opened.
   Parts of a large report lie in files beside the page, loaded as scripts, which works from a disk, too. */

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

const files = new Map(); // of parts, by their numbers, each a promise

function planishParts(first, texts) {
  texts.forEach((text, i) => { report.parts[first + i] = text; });
}

function fileOf(number) {
  if (!files.has(number)) {
    const src = `report/parts-${number}.js`;
    files.set(number, new Promise((done, failed) => {
      const gone = () => { files.delete(number); failed(new Error(`${src} is missing beside this page`)); };
      document.head.append(make("script", { src, on: { load: done, error: gone } }));
    }));
  }
  return files.get(number);
}

/* Do something when parts are there: at once where the page holds them. */
function whenParts(indices, then) {
  if (report.per_file === null) then();
  else Promise.all([...new Set(indices.map((index) => Math.floor(index / report.per_file)))].map(fileOf)).then(then, showMissing);
}

function showMissing(error) {
  byId("part").hidden = false;
  byId("part").replaceChildren(make("p", { class: "fail", role: "alert", text: error.message }));
}

const outcome = (row) => (row.class === "rejected" || row.class === "inconclusive" || row.failed > 0 ? "failed" : "passed");
