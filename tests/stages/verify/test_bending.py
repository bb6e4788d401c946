"""The sharpest bend by face of the sheet: inside radius and strain in closed form, limits, places, refusals."""

import numpy as np
import pytest

from stages.construct import construct
from stages.model.face import Face
from stages.model.material import Material
from stages.model.tolerances import Tolerances
from stages.verify import verify
from tests.near import assert_near, assert_relative
from tests.parts import CIRCLE, EXAMPLE_1, EXAMPLE_2_CYLINDER, RIGHT_FRUSTUM, Passage, Table, part, passage

PIPE: Table = {"kind": "cylinder", "directrix": CIRCLE, "direction": [0, 0, 1], "length": 5}


def verified(table: Table, face: Face, material: Material) -> Passage:
    return passage(table, material=material, face=face)


@pytest.mark.parametrize(
    ("face", "inside"), [("inner", 2.0), ("middle", 1.75), ("outer", 1.5), ("plus", 2.0), ("minus", 1.5)]
)
def test_radius_and_strain_follow_the_face(face: Face, inside: float) -> None:
    made = verified(PIPE, face, Material(thickness_mm=0.5))
    assert_relative([made.value("verify", "min_bend_radius_mm")], [inside], bound=1e-13, why="closed form")
    strain = 0.5 / (2.0 * (inside + 0.25))
    assert_relative([made.value("verify", "outer_fibre_strain")], [strain], bound=1e-13, why="t / (2 rho)")


def test_the_sharpest_end_of_a_cone_is_named() -> None:
    made = verified(RIGHT_FRUSTUM, "outer", Material(thickness_mm=0.1))
    where = made.metric("verify", "min_bend_radius_mm").where
    assert where is not None
    assert where["u"] == 1.0
    wanted = 1.5 * np.hypot(4.0, 1.5) / 4.0 - 0.1
    assert_relative([made.value("verify", "min_bend_radius_mm")], [wanted], bound=1e-13, why="closed form")


@pytest.mark.parametrize(("most", "refused"), [(0.1428, True), (0.1429, False)])
def test_a_strain_above_the_materials_is_refused(most: float, refused: bool) -> None:
    """0.5 / (2 x 1.75) = 0.142857."""
    made = verified(PIPE, "outer", Material(thickness_mm=0.5, max_strain=most))
    assert ("bend-strain" in made.codes("verify", fatal=True)) is refused
    assert made.metric("verify", "outer_fibre_strain").passed is not refused


def test_of_two_ways_the_one_with_the_smaller_inside_radius_counts() -> None:
    """Example 2 bends down to 0.486 mm away from N and to 0.623 mm towards it; `plus` lies inside of the second."""
    down, up = 1.0 / 2.0566392892090803, 1.0 / 1.6039356927502737
    for face, wanted in (("middle", down - 0.1), ("minus", min(down, up - 0.2)), ("plus", min(down - 0.2, up))):
        made = verified(EXAMPLE_2_CYLINDER, face, Material(thickness_mm=0.2))
        assert_relative([made.value("verify", "min_bend_radius_mm")], [wanted], bound=1e-12, why="both extremes")


@pytest.mark.parametrize("face", ["inner", "outer"])
def test_a_face_that_the_surface_has_not_is_refused_before_it_is_unrolled(face: Face) -> None:
    made = verified(EXAMPLE_2_CYLINDER, face, Material(thickness_mm=0.02))
    assert made.refused_by == "verify"
    assert made.codes("verify", fatal=True) == ["face-changes-side"]


def test_a_strain_without_bound_is_told_in_words_and_not_as_a_number() -> None:
    """A pipe of radius 2 whose sheet of 4.5 lies inside it: the middle of the sheet would have a radius of -0.25."""
    made = verified(PIPE, "outer", Material(thickness_mm=4.5, max_strain=0.2))
    (message,) = [one.message for one in made.reports["verify"].findings if one.code == "bend-strain"]
    assert "stretches without bound" in message
    assert "inf" not in message
    assert made.value("verify", "outer_fibre_strain") is None


def test_an_inside_face_that_folds_over_itself_is_reported() -> None:
    made = verified(PIPE, "middle", Material(thickness_mm=4.5))
    assert "inside-radius" in made.codes("verify", fatal=False)
    assert made.value("verify", "min_bend_radius_mm") == 0.0
    limited = verified(PIPE, "middle", Material(thickness_mm=4.5, bend_radius_min_mm=0.1))
    assert "bend-radius" in limited.codes("verify", fatal=True)


@pytest.mark.parametrize(("least", "refused"), [(60.0, False), (70.0, True)])
def test_an_apex_is_reported_and_the_rest_of_its_cone_held_against_the_material(least: float, refused: bool) -> None:
    """A right cone of radius 40 and height 30: at the rim the radius of curvature is 40 * 50 / 30 = 66.7."""
    whole: Table = {"kind": "cone", "radius0": 40, "radius1": 0, "height": 30, "sweep": 270}
    made = verified(whole, "middle", Material(thickness_mm=2.0, bend_radius_min_mm=least, max_strain=0.2))
    rim = 40.0 * 50.0 / 30.0 - 1.0
    assert made.value("verify", "min_bend_radius_mm") == 0.0
    assert made.codes("verify", fatal=False) == ["sharp-apex"]
    assert f"at least {rim:.4g} mm" in made.reports["verify"].findings[-1].message
    assert (made.codes("verify", fatal=True) == ["bend-radius"]) is refused


@pytest.mark.parametrize("table", [EXAMPLE_1])
def test_a_plane_is_bent_nowhere(table: Table) -> None:
    made = verified(table, "inner", Material(thickness_mm=1.0))
    assert made.value("verify", "outer_fibre_strain") is None
    assert made.metric("verify", "outer_fibre_strain").evidence == "proved"


def test_without_a_thickness_there_is_no_strain() -> None:
    made = verified(PIPE, "middle", Material())
    assert made.value("verify", "outer_fibre_strain") is None
    assert_near(made.value("verify", "min_bend_radius_mm"), 2.0, bound=1e-14, why="closed form")


def test_a_radius_that_is_the_materials_limit_passes() -> None:
    """A quarter bend of inside radius 3, off the origin so that rounding has its way; the next smaller one fails."""
    limits = Material(thickness_mm=2.0, bend_radius_min_mm=3.0, max_strain=0.25)
    for radius, fine in (("3", True), ("2.999999", False)):
        table = {
            "kind": "cylinder",
            "directrix": {
                "arc": {"center": [17.3, -41.7, 5.1], "radius": radius, "normal": [0, 1, 0], "start": 13, "end": 103}
            },
            "direction": [0, 1, 0],
            "length": 40,
        }
        found = verify(construct(part(table, limits, face="inner"), Tolerances()).product, Tolerances())
        assert found.report.passed is fine, (radius, found.report.findings)
