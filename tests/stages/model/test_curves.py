"""By how many coordinates a curve is given: what is mixed is told, no coordinate is dropped or made up."""

import pytest

from stages.model.curves import CurveSpec, EllipseSpec, PlanePoint, dimensions, is_flat, plane_curves
from stages.model.features import CurveMark, feature_troubles
from stages.model.part import Ruled
from stages.model.scalars import Coordinate, coordinate


def point(*numbers: int) -> PlanePoint:
    return tuple(coordinate(Coordinate(x), Coordinate(x)) for x in numbers)


def ellipse(center: PlanePoint, major: PlanePoint, minor: PlanePoint) -> CurveSpec:
    return CurveSpec(ellipse=EllipseSpec(center=center, major=major, minor=minor))


FLAT = ellipse(point(0, 0), point(3, 0), point(0, 2))
IN_SPACE = ellipse(point(0, 0, 0), point(3, 0, 1), point(0, 2, 0))
MIXED = [
    ellipse(point(0, 0), point(3, 0, 1), point(0, 2)),
    ellipse(point(0, 0, 0), point(3, 0), point(0, 2, 0)),
    ellipse(point(0, 0, 0), point(3, 0, 0), point(0, 2)),
]


def test_an_ellipse_has_the_coordinates_of_its_centre_and_of_both_semi_axes() -> None:
    assert (dimensions(FLAT), dimensions(IN_SPACE)) == ({2}, {3})
    assert (is_flat(FLAT), is_flat(IN_SPACE)) == (True, False)


@pytest.mark.parametrize("curve", MIXED)
def test_a_semi_axis_with_other_coordinates_than_the_centre_is_told(curve: CurveSpec) -> None:
    assert dimensions(curve) == {2, 3}
    (trouble,) = feature_troubles((), (CurveMark(curve=curve),), (), on="plate")
    assert (trouble.key, trouble.message) == ("mark[0].curve", "points of two and of three coordinates")
    assert [one.key for one in plane_curves(Ruled(c0=curve, c1=IN_SPACE), "c0", "c1")] == ["c0"]
