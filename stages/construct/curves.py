"""Curves of the job file as chains of smooth pieces.

A chain runs over [0, 1] and is split where its pieces meet: at the knots of a B-spline, the points of a polyline or an
interpolation.  Bezier curves and B-splines stay exact, with weights too (blossoming over the rationals [1]_).

.. [1] L. Ramshaw, "Blossoms are polar forms", CAGD 6 (1989), 323-358.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import pi, radians

import numpy as np

from stages.geometry.arrays import Vector3, floats, norm, unit
from stages.geometry.curves.curves import Circular, Curve, bezier, exactly, rational, restrict
from stages.geometry.ruled.ruled import RuledPatch, between
from stages.model.curves import ArcSpec, BSplineSpec, CircleSpec, CurveSpec, EllipseSpec, HelixSpec

Row = Sequence[Fraction]


@dataclass(frozen=True, slots=True)
class Chain:
    """Smooth curves end to end; curve i runs over [breaks[i], breaks[i + 1]] of the whole."""

    curves: tuple[Curve, ...]
    breaks: tuple[Fraction, ...]


def chain(spec: CurveSpec) -> Chain:
    """Return the curve of a job file as a chain."""
    if spec.bezier is not None:
        return even([bezier([in_space(point) for point in spec.bezier])])
    if spec.bspline is not None:
        return bspline(spec.bspline)
    if spec.points is not None:
        return interpolated(np.array([floats(in_space(point)) for point in spec.points]))
    if spec.polyline is not None or spec.line is not None:
        points = spec.polyline or spec.line or ()
        return even([bezier([in_space(a), in_space(b)]) for a, b in pairwise(points)])
    if spec.chain is not None:
        return _joined([chain(piece) for piece in spec.chain])
    if spec.file is not None:
        raise ValueError(f"the curves of {spec.file} were not loaded")
    return even([_turning(spec)])


def _turning(spec: CurveSpec) -> Circular:
    for given in (spec.arc, spec.circle):
        if given is not None:
            return circle(given)
    if spec.ellipse is not None:
        return ellipse(spec.ellipse)
    if spec.helix is not None:
        return helix(spec.helix)
    raise ValueError("a curve of no sort passed the checks of the job file")


def in_space(point: Row) -> tuple[Fraction, Fraction, Fraction]:
    """Return the point with z = 0 where it has two coordinates."""
    return point[0], point[1], point[2] if len(point) > len("xy") else Fraction(0)


def even(curves: Sequence[Curve]) -> Chain:
    """Return the chain in which every curve has an equal share of the parameter."""
    return Chain(tuple(curves), tuple(Fraction(i, len(curves)) for i in range(len(curves) + 1)))


def _joined(chains: Sequence[Chain]) -> Chain:
    """Return one chain of several, an equal share for each."""
    share = Fraction(1, len(chains))
    breaks = [share * (i + b) for i, link in enumerate(chains) for b in link.breaks[:-1]]
    return Chain(tuple(curve for link in chains for curve in link.curves), (*breaks, Fraction(1)))


def circle(spec: CircleSpec) -> Circular:
    """Return a circle or an arc: counter-clockwise about the normal, from the x axis of DXF's arbitrary-axis rule."""
    x, y = plane_axes(floats(spec.normal))
    radius = float(spec.radius)
    start, end = (spec.start, spec.end) if isinstance(spec, ArcSpec) else (0, 360)
    centre = floats(in_space(spec.center))
    return Circular(centre, radius * x, radius * y, np.zeros(3), radians(start), radians(float(end) - float(start)))


def plane_axes(normal: Vector3) -> tuple[Vector3, Vector3]:
    """Return the x and y axes of the plane across `normal` by DXF's arbitrary-axis rule.

    Source: Autodesk DXF reference, "Arbitrary Axis Algorithm".
    """
    n = unit(normal)
    steep = abs(n[0]) < NEAR_Z and abs(n[1]) < NEAR_Z
    x = unit(np.cross(np.array([0.0, 1.0, 0.0]) if steep else np.array([0.0, 0.0, 1.0]), n))
    return x, np.cross(n, x)


NEAR_Z = 1.0 / 64.0
"""Where the arbitrary-axis rule changes from the z axis to the y axis of the world; part of the DXF format."""


def ellipse(spec: EllipseSpec) -> Circular:
    """Return a full ellipse from center + major towards minor."""
    centre, major, minor = (floats(in_space(point)) for point in (spec.center, spec.major, spec.minor))
    return Circular(centre, major, minor, np.zeros(3), 0.0, 2.0 * pi)


