/* What a flat pattern can be coloured by: strain of laying it flat, and strain of the face seen by bending.

A field: { name, title, unit, evidence, limit, held, largest, at(x, y), paint(context, place) }.  The colours end at
`limit`: what the class or the material allows where that is known (`held`), else a round number. */

function fieldsOf(part) {
  return [laidFlat(part), bent(part)].filter((field) => field !== null);
}

const TELLING = 0.1; // of its limit: a field that stays below is all but white, offered and not shown at first

const shownFirst = (fields) => fields.find((field) => field.name === "strain" || field.largest > TELLING * field.limit) ?? null;

function strainColour(share) {
  return window.planishView3d.colour(share).map(Math.round);
}

const cssColour = ([r, g, b]) => `rgb(${r},${g},${b})`;

/* The principal strain of larger size, signed. */
const larger = (most, least) => (most + least >= 0 ? most : least);

function roundEnd(largest) {
  if (!(largest > 0)) return 1;
  const ten = 10 ** Math.floor(Math.log10(largest));
  return [1, 2, 5, 10].find((one) => largest <= one * ten) * ten;
}

const metricsNamed = (part, name) => part.report.stages.flatMap((stage) => stage.metrics).filter((metric) => metric.name === name);

function laidFlat(part) {
  const found = part.report.stages.find((stage) => stage.stage === "unroll")?.detail?.strain_field;
  if (!found) return null;
  const grid = Array.isArray(found.x[0]);
  const list = (rows) => (grid ? rows.flat() : rows);
  const [x, y, most, least] = [found.x, found.y, found.most, found.least].map(list);
  const value = most.map((one, i) => (one === null || least[i] === null ? null : larger(one, least[i])));
  const places = { x, y, value, across: grid ? found.x[0].length : 0, breaks: grid ? found.v : [] };
  const nearest = nearestPlace(places);
  const allowed = metricsNamed(part, "max_strain").find((metric) => metric.limit !== null)?.limit;
  const largest = value.reduce((most_, one) => Math.max(most_, Math.abs(one ?? 0)), 0);
  const limit = allowed > 0 ? allowed : roundEnd(largest);
  return {
    name: "strain", title: "strain of laying it flat", evidence: "sampled", limit, held: allowed > 0, largest,
    at: (px, py) => { const k = nearest(px, py); return k < 0 ? null : value[k]; },
    paint: (context, place) => (places.across > 1 ? paintGrid(context, places, limit, place) : paintPlaces(context, places, nearest, limit, place)),
  };
}

/* Between two rulings, and along them, from the values at their ends. */
function bent(part) {
  const formed = part.view?.formed, packed = formed?.fields?.find((one) => one.name === "bending");
  if (!packed || !formed.flat) return null;
  const { positions, floats, inTriangles, harmonic } = window.planishPlaces;
  const ends = positions(formed.flat, 2), value = floats(packed.values), rows = value.length / 2;
  const broken = new Set(formed.breaks), triangles = [];
  for (let i = 0; i + 1 < rows; i += 1) if (!broken.has(i)) triangles.push(2 * i, 2 * i + 1, 2 * i + 3, 2 * i, 2 * i + 3, 2 * i + 2);
  const on = (row, u) => harmonic(value[2 * row], value[2 * row + 1], u);
  const at = (px, py) => {
    const hit = inTriangles(ends, triangles, px, py);
    if (!hit) return null;
    const mix = (of) => hit.corners.reduce((sum, corner, k) => sum + hit.shares[k] * of(corner), 0);
    const row = mix((corner) => corner >> 1), u = mix((corner) => corner & 1), i = Math.min(Math.floor(row), rows - 2);
    const [here, next] = [on(i, u), on(i + 1, u)];
    return here + (row - i) * (next - here);
  };
  const limit = packed.limit, largest = value.reduce((most, one) => Math.max(most, Math.abs(one)), 0);
  const held = !packed.limit_is.startsWith("a round number");
  return { name: "bending", title: packed.title, evidence: packed.evidence, limit, held, largest, at, paint: (context, place) => paintRulings(context, { ends, rows, broken, on, limit }, place) };
}

/* What is to be said of the strain of laying a part flat, in one line: what is proved, what is measured. */
function strainWords(part) {
  const strain = metricsNamed(part, "max_strain").pop();
  if (!strain || strain.value === null) return null;
  const held = metricsNamed(part, "max_strain").find((metric) => metric.limit !== null);
  const limit = held === strain ? `, limit ${shown(held.limit)}` : "";
  const judged = held && held !== strain ? `; judged: ${shown(held.value)} (${held.evidence}, limit ${shown(held.limit)})` : "";
  const most = `${shown(strain.value)} (${strain.evidence}${limit})${judged}`;
  const warp = metricsNamed(part, "max_warp_deg")[0];
  if (strain.value === 0 && strain.evidence === "proved") return "Strain of laying it flat: 0, proved.";
  if (warp?.value === 0 && warp.evidence === "proved") return `Strain of laying it flat: 0, proved, as no ruling is twisted. The pattern as computed: at most ${most}.`;
  return `Strain of laying it flat: at most ${most}.`;
}
