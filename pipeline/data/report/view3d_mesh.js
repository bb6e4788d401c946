// A part that is triangles, with the same questions answered as those of a ruled one.  Knows no screen.
"use strict";
(function () {
  const { sub, cross, unit, floats, wholes, positions, middle, moved, inTriangles } = window.planishPlaces;

  class Triangles {
    constructor(part) {
      const points = positions(part, 3);
      this.origin = middle(points);
      this.positions = Float32Array.from(moved(points, this.origin));
      this.triangles = Uint32Array.from(wholes(part.triangles));
      this.flat = part.flat && positions(part.flat, 2);
      this.fields = part.fields.map((one) => ({ ...one, values: floats(one.values) }));
      this.canForm = false;
      const line = (kind) => (packed) => ({ kind, points: this.chained(wholes(packed)) });
      this.drawn = [...part.seams.map(line("bend")), ...part.outlines.map(line("c0"))];
      this.normal = this.normals();
    }

    chained(chain) {
      const found = [];
      for (let i = 0; i + 1 < chain.length; i++) for (const k of [chain[i], chain[i + 1]]) found.push(...this.vertex(k));
      return Float32Array.from(found);
    }

    vertex(k) { return this.positions.subarray(3 * k, 3 * k + 3); }

    normals() {
      const found = new Float32Array(this.positions.length), t = this.triangles;
      for (let i = 0; i < t.length; i += 3) {
        const [a, b, c] = [0, 1, 2].map((k) => this.vertex(t[i + k])), n = cross(sub(b, a), sub(c, a));
        for (let k = 0; k < 9; k++) found[3 * t[i + (k / 3 | 0)] + k % 3] += n[k % 3];
      }
      for (let i = 0; i < found.length; i += 3) found.set(unit(found.subarray(i, i + 3)), i);
      return found;
    }

    form() {}
    values(field) { return field.values; }

    spot(corners, shares, field) {
      const mix = (list, size, k) => corners.reduce((sum, c, j) => sum + shares[j] * list[size * c + k], 0);
      const found = { point: [0, 1, 2].map((k) => mix(this.positions, 3, k)) };
      if (this.flat) [found.x, found.y] = [mix(this.flat, 2, 0), mix(this.flat, 2, 1)];
      if (field) found.value = mix(field.values, 1, 0);
      return found;
    }

    find(place, field) {
      const hit = this.flat && place.x !== undefined && inTriangles(this.flat, this.triangles, place.x, place.y);
      return hit ? this.spot(hit.corners, hit.shares, field) : null;
    }
  }

  window.planishModel = { of: (part) => part.kind === "ruled" ? new window.planishRuled(part) : new Triangles(part) };
})();
