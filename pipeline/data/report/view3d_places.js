// Places and directions of the formed part: how they are read from the page, and where one lies.  Knows no screen.
"use strict";
(function () {
  const TINY = 1e-30, SLACK = 1e-4;

  const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const add = (a, b, k) => [a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => { const n = Math.hypot(...a); return n > TINY ? [a[0] / n, a[1] / n, a[2] / n] : [0, 0, 0]; };
  const turned = (a, axis, angle) => {
    const c = Math.cos(angle), s = Math.sin(angle), w = cross(axis, a), d = dot(axis, a) * (1 - c);
    return [a[0] * c + w[0] * s + axis[0] * d, a[1] * c + w[1] * s + axis[1] * d, a[2] * c + w[2] * s + axis[2] * d];
  };

  const bytes = (text) => Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0));
  const floats = (text) => new Float32Array(bytes(text).buffer);
  const wholes = (one) => one.bytes === 2 ? new Uint16Array(bytes(one.numbers).buffer) : new Uint32Array(bytes(one.numbers).buffer);

  function positions(packed, size) {
    const steps = new Uint16Array(bytes(packed.points).buffer), found = new Float64Array(steps.length);
    for (let i = 0; i < steps.length; i++) found[i] = packed.low[i % size] + packed.step * steps[i];
    return found;
  }

  function middle(points) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < points.length; i++) {
      low[i % 3] = Math.min(low[i % 3], points[i]);
      high[i % 3] = Math.max(high[i % 3], points[i]);
    }
    return low.map((a, k) => (a + high[k]) / 2);
  }

  const moved = (points, by) => points.map((x, i) => x - by[i % 3]);

  // Whether a place lies inside a closed polygon of places.
  function inside(ring, row, u) {
    let odd = false;
    for (let i = 0; i + 3 < ring.length; i += 2) {
      const [r0, u0, r1, u1] = [ring[i], ring[i + 1], ring[i + 2], ring[i + 3]];
      if ((u0 > u) !== (u1 > u) && row < r0 + (r1 - r0) * (u - u0) / (u1 - u0)) odd = !odd;
    }
    return odd;
  }

  // The triangle of plane points that a point lies in, or that it is nearly in.
  function inTriangles(points, triangles, x, y) {
    for (let i = 0; i < triangles.length; i += 3) {
      const corners = [triangles[i], triangles[i + 1], triangles[i + 2]], shares = sharesOf(points, 2, corners, x, y);
      if (shares && Math.min(...shares) >= -SLACK) return { corners, shares };
    }
    return null;
  }

  // Shares of the corners at a point, by the first two coordinates; null for a triangle without area.
  function sharesOf(points, size, corners, x, y) {
    const [a, b, c] = corners.map((k) => [points[size * k], points[size * k + 1]]);
    const area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if (Math.abs(area) < TINY) return null;
    const t = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area;
    const s = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area;
    return [1 - t - s, t, s];
  }

  // Along a ruling the radius is linear: what is its inverse is harmonic.
  function harmonic(a, b, u) {
    if (!isFinite(a)) return u > 0 ? b / u : a;
    if (!isFinite(b)) return u < 1 ? a / (1 - u) : b;
    const under = b * (1 - u) + a * u;
    return a * b === 0 || Math.abs(under) < TINY ? a * (1 - u) + b * u : a * b / under;
  }

  window.planishPlaces = { sub, add, dot, cross, unit, turned, bytes, floats, wholes, positions, middle, moved, inside, inTriangles, sharesOf, harmonic };
})();
