"""The neutral surface: closed forms by face and K, both ways of bending, refusals, and what one K neglects."""

from fractions import Fraction

import numpy as np
import pytest

from stages.construct import construct
from stages.geometry.flat.development import develop
from stages.model.face import Face
from stages.model.kfactor import KFactor, Rule, k_at
from stages.model.material import Material
from stages.model.report import Finding
from stages.model.surface import RuledSurface
from stages.model.tolerances import Tolerances
from stages.unroll.sides import surface_figures
from stages.unroll.thickness import Neutral, neutral
from tests.near import assert_near, assert_relative
from tests.parts import (
    AUMANN_CUBIC,
    CIRCLE,
    EXAMPLE_1,
    EXAMPLE_2_CYLINDER,
    OBLIQUE_CONE,
    RIGHT_FRUSTUM,
    Table,
    part,
)

TOL = Tolerances()
FULL_ROUND = 2.0 * np.pi
PIPE: Table = {"kind": "cylinder", "directrix": CIRCLE, "direction": [0, 0, 1], "length": 5}
"""Radius 2, bent towards N."""
CONE: Table = {"kind": "cone", "radius0": 3, "radius1": 0, "height": 4}


def given(table: Table, thickness: float | None = 0.5, rule: Rule | None = None, face: Face = "middle") -> RuledSurface:
    law = KFactor() if rule is None else KFactor(rule, given=True)
    made = construct(part(table, Material(thickness_mm=thickness, k_factor=law), face=face), TOL).product
    assert isinstance(made, RuledSurface)
    return made


def made(table: Table, thickness: float | None = 0.5, rule: Rule | None = None, face: Face = "middle") -> Neutral:
    return neutral(given(table, thickness, rule, face), TOL)


def round_length(unrolled: Neutral) -> float:
    """The flat length of c0, on the positions of the development."""
    (piece,) = develop(unrolled.surface.patches).pieces
    ends = piece.positions(np.zeros(2), np.array([0.0, 1.0]))
    return float(np.linalg.norm(ends[1] - ends[0]))


def finding(unrolled: Neutral, code: str) -> Finding:
    (found,) = [entry for entry in unrolled.findings if entry.code == code]
    return found


# K


@pytest.mark.parametrize(
    ("ratio", "k"), [(0.5, 0.2497), (1.0, 0.325), (1.5, 0.3690), (2.0, 0.4003), (3.0, 0.4443), (4.0, 0.4755)]
)
def test_k_by_din_6935_is_that_of_its_table(ratio: float, k: float) -> None:
    assert_near(k_at("din6935", np.array([ratio])), [k], bound=5e-5, why="four decimals")


def test_k_by_din_6935_stays_between_the_inside_face_and_the_middle() -> None:
    ends = k_at("din6935", np.array([0.0, 0.05, 10.0**0.7, 5.1, np.inf]))
    assert_near(ends, [0.0, 0.0, 0.5, 0.5, 0.5], bound=1e-15, why="clamped, and 0.65 + 0.35 = 1")


def test_k_by_a_table_has_straight_lines_between_its_rows_and_holds_its_ends() -> None:
    rows = ((0.5, 0.3), (1.5, 0.4), (5.0, 0.5))
    asked = np.array([0.1, 0.5, 1.0, 3.25, 9.0, np.inf])
    assert_near(k_at(rows, asked), [0.3, 0.3, 0.35, 0.45, 0.5, 0.5], bound=1e-15, why="halves of the steps")


# Lengths


@pytest.mark.parametrize(
    ("face", "inside"), [("inner", 2.0), ("middle", 1.75), ("outer", 1.5), ("plus", 2.0), ("minus", 1.5)]
)
@pytest.mark.parametrize("k", [0.5, 0.4, 0.25])
def test_a_pipe_unrolls_to_its_bend_allowance(face: Face, inside: float, k: float) -> None:
    """theta (r + K t); N points to the axis, so the plus face is the inner one."""
    wanted = FULL_ROUND * (inside + k * 0.5)
    assert_relative([round_length(made(PIPE, 0.5, k, face))], [wanted], bound=1e-13, why="a quadrature of 1e-14")


def test_turned_inside_out_plus_and_minus_change_places_and_inner_and_outer_do_not() -> None:
    other = PIPE | {"direction": [0, 0, -1]}
    for face, same in (("plus", "minus"), ("minus", "plus"), ("inner", "inner"), ("outer", "outer")):
        first, second = (round_length(made(table, 0.5, 0.4, name)) for table, name in ((PIPE, face), (other, same)))
        assert_relative([second], [first], bound=1e-13, why="the same sheet")


