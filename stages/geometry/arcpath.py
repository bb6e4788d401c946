"""Paths of lines and circular arcs, as a cutting machine takes them.

A path is an array of vertices and one bulge per vertex: the bulge b_i = tan(sweep / 4) bends the piece from vertex i
to vertex i + 1 (the last one closes the path), positive counter-clockwise, 0 straight.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import ArrayValue, Points2, Values, cross2, norm
from stages.geometry.rigid import Rigid2, apply


@dataclass(frozen=True, slots=True, eq=False)
class ArcPath(ArrayValue):
    """Vertices in mm, shape (n, 2), bulges, shape (n,), and whether the last vertex joins the first.

    On an open path the last bulge means nothing and is 0.
    """

    vertices: Points2
    bulges: Values
    closed: bool

    def check(self) -> None:
        """Refuse what no machine can follow: unequal counts, too few vertices, numbers that are not finite."""
        if self.vertices.shape != (self.bulges.size, 2) or self.bulges.size < 2:  # noqa: PLR2004
            raise ValueError(f"a path needs n >= 2 vertices and n bulges: {self.vertices.shape}, {self.bulges.shape}")
        if not (np.isfinite(self.vertices).all() and np.isfinite(self.bulges).all()):
            raise ValueError("a path must be finite")
        if not self.closed and self.bulges[-1] != 0.0:
            raise ValueError("the last bulge of an open path must be 0")


def sweeps(path: ArcPath) -> Values:
    """Return the signed sweep of each piece in rad, closing piece included on a closed path."""
    return 4.0 * np.arctan(path.bulges[: piece_count(path)])


def piece_count(path: ArcPath) -> int:
    """Return the number of lines and arcs."""
    return path.bulges.size if path.closed else path.bulges.size - 1


def chords(path: ArcPath) -> tuple[Points2, Points2]:
    """Return start and end points of the pieces, each of shape (pieces, 2)."""
    count = piece_count(path)
    return path.vertices[:count], np.roll(path.vertices, -1, axis=0)[:count]


def centres(path: ArcPath) -> Points2:
    """Return the centres of the arcs, shape (pieces, 2); NaN for straight pieces."""
    start, end = chords(path)
    bulge = path.bulges[: piece_count(path)]
    with np.errstate(divide="ignore", invalid="ignore"):
        offset = (1.0 / bulge - bulge) / 4.0
    chord = end - start
    centre = (start + end) / 2.0 + offset[:, None] * np.stack([-chord[:, 1], chord[:, 0]], axis=1)
    return np.where((bulge == 0.0)[:, None], np.nan, centre)


def radii(path: ArcPath) -> Values:
    """Return the radii of the pieces in mm; infinite for straight ones."""
    start, end = chords(path)
    bulge = np.abs(path.bulges[: piece_count(path)])
    with np.errstate(divide="ignore"):
        return np.where(bulge == 0.0, np.inf, norm(end - start) * (1.0 / bulge + bulge) / 4.0)


def length(path: ArcPath) -> float:
    """Return the length in mm; exact."""
    start, end = chords(path)
    chord = norm(end - start)
    half = np.abs(sweeps(path)) / 2.0
    return float(np.sum(chord / np.sinc(half / np.pi)))


def area(path: ArcPath) -> float:
    """Return the signed area of a closed path in mm2, positive counter-clockwise; exact."""
    start, end = chords(path)
    middle = path.vertices.mean(axis=0)
    polygon_part = 0.5 * np.sum(cross2(start - middle, end - middle))
    sweep = sweeps(path)
    chord = norm(end - start)
    # a circular segment of sweep a over the chord c: c^2 (a - sin a) / (8 sin^2(a/2)); by series where that cancels
    small = np.abs(sweep) < SMALL_SWEEP
    safe = np.where(small, 1.0, sweep)
    closed_form = (safe - np.sin(safe)) / (8.0 * np.sin(safe / 2.0) ** 2)
    series = sweep / 12.0 * (1.0 + sweep**2 / 30.0)
    return float(polygon_part + np.sum(chord**2 * np.where(small, series, closed_form)))


SMALL_SWEEP = 1e-3
"""Below this the two-term series of a segment's area is exact to rounding (next term a^4/1120), the closed form is not."""


def transform(path: ArcPath, motion: Rigid2) -> ArcPath:
    """Return the moved path; a mirror turns it round, so that a contour keeps its sense."""
    vertices = apply(motion, path.vertices)
    if not motion.mirrored:
        return ArcPath(vertices, path.bulges, path.closed)
    return backwards(ArcPath(vertices, -path.bulges, path.closed))


def backwards(path: ArcPath) -> ArcPath:
    """Return the same path run the other way."""
    if path.closed:
        return ArcPath(path.vertices[::-1], np.roll(-path.bulges[::-1], -1), closed=True)
    return ArcPath(path.vertices[::-1], np.append(-path.bulges[-2::-1], 0.0), closed=False)


def bounds(path: ArcPath) -> tuple[float, float, float, float]:
    """Return the exact extent (x least, y least, x most, y most) in mm, arcs included."""
    points = [path.vertices]
    start, _ = chords(path)
    centre, radius, sweep = centres(path), radii(path), sweeps(path)
    for i in np.flatnonzero(sweep):
        first = np.arctan2(*(start[i] - centre[i])[::-1])
        low, high = sorted((first, first + sweep[i]))
        quarters = np.arange(np.ceil(low / (np.pi / 2)), np.floor(high / (np.pi / 2)) + 1) * (np.pi / 2)
        points.append(centre[i] + radius[i] * np.stack([np.cos(quarters), np.sin(quarters)], axis=1))
    every = np.concatenate(points)
    low_x, low_y = every.min(axis=0)
    high_x, high_y = every.max(axis=0)
    return float(low_x), float(low_y), float(high_x), float(high_y)


def polygon(path: ArcPath, *, accuracy: float, outside: bool = False) -> Points2:
    """Return points along the path, mm, such that the polygon is within `accuracy` of it.

    The last point of a closed path is not repeated.  With `outside`, the polygon of a closed counter-clockwise path
    contains it: arcs that swell outward are replaced by tangents, hollow ones by chords (a part may only grow).
    """
    start, end = chords(path)
    centre, radius, sweep = centres(path), radii(path), sweeps(path)
    points = [path.vertices[:0]]
    for i in range(start.shape[0]):
        points.append(start[i : i + 1])
        if sweep[i] == 0.0:
            continue
        swelling = outside and sweep[i] > 0.0
        count = _steps(abs(sweep[i]), radius[i], accuracy)
        reach = radius[i] / np.cos(sweep[i] / count / 2.0) if swelling else radius[i]
        fraction = (np.arange(count) + 0.5) / count if swelling else np.arange(1, count) / count
        angle = np.arctan2(*(start[i] - centre[i])[::-1]) + sweep[i] * fraction
        points.append(centre[i] + reach * np.stack([np.cos(angle), np.sin(angle)], axis=1))
    if not path.closed:
        points.append(end[-1:])
    return np.concatenate(points)


def _steps(sweep: float, radius: float, accuracy: float) -> int:
    """Return into how many equal parts an arc is cut so that chord and tangent stay within `accuracy`."""
    step = 2.0 * np.arccos(max(1.0 - accuracy / (radius + accuracy), 0.0))
    return max(int(np.ceil(sweep / step)), int(np.ceil(sweep / (np.pi / 3))))
