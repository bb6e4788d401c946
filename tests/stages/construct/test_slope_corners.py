"""Corners of a surface of constant slope: cones where they open, folds at a right angle, refusals where they close."""

from math import cos, pi, radians

import numpy as np

from stages.geometry.arrays import norm
from tests.near import assert_near, assert_relative
from tests.parts import passage, patches
from tests.stages.construct.test_slope import edges, slope

RECTANGLE = [[0, 0, 0], [100, 0, 0], [100, 50, 0], [0, 50, 0], [0, 0, 0]]


def test_around_a_rectangle_there_is_a_cone_at_every_corner() -> None:
    made = passage(slope({"polyline": RECTANGLE}, 30, "out", 20))
    assert made.refused_by is None
    reach = 20.0 * cos(radians(30))
    found = edges(made, "flat")
    assert_relative([found["c0"], found["c1"]], [300.0, 300.0 + 2.0 * pi * reach], bound=1e-13, why="closed form")
    assert_relative(made.side("flat")["area"], 20.0 * 300.0 + pi * reach * 20.0, bound=1e-13, why="closed form")
    assert_near(made.value("construct", "join_gap_mm"), 0.0, bound=1e-13, why="rulings of 20 mm, to rounding")
    assert made.value("construct", "join_normal_deg") < 1e-9
    assert len(patches(slope({"polyline": RECTANGLE}, 30, "out", 20))) == 8


def test_an_open_line_has_cones_between_its_pieces_only() -> None:
    made = slope({"polyline": RECTANGLE[:3]}, 30, "out", 20)
    assert len(patches(made)) == 3
    (_, fan, _) = patches(made)
    assert_near(norm(fan.p.jet(np.linspace(0.0, 1.0, 5), 0)[0]), np.full(5, 20.0), bound=1e-14, why="rulings of 20 mm")
    assert not fan.c0.jet(np.array([0.2]), 2)[1:].any()


def test_at_a_right_angle_corners_are_folds_and_need_no_cones() -> None:
    made = passage(slope({"polyline": RECTANGLE}, 90, "in", 20))
    assert_relative(made.side("flat")["area"], 6000.0, bound=1e-14, why="300 x 20")
    assert len(patches(slope({"polyline": RECTANGLE}, 90, "in", 20))) == 4


def test_a_smooth_closed_spline_joins_without_cones() -> None:
    points = [[100, 0, 0], [0, 60, 0], [-80, 0, 0], [0, -70, 0], [100, 0, 0]]
    made = passage(slope({"points": points}, 30, "out", 20))
    assert len(patches(slope({"points": points}, 30, "out", 20))) == 4
    found = edges(made, "flat")
    wider = found["c0"] + 2.0 * pi * 20.0 * cos(radians(30))
    assert_relative(found["c1"], wider, bound=1e-12, why="one turn; slopes of the spline rounded")


def test_a_corner_towards_the_rulings_is_refused_with_the_radius_that_would_do() -> None:
    made = passage(slope({"polyline": RECTANGLE}, 30, "in", 20))
    (finding,) = (f for f in made.reports["construct"].findings if f.fatal)
    assert (finding.code, finding.where) == ("kink", {"piece": 0, "v": 1.0})
    assert "a kink of 90 deg towards the rulings" in finding.message
    assert f"at least {20.0 * cos(radians(30)):.6g} mm" in finding.message
    arc = {"arc": {"center": [80, 20, 0], "radius": 20, "start": 270, "end": 360}}
    rounded = {"chain": [{"line": [[0, 0, 0], [80, 0, 0]]}, arc, {"line": [[100, 20, 0], [100, 50, 0]]}]}
    assert passage(slope(rounded, 30, "in", 20)).refused_by is None


def test_the_corner_where_a_closed_curve_begins_counts_too() -> None:
    """A drop: one smooth curve that meets itself in a corner, open to its left."""
    drop = {"bezier": [[0, 0, 0], [100, 60, 0], [-100, 60, 0], [0, 0, 0]]}
    assert passage(slope(drop, 30, "in", 5)).codes("construct", fatal=True) == ["kink"]
    assert len(patches(slope(drop, 30, "out", 5))) == 2
