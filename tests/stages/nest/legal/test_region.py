"""Whether exact regions overlap: touching ones do not, whatever goes deeper does; polygons as the second method."""

from math import cos, pi, radians, sin, sqrt

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, transform
from stages.geometry.paths.clearance import clearance
from stages.nest.legal.region import GAP_TOLERANCE_MM, Region, overlap_mm2, region, within
from tests.stages.nest.shapes import box, circle, contour

UNDER, OVER = 0.5 * GAP_TOLERANCE_MM, 2.0 * GAP_TOLERANCE_MM


def disc(x: float, y: float, radius: float) -> Region:
    return region(at(circle(radius).path, x, y))


def at(path: ArcPath, x: float, y: float, angle: float = 0.0) -> ArcPath:
    return transform(path, Rigid2(x, y, angle))


def common(a: Region, b: Region) -> float:
    """Return the common area, the same both ways round."""
    gap = min(clearance(a.outline, b.outline, within=1e9), 1e9)
    assert (overlap_mm2(a, b, gap) > 0.0) == (overlap_mm2(b, a, gap) > 0.0)
    return overlap_mm2(a, b, gap)


@pytest.mark.parametrize("turn", [0.0, 0.3, 2.0, 4.5])
def test_discs_that_touch_do_not_overlap_and_those_that_go_deeper_do(turn: float) -> None:
    def beside(deep: float) -> Region:
        return disc(1000.0 + (90.0 - deep) * cos(turn), 500.0 + (90.0 - deep) * sin(turn), 40.0)

    fixed = disc(1000.0, 500.0, 50.0)
    assert common(fixed, beside(0.0)) == common(fixed, beside(UNDER)) == 0.0
    assert common(fixed, beside(OVER)) > 0.0


def test_the_area_of_two_discs_is_the_closed_form_to_the_chord_of_the_polygons() -> None:
    lens = 2.0 * (50.0**2 * np.arccos(40.0 / 50.0) - 40.0 * 30.0)
    assert common(disc(0.0, 0.0, 50.0), disc(80.0, 0.0, 50.0)) == pytest.approx(lens, abs=4 * pi * 50.0 * 1e-3)


@pytest.mark.parametrize("angle", [0.0, 30.0, 77.7])
def test_edges_that_run_along_each_other_touch(angle: float) -> None:
    fixed = region(at(contour(box(200.0, 100.0)).path, 900.0, 900.0, angle))

    def above(by: float) -> Region:
        c, s = cos(radians(angle)), sin(radians(angle))
        return region(at(contour(box(80.0, 50.0)).path, 900.0 - (100.0 + by) * s, 900.0 + (100.0 + by) * c, angle))

    assert common(fixed, above(0.0)) == common(fixed, above(-UNDER)) == 0.0
    assert common(fixed, above(-OVER)) > 0.0


def test_the_same_region_twice_overlaps_wholly() -> None:
    plate = region(contour(box(200.0, 100.0)).path, [at(circle(20.0).path, 50.0, 50.0)])
    assert common(plate, plate) == pytest.approx(20000.0 - pi * 400.0, abs=1.0)
    assert common(disc(7.0, 8.0, 30.0), disc(7.0, 8.0, 30.0)) == pytest.approx(pi * 900.0, abs=1.0)


def test_what_touches_from_within_overlaps() -> None:
    assert common(disc(0.0, 0.0, 50.0), disc(20.0, 0.0, 30.0)) == pytest.approx(pi * 900.0, abs=1.0)
    plate = region(contour(box(200.0, 100.0)).path)
    assert common(plate, region(contour(box(50.0, 50.0)).path)) == pytest.approx(2500.0)


def test_what_fills_a_hole_exactly_does_not_overlap() -> None:
    ring = region(circle(50.0).path, [circle(30.0).path])
    assert common(ring, disc(0.0, 0.0, 30.0)) == 0.0
    assert common(ring, disc(0.0, 0.0, 30.0 + OVER)) > 0.0
    assert common(ring, disc(0.0, 0.0, 49.0)) > 0.0, "covers the hole"


