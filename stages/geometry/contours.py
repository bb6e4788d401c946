"""Area, centroid and length of closed contours of exact edges, by quadrature."""

from collections.abc import Sequence

import numpy as np

from stages.geometry.arrays import Array, Values, Vector2, cross2, norm
from stages.geometry.plane import PlaneCurve
from stages.geometry.quadrature import integral


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
