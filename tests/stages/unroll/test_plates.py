"""Plates: figures of both sides by two ways against closed forms, and contours that are not the plate's."""

from dataclasses import replace
from math import cos, pi, radians, sin

import numpy as np
import pytest

from stages.geometry.arrays import Points2, Values
from stages.geometry.curves.plane import CircularArc, PlaneCurve, Segment
from stages.model.surface import Plate
from stages.unroll import outline, plates
from tests.near import assert_near, assert_relative
from tests.parts import Passage, Table, passage

CHORD_MM = 0.05
ROUND: Table = {
    "kind": "flat",
    "outline": {"circle": {"center": [200, 100, 0], "radius": 50, "normal": [0, 0, 1]}},
    "holes": [{"polyline": [[180, 90], [220, 90], [200, 130], [180, 90]]}],
}
CUT = [
    {"kind": "drill", "at": [170, 100], "diameter": 8},
    {"kind": "curve", "curve": {"points": [[200, 70], [205, 75], [200, 80], [195, 75], [200, 70]]}},
]


def area(made: Passage, side: str) -> float:
    return float(str(made.side(side)["area"]))


def plate_of(table: Table) -> Plate:
    made = passage(table).surface
    assert isinstance(made, Plate)
    return made


def test_both_sides_have_the_areas_of_closed_form_without_what_is_cut_out() -> None:
    made = passage(ROUND, hole=CUT[:1])
    exact = 2500.0 * pi - 800.0 - 16.0 * pi
    assert_relative([area(made, side) for side in ("surface", "flat")], [exact] * 2, bound=1e-13, why="closed form")
    for name in ("length_error", "area_error"):
        metric = made.metric("unroll", name)
        assert metric.evidence == "sampled"
        assert_near(float(metric.value or 0.0), 0.0, bound=1e-13, why="two quadratures to rounding")


def test_a_hole_along_a_spline_is_measured_on_both_sides() -> None:
    made = passage(ROUND, hole=CUT)
    assert area(made, "flat") < 2500.0 * pi - 800.0 - 16.0 * pi - 50.0, "the square on the points is 50 mm2"
    assert_relative(area(made, "surface"), area(made, "flat"), bound=1e-12, why="two quadratures")


def test_a_notch_is_cut_into_the_pattern_and_not_into_the_plate() -> None:
    square: Table = {"kind": "flat", "outline": {"polyline": [[0, 0], [60, 0], [60, 60], [0, 60], [0, 0]]}}
    made = passage(square, notch=[{"edge": "outline", "distance": 30, "width": 4, "depth": 3}])
    assert_near([area(made, "surface"), area(made, "flat")], [3600.0, 3594.0], bound=1e-10, why="a triangle of 6")
    assert_near(float(made.metric("unroll", "area_error").value or 0.0), 0.0, bound=1e-13, why="without its notches")


class Stretched:
    """A curve drawn out along x, by so much of itself."""

    def __init__(self, curve: PlaneCurve, by: float) -> None:
        self.curve, self.scale = curve, np.array([1.0 + by, 1.0])

    def at(self, t: Values) -> Points2:
        return self.curve.at(t) * self.scale

    def derivative(self, t: Values) -> Points2:
        return self.curve.derivative(t) * self.scale


@pytest.mark.parametrize("number", [0, 1])
def test_a_contour_that_is_not_the_plate_s_shows(number: int) -> None:
    """Drawn out by 1e-6 an ellipse grows by half of that in length, the triangle's base by all of it."""
    plate = plate_of(ROUND)
    given, traced = plates.given_figures(plate), [outline.contour(plate.outline, CHORD_MM)]
    traced += [outline.contour(hole, CHORD_MM, "hole-1") for hole in plate.holes]
    edges = tuple(Stretched(edge, 1e-6) for edge in traced[number].edges)
    traced[number] = replace(traced[number], edges=edges)
    length, net = plates.errors(given, {one: plates.contour_figures(one) for one in traced})
    assert length.where == {"edge": ["outline", "hole-1"][number]}
    side = np.hypot(20.0, 40.0)  # of the triangle: it grows by 20^2 / side
    grown = [0.5e-6, 1e-6 * (40.0 + 2.0 * 20.0**2 / side) / (40.0 + 2.0 * side)][number]
    assert_near(float(length.value or 0.0), grown, bound=1e-11, why="first order in 1e-6")
    whole = 2500.0 * pi + 800.0
    assert_near(
        float(net.value or 0.0), 1e-6 * [2500.0 * pi, 800.0][number] / whole, bound=1e-12, why="areas grow as x"
    )


def test_the_plate_s_own_figures_do_not_ask_for_derivatives() -> None:
    """With every derivative wrong the plate's side stays right."""
    plate = plate_of(ROUND)
    arc = CircularArc(np.array([200.0, 100.0]), 50.0, 0.0, 2.0 * pi)

    class Misled(Stretched):
        def derivative(self, t: Values) -> Points2:
            return 3.0 * super().derivative(t)

    wrong = replace(plate, outline=(Misled(arc, 0.0),), holes=())
    ((length, inside),) = plates.given_figures(wrong)
    assert_relative([length, inside], [100.0 * pi, 2500.0 * pi], bound=1e-12, why="positions alone")


def test_lines_and_arcs_are_taken_in_closed_form_wherever_they_lie() -> None:
    """A sector of 80 degrees with its tip far from the origin: two radii and an arc."""
    tip, radius, turn = np.array([1e3, -2e3]), 30.0, radians(80.0)
    ends = [tip + radius * np.array([cos(a), sin(a)]) for a in (0.2, 0.2 + turn)]
    edges = (Segment(tip, ends[0]), CircularArc(tip, radius, 0.2, turn), Segment(ends[1], tip))
    plate = replace(plate_of(ROUND), outline=edges, holes=())
    ((length, inside),) = plates.given_figures(plate)
    assert_relative([length, inside], [60.0 + 30.0 * turn, 450.0 * turn], bound=1e-13, why="rounding at 2e3 mm")


SLIVERS = [
    [[0, 0], ["0.3", "0.1"], ["0.6", "0.2"], [0, 0]],
    [["0.1", "0.2"], ["0.4", "0.3"], ["0.7", "0.4"], ["0.1", "0.2"]],
]


@pytest.mark.parametrize("points", SLIVERS)
def test_an_outline_or_a_hole_that_encloses_nothing_but_rounding_is_refused(points: list[object]) -> None:
    """Three points of one line, whose area is 1e-17 instead of 0: there is no part to be cut."""
    alone = passage({"kind": "flat", "outline": {"polyline": points}})
    assert alone.codes(alone.refused_by or "", fatal=True) == ["no-area"]
    square = {"polyline": [[-9, -9], [9, -9], [9, 9], [-9, 9], [-9, -9]]}
    hole = passage({"kind": "flat", "outline": square, "holes": [{"polyline": points}]})
    assert hole.codes(hole.refused_by or "", fatal=True) == ["no-area"]
