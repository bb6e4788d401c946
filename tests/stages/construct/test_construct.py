"""The stage: every kind is built, every condition is measured, what cannot be built is refused with its reason."""

from math import hypot, pi, sqrt

import numpy as np
import pytest

from stages.geometry.arrays import norm
from stages.geometry.ruled.ruled import at
from stages.model.report import Metric, StageReport
from stages.model.surface import Plate, RuledSurface
from stages.model.tolerances import Tolerances
from tests.near import assert_near, assert_relative
from tests.parts import (
    AFTER_CONE,
    CIRCLE,
    CONE_STRIP,
    ELLIPTIC_CYLINDER,
    EXAMPLE_1,
    EXAMPLE_2_CYLINDER,
    EXAMPLE_2_PRINTED,
    EXAMPLE_3,
    EXAMPLE_3_PRINTED,
    MITRED_CYLINDER,
    NEXT_PATCH,
    OBLIQUE_CONE,
    QUINTIC_TANGENT,
    RIGHT_FRUSTUM,
    STRIP,
    Table,
    passage,
    patches,
)

PLATE: Table = {
    "kind": "flat", "outline": {"polyline": [[0, 0], [30, 0], [30, 20], [0, 20], [0, 0]]},
    "holes": [{"circle": {"center": [10, 10], "radius": 3}}],
}  # fmt: skip
KINDS = {
    "quintic-planar": EXAMPLE_1, "quintic-ruled": EXAMPLE_2_PRINTED, "quintic-cylinder": EXAMPLE_2_CYLINDER,
    "quintic-cone, found": EXAMPLE_3, "quintic-cone, given": EXAMPLE_3_PRINTED, "quintic-strip": STRIP,
    "quintic-strip of cones": CONE_STRIP, "ruled": QUINTIC_TANGENT, "cone": OBLIQUE_CONE, "frustum": RIGHT_FRUSTUM,
    "cylinder": ELLIPTIC_CYLINDER, "mitred": MITRED_CYLINDER, "flat": PLATE,
}  # fmt: skip


@pytest.mark.parametrize("name", KINDS)
def test_every_kind_is_built_and_says_what_it_measured(name: str) -> None:
    made = passage(KINDS[name])
    assert made.surface is not None
    assert not made.codes("construct", fatal=True)
    assert isinstance(made.value("construct", "planar"), bool)
    assert made.surface.size_mm > 0.0


# End data


def test_the_metrics_of_example_2_are_the_departures_of_its_printed_data() -> None:
    """|T| = 1.0000266, T0.N0 = -0.4754: curvature 0.5 |T x N| / |T|^3 instead of 0.5."""
    made = passage(EXAMPLE_2_PRINTED)
    t = hypot(0.8798, 0.4754)
    assert_near(made.value("construct", "tangent_norm_error"), t - 1.0, bound=1e-15, why="one rounding")
    assert_near(made.value("construct", "normal_tangent_dot"), 0.4754, bound=1e-15, why="one rounding")
    error = 1.0 - 0.8798 / t**3
    assert_near(made.value("construct", "end_curvature_error"), error, bound=1e-14, why="three roundings")
    assert set(made.codes("construct")) == {"end-curvature"}
    assert made.metric("construct", "tangent_norm_error").limit == 1e-3


def test_a_tangent_that_is_not_unit_fails_unless_the_job_normalises() -> None:
    long = EXAMPLE_2_PRINTED | {"t1_hat": [1.7596, 0.9508, 0]}
    made = passage(long)
    assert not made.metric("construct", "tangent_norm_error").passed
    assert made.metric("construct", "tangent_norm_error").where == {"end": "1_hat"}
    assert made.surface is None
    rescaled = passage(long, Tolerances(normalise=True))
    assert_near(rescaled.value("construct", "tangent_norm_error"), 0.0, bound=4e-16, why="a double next to the unit")


def test_normals_across_their_tangents_reach_the_curvature() -> None:
    square = {f"n{end}": [0.4754, -0.8798, 0] for end in ("0", "1", "0_hat", "1_hat")}
    made = passage(EXAMPLE_2_PRINTED | square)
    assert made.codes("construct") == []
    assert_near(made.value("construct", "end_curvature_error"), 0.0, bound=1e-4, why="four printed digits")


