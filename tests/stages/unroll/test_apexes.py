"""Apexes: closed forms of right cones, the parallel surface as a second method, what is refused, and sensitivities."""

import numpy as np
import pytest

from stages.construct import construct
from stages.geometry.arrays import Values, dot, unit
from stages.geometry.numeric.quadrature import integral
from stages.geometry.ruled.offset import normals, offset, tapered
from stages.geometry.ruled.ruled import RuledPatch, across, frames, warp
from stages.model.face import Face
from stages.model.kfactor import KFactor, Rule, k_at
from stages.model.material import Material
from stages.model.report import Finding
from stages.model.surface import RuledSurface
from stages.model.tolerances import Tolerances
from stages.unroll.sides import surface_figures
from stages.unroll.thickness import Neutral, neutral
from tests.near import assert_near, assert_relative
from tests.parts import EXAMPLE_3, Passage, Table, part, passage

TOL = Tolerances()
CONE: Table = {"kind": "cone", "radius0": 3, "radius1": 0, "height": 4}
"""Slant 5, half angle with sine 3/5: its normal turns by 2 pi 4/5."""
TURNED: Table = {"kind": "cone", "radius0": 0, "radius1": 3, "height": 4}
OBLIQUE: Table = {
    "kind": "cone", "apex": [30, 20, 200], "directrix": {"circle": {"center": [0, 0, 0], "radius": 80}},
}  # fmt: skip
TRANSITION: Table = {
    "kind": "transition", "rectangle": [400, 300], "round": 250, "height": 350, "offset": [50, -20], "tilt": 15,
}  # fmt: skip
CROSSED: Table = {
    "kind": "strip",
    "pieces": [
        {"kind": "cone", "apex": [0, 0, 100], "directrix": {"bezier": [[0, 100, 0], [60, 100, 0], [100, 0, 0]]}},
        {"kind": "cone", "apex": [100, 0, 0], "directrix": {"bezier": [[0, 0, 100], [20, -80, 100], [60, -99, 60]]}},
    ],
}
"""Two cones with a ruling in common, each with its apex on the other's directrix."""


def sheet(thickness: float, rule: Rule | None) -> Material:
    return Material(thickness_mm=thickness, k_factor=KFactor() if rule is None else KFactor(rule, given=True))


def made(table: Table, thickness: float = 0.5, rule: Rule | None = None, face: Face = "middle") -> Neutral:
    product = construct(part(table, sheet(thickness, rule), face=face), TOL).product
    assert isinstance(product, RuledSurface)
    return neutral(product, TOL)


def whole(table: Table, thickness: float, rule: Rule | None = None, face: Face = "middle") -> Passage:
    return passage(table, TOL, sheet(thickness, rule), face=face)


def finding(unrolled: Neutral, code: str) -> Finding:
    (found,) = [entry for entry in unrolled.findings if entry.code == code]
    return found


def metric(unrolled: Neutral, name: str) -> float:
    (found,) = [entry for entry in unrolled.metrics if entry.name == name]
    return float(str(found.value))


def lengths(unrolled: Neutral) -> dict[str, float]:
    return surface_figures(unrolled.surface.patches)[0].by_name()


@pytest.mark.parametrize(("table", "edges"), [(CONE, ("c0", "c1")), (TURNED, ("c1", "c0"))])
@pytest.mark.parametrize(("face", "k", "inwards"), [("outer", 0.5, 0.25), ("middle", 0.4, 0.05), ("outer", 0.3, 0.35)])
def test_a_cone_is_unrolled_from_the_neutral_line_of_its_base_into_its_apex(
    table: Table, edges: tuple[str, str], face: Face, k: float, inwards: float
) -> None:
    base, tip = edges
    unrolled = made(table, 0.5, k, face)
    found = lengths(unrolled)
    radius, slant = 3.0 - 0.8 * inwards, np.hypot(5.0, inwards)
    assert_relative(found[base], 2.0 * np.pi * radius, bound=1e-13, why="a circle moved in along (0.8, 0.6)")
    assert_near(found[tip], 0.0, bound=1e-13, why="the apex stays a point")
    assert_relative([found["start"], found["end"]], [slant] * 2, bound=1e-14, why="Pythagoras")
    area = surface_figures(unrolled.surface.patches)[1]
    assert_relative(area, np.pi * radius * slant, bound=1e-13, why="a right cone again")


