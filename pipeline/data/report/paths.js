/* Lines and arcs on a canvas.  A path is x, y, bulge of one vertex after another; bulge = tan(sweep / 4). */

function tracePath(context, path, place) {
  const p = path.points;
  const count = p.length / 3;
  const [x0, y0] = place(p[0], p[1]);
  context.moveTo(x0, y0);
  for (let i = 0; i < (path.closed ? count : count - 1); i += 1) {
    const a = 3 * i, b = 3 * ((i + 1) % count);
    traceStep(context, p[a], p[a + 1], p[b], p[b + 1], p[a + 2], place);
  }
  if (path.closed) context.closePath();
}

function traceStep(context, ax, ay, bx, by, bulge, place) {
  const [px, py] = place(bx, by);
  if (bulge === 0) { context.lineTo(px, py); return; }
  const [qx, qy] = place(ax, ay);
  const chord = Math.hypot(px - qx, py - qy);
  const off = (1 - bulge * bulge) / (4 * bulge); // of the chord: from its middle to the centre, on its left in mm
  const dx = bx - ax, dy = by - ay;
  const [cx, cy] = place((ax + bx) / 2 - off * dy, (ay + by) / 2 + off * dx);
  const radius = (chord * (1 + bulge * bulge)) / (4 * Math.abs(bulge));
  if (!(radius < 1e7)) { context.lineTo(px, py); return; } // straight to a pixel
  const start = Math.atan2(qy - cy, qx - cx), end = Math.atan2(py - cy, px - cx);
  const [ox, oy] = place(0, 0), [ux, uy] = place(1, 0), [vx, vy] = place(0, 1);
  const mirrored = (ux - ox) * (vy - oy) - (uy - oy) * (vx - ox) < 0; // y up on the page: counter-clockwise turns over
  context.arc(cx, cy, radius, start, end, mirrored === bulge > 0);
}

function pathBox(paths) {
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  for (const { points: p, closed } of paths) {
    for (let i = 0; i < p.length; i += 3) {
      grow(box, p[i], p[i + 1]);
      const j = (i + 3) % p.length;
      if (p[i + 2] !== 0 && (closed || j > i)) {
        const b = p[i + 2] / 2; // the middle of the arc lies bulge / 2 chords to the right
        grow(box, (p[i] + p[j]) / 2 + b * (p[j + 1] - p[i + 1]), (p[i + 1] + p[j + 1]) / 2 - b * (p[j] - p[i]));
      }
    }
  }
  return box;
}

function grow(box, x, y) {
  box[0] = Math.min(box[0], x); box[1] = Math.min(box[1], y);
  box[2] = Math.max(box[2], x); box[3] = Math.max(box[3], y);
}