def test_a_normal_may_be_zero_where_its_curvature_is() -> None:
    straight = {"n0": [0, 0, 0], "n1": [0, 0, 0], "k0": 0, "k1": 0}
    made = passage(EXAMPLE_2_CYLINDER | straight)
    assert made.refused_by is None
    assert made.value("construct", "end_curvature_error") == 0.0


# Theorems


def test_theorem_residuals_are_zero_exactly_where_the_theorems_hold() -> None:
    assert passage(EXAMPLE_1).value("construct", "theorem_residual") == 0.0
    assert passage(EXAMPLE_2_CYLINDER).value("construct", "theorem_residual") == 0.0
    assert passage(EXAMPLE_3).value("construct", "theorem_residual") == 0.0
    residual = passage(EXAMPLE_2_PRINTED).value("construct", "theorem_residual")
    assert isinstance(residual, float)
    assert residual > 1e-3


@pytest.mark.parametrize(
    ("change", "number"), [({"q1": [3, 82, 6]}, "(1)"), ({"q1": [3, 81, 7], "q0": [1, 3, 6]}, "(2)")]
)
def test_a_condition_of_theorem_2_1_that_does_not_hold_is_named(change: Table, number: str) -> None:
    made = passage(EXAMPLE_1 | change)
    messages = [f.message for f in made.reports["construct"].findings]
    assert any(number in message for message in messages)
    assert made.value("construct", "theorem_residual") > 1e-4


def test_theorem_2_1_is_plane_and_that_is_proved() -> None:
    metric = passage(EXAMPLE_1).metric("construct", "planar")
    assert (metric.value, metric.evidence) == (True, "proved")


def test_every_coefficient_is_in_the_detail() -> None:
    detail = passage(EXAMPLE_2_PRINTED).reports["construct"].detail
    assert np.shape(detail["A"]) == (1, 14)
    assert np.shape(detail["C_tilde"]) == (1, 10, 3)


def test_example_3_reports_its_parameters_and_its_speed() -> None:
    made = passage(EXAMPLE_3)
    shape = made.reports["construct"].detail["shape"]
    assert isinstance(shape, dict)
    assert_near(shape["alpha0"], 0.698376854503, bound=1e-4, why="flat objective")
    assert_near(made.value("construct", "speed_max"), 0.698368026963404, bound=1e-9, why="as asked")
    printed = passage(EXAMPLE_3_PRINTED)
    assert_near(printed.value("construct", "speed_max"), 0.698416891747, bound=1e-12, why="12 digits are given")


@pytest.mark.parametrize("strip", [STRIP, CONE_STRIP])
def test_theorem_3_1_joins_without_gap_fold_or_jump_of_curvature(strip: Table) -> None:
    made = passage(strip)
    assert_near(made.value("construct", "join_gap_mm"), 0.0, bound=1e-14, why="the same points, rounded once")
    assert_near(made.value("construct", "join_normal_deg"), 0.0, bound=1e-12, why="the same derivatives, rounded once")
    assert_near(made.value("construct", "join_curvature_jump"), 0.0, bound=1e-11, why="1/mm times D of 10 mm")
    detail = made.reports["construct"].detail["joins"]
    assert isinstance(detail, list)
    assert [detail[0][f"{order}_derivative_residual"] for order in ("first", "second")] == [0.0, 0.0]


def test_a_strip_of_cylinders_is_a_cylinder_over_all_its_patches() -> None:
    longer = STRIP | {"next": [NEXT_PATCH, NEXT_PATCH | {"p1": [12, -2, 2]}]}
    made = passage(longer)
    assert made.value("construct", "theorem_residual") == 0.0
    assert made.value("verify", "max_warp_deg") == 0.0
    assert isinstance(made.surface, RuledSurface)
    assert len(made.surface.patches) == 3


