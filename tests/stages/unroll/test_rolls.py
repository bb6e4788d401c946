"""The roll schedule: distances, radii and tilt in closed form, and springback by its own formula."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stages.construct import construct
from stages.model.face import Face
from stages.model.kfactor import KFactor
from stages.model.material import Material
from stages.model.surface import RuledSurface
from stages.model.tolerances import Tolerances
from stages.unroll.rolls import TOO_SHARP, Rolling, ratio_of, rolled, tool_radius
from stages.unroll.thickness import neutral
from tests.near import assert_near, assert_relative
from tests.parts import AUMANN_CUBIC, EXAMPLE_1, EXAMPLE_2_CYLINDER, RIGHT_FRUSTUM, Table, part

STEEL = Material("steel", 2.0, k_factor=KFactor(0.4, given=True), yield_strength_mpa=235.0, youngs_modulus_gpa=210.0)
LEATHER = Material("leather", 2.0, k_factor=KFactor(0.4, given=True))
SHELL: Table = {"kind": "cylinder", "directrix": {"circle": {"center": [0, 0, 0], "radius": 300}},
                "direction": [0, 0, 1], "length": 500}  # fmt: skip


def schedule(table: Table, material: Material = STEEL, face: Face = "middle") -> Rolling:
    made = construct(part(table, material, face=face), Tolerances()).product
    assert isinstance(made, RuledSurface)
    return rolled(neutral(made, Tolerances()).bent)


def column(rolling: Rolling, key: str) -> list[float]:
    return [row[key] for row in rolling.rows]  # type: ignore[misc]


def test_a_shell_is_rolled_to_one_radius_with_the_rolls_parallel() -> None:
    """Inside 299, fed over theta (r + K t)."""
    made = schedule(SHELL)
    assert_relative(column(made, "radius_mm"), np.full((len(made.rows), 2), 299.0), bound=1e-13, why="R - t / 2")
    assert_near(column(made, "cone_tilt_deg"), np.zeros(len(made.rows)), bound=1e-11, why="rounding of 1e-14 rad")
    fed = np.array(column(made, "v")) * 2 * np.pi * 299.8
    assert_near(column(made, "distance_mm"), fed, bound=2e-11, why="1e-14 of 1900 mm")
    assert (made.rows[0]["v"], made.rows[-1]["v"]) == (0.0, 1.0)
    assert set(column(made, "side")) == {"up"}


def test_a_cone_tilts_the_rolls_by_its_half_angle() -> None:
    made = schedule(RIGHT_FRUSTUM, Material(thickness_mm=0.1, k_factor=KFactor(0.5, given=True)))
    half_angle = np.degrees(np.arctan2(1.5, 4.0))
    assert_near(column(made, "cone_tilt_deg"), np.full(len(made.rows), -half_angle), bound=1e-11, why="closed form")
    radii = np.array([3.0, 1.5]) * np.hypot(4.0, 1.5) / 4.0 - 0.05
    assert_relative(column(made, "radius_mm"), np.tile(radii, (len(made.rows), 1)), bound=1e-13, why="closed form")
    fed = np.array(column(made, "v")) * 2 * np.pi * 2.25
    assert_near(column(made, "distance_mm"), fed, bound=1e-12, why="along the middles of the rulings")


def test_the_tightest_places_are_stations_and_an_inflection_is_straight() -> None:
    made = schedule(EXAMPLE_2_CYLINDER, Material(thickness_mm=0.01, k_factor=KFactor(0.4, given=True)))
    radii = [row["radius_mm"][0] for row in made.rows]  # type: ignore[index]
    assert radii.count(None) == len(["the end of the run down", "the start of the run up"])
    known = [radius for radius in radii if radius is not None]
    assert_relative([min(known)], [1.0 / 2.0566392892090803 - 0.005], bound=1e-12, why="the largest curvature")
    assert {"up", "down"} == set(column(made, "side"))
    assert sorted(column(made, "v")) == column(made, "v")


@pytest.mark.parametrize("table", [EXAMPLE_1])
def test_what_is_flat_is_not_rolled(table: Table) -> None:
    assert schedule(table) == Rolling()


def test_what_has_no_thickness_is_rolled_to_its_own_radius() -> None:
    made = schedule(RIGHT_FRUSTUM, Material())
    radii = np.array([3.0, 1.5]) * np.hypot(4.0, 1.5) / 4.0
    assert_relative(column(made, "radius_mm"), np.tile(radii, (len(made.rows), 1)), bound=1e-13, why="closed form")
    assert not any("tool_radius_mm" in row for row in made.rows)


# Springback


@given(st.floats(1e-9, 1e4))
def test_the_tool_radius_springs_back_to_the_part(c: float) -> None:
    """R / R_f = 4 X^3 - 3 X + 1 with X = c R / R_f."""
    ratio = ratio_of(c)
    x = c * ratio
    assert 0.0 < x < 0.5 + 1e-12
    assert_near(ratio, 4.0 * x**3 - 3.0 * x + 1.0, bound=1e-12, why="the root to its last digit")


def test_the_tool_is_tighter_than_the_part_and_the_more_so_the_wider_the_radius() -> None:
    ratios = np.array([ratio_of(c) for c in np.geomspace(1e-6, 1e2, 60)])
    assert (np.diff(ratios) < 0.0).all()
    assert_near(ratios[0], 1.0 - 3e-6, bound=1e-11, why="to first order 1 - 3 c")


def test_the_schedule_names_the_tool_and_says_that_it_is_an_estimate() -> None:
    made = schedule(SHELL)
    c = 235.0 * 300.0 / (210e3 * 2.0)
    wanted = 300.0 * ratio_of(c) - 1.0
    assert_relative(column(made, "tool_radius_mm"), np.full((len(made.rows), 2), wanted), bound=1e-12, why="R_f = 300")
    assert all("estimate" in text for text in column(made, "tool_radius_by"))
    (metric,) = made.metrics
    assert (metric.name, metric.evidence) == ("springback_ratio", "sampled")
    assert_relative([metric.value], [ratio_of(c)], bound=1e-12, why="the same radius everywhere")
    assert not made.findings


def test_what_is_not_elastic_has_no_springback() -> None:
    made = schedule(SHELL, LEATHER)
    assert (made.metrics, made.findings) == ((), ())
    assert tool_radius(LEATHER, 100.0) is None
    assert tool_radius(STEEL, None) is None


POINTED: Table = {"kind": "cone", "apex": [0, 0, 400], "fraction": [0, 1],
                  "directrix": {"circle": {"center": [0, 0, 0], "radius": 300}}}  # fmt: skip


@pytest.mark.parametrize("material", [STEEL, LEATHER])
def test_an_apex_has_no_tool_radius_and_says_why(material: Material) -> None:
    made = schedule(POINTED, material)
    for row in made.rows:
        base, apex = row["radius_mm"]  # type: ignore[misc]
        assert (apex, row["note"]) == (0.0, TOO_SHARP)
        if material is STEEL:
            tool = row["tool_radius_mm"]
            assert tool == [tool_radius(STEEL, base), None]
            assert 0.0 < tool[0] < base
        else:
            assert "tool_radius_mm" not in row
    assert not any("note" in row for row in schedule(SHELL, material).rows)


def test_what_springs_back_to_more_than_asked_has_no_tool() -> None:
    """A tool of no radius bends the middle to R = t / 2, and leaves R_f = R / (4 X^3 - 3 X + 1) of it."""
    x = 235.0 * 1.0 / (210e3 * 2.0)
    middle = 1.0 / (4.0 * x**3 - 3.0 * x + 1.0)
    just = tool_radius(STEEL, middle - 1.0 + 1e-6)
    assert tool_radius(STEEL, middle - 1.0 - 1e-6) is None
    assert just is not None
    assert_near(just, 1e-6, bound=1e-8, why="to first order what is more than R_f, less springing back")


def test_a_radius_beyond_the_elastic_limit_is_reported() -> None:
    """E t / (2 sigma_y) = 447 t = 894 mm."""
    wide = {**SHELL, "directrix": {"circle": {"center": [0, 0, 0], "radius": 900}}}
    (found,) = schedule(wide).findings
    assert (found.code, found.fatal) == ("springs-back", False)
    assert "446.8 x thickness" in found.message
    assert not schedule({**SHELL, "directrix": {"circle": {"center": [0, 0, 0], "radius": 890}}}).findings


def test_the_face_moves_the_inside_radius() -> None:
    for face, inside in (("inner", 300.0), ("middle", 299.0), ("outer", 298.0)):
        radii = column(schedule(SHELL, STEEL, face), "radius_mm")
        assert_relative(radii, np.full((len(radii), 2), inside), bound=1e-13, why="the sheet's inside face")


def test_a_general_developable_has_its_stations_in_order() -> None:
    made = schedule(AUMANN_CUBIC, Material(thickness_mm=0.01))
    assert (np.diff(column(made, "distance_mm")) >= 0.0).all()
