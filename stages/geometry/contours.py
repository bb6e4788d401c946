"""Area and length of closed contours of exact edges, by quadrature."""

from collections.abc import Sequence

import numpy as np

from stages.geometry.arrays import Array, Values, Vector2, norm
from stages.geometry.plane import PlaneCurve
from stages.geometry.quadrature import integral


def area(edges: Sequence[PlaneCurve]) -> float:
    """Return the signed area inside, mm2, positive counter-clockwise (Green's theorem); some 1e-14 of the scale.

    About the first point, so that an outline far from the origin loses no digits.
    """
    origin = edges[0].at(np.array([0.0]))[0]
    return sum((_green(edge, origin) for edge in edges), 0.0)


def length(edges: Sequence[PlaneCurve]) -> float:
    """Return the length, mm; some 1e-14 of the scale."""
    return sum((_arc_length(edge) for edge in edges), 0.0)


def _green(edge: PlaneCurve, origin: Vector2) -> float:
    """Return half the integral of x dy - y dx along an edge, mm2.

    x dy and y dx apart: their difference has no scale of its own on an edge that points at the origin.  The third
    channel says how large the coordinates are that were rounded.
    """
    far = float(norm(origin))

    def sample(t: Values) -> Array:
        arm, slope = edge.at(t) - origin, edge.derivative(t)
        rounded = np.full_like(t, far * float(norm(slope).max()))
        return np.stack([arm[:, 0] * slope[:, 1], arm[:, 1] * slope[:, 0], rounded], axis=1)

    forth, back, _ = integral(sample, "area of a contour")
    return float(forth - back) / 2.0


def _arc_length(edge: PlaneCurve) -> float:
    total = integral(lambda t: norm(edge.derivative(t))[:, None], "length of a contour")
    return float(total[0])