def test_what_the_first_patch_of_a_strip_found_is_kept() -> None:
    tilted = {"kind": "quintic-strip", "first": EXAMPLE_1 | {"q1": [3, 82, 6]}, "next": [
        {"p1": [9, 90, 2], "t1": [0, 0, 1], "n1": [0, 0, 0], "k1": 0, "alpha1": 1, "beta1": 1, "q1": [9, 91, 6],
         "t1_hat": [0, 0, 1], "n1_hat": [0, 0, 0], "k1_hat": 0, "alpha1_hat": 1, "beta1_hat": 1}]}  # fmt: skip
    assert "theorem-condition" in passage(tilted).codes("construct")
    through = CONE_STRIP | {"next": [AFTER_CONE | {"p1": [0.8, 0.5, 5]}]}
    assert passage(through).codes("construct", fatal=True) == ["apex-on-directrix"]


# Cones, cylinders, plates


@pytest.mark.parametrize("angle", [0.0, 1.0, 2.5, 3.14159])
def test_an_apex_on_the_directrix_is_refused_with_its_place(angle: float) -> None:
    apex = [float(np.cos(angle)) * 100, float(np.sin(angle)) * 100, 0]
    circle = {"circle": {"center": [0, 0, 0], "radius": 100}}
    made = passage({"kind": "cone", "apex": apex, "directrix": circle})
    assert made.refused_by == "construct"
    (finding,) = made.reports["construct"].findings
    assert finding.code == "apex-on-directrix"
    assert finding.where is not None
    assert_near(finding.where["v"], angle / (2 * pi), bound=1e-12, why="three steps of Gauss-Newton")


def test_an_apex_beside_the_directrix_is_not_refused() -> None:
    circle = {"circle": {"center": [0, 0, 0], "radius": 100}}
    assert passage({"kind": "cone", "apex": ["100.00001", 0, 0], "directrix": circle}).codes("construct") == []


def test_a_cylinder_has_its_length_along_its_direction() -> None:
    patch = patches(ELLIPTIC_CYLINDER)[0]
    v = np.linspace(0.0, 1.0, 9)
    rulings = at(patch, np.ones(9), v) - at(patch, np.zeros(9), v)
    direction = np.array([0.0, 0.5, 1.0]) / sqrt(1.25)
    assert_near(rulings, np.tile(3.0 * direction, (9, 1)), bound=1e-14, why="points of 5 mm, rounded")


def test_a_cylinder_between_planes_ends_on_them() -> None:
    planes = {"start_plane": {"point": [0, 0, -1], "normal": [1, 1, 4]},
              "end_plane": {"point": [1, 0, 9], "normal": [-2, 1, 5]}}  # fmt: skip
    patch = patches({"kind": "cylinder", "directrix": CIRCLE, "direction": [1, 2, 7]} | planes)[0]
    v = np.linspace(0.0, 1.0, 9)
    low, high = at(patch, np.zeros(9), v), at(patch, np.ones(9), v)
    assert_near((low - [0, 0, -1]) @ [1, 1, 4], np.zeros(9), bound=1e-13, why="coordinates of 10 mm times 4")
    assert_near((high - [1, 0, 9]) @ [-2, 1, 5], np.zeros(9), bound=1e-13, why="coordinates of 10 mm times 5")
    assert_near(patch.p.jet(v, 0)[0], high - low, bound=1e-14, why="coordinates of 10 mm")


def test_a_cone_keeps_its_fraction_of_the_way_to_the_apex() -> None:
    patch = patches(OBLIQUE_CONE | {"fraction": [0.25, 0.75]})[0]
    v = np.linspace(0.0, 1.0, 9)
    apex = np.array([1.5, 0.5, 4.0])
    base = patches(OBLIQUE_CONE)[0].c0.jet(v, 0)[0]
    assert_near(patch.c0.jet(v, 0)[0], base + 0.25 * (apex - base), bound=1e-14, why="coordinates of 4 mm")
    assert_near(patch.c1.jet(v, 0)[0], base + 0.75 * (apex - base), bound=1e-14, why="coordinates of 4 mm")
    assert_near(patch.p.jet(v, 0)[0], 0.5 * (apex - base), bound=1e-14, why="coordinates of 4 mm")


def test_a_chain_with_a_gap_is_refused_with_its_width() -> None:
    torn = {"chain": [{"line": [[0, 0, 0], [1, 0, 0]]}, {"line": [[1, 0, 0.5], [2, 0, 1]]}]}
    made = passage({"kind": "cylinder", "directrix": torn, "direction": [0, 1, 0], "length": 2})
    assert made.codes("construct") == ["chain-open"]
    assert "0.5 mm" in made.reports["construct"].findings[0].message
    assert made.metric("construct", "join_gap_mm").value == 0.5


