"""Notches of every kind in closed form: what they take of the outline, what they draw, and how they are refused."""

from math import pi

import numpy as np
import pytest

from stages.geometry.curves import contours
from stages.geometry.curves.plane import CircularArc, Segment
from stages.geometry.paths import arcpath
from stages.model.pattern import FlatPattern
from tests.near import assert_near, assert_relative
from tests.parts import Passage, Table, passage, read
from tests.stages.unroll.test_features import PLATE

ROUND: Table = {"kind": "flat", "outline": {"circle": {"center": [0, 0], "radius": 30}}}
WIDE, DEEP = 4.0, 6.0


def passed(*notches: Table, surface: Table = PLATE) -> Passage:
    return passage(surface, notch=[{"edge": "outline", "width": 4, "depth": 6} | one for one in notches])


def made(*notches: Table, surface: Table = PLATE) -> FlatPattern:
    found = passed(*notches, surface=surface).pattern
    assert found is not None
    return found


BARE = contours.area(made().outer.edges)
TAKEN = {"v": WIDE * DEEP / 2.0, "castle": WIDE * DEEP, "u": WIDE * (DEEP - WIDE / 2.0) + pi * WIDE**2 / 8.0}
"""Triangle, rectangle, rectangle with half a circle at its end, mm2."""


@pytest.mark.parametrize("kind", TAKEN)
def test_a_notch_that_is_cut_takes_its_area_from_the_outline(kind: str) -> None:
    found = made({"kind": kind, "distance": 20})
    assert_near([contours.area(found.outer.edges)], [BARE - TAKEN[kind]], bound=1e-9, why="closed form")
    assert_near([arcpath.area(found.outer.path)], [BARE - TAKEN[kind]], bound=1e-9, why="lines and arcs as they are")
    assert found.boundary is not None and contours.area(found.boundary.edges) == BARE
    (place,) = found.notches
    assert (place.kind, place.in_outline, place.depth_mm, place.width_mm) == (kind, True, DEEP, WIDE)


@pytest.mark.parametrize("kind", TAKEN)
def test_one_that_is_not_cut_is_drawn_with_the_same_shape(kind: str) -> None:
    found = made({"kind": kind, "distance": 20, "cut": False})
    (mark,) = found.marks
    assert mark.layer == "MARK" and not mark.path.closed
    closed = arcpath.ArcPath(mark.path.vertices, mark.path.bulges, closed=True)
    assert_near([abs(arcpath.area(closed))], [TAKEN[kind]], bound=1e-9, why="closed by the edge it opens in")
    assert contours.area(found.outer.edges) == BARE
    assert found.notches[0].in_outline is False


@pytest.mark.parametrize(("cut", "layer"), [(None, "MARK"), (False, "MARK"), (True, "CUT_SLIT")])
def test_slits_and_bars_are_marked_or_cut_as_asked(cut: bool | None, layer: str) -> None:
    found = made({"kind": "t", "distance": 20, "cut": cut}, {"kind": "slit", "distance": 35, "cut": cut})
    assert [mark.layer for mark in found.marks] == [layer] * 3
    stem, bar, slit = (arcpath.length(mark.path) for mark in found.marks)
    assert_near([stem, bar, slit], [DEEP, WIDE, DEEP], bound=1e-12, why="as deep and as wide as asked")
    stem_end, ends = found.marks[0].path.vertices[1], found.marks[1].path.vertices
    assert_near(ends.mean(axis=0), stem_end, bound=1e-12, why="the bar lies across the end")
    assert contours.area(found.outer.edges) == BARE


def test_a_u_on_a_round_edge_ends_in_a_half_circle_between_straight_walls() -> None:
    found = made({"kind": "u", "distance": 40}, surface=ROUND)
    sides = [edge for edge in found.outer.edges if contours.length([edge]) < 20.0]
    first, half, last = sides
    assert isinstance(first, Segment) and isinstance(half, CircularArc) and isinstance(last, Segment)
    chord = 60.0 * np.sin(WIDE / 60.0)
    assert_relative([2.0 * half.radius], [chord], bound=1e-12, why="the chord of 4 mm of a circle of radius 30")
    assert_near([half.sweep_rad], [-pi], bound=0.0, why="half a turn into the part")
    low = min(np.hypot(*edge.at(np.array([0.5]))[0]) for edge in sides)
    want = np.sqrt(900.0 - chord**2 / 4.0) - DEEP
    assert_near([low], [want], bound=1e-9, why="as deep as asked, from the chord that it opens in")


def test_a_u_as_deep_as_half_its_width_is_a_half_circle() -> None:
    found = made({"kind": "u", "distance": 20, "depth": 2})
    assert_near([BARE - contours.area(found.outer.edges)], [pi * WIDE**2 / 8.0], bound=1e-9, why="closed form")
    assert sum(isinstance(edge, CircularArc) for edge in found.outer.edges) == 1


@pytest.mark.parametrize(
    ("notches", "code"),
    [
        ([{"kind": "castle", "distance": 1, "width": 2000}], "notch-off-edge"),
        ([{"kind": "u", "distance": 20}, {"kind": "castle", "distance": 23}], "notches-overlap"),
        ([{"kind": "castle", "distance": 20, "depth": 500}], "contour-crosses-itself"),
    ],
)
def test_notches_that_cannot_be_cut_are_refused(notches: list[Table], code: str) -> None:
    found = passed(*notches)
    assert found.refused_by == "unroll"
    assert found.codes("unroll", fatal=True) == [code]


def test_a_u_that_is_wider_than_deep_is_a_mistake_of_the_job() -> None:
    (notch,) = read(PLATE, notch=[{"edge": "outline", "distance": 20, "kind": "u", "width": 4, "depth": 1.9}]).notch
    assert [trouble.key for trouble in notch.troubles()] == ["depth"]


def test_notches_stand_in_the_pattern_with_their_place_and_direction() -> None:
    (place,) = made({"kind": "slit", "distance": 20}).notches
    assert_near(np.hypot(*place.inward), 1.0, bound=1e-12, why="a unit vector")
    (mark,) = made({"kind": "slit", "distance": 20}).marks
    assert_near(place.at + DEEP * place.inward, mark.path.vertices[1], bound=1e-12, why="where the slit ends")
