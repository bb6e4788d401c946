"""Developable kinds that follow from one curve: Aumann's pair of Bezier curves, tangent surfaces, constant slope.

The names of the fields are those of the job file, but for `lambda_` and `from_`, which Python keeps to itself.
"""

from collections.abc import Iterator
from typing import Annotated, Literal

from msgspec import Meta, field

from stages.model.curves import CurveSpec, Table, Trouble, not_positive, plane_curves
from stages.model.scalars import RIGHT_ANGLE, Angle, Direction, Length, Number, Point, is_zero


class BezierPair(Table, frozen=True, kw_only=True, tag_field="kind", tag="bezier-pair"):
    """Aumann's developable: a Bezier curve c, the first point d0 of the other, and two numbers.

    d_{i+1} = ((1 - lambda) c_i + lambda c_{i+1} - (1 - mu) d_i) / mu.  The rulings touch the edge of regression at the
    share (mu - v) / (mu - lambda) of the way from c to d.
    elevate: by so much the degree of c is raised first: the same c, another d.
    """

    points: Annotated[tuple[Point, ...], Meta(min_length=2, max_length=16)]
    first: Point
    lambda_: Number = field(name="lambda")
    mu: Number
    elevate: Annotated[int, Meta(ge=0, le=15)] = 0

    def troubles(self) -> Iterator[Trouble]:
        """Yield points that all coincide, mu = 0, and rulings without length."""
        if len(set(self.points)) == 1:
            yield Trouble("points", "all control points coincide", "give at least two different points")
        if self.mu == 0:
            yield Trouble("mu", "0: the recursion divides by it", "at least 1, or below 0")
        if self.first == self.points[0] and self.lambda_ == self.mu:
            yield Trouble("first", "the point is points[0]: no ruling has a length", "give a point beside the curve")


class Tangent(Table, frozen=True, kw_only=True, tag_field="kind", tag="tangent"):
    """The tangents of a space curve, its edge of regression, between two distances along them."""

    edge: CurveSpec
    from_: Length = field(name="from")
    to: Length

    def troubles(self) -> Iterator[Trouble]:
        """Yield a curve without curvature, and distances that are equal or on both sides of the edge."""
        yield from plane_curves(self, "edge")
        if self.edge.line is not None:
            yield Trouble("edge", "a straight line is its own only tangent", "give a curve that bends")
        if self.edge.polyline is not None:
            yield Trouble("edge", "straight lines are their own only tangents", "give a curve that bends")
        if self.from_ == self.to:
            yield Trouble("to", "the same distance as from", "the two must differ")
        if self.from_ * self.to < 0:
            yield Trouble("to", "the edge of regression lies between from and to", "both at least 0, or both at most 0")


class Slope(Table, frozen=True, kw_only=True, tag_field="kind", tag="slope"):
    """A surface of constant slope: from a planar curve, at one angle to its plane.

    A corner of the curve that opens adds a piece, a cone about it.
    angle: between rulings and plane; above 0 they fall away from the plane's normal, at 90 they are perpendicular.
    side: to which side of the curve they run: out is right of travel, seen against the normal.
    length: of the rulings.
    normal: of the plane; else that of the circle or arc, or the one upwards (z, or y, or x above 0).
    """

    curve: CurveSpec
    angle: Angle
    side: Literal["in", "out"]
    length: Length
    normal: Direction | None = None

    def troubles(self) -> Iterator[Trouble]:
        """Yield a length that is not positive, an angle over the vertical, a normal of length 0."""
        yield from plane_curves(self, "curve")
        yield from not_positive(self, "length")
        if abs(self.angle) > RIGHT_ANGLE:
            yield Trouble("angle", f"{float(self.angle):g} deg", "from -90 to 90 deg; the other side is `side`")
        if self.normal is not None and is_zero(self.normal):
            yield Trouble("normal", "the vector has length 0", "give the direction across the plane")