def test_a_plate_has_its_outline_counter_clockwise_and_its_holes_clockwise() -> None:
    from stages.geometry.curves.contours import area

    for outline in ([[0, 0], [30, 0], [30, 20], [0, 20], [0, 0]], [[0, 0], [0, 20], [30, 20], [30, 0], [0, 0]]):
        plate = passage(PLATE | {"outline": {"polyline": outline}}).surface
        assert isinstance(plate, Plate)
        assert_relative([area(plate.outline)], [600.0], bound=1e-14, why="four products")
        assert_relative([area(plate.holes[0])], [-9.0 * pi], bound=1e-13, why="a quadrature")
        assert_near(plate.size_mm, hypot(30, 20), bound=1e-13, why="the diagonal")


def test_a_tilted_plate_is_as_large_in_its_own_plane() -> None:
    corners = [[0, 0, 0], [3, 0, 4], [3, 2, 4], [0, 2, 0], [0, 0, 0]]
    made = passage({"kind": "flat", "outline": {"polyline": corners}})
    assert_relative([made.side("flat")["area"]], [10.0], bound=1e-14, why="a rectangle of 5 by 2")
    assert_near(made.value("construct", "planar_error_mm"), 0.0, bound=1e-14, why="coordinates of 4 mm")


@pytest.mark.parametrize(
    ("outline", "code"),
    [
        ([[0, 0], [30, 0], [30, 20], [0, 19]], "open-contour"),
        ([[0, 0], [10, 0], [5, 0], [0, 0]], "no-area"),
    ],
)
def test_an_outline_that_is_no_contour_is_refused(outline: list[list[int]], code: str) -> None:
    made = passage({"kind": "flat", "outline": {"polyline": outline}})
    assert (made.refused_by, made.codes("construct")) == ("construct", [code])


def test_an_outline_that_leaves_its_plane_fails_by_the_metric() -> None:
    made = passage({"kind": "flat", "outline": {"polyline": [[0, 0, 0], [9, 0, 1], [9, 9, 0], [0, 9, 1], [0, 0, 0]]}})
    assert made.refused_by == "construct"
    assert_near(made.value("construct", "planar_error_mm"), 0.5, bound=0.1, why="half of 1 mm, about the mean plane")


@pytest.mark.parametrize("slope", ["1/3", "0.7", "-2"])
def test_an_outline_with_an_edge_through_the_origin_is_no_trouble(slope: str) -> None:
    from fractions import Fraction

    a, b = (["0.1", str(Fraction("0.1") * Fraction(slope))], ["0.7", str(Fraction("0.7") * Fraction(slope))])
    made = passage({"kind": "flat", "outline": {"polyline": [a, b, [20, 15], a]}})
    assert made.refused_by is None


# Values


def test_a_metric_passes_at_its_limit_and_fails_just_above() -> None:
    limit = 0.1
    assert Metric("m", limit, limit=limit).passed
    assert not Metric("m", float(np.nextafter(limit, 1.0)), limit=limit).passed
    assert Metric("m", 0.0, limit=limit).passed
    assert not Metric("m", 5e-324, limit=0.0).passed
    assert Metric("m", None, limit=limit).passed
    assert Metric("m", 1e300).passed
    assert not Metric("m", float("nan"), limit=limit).passed
    assert Metric("m", True, limit=True).passed
    assert not Metric("m", False, limit=True).passed
    assert not Metric("m", True, limit=False).passed


def test_a_report_names_its_metrics_and_has_no_others() -> None:
    report = StageReport("construct", "part", (Metric("planar", True), Metric("speed_max", 1.0)))
    assert report.metric("speed_max").value == 1.0
    with pytest.raises(KeyError, match="speed"):
        report.metric("speed")


def test_the_size_of_a_surface_is_the_diagonal_of_its_box() -> None:
    surface = passage(RIGHT_FRUSTUM).surface
    assert isinstance(surface, RuledSurface)
    assert_relative([surface.size_mm], [norm(np.array([6.0, 6.0, 4.0]))], bound=1e-14, why="extremes are sampled")
