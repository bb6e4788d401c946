/* Fields painted on the flat pattern, the signs where a limit is exceeded, and the scale with its numbers. */

const MOST_CELLS = 24; // cells along a side of a patch: no finer than a change of colour by two steps asks for

/* Cells fine enough that the colour of the middle of each is within one step of that of its ends. */
function cellsFor(values, limit) {
  const tones = values.map((value) => strainColour(value / limit));
  const apart = Math.max(...tones[0].map((_, k) => Math.max(...tones.map((tone) => tone[k])) - Math.min(...tones.map((tone) => tone[k]))));
  return Math.min(Math.max(Math.ceil(apart / 2), 1), MOST_CELLS);
}

/* corners: places of the field at (0,0), (1,0), (1,1), (0,1); value(s, t) within; every cell has one colour. */
function paintPatch(context, corners, value, n, limit, place) {
  const at = (s, t) => [0, 1].map((k) => (1 - t) * ((1 - s) * corners[0][k] + s * corners[1][k]) + t * ((1 - s) * corners[3][k] + s * corners[2][k]));
  // the outer cells have the value of the edge that they touch, so that the places of the field have their own colour
  const near = (c) => (c === 0 ? 0 : c === n - 1 ? 1 : (c + 0.5) / n);
  for (let a = 0; a < n; a += 1) {
    for (let b = 0; b < n; b += 1) {
      context.fillStyle = context.strokeStyle = cssColour(strainColour(value(near(a), near(b)) / limit));
      context.beginPath();
      for (const [s, t] of [[a, b], [a + 1, b], [a + 1, b + 1], [a, b + 1]]) context.lineTo(...place(...at(s / n, t / n)));
      context.closePath();
      context.fill();
      context.stroke();
    }
  }
}

function paintGrid(context, { x, y, value, across: n, breaks }, limit, place) {
  for (let j = 0; (j + 2) * n <= x.length; j += 1) {
    if (breaks[j] === breaks[j + 1]) continue; // the joint of two pieces
    for (let i = 0; i + 1 < n; i += 1) {
      const corners = [j * n + i, j * n + i + 1, (j + 1) * n + i + 1, (j + 1) * n + i], [a, b, c, d] = corners.map((k) => value[k]);
      if (corners.some((k) => value[k] === null)) continue;
      const between = (s, t) => (1 - t) * ((1 - s) * a + s * b) + t * ((1 - s) * d + s * c);
      paintPatch(context, corners.map((k) => [x[k], y[k]]), between, Math.max(cellsFor([a, b, c, d], limit), 4), limit, place);
    }
  }
}

/* Strips between rulings, each with the colours along its middle: it is narrow, and few values change across it. */
function paintRulings(context, { ends, rows, broken, on, limit }, place) {
  const end = (k) => [ends[2 * k], ends[2 * k + 1]];
  for (let i = 0; i + 1 < rows; i += 1) {
    if (broken.has(i)) continue;
    const corners = [2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2].map(end), between = (s, t) => (1 - t) * on(i, s) + t * on(i + 1, s);
    const strips = Math.max(...[0, 1].map((s) => cellsFor([between(s, 0), between(s, 1)], limit)));
    for (let k = 0; k < strips; k += 1) paintStrip(context, corners, between, [k / strips, (k + 1) / strips], limit, place);
  }
}

function paintStrip(context, corners, between, [low, high], limit, place) {
  const at = (s, t) => place(...[0, 1].map((k) => (1 - t) * corners[s][k] + t * corners[3 - s][k])), middle = (low + high) / 2;
  const ramp = context.createLinearGradient(...at(0, middle), ...at(1, middle));
  const stops = cellsFor([0, 0.5, 1].map((s) => between(s, middle)), limit);
  for (let k = 0; k <= stops; k += 1) ramp.addColorStop(k / stops, cssColour(strainColour(between(k / stops, middle) / limit)));
  context.fillStyle = context.strokeStyle = ramp;
  context.beginPath();
  for (const [s, t] of [[0, low], [1, low], [1, high], [0, high]]) context.lineTo(...at(s, t));
  context.closePath();
  context.fill();
  context.stroke();
}

