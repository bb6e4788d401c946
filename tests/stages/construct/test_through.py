"""Strips through points: the curve has the points, tangents and curvatures asked for, and every join is G2."""

from fractions import Fraction

import numpy as np
import pytest
from msgspec import convert

from stages.construct import construct
from stages.construct.quintic import vector
from stages.geometry.arrays import norm
from stages.geometry.curves.curves import Bezier
from stages.model.quinticstrip import Station
from stages.model.tolerances import Tolerances
from tests.near import assert_near
from tests.parts import Table, number, part, passage, patches, troubles

POINTS = [
    ([0, 0, 0], [1, 0, 0], [0, 1, 0], "0.02"),
    ([30, 10, 0], ["0.6", "0.8", 0], ["-0.8", "0.6", 0], "0.01"),
    ([38, 40, 5], [0, "0.96", "0.28"], [1, 0, 0], "-0.005"),
    ([900, 700, 60], ["0.8", "0.6", 0], [0, 0, 1], 0),
]
"""Irregular: spans of 32, 31 and 1088 mm."""
THROUGH: list[Table] = [{"point": p, "tangent": t, "normal": n, "k": k} for p, t, n, k in POINTS]
CYLINDER: Table = {"kind": "quintic-strip", "through": THROUGH, "ruling": [20, -15, 200]}
CONE: Table = {"kind": "quintic-strip", "through": THROUGH, "apex": [300, 150, 2000], "fraction": ["0.1", "0.7"]}
BOTH = {"cylinder": CYLINDER, "cone": CONE}


def continuity(table: Table) -> object:
    """Return the order of continuity of the worst join."""
    return construct(part(table), Tolerances()).report.metric("join_continuity").value


@pytest.mark.parametrize("name", BOTH)
def test_every_join_is_g2_and_the_whole_proved_developable(name: str) -> None:
    made = passage(BOTH[name])
    assert made.value("construct", "join_continuity") == 2.0
    assert made.value("construct", "theorem_residual") == 0.0
    assert made.value("construct", "join_gap_mm") == 0.0
    size = made.surface.size_mm if made.surface else 0.0
    jump = made.value("construct", "join_curvature_jump")
    assert isinstance(jump, float)
    assert jump <= 1e-9, f"rounding of curvatures times {size} mm"
    assert made.metric("construct", "join_normal_deg").passed
    warp = made.metric("verify", "max_warp_deg")
    assert (warp.value, warp.evidence) == (0.0, "proved")


def test_the_curve_has_the_points_tangents_and_curvatures_that_were_given() -> None:
    curves = [patch.c0 for patch in patches(CYLINDER)]
    for i, (point, tangent, normal, k) in enumerate(POINTS):
        expected = np.array([float(Fraction(str(x))) for x in point])
        kn = float(Fraction(str(k))) * np.array([float(Fraction(str(x))) for x in normal])
        for curve, v in ((curves[i - 1], 1.0), (curves[min(i, 2)], 0.0)):
            if (i, v) in ((0, 1.0), (3, 0.0)):
                continue
            (r,), (d,), (dd,) = curve.jet(np.array([v]), 2)
            assert_near(r, expected, bound=0.0, why="a control point")
            speed = float(norm(d))
            assert_near(d / speed, [float(Fraction(str(x))) for x in tangent], bound=1e-13, why="rounding")
            across = dd - (dd @ d) * d / speed**2
            assert_near(across / speed**2, kn, bound=1e-12, why="second derivatives of some 1e3 over speeds of 10")


def test_both_edges_of_the_cylinder_are_one_ruling_apart_everywhere() -> None:
    for patch in patches(CYLINDER):
        assert isinstance(patch.p, Bezier)
        assert set(patch.p.exact) == {vector([Fraction(20), Fraction(-15), Fraction(200)])}


def test_one_curvature_changed_at_one_point_by_a_tenth_breaks_no_join() -> None:
    """Both spans at a point share its data: what is changed is changed for both."""
    changed = [row | ({"k": "0.022"} if i == 1 else {}) for i, row in enumerate(THROUGH)]
    assert continuity(CYLINDER | {"through": changed}) == 2.0


def test_a_strip_of_one_curvature_on_either_side_of_a_point_is_no_longer_g2() -> None:
    """The planted fault: two strips, joined as pieces, whose curvatures at the common point differ."""
    left = CYLINDER | {"through": THROUGH[:2]}
    right = CYLINDER | {"through": [THROUGH[1] | {"k": "0.012"}, *THROUGH[2:]]}
    assert continuity({"kind": "strip", "pieces": [left, right]}) == 1.0
    assert continuity({"kind": "strip", "pieces": [left, CYLINDER | {"through": THROUGH[1:]}]}) == 2.0


def test_an_apex_on_the_curve_is_refused() -> None:
    made = passage(CONE | {"apex": [30, 10, 0]})
    assert "apex-on-directrix" in made.codes("construct", fatal=True)


def test_a_tangent_that_is_not_unit_is_named_by_its_point() -> None:
    long = [row | ({"tangent": [2, 0, 0]} if i == 0 else {}) for i, row in enumerate(THROUGH)]
    made = passage(CYLINDER | {"through": long})
    metric = made.metric("construct", "tangent_norm_error")
    assert not metric.passed
    assert metric.where == {"end": "through[0]"}
    rescaled = construct(part(CYLINDER | {"through": long}), Tolerances(normalise=True)).report
    assert rescaled.metric("tangent_norm_error").value == 0.0


@pytest.mark.parametrize(
    ("table", "said"),
    [
        (CYLINDER | {"apex": [0, 0, 9]}, "exactly one of ruling and apex"),
        ({k: v for k, v in CYLINDER.items() if k != "ruling"}, "exactly one of ruling and apex"),
        (CYLINDER | {"ruling": [0, 0, 0]}, "the ruling has length 0"),
        (CYLINDER | {"fraction": [0, 1]}, "not used without an apex"),
        (CONE | {"fraction": [1, 0]}, "[1, 0]"),
        (CYLINDER | {"through": [THROUGH[0], THROUGH[0]]}, "the point repeats the one before"),
        ({"kind": "quintic-strip", "ruling": [0, 0, 1]}, "not used without through"),
        ({"kind": "quintic-strip"}, "missing"),
    ],
)
def test_what_makes_no_strip_is_refused(table: Table, said: str) -> None:
    assert said in troubles(table)


def test_a_turn_without_a_normal_is_refused_and_a_straight_point_needs_none() -> None:
    bent = convert({"point": [0, 0, 0], "tangent": [1, 0, 0], "k": 1}, Station, dec_hook=number)
    assert [trouble.key for trouble in bent.troubles()] == ["normal"]
    straight = convert({"point": [0, 0, 0], "tangent": [1, 0, 0]}, Station, dec_hook=number)
    assert not [*straight.troubles()]


def test_spans_are_reported_with_their_shapes() -> None:
    spans = construct(part(CYLINDER), Tolerances()).report.detail["spans"]
    assert isinstance(spans, list)
    for patch, span in zip(patches(CYLINDER), spans, strict=True):
        start = patch.c0.jet(np.array([0.0]), 1)[1, 0]
        assert_near(float(norm(start)), span["shape"]["alpha0"], bound=1e-9, why="|r'(0)| = alpha0, 1e3 mm rounded")
