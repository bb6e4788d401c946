"""Where the holes, marks and notches of a job lie on faces that make one blank in any direction.

A place in space belongs to the face that it is nearest to: on its strip the nearest place is sought (`pullback`), and
taken into the edges of the face.  Equally near places on two faces are refused, unless they are one, as on the edge
where the faces go over into each other.  A curve is divided where it passes from one face to the next, which is
bisected; each piece is pulled back onto its own face.  Places given as u and v are refused: every face has its own.

A place may lie beyond the edges of its face by `NEAR` of its size: what is on the part is seen on the contours that are
cut.  A visit of a curve to another face between two of its `SAMPLES` places is not seen.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

import numpy as np

from stages.construct.curves import chain
from stages.construct.faces.based import Based
from stages.construct.faces.ground import Ground, ground_of
from stages.construct.features import MEETS, SAMPLES, NoPlaceError, Placement, checked, gap, placement
from stages.geometry.arrays import Points2, Values, Vector2, Vector3, floats, norm
from stages.geometry.curves.curves import Curve, restrict
from stages.geometry.curves.plane import PlaneCurve
from stages.geometry.flat.tabled import tabled
from stages.geometry.ruled.nearest import APART, SAME, nearest, rivals
from stages.geometry.ruled.pullback import pulled_back
from stages.geometry.ruled.strip import points
from stages.model.curves import CurveSpec, PlanePoint, is_flat
from stages.model.features import CurveHole, CurveMark, Feature, NotchSpec, RulingMarks
from stages.model.part import PartSpec
from stages.model.surface import Placed
from stages.model.tolerances import Tolerances

NEAR = 2e-3
"""Share of the size of a face: more than what the chords of its edges leave out (`ground`)."""


def on_faces(spec: PartSpec, sides: Sequence[Based], tol: Tolerances) -> Placement:
    """Return the features of a part on its faces; a fatal finding for each that has no place there."""
    if not (spec.hole or spec.mark or spec.notch):
        return Placement((), ())
    grounds = [ground_of(side) for side in sides]
    return placement(spec, lambda name, feature: _placed(grounds, name, feature), tol)


def _placed(grounds: Sequence[Ground], name: str, spec: Feature) -> Placed:
    if isinstance(spec, RulingMarks):
        raise ValueError("marked rulings have no place of their own")
    if isinstance(spec, NotchSpec):
        if spec.edge == "outline":
            return Placed(name, spec)
        text = f'a blank of several faces has no edge {spec.edge!r}; give edge = "outline" and a distance along it'
        raise NoPlaceError("no-such-edge", text)
    if isinstance(spec, CurveHole | CurveMark):
        return _curve(grounds, name, spec, spec.curve)
    return _place(grounds, name, spec, spec.at)


def _refuse_uv(what: str) -> NoPlaceError:
    text = f"[u, v] has no meaning on a blank of several faces: give {what} in space"
    return NoPlaceError("feature-on-branches", text)


# Places


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """The nearest place of a face: its distance and how far beyond the edges of the face it would be, both mm."""

    face: int
    place: Vector2
    point: Vector3
    distance_mm: float
    beyond_mm: float


def _place(grounds: Sequence[Ground], name: str, spec: Feature, at: PlanePoint) -> Placed:
    if len(at) == len("uv"):
        raise _refuse_uv("at = [x, y, z]")
    point: Vector3 = floats(at)
    found: list[Candidate] = []
    for k in np.argsort([float(ground.beyond_box(point[None])[0]) for ground in grounds], kind="stable"):
        ground = grounds[k]
        least = min((one.distance_mm for one in found), default=np.inf)
        if float(ground.beyond_box(point[None])[0]) <= least:
            found += _candidates(int(k), ground, point)
    best = min(found, key=lambda one: (one.distance_mm > _least(found) + SAME * grounds[one.face].size_mm, one.face))
    _refuse_beyond(grounds[best.face], best)
    _refuse_rivals(grounds, found, best)
    distance = float(norm(points(grounds[best.face].strip, *best.place[:, None]) - point)[0])
    return Placed(name, spec, best.place, (), distance, faces=(best.face,))


def _least(found: Sequence[Candidate]) -> float:
    return min(one.distance_mm for one in found)


def _candidates(k: int, ground: Ground, point: Vector3) -> list[Candidate]:
    """Return the nearest place on a face, and those that are as near and elsewhere."""
    near = nearest(ground.strip, point)
    every: Points2 = np.concatenate([near.place[None], rivals(ground.strip, near)])
    inner = ground.inside(every)
    at, there = (points(ground.strip, *rows.T) for rows in (every, inner))
    rows = zip(inner, there, norm(there - point), norm(there - at), strict=True)
    return [Candidate(k, place, spot, float(off), float(beyond)) for place, spot, off, beyond in rows]


def _refuse_beyond(ground: Ground, one: Candidate) -> None:
    if one.beyond_mm > NEAR * ground.size_mm:
        number = ground.side.face.index
        text = f"the nearest face is {number}, and the place lies {one.beyond_mm:.4g} mm beyond its edges"
        raise NoPlaceError("place-outside", text)


def _refuse_rivals(grounds: Sequence[Ground], found: Sequence[Candidate], best: Candidate) -> None:
    """Refuse a place that has another one as near, elsewhere in space or at the other end of a seam."""
    for one in found:
        scale = max(grounds[i].size_mm for i in (one.face, best.face))
        near = one.distance_mm <= best.distance_mm + SAME * scale
        other = float(norm(one.point - best.point)) > APART * scale or one.face == best.face
        if one is not best and near and other:
            numbers = sorted({grounds[i].side.face.index for i in (one.face, best.face)})
            where = " and ".join(f"({x:.6g}, {y:.6g}, {z:.6g})" for x, y, z in (best.point, one.point))
            text = f"{where} mm are equally near, {best.distance_mm:.4g} mm, on {' and '.join(map(_called, numbers))}"
            raise NoPlaceError("ambiguous-place", f"{text}: give a place nearer to one of them")


def _called(number: int) -> str:
    return f"face {number}"


# Curves


def _curve(grounds: Sequence[Ground], name: str, spec: Feature, given: CurveSpec) -> Placed:
    if is_flat(given):
        raise _refuse_uv("the points of the curve as [x, y, z]")
    rows = [piece for curve in chain(given).curves for piece in _pieces(grounds, curve)]
    faces, edges = tuple(k for k, _, _ in rows), tuple(edge for _, edge, _ in rows)
    breaks = list(pairwise(range(len(rows)))) + ([(len(rows) - 1, 0)] if isinstance(spec, CurveHole) else [])
    for i, j in breaks:
        left = _gap(grounds, (faces[i], edges[i]), (faces[j], edges[j]))
        if left > MEETS * max(grounds[k].size_mm for k in (faces[i], faces[j])):
            text = "the curve does not close" if j == 0 else "the pieces of the curve do not meet"
            raise NoPlaceError("open-contour", f"{text} on the faces: {left:.4g} mm are missing")
    return Placed(name, spec, None, edges, max(off for *_, off in rows), faces=faces)


OnFace = tuple[int, PlaneCurve]


def _gap(grounds: Sequence[Ground], one: OnFace, other: OnFace) -> float:
    """Return how far apart the end of one piece and the beginning of the next are, mm."""
    if one[0] == other[0]:
        return gap(grounds[one[0]].strip, one[1], other[1])
    end, start = (points(grounds[k].strip, *edge.at(np.array([t])).T) for (k, edge), t in ((one, 1.0), (other, 0.0)))
    return float(norm(end - start)[0])


def _pieces(grounds: Sequence[Ground], curve: Curve) -> list[tuple[int, PlaneCurve, float]]:
    """Return a smooth curve as pieces: the face of each, its u and v there, and its largest distance from it, mm."""
    near = _near(grounds, curve)
    scale = max(grounds[k].size_mm for k in near)

    def owners(t: Values) -> list[int]:
        """Return the nearest of the faces at t; of several as near the first in which the point has its foot."""
        x = curve.jet(t, 0)[0]
        off, along = np.stack([grounds[k].reach(x) for k in near], axis=1)
        along = np.where(off <= off.min(axis=0) + TIED * scale, along, np.inf)
        return [near[int(i)] for i in np.argmax(along <= along.min(axis=0) + ROUNDING * scale, axis=0)]

    t = np.linspace(0.0, 1.0, SAMPLES + 1)
    found = owners(t)
    steps = [(i, a, b) for i, (a, b) in enumerate(pairwise(found)) if a != b]
    if len(steps) >= MOST_PIECES:
        raise NoPlaceError("ambiguous-curve", "the curve runs along an edge between two faces: keep clear of it")
    cuts = [cut for i, a, b in steps for cut in changes(owners, (float(t[i]), a), (float(t[i + 1]), b))]
    stretches = _between([(0.0, found[0]), *cuts, (1.0, found[-1])])
    return [_piece(grounds[face], face, curve, low, high) for low, high, face in stretches]


TIED = 1e-6
"""Share of the size: faces as near as this are told apart by where the foot of the point is.

