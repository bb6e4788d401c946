"""Grown parts contain what they stand for; the angles in which a part fits are found."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from shapely import Polygon, contains_properly

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, polygon, transform
from stages.model.sheet import NestOptions, Sheet
from stages.nest.beds import bed
from stages.nest.blank import as_blank, fits, turned
from stages.nest.fit import fitting_angles, hull, kind, tight_angle
from tests.stages.nest.shapes import angle_piece, disc, rectangle, ring, sector

SHAPES = [angle_piece("l", 80.0, 20.0), disc("d", 30.0), ring("r", 40.0, 25.0), sector("s", 50.0, 90.0, 140.0)]


@given(st.sampled_from(SHAPES), st.floats(0.0, 360.0), st.floats(0.5, 20.0))
@settings(max_examples=60, deadline=None)
def test_a_grown_part_contains_the_part_grown_by_half_the_gap(shape, angle: float, gap: float) -> None:
    one = turned(as_blank(0, shape, NestOptions(gap_mm=gap)), angle)
    outer = transform(shape.outer.path, Rigid2(one.dx, one.dy, angle))
    fine = Polygon(polygon(outer, accuracy=1e-3)).buffer(gap / 2.0 - 1e-3, quad_segs=32)
    assert contains_properly(Polygon(one.shape.exterior), fine)
    low_x, low_y, high_x, high_y = fine.bounds
    assert (low_x, low_y) == (pytest.approx(0.0, abs=1e-2), pytest.approx(0.0, abs=1e-2))
    assert one.width_mm == pytest.approx(high_x, abs=1e-2)
    assert one.height_mm == pytest.approx(high_y, abs=1e-2)


def test_a_hole_shrinks_when_its_part_grows() -> None:
    one = as_blank(0, ring("r", 40.0, 25.0), NestOptions(gap_mm=6.0))
    (hole,) = one.shape.interiors
    assert np.hypot(*np.array(hole.coords).T).max() == pytest.approx(22.0, abs=0.1)


def test_boxes_stay_exact_boxes() -> None:
    one = turned(as_blank(0, rectangle("a", 100.0, 50.0), NestOptions(gap_mm=5.0)), 90.0)
    assert one.width_mm == pytest.approx(55.0, abs=1e-8)
    assert one.height_mm == pytest.approx(105.0, abs=1e-8)
    assert one.shape.area == pytest.approx(55.0 * 105.0, rel=1e-9)


def test_an_upright_box_is_not_turned() -> None:
    assert tight_angle(hull(as_blank(0, rectangle("a", 100.0, 50.0), NestOptions()))) == 0.0


@given(st.floats(0.0, 180.0))
@settings(max_examples=40, deadline=None)
def test_a_turned_box_is_turned_back(angle: float) -> None:
    base = rectangle("a", 100.0, 30.0)
    moved = base.replace(outer=type(base.outer)((), transform(base.outer.path, Rigid2(angle_deg=angle)), 0.0))
    blank = as_blank(0, moved, NestOptions())
    one = turned(blank, tight_angle(hull(blank)))
    assert one.width_mm * one.height_mm == pytest.approx(3000.0, rel=1e-6)


def bar_sheet(width: float, height: float):
    return bed(0, Sheet("s", width, height), NestOptions())


def test_a_bar_that_fits_along_the_diagonal_only_is_laid_there() -> None:
    blank = as_blank(0, rectangle("bar", 110.0, 4.0), NestOptions())
    square = bar_sheet(90.0, 90.0)
    angles = fitting_angles(blank, square)
    assert angles
    assert all(fits(turned(blank, angle), square) for angle in angles)
    assert kind([blank], [square], NestOptions()).on(square)


@given(st.floats(20.0, 200.0), st.floats(2.0, 80.0), st.floats(30.0, 150.0), st.floats(30.0, 150.0))
@example(116.0, 6.75, 114.0, 40.0)  # both bounds of the angles that fit were refused by rounding
@settings(max_examples=60, deadline=None)
def test_no_angle_is_missed_that_dense_trying_finds(length: float, thick: float, width: float, height: float) -> None:
    blank = as_blank(0, rectangle("bar", length, thick), NestOptions())
    turn = np.radians(np.linspace(0.0, 180.0, 721))
    wide = length * np.abs(np.cos(turn)) + thick * np.abs(np.sin(turn))
    high = length * np.abs(np.sin(turn)) + thick * np.abs(np.cos(turn))
    found = bool(((wide <= width) & (high <= height)).any())
    if found:
        assert fitting_angles(blank, bar_sheet(width, height))
    else:
        angles = fitting_angles(blank, bar_sheet(width - 1.0, height - 1.0))
        assert not angles, "it fits a smaller sheet in an angle between those tried"


def test_the_polygon_of_many_arcs_is_kept_short() -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 401)[:-1]
    points = np.stack([300.0 * np.cos(angle), 200.0 * np.sin(angle)], axis=1)
    shape = disc("d", 1.0)
    oval = shape.replace(outer=type(shape.outer)((), ArcPath(points, np.zeros(400), closed=True), 0.0))
    grown = as_blank(0, oval, NestOptions(gap_mm=2.0)).shape
    assert len(grown.exterior.coords) < 150
    assert contains_properly(grown, Polygon(points).buffer(1.0))
