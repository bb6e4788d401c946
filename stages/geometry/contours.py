"""Area and length of closed contours of exact edges, by quadrature."""

from collections.abc import Sequence

from stages.geometry.arrays import cross2, norm
from stages.geometry.plane import PlaneCurve
from stages.geometry.quadrature import integral


def area(edges: Sequence[PlaneCurve]) -> float:
    """Return the signed area inside, mm2, positive counter-clockwise (Green's theorem); some 1e-14 of the scale."""
    return sum((_green(edge) for edge in edges), 0.0)


def length(edges: Sequence[PlaneCurve]) -> float:
    """Return the length, mm; some 1e-14 of the scale."""
    return sum((_arc_length(edge) for edge in edges), 0.0)


def _green(edge: PlaneCurve) -> float:
    """Return half the integral of x dy - y dx along an edge, mm2."""
    total = integral(lambda t: 0.5 * cross2(edge.at(t), edge.derivative(t))[:, None], "area of a contour")
    return float(total[0])


def _arc_length(edge: PlaneCurve) -> float:
    total = integral(lambda t: norm(edge.derivative(t))[:, None], "length of a contour")
    return float(total[0])
