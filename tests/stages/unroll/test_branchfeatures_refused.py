"""Features that a branched blank cannot take: refused with the place, or with the way out."""

from fractions import Fraction
from math import cos, pi, sin

import numpy as np
import pytest

from stages.construct.faces.surface import face_surface
from stages.geometry.arrays import Array, norm
from stages.model.curves import CurveSpec
from stages.model.features import CircleHole, CurveHole, CurveMark, DrilledHole, NotchSpec, PointMark
from stages.model.material import Part
from stages.model.scalars import Number, coordinate
from tests.stages.unroll.test_branchfeatures import (
    BEND,
    DEEP,
    TOL,
    folded,
    mm,
    polyline,
    refused,
    shell,
    space,
    spec_of,
    unrolled,
)


def square_edge(number: int) -> Array:
    """Return the ends of an edge between a triangle and a cone of the transition."""
    i, which = divmod(number, 2)
    angle = (i + 1) * pi / 2.0
    top = np.array([30.0 * cos(angle), 30.0 * sin(angle), 80.0])
    corners = 50.0 * np.array([(1, 1, 0), (-1, 1, 0), (-1, -1, 0), (1, -1, 0)])
    return np.array([corners[(i + which) % 4], top])


def across(number: int) -> CurveMark:
    """Return a line across an edge of the transition, 5 mm to either side in the plane of its triangle."""
    a, top = square_edge(number)
    other = square_edge(number + 1 if number % 2 == 0 else number - 1)[0]
    way = np.cross(np.cross(other - a, top - a), top - a)
    way *= 5.0 / norm(way)
    middle = (a + top) / 2.0
    return CurveMark(name=f"line-{number}", curve=polyline([middle - way, middle + way]))


def test_a_line_across_a_joined_edge_is_drawn_and_one_across_the_cut_is_refused() -> None:
    (remark,) = shell("square").remarks
    middles = ["({:.6g}, {:.6g}, {:.6g})".format(*square_edge(n).mean(axis=0).round(9) + 0.0) for n in range(8)]
    (cut,) = [n for n, middle in enumerate(middles) if middle in remark.message]
    lines = [across(n) for n in (cut, (cut + 1) % 8, (cut + 4) % 8)]
    made = unrolled("square", *lines)
    assert made.product is None
    (finding,) = [one for one in made.report.findings if one.fatal]
    assert (finding.code, finding.where) == ("feature-cut", {"feature": f"line-{cut}"})


def test_u_and_v_are_refused_with_the_way_out() -> None:
    flat = (coordinate(Fraction(0), Fraction(0)), coordinate(Fraction(0), Fraction(0)))
    code, message = refused(CircleHole(name="bolt", at=flat, diameter=mm(5.0)))
    assert code == "feature-on-branches"
    assert message.startswith("bolt: ")
    assert "at = [x, y, z]" in message
    line = CurveSpec(line=(flat, (coordinate(Fraction(1), Fraction(1)), flat[1])))
    assert refused(CurveMark(curve=line))[0] == "feature-on-branches"


def test_a_place_as_near_to_two_flanges_is_refused() -> None:
    code, message = refused(PointMark(at=space(60.0, DEEP / 2.0, 60.0)))
    assert code == "ambiguous-place"
    assert "(60, -4, 29)" in message


def test_a_place_in_a_hole_of_the_drawing_is_refused() -> None:
    code, message = refused(PointMark(at=space(40.0, 40.0, 0.0)))
    assert code == "place-outside"
    assert "mm beyond its edges" in message


def test_a_curve_that_jumps_from_face_to_face_is_refused() -> None:
    code, message = refused(CurveMark(curve=polyline([(50, 10, 0), (50, -4, 14)])))
    assert code == "open-contour"
    assert "do not meet on the faces" in message


def test_an_open_curve_is_no_hole() -> None:
    code, message = refused(CurveHole(curve=polyline([(50.0, 10.0, 0.0), (70.0, 10.0, 0.0), (70.0, 20.0, 0.0)])))
    assert code == "open-contour"
    assert "does not close" in message


def test_a_curve_over_a_hole_of_the_drawing_is_refused() -> None:
    line = CurveMark(curve=polyline([(20.0, 40.0, 0.0), (60.0, 40.0, 0.0)]))
    assert refused(line)[0] == "place-outside"


def test_an_edge_of_a_strip_is_none_of_a_branched_blank() -> None:
    code, message = refused(NotchSpec(edge="c0", at=Number(0)))
    assert code == "no-such-edge"
    assert 'edge = "outline"' in message


def test_construct_refuses_a_part_with_a_feature_that_has_no_place() -> None:
    spec = spec_of("tray", PointMark(name="lost", at=space(40.0, 40.0, 0.0)))
    made = face_surface(Part(spec, body=shell("tray").body), TOL)
    assert made.product is None
    assert [(one.code, one.fatal) for one in made.report.findings] == [("place-outside", True)]


@pytest.mark.parametrize(("name", "at"), [("tray", folded(60.0, BEND + 4.0)), ("window", (60.0, 27.0, 0.0))])
def test_a_drilled_hole_that_reaches_over_a_bend_is_refused(name: str, at: tuple[float, float, float]) -> None:
    """On the flange of the tray the face ends there, on the plate with the window only what its edges enclose."""
    made = unrolled(name, DrilledHole(name="bolt", at=space(*at), diameter=mm(10.0)))
    assert made.product is None
    (finding,) = [one for one in made.report.findings if one.fatal]
    assert (finding.code, finding.where) == ("hole-outside", {"feature": "bolt"})
    assert 'kind = "circle"' in finding.message