@pytest.mark.parametrize(("face", "out"), [("inner", 0.2), ("outer", -0.3)])
def test_a_cone_unrolls_on_the_cone_moved_along_its_normal(face: Face, out: float) -> None:
    """K = 0.4, t = 0.5: the neutral surface lies 0.2 outside the inner face and 0.3 inside the outer one."""
    edges = surface_figures(made(RIGHT_FRUSTUM, 0.5, 0.4, face).surface.patches)[0]
    outward = 4.0 / np.hypot(4.0, 1.5)
    wanted = [FULL_ROUND * (radius + out * outward) for radius in (3.0, 1.5)]
    slant = np.hypot(4.0, 1.5)
    assert_relative(
        [*edges.by_name().values()], [*wanted, slant, slant], bound=1e-13, why="closed form; rulings keep their length"
    )


def test_the_middle_of_rolled_work_is_unrolled_as_it_is() -> None:
    surface = given(AUMANN_CUBIC, 0.02)
    unrolled = neutral(surface, TOL)
    assert [a is b for a, b in zip(unrolled.surface.patches, surface.patches, strict=True)] == [True]
    assert [(m.name, m.value, m.evidence) for m in unrolled.metrics] == [
        ("k_factor", 0.5, "proved"), ("neutral_offset_mm", 0.0, "proved"),
    ]  # fmt: skip
    assert not unrolled.findings


def test_without_a_thickness_the_surface_is_unrolled_and_that_is_said() -> None:
    surface = given(AUMANN_CUBIC, None)
    unrolled = neutral(surface, TOL)
    assert unrolled.surface is surface
    assert not unrolled.metrics
    assert unrolled.detail == {"thickness": {"note": "no thickness is known: the surface itself is unrolled"}}


@pytest.mark.parametrize("face", ["inner", "outer", "plus", "minus"])
def test_a_plane_unrolls_alike_whatever_its_face(face: Face) -> None:
    surface = given(EXAMPLE_1, 3.0, "din6935", face)
    unrolled = neutral(surface, TOL)
    assert unrolled.surface is surface
    assert [(m.name, m.value) for m in unrolled.metrics] == [("k_factor", 0.5), ("neutral_offset_mm", 0.0)]
    assert not unrolled.findings


# Both ways


@pytest.mark.parametrize("k", [0.5, 0.4, 0.0])
def test_where_a_surface_bends_both_ways_k_counts_from_its_own_inside_on_either_side(k: float) -> None:
    """A directrix across the rulings: every bend is shorter than the middle by (1/2 - K) t per rad of either sign."""
    flat = neutral(given(EXAMPLE_2_CYLINDER, 0.05), TOL)
    middle, turned = surface_figures(flat.surface.patches)[0].c0, flat.bent.bends.total_rad
    unrolled = made(EXAMPLE_2_CYLINDER, 0.05, k)
    wanted = middle - (0.5 - k) * 0.05 * turned
    assert_relative([surface_figures(unrolled.surface.patches)[0].c0], [wanted], bound=1e-13, why="closed form")
    offsets = unrolled.detail["thickness"]["offsets"]  # type: ignore[index]
    distances = [0.0] if k == 0.5 else [-(0.5 - k) * 0.05, (0.5 - k) * 0.05]
    assert_near([entry["offset_mm"] for entry in offsets], distances, bound=1e-17, why="rounding of 0.05")
    low, high = unrolled.surface.spans[0][0], unrolled.surface.spans[-1][1]
    assert (low, high) == (Fraction(0), Fraction(1))
    assert all(a[1] == b[0] for a, b in zip(unrolled.surface.spans, unrolled.surface.spans[1:], strict=False))


def test_the_flat_of_both_sides_joins_without_a_gap_at_the_inflection() -> None:
    pieces = develop(made(EXAMPLE_2_CYLINDER, 0.05, 0.3).surface.patches).pieces
    u = np.array([0.0, 1.0])
    (end, start) = pieces[0].positions(u, np.ones(2)), pieces[1].positions(u, np.zeros(2))
    assert_near(end, start, bound=1e-14 * 10, why="chained, with the ruling in common")


def test_a_surface_that_bends_both_ways_has_no_inner_face_and_the_place_is_named() -> None:
    for face in ("inner", "outer"):
        found = finding(made(EXAMPLE_2_CYLINDER, 0.05, None, face), "face-changes-side")
        assert found.fatal
        assert found.where is not None
        assert_near(float(found.where["v"]), 0.5090984889689595, bound=1e-12, why="where its curvature vanishes")
        assert "plus" in found.message
    for face in ("plus", "minus"):
        assert not made(EXAMPLE_2_CYLINDER, 0.05, None, face).findings


