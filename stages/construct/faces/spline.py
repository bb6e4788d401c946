"""B-spline curves given in doubles -> exact Bezier pieces."""

from collections.abc import Sequence
from fractions import Fraction

from stages.construct.curves import bspline
from stages.geometry.arrays import Array
from stages.geometry.curves.curves import Curve, bezier, exactly
from stages.model.curves import BSplineSpec
from stages.model.scalars import Number, coordinate


def pieces(degree: int, knots: Array, points: Array, weights: Sequence[float] | None) -> tuple[Curve, ...]:
    """Return the Bezier pieces of a B-spline between its knots; doubles are taken as the fractions they are.

    knots: in full.  points: shape (n, 3), mm.  Equal weights make a polynomial curve.
    """
    if weights is not None and len(set(weights)) == 1:
        weights = None
    spec = BSplineSpec(
        degree=degree,
        knots=tuple(Number(float(knot)) for knot in knots),
        points=tuple(tuple(coordinate(Fraction(float(x)), None) for x in point) for point in points),
        weights=None if weights is None else tuple(Number(float(weight)) for weight in weights),
    )
    for trouble in spec.troubles():
        raise ValueError(f"a B-spline: {trouble.message}")
    return bspline(spec).curves


def straight(start: Array, end: Array) -> Curve:
    """Return the line from one point to another."""
    return bezier([exactly(start), exactly(end)])
