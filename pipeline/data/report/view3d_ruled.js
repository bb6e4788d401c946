// A ruled part, as triangles and lines that follow when it is rolled up.  Knows no screen.
//
// It is two rails: both ends of its rulings, in space and flat.  A place on it is [row, u], row counted over the rulings
// with fractions between two, and everything shown is linear between rulings and along them.  Positions are relative to
// the middle of the box, so that single precision holds them.
"use strict";
(function () {
  const { sub, add, dot, cross, unit, turned, bytes, floats, positions, middle, moved, inside, inTriangles, harmonic } = window.planishPlaces;
  const COLUMNS = 6, PIECES = 24;

  class Ruled {
    constructor(part) {
      const points = positions(part, 3);
      this.origin = middle(points);
      this.formed = moved(points, this.origin);
      this.rows = this.formed.length / 6;
      this.flat = part.flat && positions(part.flat, 2);
      this.v = floats(part.v);
      this.broken = new Set(part.breaks);
      this.fields = part.fields.map((one) => ({ ...one, values: floats(one.values) }));
      this.rings = part.outlines.map(floats);
      this.marks = part.lines.map((one) => ({ ...one, places: floats(one.places) }));
      this.layOut(part);
      this.drawn = this.lines(part);
      this.rails = this.formed;
      this.canForm = this.flat !== null && this.rows > 2;
      if (this.canForm) this.prepare();
      this.form(1);
    }

    // Places and triangles: cells of the net that are whole, and triangles where an outline or a hole cuts one.
    layOut(part) {
      const whole = part.cells && bytes(part.cells.whole), corners = part.cells ? floats(part.cells.corners) : [];
      const wide = COLUMNS + 1, places = [], found = [];
      for (let i = 0; i < this.rows; i++) for (let j = 0; j < wide; j++) places.push(i, j / COLUMNS);
      for (let i = 0; i + 1 < this.rows; i++) {
        for (let j = 0; j < COLUMNS && !this.broken.has(i); j++) {
          const k = i * COLUMNS + j, a = i * wide + j;
          if (!whole || (whole[k >> 3] >> (k & 7)) & 1) found.push(a, a + 1, a + wide + 1, a, a + wide + 1, a + wide);
        }
      }
      for (let i = 0; i < corners.length; i += 2) found.push((places.length + i) / 2);
      // corners are rows and u, counter-clockwise as such: seen from the front they run the other way
      for (let i = found.length - corners.length / 2; i < found.length; i += 3) [found[i + 1], found[i + 2]] = [found[i + 2], found[i + 1]];
      this.places = Float32Array.from([...places, ...corners]);
      this.triangles = Uint32Array.from(found);
    }

    // Lines as pairs of places, with what they are.
    lines(part) {
      const last = this.rows - 1, edge = (u) => this.chain(Array.from({ length: this.rows }, (_, i) => [i, u]));
      const ruling = (row) => this.chain(Array.from({ length: PIECES + 1 }, (_, i) => [row, i / PIECES]));
      const bent = this.marks.some((one) => one.kind === "bend");
      const found = bent ? [] : [{ kind: "ruling", places: part.rulings.flatMap((row) => this.left(ruling(row))) }];
      for (const one of this.marks) found.push({ kind: one.kind, places: this.pairs(one.places) });
      if (part.worst !== null) found.push({ kind: "worst", places: this.left(ruling(part.worst)) });
      for (const ring of this.rings.slice(0, 1)) found.push({ kind: "c0", places: this.pairs(ring) });
      if (this.rings.length === 0) {
        found.push({ kind: "c0", places: edge(0) }, { kind: "c1", places: edge(1) });
        found.push({ kind: "end", places: ruling(last) }, { kind: "start", places: ruling(0) });
      }
      return found.filter((one) => one.places.length > 0);
    }

    chain(list) { return list.slice(1).flatMap((b, i) => [...list[i], ...b]); }
    pairs(ring) {
      const found = [];
      for (let i = 0; i + 3 < ring.length; i += 2) found.push(ring[i], ring[i + 1], ring[i + 2], ring[i + 3]);
      return found;
    }

    // What an outline and holes leave of pairs of places.
    left(pairs) {
      const holes = [...this.rings.slice(1), ...this.marks.filter((one) => one.kind === "hole").map((one) => one.places)];
      const found = [];
      for (let i = 0; i < pairs.length; i += 4) {
        const row = (pairs[i] + pairs[i + 2]) / 2, u = (pairs[i + 1] + pairs[i + 3]) / 2;
        const out = (this.rings.length && !inside(this.rings[0], row, u)) || holes.some((ring) => inside(ring, row, u));
        if (!out) found.push(...pairs.slice(i, i + 4));
      }
      return found;
    }

    at(row, u, rails, size) {
      const i = Math.max(0, Math.min(Math.floor(row), this.rows - 2)), t = row - i, found = [];
      for (let k = 0; k < size; k++) {
        const here = rails[(2 * i) * size + k] * (1 - u) + rails[(2 * i + 1) * size + k] * u;
        const next = rails[(2 * i + 2) * size + k] * (1 - u) + rails[(2 * i + 3) * size + k] * u;
        found.push(here + t * (next - here));
      }
      return found;
    }

    end(rails, row, side) { const i = 6 * row + 3 * side; return [rails[i], rails[i + 1], rails[i + 2]]; }

    // The angles by which the sheet is folded at each ruling, quads between rulings taken as plane.
    prepare() {
      this.quads = [];
      for (let i = 0; i + 1 < this.rows; i++) if (!this.broken.has(i)) this.quads.push(i);
      const normal = (i) => {
        const p = (row, side) => this.end(this.formed, row, side);
        return unit(cross(sub(p(i + 1, 1), p(i, 0)), sub(p(i + 1, 0), p(i, 1))));
      };
      this.normals = this.quads.map(normal);
      this.folds = this.quads.slice(1).map((i, k) => {
        const axis = unit(sub(this.end(this.formed, i, 1), this.end(this.formed, i, 0)));
        const [a, b] = [this.normals[k], this.normals[k + 1]];
        return Math.atan2(dot(cross(a, b), axis), dot(a, b));
      });
      const rolled = this.rolled(1);
      this.amiss = this.formed.map((x, i) => x - rolled[i]);
    }

    // Both ends of all rulings when every fold is bent by a share of its angle; the quad in the middle stays.
    rolled(share) {
      const base = this.quads.length >> 1, found = new Float64Array(6 * this.rows), flat = this.flat;
      const corner = (row, side) => [flat[4 * row + 2 * side], flat[4 * row + 2 * side + 1]];
      const laid = (map, [x, y]) => add(add(map.o, map.x, x), map.y, y);
      const put = (map, row) => { for (const side of [0, 1]) found.set(laid(map, corner(row, side)), 6 * row + 3 * side); };
      const start = this.standing(base, corner);
      const walk = (map, k, step) => {
        for (;;) {
          put(map, this.quads[k]);
          put(map, this.quads[k] + 1);
          const next = k + step;
          if (next < 0 || next >= this.quads.length) return;
          const row = step > 0 ? this.quads[k] + 1 : this.quads[k];
          const a = laid(map, corner(row, 0)), axis = unit(sub(laid(map, corner(row, 1)), a));
          const angle = share * step * this.folds[Math.min(k, next)];
          const [x, y] = [turned(map.x, axis, angle), turned(map.y, axis, angle)];
          map = { x, y, o: add(a, turned(sub(map.o, a), axis, angle), 1) };
          k = next;
        }
      };
      walk(start, base, 1);
      walk(start, base, -1);
      return found;
    }

    // The map of the flat frame onto the plane of a quad of the formed part.
    standing(k, corner) {
      const i = this.quads[k], n = this.normals[k], mid = (a, b) => a.map((x, j) => (x + b[j]) / 2);
      const [a, b] = [mid(corner(i, 0), corner(i + 1, 0)), mid(corner(i, 1), corner(i + 1, 1))];
      const p = (row, side) => this.end(this.formed, row, side);
      const [low, high] = [mid(p(i, 0), p(i + 1, 0)), mid(p(i, 1), p(i + 1, 1))];
      const e = unit(sub(high, low)), g = cross(n, e), f = unit([b[0] - a[0], b[1] - a[1], 0]);
      const x = add(e.map((c) => c * f[0]), g, -f[1]), y = add(e.map((c) => c * f[1]), g, f[0]);
      const c = mid(a, b);
      return { x, y, o: add(add(mid(low, high), x, -c[0]), y, -c[1]) };
    }

    // Positions and normals of everything at a share of the way from flat to formed.
    form(share) {
      if (share < 1) { const found = this.rolled(share); this.rails = found.map((x, i) => x + share * this.amiss[i]); }
      else this.rails = this.formed;
      this.positions = this.placed(this.places);
      const across = this.across(), n = this.places.length / 2;
      this.normal = new Float32Array(3 * n);
      for (let i = 0; i < n; i++) this.normal.set(unit(this.at(this.places[2 * i], this.places[2 * i + 1], across, 3)), 3 * i);
      for (const one of this.drawn) one.points = this.placed(one.places);
    }

    placed(places) {
      const found = new Float32Array(places.length / 2 * 3);
      for (let i = 0; 2 * i < places.length; i++) found.set(this.at(places[2 * i], places[2 * i + 1], this.rails, 3), 3 * i);
      return found;
    }

    // Unit normals at both ends of all rulings; of an end where the rails stand still, that of the other end.
    across() {
      const found = new Float64Array(6 * this.rows), r = this.rails;
      for (let i = 0; i < this.rows; i++) {
        const low = i > 0 && !this.broken.has(i - 1) ? i - 1 : i, high = i + 1 < this.rows && !this.broken.has(i) ? i + 1 : i;
        const p = sub(this.end(r, i, 1), this.end(r, i, 0));
        const both = [0, 1].map((side) => cross(p, sub(this.end(r, high, side), this.end(r, low, side))));
        const size = both.map((one) => Math.hypot(...one));
        for (const side of [0, 1]) {
          found.set(unit(both[size[side] > 1e-6 * size[1 - side] ? side : 1 - side]), 6 * i + 3 * side);
        }
      }
      return found;
    }

    // The value of a field: along a ruling the radius is linear, so the curvature is harmonic.
    value(field, row, u) {
      const i = Math.max(0, Math.min(Math.floor(row), this.rows - 2)), t = row - i, k = field.values;
      const along = (j) => harmonic(k[2 * j], k[2 * j + 1], u);
      const [a, b] = [along(i), along(i + 1)];
      return t === 0 ? a : t === 1 ? b : a + t * (b - a);
    }

    values(field) {
      const n = this.places.length / 2, found = new Float32Array(n);
      for (let i = 0; i < n; i++) found[i] = this.value(field, this.places[2 * i], this.places[2 * i + 1]);
      return found;
    }

    // What is at shares of the corners of a triangle.
    spot(corners, shares, field) {
      const mix = (k) => corners.reduce((sum, c, j) => sum + shares[j] * this.places[2 * c + k], 0);
      return this.spotAt(mix(0), mix(1), field);
    }

    spotAt(row, u, field) {
      const i = Math.max(0, Math.min(Math.floor(row), this.rows - 2));
      const found = { u, v: this.v[i] + (row - i) * (this.v[i + 1] - this.v[i]), row, point: this.at(row, u, this.rails, 3) };
      if (this.flat) [found.x, found.y] = this.at(row, u, this.flat, 2);
      if (field) found.value = this.value(field, row, u);
      return found;
    }

    find(place, field) {
      if (place.x === undefined) return this.spotAt(this.rowOf(place.v), place.u, field);
      const hit = this.flat && inTriangles(this.flatPositions(), this.triangles, place.x, place.y);
      return hit ? this.spot(hit.corners, hit.shares, field) : null;
    }

    flatPositions() {
      if (!this.inFlat) {
        this.inFlat = new Float64Array(this.places.length);
        for (let i = 0; i < this.places.length; i += 2) this.inFlat.set(this.at(this.places[i], this.places[i + 1], this.flat, 2), i);
      }
      return this.inFlat;
    }

    rowOf(v) {
      let i = 0;
      while (i + 2 < this.rows && this.v[i + 1] < v) i++;
      const wide = this.v[i + 1] - this.v[i];
      return i + (wide > 0 ? Math.max(0, Math.min((v - this.v[i]) / wide, 1)) : 0);
    }
  }

  window.planishRuled = Ruled;
})();