def test_a_strip_takes_its_side_from_all_of_its_patches() -> None:
    """Two quarters of a pipe, the second one bent the other way."""
    arcs = [{"arc": {"center": [0, 0, 0], "radius": 2, "start": 0, "end": 90}},
            {"arc": {"center": [0, 4, 0], "radius": 2, "start": 270, "end": 180}}]  # fmt: skip
    table = {"kind": "cylinder", "directrix": {"chain": arcs}, "direction": [0, 0, 1], "length": 5}
    found = finding(made(table, 0.1, None, "inner"), "face-changes-side")
    assert found.where == {"v": 1.0}
    unrolled = made(table, 0.1, 0.4)
    wanted = 2 * (np.pi / 2) * (2.0 - 0.05 + 0.4 * 0.1)
    edges, _ = surface_figures(unrolled.surface.patches)
    assert_relative([edges.c0], [wanted], bound=1e-13, why="both bends from inside")


# Too thick


def test_a_sheet_thicker_than_its_bend_is_refused_with_place_and_radius() -> None:
    found = finding(made(PIPE, 5.0, None, "outer"), "offset-past-edge")
    assert found.fatal
    assert "radius of 2 mm" in found.message
    assert "-3 mm" in found.message
    assert not [f for f in made(PIPE, 3.9, None, "outer").findings if f.fatal]


def test_an_apex_opens_where_the_neutral_surface_moves_out() -> None:
    unrolled = made(CONE, 0.5, 0.5, "inner")
    assert not unrolled.findings
    edges = surface_figures(unrolled.surface.patches)[0]
    wanted = [FULL_ROUND * 3.2, FULL_ROUND * 0.2]
    assert_relative([edges.c0, edges.c1], wanted, bound=1e-13, why="moved by 0.25 along (0.8, 0.6)")


# What one K neglects


def test_k_by_rule_is_that_of_the_smallest_inside_radius_and_its_error_is_told() -> None:
    """Frustum, inner face: r/t is constant along each edge, so the neglected length has a closed form."""
    unrolled = made(RIGHT_FRUSTUM, 1.0, "din6935", "inner")
    slant = np.hypot(4.0, 1.5)
    radii = np.array([3.0, 1.5]) * slant / 4.0
    k0, k1 = k_at("din6935", radii)
    assert_near(unrolled.metrics[0].value, k1, bound=1e-14, why="closed form")
    assert unrolled.metrics[0].evidence == "sampled"
    lost = (k0 - k1) * 1.0 * FULL_ROUND * 4.0 / slant
    assert f"{lost:.4g} mm off" in finding(unrolled, "k-varies").message
    over = unrolled.detail["thickness"]["k_over_the_part"]  # type: ignore[index]
    assert_near(over["edge_change_mm"], [lost, 0.0], bound=1e-12, why="a constant integrand")
    assert_near(over["r_over_t"], [radii[1], radii[0]], bound=1e-13, why="closed form")


def test_one_value_for_k_neglects_nothing() -> None:
    assert not made(RIGHT_FRUSTUM, 1.0, 0.4, "inner").findings
    assert not made(OBLIQUE_CONE, 0.01, "din6935", "inner").findings


def test_rolled_work_taken_for_granted_is_questioned_where_the_bend_is_sharp() -> None:
    """r = 1.5, t = 1: DIN 6935 gives K = 0.369."""
    found = finding(made(PIPE, 1.0), "k-default")
    change = (k_at("din6935", np.array([1.5]))[0] - 0.5) * FULL_ROUND
    assert not found.fatal
    assert f"change a flat edge by {change:.4g} mm" in found.message
    assert not made(PIPE, 0.3).findings, "r/t = 6.2"
    assert not made(PIPE, 1.0, 0.5).findings, "the job gave it"


def test_folds_say_what_they_leave_out() -> None:
    """Given outside, sharp, 90 deg, r = 1, t = 1, K = 0.4: theta (r + K t) - 2 (r + t) tan(theta / 2)."""
    angle = {"kind": "cylinder", "directrix": {"polyline": [[0, 0, 0], [3, 0, 0], [3, 4, 0]]},
             "direction": [0, 0, 1], "length": 5}  # fmt: skip
    sheet = Material(thickness_mm=1.0, bend_radius_min_mm=1.0, k_factor=KFactor(0.4, given=True))
    surface = construct(part(angle, sheet, face="outer"), TOL).product
    assert isinstance(surface, RuledSurface)
    change = np.pi / 2 * 1.4 - 4.0
    assert f"would change the flat by {change:.4g} mm" in finding(neutral(surface, TOL), "fold-allowance").message
