"""Lines and arcs for the exact edges of a contour: few of them, smooth inside each edge, within a stated distance.

A `Segment` becomes one line and a `CircularArc` its own arc.  Any other edge that is straight or circular to rounding
is recovered as such; what remains is cut at corners and straight stretches, and the smooth stretches between become
G1 chains of arcs (`arcspline`).  Vertices lie exactly on the curve where edges meet, so corners are kept.  Directions
are kept where the curve runs on smoothly: at a straight stretch, and into the next edge.

Not for curves whose shape is finer than `FINEST_PIECE_MM`; those end in an error with both numbers.  Whether an edge is
straight or circular, and how far the arcs are from it, is measured at dense points, not proved.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, dist, hypot, pi, radians, tan

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.arrays import EPS, Array, Numbers, Points2, Values, norm
from stages.geometry.curves.plane import CircularArc, PlaneCurve, Segment
from stages.geometry.flat.sampling import Resolved, Samples, not_too_large, resolved, samples
from stages.geometry.paths.arcbreaks import Stretch
from stages.geometry.paths.arcpath import ArcPath
from stages.geometry.paths.arcspline import TooSparseError, chain

LEAST_PIECE_MM = 0.05
"""Controllers stumble over shorter pieces; only edges that are shorter, or bend too tightly for it, give some."""

FINEST_PIECE_MM = 0.003
"""Shorter pieces than this are not tried: what bends so tightly is no shape to be cut."""

ZERO_LENGTH_MM = 1e-6
"""An edge that stays within this of its start is a point: no reader tells its ends apart."""

SPENT = 0.7
"""Share of the accuracy that the fit may use; the rest is for rounding, for the reader, and for the measurement."""

EXACT, EXACT_SHARE = 1e-9, 1e-3
"""An edge this close to a line or circle is one: as a share of its size, and of the accuracy asked for."""

SMOOTH_JOIN_RAD = radians(1.0)
"""Two edges that meet at less than this run on smoothly: both keep their directions there."""

WIDEST_ARC_RAD = pi / 2.0
FIRST_SAMPLES = 769
MOST_SAMPLES = 40_000
"""A curve that needs more is too fine for its accuracy; shorter pieces may still do."""


@dataclass(frozen=True, slots=True)
class _Edge:
    """An edge with what has to be known of it before its neighbours: samples and end directions in rad."""

    curve: PlaneCurve
    samples: Samples
    known: Resolved | None = None

    @property
    def start(self) -> Array:
        """The first point."""
        first: Array = self.samples.points[0]
        return first

    @property
    def end(self) -> Array:
        """The last point."""
        last: Array = self.samples.points[-1]
        return last


@dataclass(frozen=True, slots=True, eq=False)
class _Run:
    """Pieces in order: the start of each, their bulges, and the end of the last."""

    starts: Points2
    bulges: Values
    end: Array


def trace(edges: Sequence[PlaneCurve], *, accuracy: float) -> ArcPath:
    """Return the closed path of lines and arcs within `accuracy` mm of the contour that the edges close.

    Each edge begins where the one before ends.  Edges of no length (an apex) are dropped.

    Raises NoSolutionError if the accuracy cannot be met or the edges leave a gap.
    """
    return traced(edges, accuracy)[0]


def traced(edges: Sequence[PlaneCurve], accuracy: float) -> tuple[ArcPath, Numbers]:
    """Return that path, and of each of its pieces the number of the edge that it stands for."""
    sampled = [_sampled(edge, accuracy) for edge in not_too_large(edges, accuracy)]
    numbers = [number for number, edge in enumerate(sampled) if _extent(edge) > ZERO_LENGTH_MM]
    known = [sampled[number] for number in numbers]
    if not known:
        raise NoSolutionError("a contour of points", reached=0.0, wanted=ZERO_LENGTH_MM, unit="mm")
    _refuse_gaps(known, accuracy)
    smooth = [_runs_on(known[i - 1], known[i]) for i in range(len(known))]
    smooth.append(smooth[0])
    runs = [_traced(edge, smooth[i], smooth[i + 1], accuracy) for i, edge in enumerate(known)]
    starts = np.concatenate([run.starts for run in runs])
    path = ArcPath(starts, np.concatenate([run.bulges for run in runs]), closed=True)
    return path, np.repeat(numbers, [run.bulges.size for run in runs])


def fit(edge: PlaneCurve, *, accuracy: float) -> ArcPath:
    """Return the open path of lines and arcs within `accuracy` mm of the edge, with its exact ends.

    Raises NoSolutionError if the accuracy cannot be met.
    """
    known = _sampled(edge, accuracy)
    closes = dist(known.end, known.start) <= ZERO_LENGTH_MM and _runs_on(known, known)
    run = _traced(known, closes, closes, accuracy)
    return ArcPath(np.vstack([run.starts, run.end]), np.append(run.bulges, 0.0), closed=False)


def _sampled(edge: PlaneCurve, accuracy: float) -> _Edge:
    """Return the edge with samples of it; a few do for lines and arcs."""
    if isinstance(edge, Segment | CircularArc):
        t = np.linspace(0.0, 1.0, 9)
        slopes = edge.derivative(t)
        return _Edge(edge, Samples(t, edge.at(t), np.unwrap(np.arctan2(slopes[:, 1], slopes[:, 0]))))
    known = resolved(edge, accuracy=accuracy * GRID_SHARE)
    return _Edge(edge, samples(known, count=FIRST_SAMPLES), known)


GRID_SHARE = 0.02
"""How well the grid under the samples must know the curve, as a share of the accuracy."""


def _extent(edge: _Edge) -> float:
    """Return how far the edge gets from its start, in mm."""
    return float(norm(edge.samples.points - edge.start).max())


def _refuse_gaps(edges: Sequence[_Edge], accuracy: float) -> None:
    """Raise NoSolutionError if an edge does not begin where the one before ends."""
    gap = max(dist(edges[i].start, edges[i - 1].end) for i in range(len(edges)))
    allowed = (1.0 - SPENT) * accuracy
    if gap > allowed:
        raise NoSolutionError("a gap between the edges of a contour", reached=gap, wanted=allowed, unit="mm")


def _runs_on(before: _Edge, after: _Edge) -> bool:
    """Return whether the direction hardly changes from one edge to the next."""
    turn = after.samples.angle[0] - before.samples.angle[-1]
    return bool(abs(pi - (pi - turn) % (2.0 * pi)) < SMOOTH_JOIN_RAD)


def _traced(edge: _Edge, keep_start: bool, keep_end: bool, accuracy: float) -> _Run:
    """Return the pieces of one edge."""
    if isinstance(edge.curve, Segment):
        return _line(edge.start, edge.end)
    if isinstance(edge.curve, CircularArc):
        return _arcs(edge.samples.points, edge.curve.sweep_rad)
    size = _extent(edge)
    exact = min(EXACT * size, EXACT_SHARE * accuracy)
    if _is_straight(edge.samples.points, exact):
        return _line(edge.start, edge.end)
    sweep = _circular_sweep(edge.samples.points, exact)
    if sweep is not None:
        return _arcs(edge.samples.points, sweep)
    return _curved(edge, keep_start, keep_end, accuracy)


def _line(start: Array, end: Array) -> _Run:
    """Return one line."""
    return _Run(start[None, :], np.zeros(1), end)


def _arcs(points: Points2, sweep: float) -> _Run:
    """Return one arc from the first to the last of its points, in equal parts if it is more than a half circle."""
    parts = max(ceil(abs(sweep) / pi - EXACT), 1)
    centre, radius = _circle(points)
    first = points[0] - centre
    angle = np.arctan2(first[1], first[0]) + sweep * np.arange(1, parts) / parts
    inner = centre + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return _Run(np.vstack([points[:1], inner]), np.full(parts, tan(sweep / parts / 4.0)), points[-1])


def _is_straight(points: Points2, exact: float) -> bool:
    """Return whether the points run straight from the first to the last."""
    chord = points[-1] - points[0]
    length = hypot(*chord)
    if length <= exact:
        return False
    offset = (points - points[0]) @ (np.array([[chord[0], -chord[1]], [chord[1], chord[0]]]) / length)
    return bool(np.abs(offset[:, 1]).max() <= exact and np.diff(offset[:, 0]).min() >= -exact)


def _circle(points: Points2) -> tuple[Array, float]:
    """Return centre and radius of the circle through three points far apart; not finite if they are in line."""
    closed = dist(points[-1], points[0]) < dist(points[points.shape[0] // 2], points[0]) / 2.0
    picks = np.array([0, 1, 2]) * ((points.shape[0] - 1) // (3 if closed else 2))
    origin, p, q = points[picks] - points[0]
    doubled = 2.0 * (p[0] * q[1] - p[1] * q[0])
    with np.errstate(divide="ignore", invalid="ignore"):
        right = np.array([q[1] * (p @ p) - p[1] * (q @ q), p[0] * (q @ q) - q[0] * (p @ p)]) / doubled
    return points[0] + right + origin, hypot(*right)


CENTRE_ROUNDING = 16.0 * EPS
"""Distances from a centre are off by this share of the radius: too large a circle would hold any points."""


def _circular_sweep(points: Points2, exact: float) -> float | None:
    """Return the signed sweep in rad if the points run along one circle, else None."""
    centre, radius = _circle(points)
    if not radius * CENTRE_ROUNDING <= exact or np.abs(norm(points - centre) - radius).max() > exact:
        return None
    angle = np.unwrap(np.arctan2(*(points - centre).T[::-1]))
    step = np.diff(angle) * np.sign(angle[-1] - angle[0])
    if step.min() * radius < -exact or abs(angle[-1] - angle[0]) > 2.0 * pi + EXACT:
        return None
    return float(angle[-1] - angle[0])


def _curved(edge: _Edge, keep_start: bool, keep_end: bool, accuracy: float) -> _Run:
    """Return lines and chains of arcs for an edge that is neither straight nor circular as a whole.

    Takes four times the samples as long as they are too few, then pieces of a quarter of the length, twice.
    """
    found, least = edge.samples, LEAST_PIECE_MM
    while True:
        try:
            return _chained(found, keep_start, keep_end, accuracy, least)
        except NoSolutionError as error:
            if isinstance(error, TooSparseError) and edge.known is not None and found.t.size < MOST_SAMPLES:
                found = samples(edge.known, count=4 * found.t.size - 3)
            elif least >= 4.0 * FINEST_PIECE_MM:
                least /= 4.0
            else:
                raise


def _chained(found: Samples, keep_start: bool, keep_end: bool, accuracy: float, least: float) -> _Run:
    """Return lines for the straight stretches of the samples and chains of arcs for the others."""
    starts, bulges = [found.points[:0]], [np.zeros(0)]
    cuts = _stretches(found, accuracy)
    for i, (first, last, straight) in enumerate(cuts):
        points = found.points[first : last + 1]
        if straight:
            starts.append(points[:1])
            bulges.append(np.zeros(1))
            continue
        # a neighbour that shares the sample is straight and is run into smoothly; one that does not is past a corner
        keep_first = keep_start if i == 0 else cuts[i - 1][1] == first
        keep_last = keep_end if i == len(cuts) - 1 else cuts[i + 1][0] == last
        stretch = Stretch(points, found.angle[first : last + 1], keep_first, keep_last)
        part = chain(stretch, accuracy=SPENT * accuracy, least_piece=least)
        starts.append(part.vertices[:-1])
        bulges.append(part.bulges)
    return _Run(np.concatenate(starts), np.concatenate(bulges), found.points[-1])


CORNER_RAD = radians(1.0)
CORNER_SHARE = 16.0
"""A corner turns by more than this many times the mean step; samples share the turning out evenly, within twice."""

STRAIGHT_RAD = 1e-11
"""Directions along a line agree this well; on a curve of 10 m radius, samples would have to be 1e-7 mm apart."""

STRAIGHT_STEPS = 8
"""So many steps in a row without a turn are a line, not the inflection of a curve."""


def _stretches(found: Samples, accuracy: float) -> list[tuple[int, int, bool]]:
    """Return the stretches between corners and between the ends of lines: first and last sample, and if straight."""
    turn = np.abs(np.diff(found.angle))
    step = norm(np.diff(found.points, axis=0))
    corner = (turn > max(CORNER_RAD, CORNER_SHARE * turn.mean())) & (step <= GRID_SHARE * accuracy)
    edges = np.flatnonzero(corner)
    firsts = np.concatenate([[0], edges + 1])
    lasts = np.concatenate([edges, [turn.size]])
    parts: list[tuple[int, int, bool]] = []
    for first, last in zip(firsts, lasts, strict=True):
        if dist(found.points[last], found.points[first]) > GRID_SHARE * accuracy or last - first > STRAIGHT_STEPS:
            parts += _between_lines(turn, step, int(first), int(last))
    return parts


def _between_lines(turn: Values, step: Values, first: int, last: int) -> list[tuple[int, int, bool]]:
    """Return the straight stretches from sample `first` to `last` and what lies between them."""
    straight = np.concatenate([[False], turn[first:last] <= STRAIGHT_RAD, [False]])
    begins, ends = (np.flatnonzero(np.diff(straight.astype(np.int64)) == sign) + first for sign in (1, -1))
    parts: list[tuple[int, int, bool]] = []
    done = first
    for begin, end in zip(begins.tolist(), ends.tolist(), strict=True):
        if end - begin < STRAIGHT_STEPS or step[begin:end].sum() < LEAST_PIECE_MM:
            continue
        if begin > done:
            parts.append((done, begin, False))
        parts.append((begin, end, True))
        done = end
    if done < last:
        parts.append((done, last, False))
    return parts