Beside an edge that two faces share, their distances from a point off the surface differ by a square of what it is
beyond the edge, which would be lost in rounding.
"""
ROUNDING = 1e-12
"""Share of the size by which a point on a common edge may be beyond either face."""
MOST_PIECES = 64
"""A curve that changes between faces more often runs along their edge."""

At = tuple[float, int]
"""A place of a curve, and the face from there on."""


def _near(grounds: Sequence[Ground], curve: Curve) -> list[int]:
    """Return the faces that may be the nearest to a curve somewhere."""
    every = curve.jet(np.linspace(0.0, 1.0, SAMPLES + 1), 0)[0]
    beyond = [ground.beyond_box(every) for ground in grounds]
    off: dict[int, Values] = {}
    least = np.full(len(every), np.inf)
    for k in sorted(range(len(grounds)), key=lambda k: float(beyond[k].max())):
        if (beyond[k] <= least).any():
            off[k], _ = grounds[k].reach(every)
            least = np.minimum(least, off[k])
    # between two samples no distance changes by more than the way
    step = float(norm(np.diff(every, axis=0)).max())
    return sorted(k for k, row in off.items() if (row <= least + 2.0 * step).any())


def changes(owners: Callable[[Values], list[int]], low: At, high: At) -> list[At]:
    """Return where a curve passes from one face to the next between two places on different ones."""
    (a, one), (b, other) = low, high
    later: list[At] = []
    while b - a > FINEST:
        t = np.linspace(a, b, SECTIONS + 1)
        found = [*owners(t[1:-1]), other]
        i = next(i for i, there in enumerate(found) if there != one)
        a, b = float(t[i]), float(t[i + 1])
        if found[i] != other:
            later = [*changes(owners, (b, found[i]), high), *later]
            other, high = found[i], (b, found[i])
    return [((a + b) / 2.0, other), *later]


SECTIONS = 16
FINEST = 1e-14
"""Of a curve: some roundings of a place on it."""


def _between(ends: Sequence[At]) -> list[tuple[float, float, int]]:
    """Return the stretches between places; one that is no longer than rounding goes to the one before or after it."""
    made: list[tuple[float, float, int]] = []
    for (low, face), (high, _) in pairwise(ends):
        begin = made[-1][1] if made else 0.0
        if high - low > SHORTEST:
            made.append((begin, high, face))
    low, _, face = made[-1]
    return [*made[:-1], (low, 1.0, face)]


SHORTEST = 1e-9
"""Of a curve: what ends so near to the edge of a face ends on it."""


def _piece(ground: Ground, face: int, curve: Curve, low: float, high: float) -> tuple[int, PlaneCurve, float]:
    """Return the stretch of a curve that is nearest to a face, on it."""
    part = curve if (low, high) == (0.0, 1.0) else restrict(curve, Fraction(low), Fraction(high))
    way = pulled_back(ground.strip, part, SAMPLES)
    off = checked(ground.strip, way)
    beyond = norm(points(ground.strip, *ground.inside(way.table).T) - points(ground.strip, *way.table.T))
    if beyond.max() > NEAR * ground.size_mm:
        number = ground.side.face.index
        text = f"the curve runs {float(beyond.max()):.4g} mm beyond the edges of the nearest face, {number}"
        raise NoPlaceError("place-outside", text)
    return face, tabled(way, ground.strip), off