def test_a_ring_that_covers_a_hole_of_a_plate_it_touches_is_found() -> None:
    plate = region(contour(box(400.0, 400.0)).path, [at(circle(90.0).path, 100.0, 200.0)])
    cover = region(at(circle(100.0).path, 100.0, 200.0), [at(circle(10.0).path, 100.0, 200.0)])
    assert common(plate, cover) == pytest.approx(pi * (100.0**2 - 90.0**2), rel=1e-3), "touches the left edge"


def test_the_sense_of_contours_does_not_matter() -> None:
    outer, hole = circle(50.0).path, circle(30.0, hole=True).path
    turned = region(circle(50.0, hole=True).path, [circle(30.0).path])
    for some in (region(outer, [hole]), turned):
        assert common(some, disc(0.0, 0.0, 20.0)) == 0.0
        assert common(some, disc(20.0, 0.0, 20.0)) > 0.0


def test_a_tip_that_reaches_into_an_edge_is_found_by_the_edge() -> None:
    plate = region(contour(box(200.0, 100.0)).path)

    def needle(by: float) -> Region:
        return region(contour([(100.0, 100.0 - by), (101.0, 160.0), (99.0, 160.0)]).path)

    assert common(plate, needle(0.0)) == common(plate, needle(UNDER)) == 0.0
    assert common(plate, needle(OVER)) > 0.0


@given(st.floats(-130.0, 130.0), st.floats(-130.0, 130.0), st.floats(0.0, 360.0))
@example(0.0, 3.533745470554566e-153, 0.0)
@settings(max_examples=60, deadline=None)
def test_a_square_and_a_disc_by_the_distance_of_the_centre(x: float, y: float, angle: float) -> None:
    square = region(at(contour(box(100.0, 100.0, -50.0, -50.0)).path, 0.0, 0.0, angle))
    c, s = cos(radians(-angle)), sin(radians(-angle))
    u, v = abs(x * c - y * s), abs(x * s + y * c)
    away = sqrt(max(u - 50.0, 0.0) ** 2 + max(v - 50.0, 0.0) ** 2)
    if abs(away - 40.0) > OVER:
        assert (common(square, disc(x, y, 40.0)) > 0.0) == (away < 40.0)


def test_within_takes_what_touches_and_nothing_further_out() -> None:
    bed = region(contour(box(100.0, 100.0)).path)
    for size, wanted in ((100.0, True), (100.0 + UNDER, True), (100.0 + OVER, False), (50.0, True)):
        inner = region(contour(box(size, size)).path)
        assert within(inner, bed, clearance(inner.outline, bed.outline, within=0.0)) == wanted, size
    assert not within(region(contour(box(50.0, 50.0, 100.0)).path), bed, 0.0), "beside it, touching"
    assert not within(region(contour(box(50.0, 50.0, 170.0)).path), bed, 70.0), "beside it"


@pytest.mark.parametrize("more", [0.0, 1e-13, UNDER])
@pytest.mark.parametrize("angle", [0.0, 90.0, 30.0])
def test_what_is_as_high_as_the_bed_does_not_slip_out_between_its_corners(more: float, angle: float) -> None:
    """It leaves by 11 mm, and its long sides meet the outline at the corners alone, by rounding just outside."""
    bed = region(at(contour(box(100.0, 100.0)).path, 500.0, 700.0, angle))
    for x, wanted in ((39.0, True), (50.0, False)):
        inner = region(at(contour(box(61.0, 100.0 + 2.0 * more, x, -more)).path, 500.0, 700.0, angle))
        assert within(inner, bed, clearance(inner.outline, bed.outline, within=1.0)) == wanted


@pytest.mark.parametrize("by", [0.0, 1e-13, -1e-13])
def test_a_vertex_that_is_there_twice_but_for_rounding_has_no_say(by: float) -> None:
    """The corner reaches a plate above and the edge of its bed, wherever the edge between the two points goes."""
    wedge = region(contour([(100.0, 0.0), (100.0, 100.0), (100.0 + by, 100.0 + abs(by)), (30.0, 0.0)]).path)
    plate = region(contour(box(200.0, 50.0, 0.0, 100.0)).path)
    assert common(wedge, plate) == 0.0
    bed = region(contour(box(100.0, 100.0)).path)
    assert within(wedge, bed, clearance(wedge.outline, bed.outline, within=1.0))
    assert common(wedge, region(contour(box(200.0, 50.0, 0.0, 100.0 - OVER)).path)) > 0.0
