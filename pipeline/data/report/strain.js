/* Strain as colours: orange stretched, blue pressed together, white nothing; the ends of the scale are the limit. */

const STRETCHED = [213, 94, 0], PRESSED = [0, 114, 178];

function strainColour(share) {
  const size = Math.min(Math.abs(share), 1);
  const end = share >= 0 ? STRETCHED : PRESSED;
  return end.map((channel) => Math.round(255 + size * (channel - 255)));
}

const cssColour = ([r, g, b]) => `rgb(${r},${g},${b})`;

/* The principal strain of larger size, signed. */
const larger = (most, least) => (most + least >= 0 ? most : least);

function strainField(part) {
  const stages = part.report.stages;
  const field = stages.find((stage) => stage.stage === "unroll")?.detail?.strain_field;
  const limit = stages.flatMap((stage) => stage.metrics).find((metric) => metric.name === "max_strain" && metric.limit !== null)?.limit;
  if (!field || !(limit > 0)) return null;
  const grid = Array.isArray(field.x[0]);
  const flat = (rows) => (grid ? rows.flat() : rows);
  const [x, y, most, least] = [field.x, field.y, field.most, field.least].map(flat);
  const value = most.map((larger_, i) => (larger_ === null || least[i] === null ? null : larger(larger_, least[i])));
  return { limit, x, y, value, across: grid ? field.x[0].length : 0, breaks: grid ? field.v : [] };
}

const BETWEEN = 4; // cells between two places of the grid, in each direction

function paintField(context, field, place) {
  if (field.across > 1) paintGrid(context, field, place);
  else paintPlaces(context, field, place);
}

function paintGrid(context, field, place) {
  const n = field.across, rows = field.x.length / n;
  for (let j = 0; j + 1 < rows; j += 1) {
    if (field.breaks[j] === field.breaks[j + 1]) continue; // the joint of two pieces
    for (let i = 0; i + 1 < n; i += 1) paintCell(context, field, [j * n + i, j * n + i + 1, (j + 1) * n + i + 1, (j + 1) * n + i], place);
  }
}

function paintCell(context, field, corners, place) {
  if (corners.some((k) => field.value[k] === null)) return;
  const at = (list, s, t) => (1 - t) * ((1 - s) * list[corners[0]] + s * list[corners[1]]) + t * ((1 - s) * list[corners[3]] + s * list[corners[2]]);
  for (let a = 0; a < BETWEEN; a += 1) {
    for (let b = 0; b < BETWEEN; b += 1) {
      // the outer cells have the value of the place that they touch, the others that of their middle
      const near = (c) => (c === 0 ? 0 : c === BETWEEN - 1 ? 1 : (c + 0.5) / BETWEEN);
      context.fillStyle = context.strokeStyle = cssColour(strainColour(at(field.value, near(a), near(b)) / field.limit));
      context.beginPath();
      for (const [s, t] of [[a, b], [a + 1, b], [a + 1, b + 1], [a, b + 1]]) {
        context.lineTo(...place(at(field.x, s / BETWEEN, t / BETWEEN), at(field.y, s / BETWEEN, t / BETWEEN)));
      }
      context.closePath();
      context.fill();
      context.stroke();
    }
  }
}

/* Places of a mesh: every spot has the colour of the nearest one, found on a raster. */
function paintPlaces(context, field, place) {
  const nearest = nearestPlace(field);
  const box = [Math.min(...field.x), Math.min(...field.y), Math.max(...field.x), Math.max(...field.y)];
  const [l, b] = place(box[0], box[1]), [r, t] = place(box[2], box[3]);
  const step = Math.max(1, Math.hypot(r - l, b - t) / 300), over = 4 * step;
  const perX = (box[2] - box[0]) / Math.max(r - l, 1e-9), perY = (box[3] - box[1]) / Math.max(b - t, 1e-9);
  for (let py = t - over; py < b + over; py += step) {
    for (let px = l - over; px < r + over; px += step) {
      const k = nearest(box[0] + (px + step / 2 - l) * perX, box[3] - (py + step / 2 - t) * perY);
      if (field.value[k] === null) continue;
      context.fillStyle = cssColour(strainColour(field.value[k] / field.limit));
      context.fillRect(px, py, step + 0.5, step + 0.5);
    }
  }
}

/* Return the function that finds the place nearest to a point: buckets, searched in growing rings. */
function nearestPlace(field) {
  if (field.nearest) return field.nearest;
  const { x, y } = field;
  const low = [Math.min(...x), Math.min(...y)];
  const wide = Math.max(...x) - low[0], tall = Math.max(...y) - low[1];
  const pitch = Math.max(Math.sqrt((wide * tall) / x.length), Math.max(wide, tall) / x.length, 1e-9);
  const columns = Math.floor(wide / pitch) + 1, rows = Math.floor(tall / pitch) + 1;
  const buckets = Array.from({ length: columns * rows }, () => []);
  x.forEach((_, k) => buckets[Math.floor((y[k] - low[1]) / pitch) * columns + Math.floor((x[k] - low[0]) / pitch)].push(k));
  field.nearest = (px, py) => {
    const i = Math.floor((px - low[0]) / pitch), j = Math.floor((py - low[1]) / pitch);
    let best = -1, least = Infinity;
    for (let ring = 0; ring <= columns + rows + 2; ring += 1) {
      for (let b = j - ring; b <= j + ring; b += 1) {
        const whole = b === j - ring || b === j + ring;
        for (let a = i - ring; a <= i + ring; a += whole || ring === 0 ? 1 : 2 * ring) {
          if (a < 0 || b < 0 || a >= columns || b >= rows) continue;
          for (const k of buckets[b * columns + a]) {
            const far = (x[k] - px) ** 2 + (y[k] - py) ** 2;
            if (far < least) { least = far; best = k; }
          }
        }
      }
      if (best >= 0 && least <= (ring * pitch) ** 2) break;
    }
    return best;
  };
  return field.nearest;
}

function drawStrainScale(context, field, width, ink) {
  const long = Math.min(240, width - 40), left = 16, top = 12;
  for (let i = 0; i < long; i += 1) {
    context.fillStyle = cssColour(strainColour((2 * i) / (long - 1) - 1));
    context.fillRect(left + i, top, 1.5, 12);
  }
  context.strokeStyle = context.fillStyle = ink;
  context.lineWidth = 1;
  context.strokeRect(left, top, long, 12);
  context.font = "11px system-ui, sans-serif";
  for (const tick of [-1, -0.5, 0, 0.5, 1]) {
    context.textAlign = tick === -1 ? "left" : tick === 1 ? "right" : "center";
    context.fillText(tick === 0 ? "0" : (tick > 0 ? "+" : "\u2212") + percent(Math.abs(tick * field.limit)), left + (long * (tick + 1)) / 2, top + 25);
  }
}
