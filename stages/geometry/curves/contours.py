"""Area, centroid and length of closed contours of exact edges, by quadrature.

Two ways that share no number, so that either can be held against the other: from positions and the edges' own
derivatives (`area`, `length`), and from positions alone, lines and arcs in closed form (`from_positions`).
"""

from collections.abc import Sequence

import numpy as np

from stages.geometry.arrays import Array, Values, Vector2, cross2, norm
from stages.geometry.curves.plane import CircularArc, PlaneCurve, Segment
from stages.geometry.numeric import quadrature
from stages.geometry.numeric.differentiation import matrix
from stages.geometry.numeric.quadrature import NODES, WEIGHTS, integral

SLOPES = matrix(NODES)
"""From values at the nodes of a panel to their derivatives, shape (16, 16)."""


def area(edges: Sequence[PlaneCurve]) -> float:
    """Return the signed area inside, mm2, positive counter-clockwise (Green's theorem); some 1e-14 of the scale.

    About the first point, so that an outline far from the origin loses no digits.
    """
    origin = edges[0].at(np.array([0.0]))[0]
    far, wide = _extent(edges)
    return sum((_green(edge, origin, far * wide) for edge in edges), 0.0)


def area_and_centroid(edges: Sequence[PlaneCurve]) -> tuple[float, float, float]:
    """Return the signed area inside, mm2, and x and y of its centroid, mm; the first point where the area is 0."""
    origin = edges[0].at(np.array([0.0]))[0]
    far, wide = _extent(edges)
    area_, *moments = sum((_moments(edge, origin, wide, far * wide) for edge in edges), np.zeros(3))
    x, y = origin + np.array(moments) / area_ if area_ != 0.0 else origin
    return float(area_), float(x), float(y)


def _moments(edge: PlaneCurve, origin: Vector2, wide: float, scale: float) -> Array:
    """Return what an edge adds to the area and to its first moments about the origin, mm2 and mm3.

    The triangle between the origin and a step of the edge has its centroid at 2/3 of the way to the edge.
    """

    def sample(t: Values) -> Array:
        arm = edge.at(t) - origin
        swept = cross2(arm, edge.derivative(t)) / 2.0
        # the moments are resolved as areas: one scale serves all channels
        return np.stack([swept, *(2.0 / 3.0 * swept * arm.T / wide), np.full_like(t, scale)], axis=1)

    area_, x, y, _ = integral(sample, "centroid of a contour")
    return np.array([area_, x * wide, y * wide])


def length(edges: Sequence[PlaneCurve]) -> float:
    """Return the length, mm; some 1e-14 of the scale."""
    _, wide = _extent(edges)
    return sum((_arc_length(edge, wide) for edge in edges), 0.0)


def from_positions(edges: Sequence[PlaneCurve]) -> tuple[float, float]:
    """Return the length, mm, and the signed area inside, mm2, without the edges' derivatives; some 1e-13 of the scale.

    Raises NoSolutionError where the positions along an edge do not resolve.
    """
    about = edges[0].at(np.array([0.0]))[0]
    far, _ = _extent(edges)
    total = sum((_of_positions(edge, about, far) for edge in edges), np.zeros(2))
    return float(total[0]), float(total[1])


def _of_positions(edge: PlaneCurve, about: Vector2, far: float) -> Array:
    """Return the length of an edge, mm, and the area that it sweeps about a point, mm2."""
    if isinstance(edge, Segment):
        return np.array([norm(edge.end - edge.start), cross2(edge.start - about, edge.end - about) / 2.0])
    start, end = edge.at(np.array([0.0, 1.0]))
    if isinstance(edge, CircularArc):
        sector = edge.radius**2 * edge.sweep_rad
        return np.array([edge.radius * abs(edge.sweep_rad), (sector + cross2(edge.centre - about, end - start)) / 2.0])

    def sample(t: Values) -> Array:
        return np.column_stack([edge.at(t) - start, np.full_like(t, far * COARSE)])

    breaks, _ = quadrature.panels(sample, "points of a contour")
    points = edge.at(quadrature.nodes(breaks[:-1], breaks[1:]).ravel()).reshape(breaks.size - 1, -1, 2)
    return np.array(swept(points, about))


COARSE = 1.0 / 16.0
"""Of the distance from the origin, the least scale of an edge: its rounding stays below that of a panel."""


def swept(points: Array, about: Vector2) -> tuple[float, float]:
    """Return the length, mm, and the area swept about a point, mm2, of points at the nodes of panels, (m, 16, 2)."""
    slopes = np.einsum("ij,pjc->pic", SLOPES, points - points[:, :1])
    rates = cross2(points - about, slopes) / 2.0
    return float((norm(slopes) @ WEIGHTS).sum()), float((rates @ WEIGHTS).sum())


def _extent(edges: Sequence[PlaneCurve]) -> tuple[float, float]:
    """Return how far the contour reaches from the origin and from its first point, mm: what its rounding scales with.

    An edge of no length (an apex), or one that points at the first point, has no scale of its own.
    """
    points = np.concatenate([edge.at(np.array([0.0, 0.5, 1.0])) for edge in edges])
    return float(norm(points).max()), float(norm(points - points[0]).max())


def _green(edge: PlaneCurve, origin: Vector2, scale: float) -> float:
    """Return half the integral of x dy - y dx along an edge, mm2."""

    def sample(t: Values) -> Array:
        swept = cross2(edge.at(t) - origin, edge.derivative(t)) / 2.0
        return np.stack([swept, np.full_like(t, scale)], axis=1)

    return float(integral(sample, "area of a contour")[0])


def _arc_length(edge: PlaneCurve, scale: float) -> float:
    def sample(t: Values) -> Array:
        return np.stack([norm(edge.derivative(t)), np.full_like(t, scale)], axis=1)

    return float(integral(sample, "length of a contour")[0])