def helix(spec: HelixSpec) -> Circular:
    """Return a helix about z."""
    radius = float(spec.radius)
    u, v = np.array([radius, 0.0, 0.0]), np.array([0.0, radius, 0.0])
    rise = np.array([0.0, 0.0, float(spec.pitch) / (2.0 * pi)])
    return Circular(np.zeros(3), u, v, rise, 0.0, 2.0 * pi * float(spec.turns))


def bspline(spec: BSplineSpec) -> Chain:
    """Return the Bezier pieces of a B-spline between its knots, exact."""
    weights = spec.weights
    rows = [list(in_space(point)) for point in spec.points]
    if weights is not None:
        rows = [[w * x for x in row] + [Fraction(w)] for row, w in zip(rows, weights, strict=True)]
    knots, n = [Fraction(k) for k in spec.knots], spec.degree
    inner = sorted(set(knots[n : len(knots) - n]))
    pieces = [
        [_blossom(rows, knots, n, [low] * (n - i) + [high] * i, low) for i in range(n + 1)]
        for low, high in pairwise(inner)
    ]
    span = inner[-1] - inner[0]
    breaks = tuple((knot - inner[0]) / span for knot in inner)
    return Chain(tuple(bezier(rows) if weights is None else rational(rows) for rows in pieces), breaks)


def _blossom(rows: list[list[Fraction]], knots: Row, n: int, arguments: Row, low: Fraction) -> list[Fraction]:
    """Return the blossom of the B-spline piece that begins at the knot `low` (de Boor with unlike arguments)."""
    last = max(i for i, knot in enumerate(knots) if knot <= low and i < len(rows))
    active = rows[last - n : last + 1]
    for level, t in enumerate(arguments, start=1):
        following = []
        for i in range(n - level + 1):
            a, b = knots[last - n + level + i], knots[last + 1 + i]
            share = (t - a) / (b - a)
            following.append([(1 - share) * x + share * y for x, y in zip(active[i], active[i + 1], strict=True)])
        active = following
    return active[0]


def interpolated(points: np.ndarray) -> Chain:
    """Return the cubic spline through points, shape (n, 3): C2, chord-length parameter, not-a-knot or periodic."""
    chords = np.concatenate([[0.0], np.cumsum(norm(np.diff(points, axis=0)))])
    return spline(points, chords, closed=bool(np.array_equal(points[0], points[-1])))


def spline(points: np.ndarray, parameters: np.ndarray, *, closed: bool) -> Chain:
    """Return the C2 cubic spline through points, shape (n, 3), at given parameters: periodic if closed, else
    not-a-knot."""
    from scipy.interpolate import CubicSpline

    slopes = CubicSpline(parameters, points, bc_type="periodic" if closed else "not-a-knot")(parameters, 1)
    curves = []
    for i, step in enumerate(np.diff(parameters)):
        a, b = points[i], points[i + 1]
        rows = (a, a + step / 3.0 * slopes[i], b - step / 3.0 * slopes[i + 1], b)
        curves.append(bezier([exactly(row) for row in rows]))
    return Chain(tuple(curves), tuple(Fraction(float(c)) / Fraction(float(parameters[-1])) for c in parameters))


def ends(curve: Curve) -> tuple[Vector3, Vector3]:
    """Return the first and the last point, mm."""
    first, last = curve.jet(np.array([0.0, 1.0]), 0)[0]
    return first, last


def largest_gap(link: Chain) -> float:
    """Return the largest distance between the end of a curve and the beginning of the next, mm."""
    gaps = [float(norm(ends(b)[0] - ends(a)[1])) for a, b in pairwise(link.curves)]
    return max(gaps, default=0.0)


def ruled_patches(c0: Chain, c1: Chain) -> tuple[RuledPatch, ...]:
    """Return patches between two chains, equal parameter to equal parameter, split at the breaks of both."""
    return tuple(between(a, b) for a, b in common_pieces(c0, c1))


def common_pieces(a: Chain, b: Chain) -> list[tuple[Curve, Curve]]:
    """Return both chains, split at the breaks of either."""
    breaks = sorted({*a.breaks, *b.breaks})
    return [(_over(a, low, high), _over(b, low, high)) for low, high in pairwise(breaks)]


def _over(link: Chain, low: Fraction, high: Fraction) -> Curve:
    """Return the part of a chain over an interval that contains none of its breaks."""
    index = max(i for i, b in enumerate(link.breaks[:-1]) if b <= low)
    start, end = link.breaks[index], link.breaks[index + 1]
    return restrict(link.curves[index], (low - start) / (end - start), (high - start) / (end - start))