def test_what_is_neglected_at_the_apex_is_said_in_closed_form() -> None:
    unrolled = made(CONE, 0.5, None, "outer")
    told = finding(unrolled, "apex-tapered")
    assert not told.fatal
    assert told.where is not None and told.where["u"] == 1.0
    assert_relative(metric(unrolled, "apex_allowance_mm"), 0.4 * np.pi, bound=1e-13, why="0.25 mm 2 pi 4/5")
    assert "within 0.3333 mm of an apex" in told.message, "0.25 / tan of the half angle"
    assert "up to 1.257 mm too long" in told.message


@pytest.mark.parametrize(("face", "rule"), [("middle", None), ("inner", None), ("inner", 0.3)])
def test_nothing_is_said_where_the_neutral_surface_reaches_the_apex(face: Face, rule: Rule | None) -> None:
    for table in (CONE, OBLIQUE, TRANSITION):
        unrolled = made(table, 0.5, rule, face)
        assert not unrolled.findings
        assert [entry.name for entry in unrolled.metrics] == ["k_factor", "neutral_offset_mm"]


def test_k_by_a_rule_is_that_of_the_base_and_not_of_the_apex() -> None:
    unrolled = made(CONE, 1.0, "din6935", "inner")
    radius = 3.0 * 5.0 / 4.0
    assert_relative(metric(unrolled, "k_factor"), k_at("din6935", np.array([radius]))[0], bound=1e-13, why="r/t = 3.75")
    over = unrolled.detail["thickness"]["k_over_the_part"]  # type: ignore[index]
    assert_near(over["edge_change_mm"], [0.0, 0.0], bound=1e-13, why="one radius along the base")


def width(patch: RuledPatch, u: float) -> float:
    """Return the length across the rulings at u, mm."""

    def rate(v: Values) -> np.ndarray:
        f = frames(patch, v)
        e, w = unit(f.p), unit(across(f, 0.5 if u in (0.0, 1.0) else u)[1])
        s_v = f.c0_d1 + u * f.p_d1
        return np.stack([dot(s_v - dot(s_v, e)[:, None] * e, w), np.full_like(v, 100.0)], axis=1)

    return float(integral(rate, "width")[0])


@pytest.mark.parametrize("u", [0.0, 0.25, 0.5, 0.75])
def test_widths_exceed_those_of_the_parallel_surface_by_a_share_that_grows_evenly(u: float) -> None:
    unrolled = made(OBLIQUE, 1.0, None, "outer")
    given = construct(part(OBLIQUE), TOL).product
    assert isinstance(given, RuledSurface)
    parallel = offset(given.patches[0], 0.5)
    excess = width(unrolled.surface.patches[0], u) - width(parallel, u)
    wanted = u * metric(unrolled, "apex_allowance_mm")
    bound = 0.5**2 / 100.0 * 2.0 * np.pi
    assert_near(excess, wanted, bound=bound, why="rulings that lean by d / L make widths longer by (d / L)^2 of them")


@pytest.mark.parametrize("thickness", [0.8, 2.0])
def test_a_transition_by_its_outside_keeps_its_rectangle_and_has_the_neutral_length_around_the_round(
    thickness: float,
) -> None:
    unrolled = made(TRANSITION, thickness, None, "outer")
    found = lengths(unrolled)
    given = construct(part(TRANSITION), TOL).product
    assert isinstance(given, RuledSurface)
    moved = [offset(patch, thickness / 2.0) for patch in given.patches]
    assert_relative(found["c0"], 1400.0, bound=1e-14, why="2 (400 + 300)")
    assert_relative(found["c1"], surface_figures(tuple(moved))[0].c1, bound=1e-13, why="parallel at the round")
    made_of = whole(TRANSITION, thickness, None, "outer")
    assert made_of.refused_by is None
    assert_near(made_of.value("unroll", "flat_gap_mm"), 0.0, bound=1e-11, why="rulings in common keep one length")
    assert "apex-tapered" in made_of.codes("unroll", fatal=False)