/* Places of a mesh: every spot has the colour of the nearest one, found on a raster. */
function paintPlaces(context, { x, y, value }, nearest, limit, place) {
  const box = [Math.min(...x), Math.min(...y), Math.max(...x), Math.max(...y)];
  const [l, b] = place(box[0], box[1]), [r, t] = place(box[2], box[3]);
  const step = Math.max(1, Math.hypot(r - l, b - t) / 300), over = 4 * step;
  const perX = (box[2] - box[0]) / Math.max(r - l, 1e-9), perY = (box[3] - box[1]) / Math.max(b - t, 1e-9);
  for (let py = t - over; py < b + over; py += step) {
    for (let px = l - over; px < r + over; px += step) {
      const k = nearest(box[0] + (px + step / 2 - l) * perX, box[3] - (py + step / 2 - t) * perY);
      if (value[k] === null) continue;
      context.fillStyle = cssColour(strainColour(value[k] / limit));
      context.fillRect(px, py, step + 0.5, step + 0.5);
    }
  }
}

/* Return the function that finds the place nearest to a point: buckets, searched in growing rings. */
function nearestPlace({ x, y }) {
  const low = [Math.min(...x), Math.min(...y)];
  const wide = Math.max(...x) - low[0], tall = Math.max(...y) - low[1];
  const pitch = Math.max(Math.sqrt((wide * tall) / x.length), Math.max(wide, tall) / x.length, 1e-9);
  const columns = Math.floor(wide / pitch) + 1, rows = Math.floor(tall / pitch) + 1;
  const buckets = Array.from({ length: columns * rows }, () => []);
  x.forEach((_, k) => buckets[Math.floor((y[k] - low[1]) / pitch) * columns + Math.floor((x[k] - low[0]) / pitch)].push(k));
  return (px, py) => {
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
}

const SIGN_PITCH = 16, SIGN_SIZE = 4; // px

/* Small triangles wherever the limit is exceeded, within what is clipped to. */
function paintSigns(plan, field) {
  if (!(field.largest > field.limit)) return;
  const { context } = plan;
  context.fillStyle = "#14181d";
  for (let py = SIGN_PITCH / 2; py < plan.height; py += SIGN_PITCH) {
    for (let px = SIGN_PITCH / 2; px < plan.width; px += SIGN_PITCH) {
      const value = field.at(...plan.unplace(px, py));
      if (value === null || !(Math.abs(value) > field.limit)) continue;
      context.beginPath();
      context.moveTo(px, py - SIGN_SIZE);
      context.lineTo(px + SIGN_SIZE, py + SIGN_SIZE * 0.7);
      context.lineTo(px - SIGN_SIZE, py + SIGN_SIZE * 0.7);
      context.fill();
    }
  }
}

/* Where the colours end at a round number there is no limit to be beyond. */
const beyondWords = (field) => `beyond the ${field.held ? "limit" : "scale"}`;

const SCALE_ROOM = 58; // px above the pattern that the scale takes

function drawScale(plan, field) {
  const { context, width } = plan, ink = themeColour("--ink");
  const long = Math.min(300, width - 40), left = 16, top = 22, tall = 12, beyond = field.largest > field.limit;
  context.fillStyle = themeColour("--bg");
  context.globalAlpha = 0.85;
  context.fillRect(0, 0, width, SCALE_ROOM - 4);
  context.globalAlpha = 1;
  for (let i = 0; i < long; i += 1) {
    context.fillStyle = cssColour(strainColour((2 * i) / (long - 1) - 1));
    context.fillRect(left + i, top, 1.5, tall);
  }
  context.strokeStyle = context.fillStyle = ink;
  context.lineWidth = 1;
  context.strokeRect(left, top, long, tall);
  context.font = "12px system-ui, sans-serif";
  context.textAlign = "left";
  const words = beyond ? `${field.title}: \u25b2 ${beyondWords(field)}` : `${field.title}, to ${field.held ? "its limit" : "a round number: no limit"}`;
  context.fillText(words, left, top - 7, width - 2 * left);
  for (const tick of [-1, -0.5, 0, 0.5, 1]) {
    const x = left + (long * (tick + 1)) / 2;
    context.fillRect(x - 0.5, top + tall, 1, 4);
    context.textAlign = tick === -1 ? "left" : tick === 1 ? "right" : "center";
    context.fillText(tick === 0 ? "0" : (tick > 0 ? "+" : "\u2212") + percent(Math.abs(tick * field.limit)), x, top + tall + 16);
  }
}
