/* The page: verdict, theme, paper, links within it. */

const plans = new Set();

const VERDICTS = { made: "Made: every part passed", rejected: "Rejected", "no-solution": "No solution" };

function showVerdict() {
  const { job, rows } = report;
  const failed = rows.filter((row) => outcome(row) === "failed").length;
  const good = job.status === "made" && failed === 0;
  const count = failed ? `${failed} of ${rows.length} parts failed. ` : "";
  const checks = rows.reduce((sum, row) => sum + row.checks, 0);
  const box = byId("verdict");
  box.classList.toggle("bad", !good);
  box.append(make("h1", { text: job.job.name }), make("div", { class: "word", text: `${good ? "\u2713" : "\u2717"} ${VERDICTS[job.status] ?? job.status}` }),
    make("div", { text: `${count}${rows.length} part${rows.length === 1 ? "" : "s"}, ${checks} checks against a limit.` }));
  const { material, tolerance } = job.job;
  byId("facts").append(facts([["Customer", job.job.customer], ["Revision", job.job.revision], ["Material", material?.name],
    ["Thickness", material?.thickness_mm ? shown(material.thickness_mm, "mm") : null], ["Accepts", tolerance?.accept], ["Chord", tolerance ? shown(tolerance.chord_mm, "mm") : null],
    ["Sheets", report.nest?.sheets?.length], ["Units", "mm, degrees"]]));
  document.title = `${job.job.name}: ${job.status}`;
  byId("foot").textContent = `planish ${job.run?.version ?? ""} \u00b7 ${job.schema} \u00b7 proved: holds at every point, or exact; sampled: measured at many points. Margin: limit less value.`;
}

function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  for (const plan of plans) plan.redraw();
  current?.solid?.setTheme(theme);
}

function startTheme() {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  setTheme(dark.matches ? "dark" : "light");
  dark.addEventListener("change", () => setTheme(dark.matches ? "dark" : "light"));
  byId("theme").addEventListener("click", () => setTheme(isDark() ? "light" : "dark"));
}

const PAPER_SHARPNESS = 3; // dots to a px of the page: some 290 to an inch

/* On paper all is light, drawn sharper, and the formed part is there, too, as it stands. */
function startPaper() {
  let before = null;
  window.addEventListener("beforeprint", () => {
    before ??= document.documentElement.dataset.theme;
    current?.form?.();
    setTheme("light");
    for (const plan of plans) plan.sharpen(PAPER_SHARPNESS);
    current?.solid?.toPaper(PAPER_SHARPNESS);
  });
  window.addEventListener("afterprint", () => {
    current?.solid?.fromPaper();
    for (const plan of plans) plan.sharpen(null);
    setTheme(before ?? "light");
    before = null;
  });
}

function goTo(index) {
  if (location.hash === `#part-${index}`) followHash();
  else location.hash = `part-${index}`;
}

function followHash() {
  const found = /^#part-(\d+)$/.exec(location.hash);
  if (!found || !(Number(found[1]) < report.rows.length)) return;
  openPart(Number(found[1]), () => {
    byId("part").focus({ preventScroll: true });
    byId("part").scrollIntoView();
  });
}

let asked = -1; // the part that was asked for last

function openPart(index, then) {
  asked = index;
  whenParts([index], () => {
    if (asked !== index) return;
    showPart(index);
    then?.();
  });
}

function startPage() {
  startTheme();
  showVerdict();
  startTable();
  startSheets();
  startPaper(); // behind the sheets, which open all that are to be printed
  for (const name of ["nest", "write"]) {
    const stage = name === "nest" ? report.nest : report.job.write;
    if (stage?.status) byId("job-stages").append(stageBox(name, stage));
  }
  window.addEventListener("hashchange", followHash);
  if (location.hash) followHash();
  else if (report.rows.length) openPart(ordered([...report.rows.keys()])[0]);
  document.documentElement.dataset.ready = "yes";
}

startPage();