def test_one_corner_of_a_transition_counts_and_not_all_four_together() -> None:
    square: Table = {"kind": "transition", "rectangle": [300, 300], "round": 250, "height": 350}
    turned = made(square, 1.0).bent.bends.total_rad
    found = metric(made(square, 1.0, None, "outer"), "apex_allowance_mm")
    assert_relative(found, 0.5 * turned / 4.0, bound=1e-12, why="four alike")


def test_a_cone_of_several_pieces_has_one_apex() -> None:
    half = [{"arc": {"center": [0, 0, 0], "radius": 3, "start": a, "end": a + 180}} for a in (0, 180)]
    table: Table = {"kind": "cone", "apex": [0, 0, 4], "directrix": {"chain": half}}
    assert_relative(metric(made(table, 0.5, None, "outer"), "apex_allowance_mm"), 0.4 * np.pi, bound=1e-13, why="whole")


def test_the_papers_cone_to_its_apex_is_made_from_either_face() -> None:
    for face in ("inner", "outer"):
        made_of = whole(EXAMPLE_3, 0.002, None, face)
        assert made_of.refused_by is None
        assert made_of.value("unroll", "metric_error") < 1e-10  # type: ignore[operator]


def test_apexes_at_both_edges_are_refused_with_what_would_do() -> None:
    refused = [f for f in made(CROSSED, 0.5, 0.4).findings if f.fatal]
    assert {f.code for f in refused} == {"offset-past-edge"}
    assert all("give the middle surface and K = 0.5, or cut the tips off" in f.message for f in refused)
    assert not [f for f in made(CROSSED, 0.5, 0.5).findings if f.fatal]


def test_a_cone_beside_a_flat_piece_that_is_no_triangle_is_refused() -> None:
    # the flat piece: from A = (0, 0, 100) and B = (100, 0, 0) to B + w and A + w / 2 + (B - A) / 10, w = (20, -80, 10)
    beside = {
        "kind": "ruled",
        "c0": {"line": [[100, 0, 0], [120, -80, 10]]},
        "c1": {"line": [[0, 0, 100], [20, -40, 95]]},
    }
    pieces = CROSSED["pieces"]
    assert isinstance(pieces, list)
    strip: Table = {"kind": "strip", "pieces": [pieces[0], beside]}
    assert [f.code for f in made(strip, 0.5, 0.4).findings if f.fatal] == ["offset-past-edge"]
    assert not [f for f in made(strip, 0.5, 0.5).findings if f.fatal]


def test_a_base_that_is_bent_too_sharply_is_still_refused() -> None:
    found = finding(made(CONE, 9.0, None, "outer"), "offset-past-edge")
    assert found.fatal
    assert found.where is not None and found.where["u"] == 0.0


@pytest.mark.parametrize("kept", [0.0, 1.0])
def test_the_tapered_surface_is_a_cone_with_the_same_apex(kept: float) -> None:
    (patch,) = construct(part(TURNED if kept == 0.0 else CONE), TOL).product.patches  # type: ignore[union-attr]
    taper = tapered(patch, 0.3, normals(patch), kept)
    v = np.linspace(0.0, 1.0, 9)
    assert_near(warp(taper, v), np.zeros(9), bound=1e-15, why="one normal vanishes")
    assert_near(taper.c1.jet(v, 3) - taper.c0.jet(v, 3), taper.p.jet(v, 3), bound=1e-12, why="p is their difference")


def test_sensitivities_are_those_of_patterns_of_other_sheets() -> None:
    rows = whole(CONE, 0.5, None, "outer").reports["unroll"].detail["sensitivity"]
    assert isinstance(rows, dict)
    step = rows["per_0_1_mm_thickness"]
    assert_near(step["c0"], -0.08 * np.pi, bound=1e-12, why="2 pi 4/5 for half of 0.1 mm")
    assert_near([step["c1"], step["start"]], [0.0, 0.0], bound=1e-12, why="the apex and the rulings stay")
    above, below = (whole(CONE, t, None, "outer").side("flat") for t in (0.55, 0.45))
    grown = 0.25 / 5.0 * 0.05
    for key, bound in (("area", np.pi * 3.0 * grown), ("width", 2.0 * grown), ("height", 2.0 * grown)):
        difference = float(str(above[key])) - float(str(below[key]))
        assert_near(step[key], difference, bound=1.01 * bound, why="rulings grow by d / L of 0.05 mm")
