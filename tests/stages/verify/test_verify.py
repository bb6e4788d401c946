"""The stage: class, place and amount, regularity, bending, and surfaces that are sampled instead of proved."""

from math import hypot

import numpy as np
import pytest

from stages.construct import construct
from stages.model.material import Material
from stages.model.surface import Certificate
from stages.model.tolerances import CLASSES, WARP_LIMIT_DEG, Class, Tolerances, class_by_warp
from stages.verify import verify
from tests.near import assert_near, assert_relative
from tests.parts import (
    DEFAULT,
    ELLIPTIC_CYLINDER,
    EXAMPLE_1,
    EXAMPLE_2_CYLINDER,
    EXAMPLE_2_PRINTED,
    MITRED_CYLINDER,
    OBLIQUE_CONE,
    QUINTIC_TANGENT,
    RIGHT_FRUSTUM,
    Table,
    part,
    passage,
)


def saddle(warp_deg: float) -> Table:
    rise = 100.0 * np.tan(np.radians(warp_deg) / 2.0)
    return {
        "kind": "ruled",
        "c0": {"bezier": [[-100, -100, rise], [100, -100, -rise]]},
        "c1": {"bezier": [[-100, 100, -rise], [100, 100, rise]]},
    }


def test_example_2_as_printed_is_rejected_with_place_and_amount() -> None:
    made = passage(EXAMPLE_2_PRINTED)
    assert made.refused_by == "verify"
    (finding,) = [f for f in made.reports["verify"].findings if f.fatal]
    assert finding.code == "not-developable"
    assert "3.28499 deg" in finding.message
    assert "v = 0.206364" in finding.message
    assert "'metal'" in finding.message
    metric = made.metric("verify", "max_warp_deg")
    assert metric.evidence == "proved"
    assert not metric.passed
    assert metric.where is not None
    assert_near(metric.where["v"], 0.206364358832, bound=1e-7, why="the square root of rounding")
    assert 3.2849872165410022977 <= metric.value <= 3.2849872165410022977 + 1e-9


def test_example_2_with_theorem_2_2_applied_is_exact_and_that_is_proved() -> None:
    made = passage(EXAMPLE_2_CYLINDER)
    assert made.certificate is not None
    assert (made.certificate.reached, made.certificate.proved) == ("exact", True)
    for name in ("max_warp_deg", "max_gaussian_curvature"):
        assert (made.value("verify", name), made.metric("verify", name).evidence) == (0.0, "proved")
    assert made.value("verify", "regular") is True
    assert_near(made.value("verify", "turn_deg"), 0.0, bound=1e-12, why="parallel rulings")


@pytest.mark.parametrize(
    ("warp_deg", "reached"), [(1e-10, "exact"), (0.05, "fabrication"), (3.0, "metal"), (30.0, "leather"), (60.0, None)]
)
def test_the_class_follows_from_the_warp(warp_deg: float, reached: Class | None) -> None:
    surface = construct(part(saddle(warp_deg)), DEFAULT).product
    assert surface is not None
    for accept in CLASSES:
        found = verify(surface, Tolerances(accept=accept))
        accepted = reached is not None and CLASSES.index(reached) <= CLASSES.index(accept)
        assert (found.product is not None) is accepted
        assert found.report.detail["class"] == (reached if accepted else "rejected")
        if found.product is not None:
            assert found.product.reached == reached


@pytest.mark.parametrize("name", CLASSES)
def test_a_warp_at_its_limit_is_in_the_class_and_the_next_double_is_not(name: Class) -> None:
    limit = WARP_LIMIT_DEG[name]
    assert class_by_warp(limit) == name
    assert class_by_warp(float(np.nextafter(limit, 999.0))) != name


@pytest.mark.parametrize(
    ("table", "turn_deg"),
    [
        (OBLIQUE_CONE, None),
        (RIGHT_FRUSTUM, 540 / hypot(1.5, 4)),
        (MITRED_CYLINDER, 0.0),
        (ELLIPTIC_CYLINDER, 0.0),
    ],
)
def test_other_curves_are_sampled_and_say_so(table: Table, turn_deg: float | None) -> None:
    made = passage(table)
    metric = made.metric("verify", "max_warp_deg")
    assert metric.evidence == "sampled"
    assert_near(metric.value, 0.0, bound=1e-12, why="rounding, in deg")
    assert made.certificate is not None
    assert (made.certificate.reached, made.certificate.proved) == ("exact", False)
    if turn_deg is not None:
        assert_near(made.value("verify", "turn_deg"), turn_deg, bound=1e-11, why="a quadrature of 1e-14 of 360")


def test_the_rulings_of_the_quintic_tangent_surface_turn_as_far_as_its_edge() -> None:
    """The geodesic curvature of an edge of regression is its curvature: 1.42336673777949279016 rad at 30 digits."""
    turn = np.degrees(1.42336673777949279016)
    assert_near(passage(QUINTIC_TANGENT).value("verify", "turn_deg"), turn, bound=1e-11, why="1e-14 of 82 deg, summed")


# Weights

ARC: Table = {"bspline": {"degree": 2, "knots": [0, 0, 0, 1, 1, 1], "points": [[5, 0, 0], [5, 5, 0], [0, 5, 0]],
                          "weights": [1, "0.70710678118654752440", 1]}}  # fmt: skip
"""A quarter of a circle to 20 digits."""


@pytest.mark.parametrize(
    "table",
    [
        {"kind": "cylinder", "directrix": ARC, "direction": [0, "0.5", 1], "length": 3},
        {"kind": "cylinder", "directrix": ARC, "direction": [0, 0, 1],
         "end_plane": {"point": [0, 0, 5], "normal": ["0.3", "0.1", 1]}},
        {"kind": "cone", "apex": [1, 2, 9], "directrix": ARC, "fraction": [0, "0.6"]},
    ],
)  # fmt: skip
def test_developables_over_rational_curves_are_proved(table: Table) -> None:
    made = passage(table, Tolerances(accept="leather"))
    assert made.certificate is not None
    assert (made.certificate.reached, made.certificate.proved) == ("exact", True)
    for name in ("max_warp_deg", "max_gaussian_curvature"):
        assert (made.value("verify", name), made.metric("verify", name).evidence) == (0.0, "proved")
    assert (made.value("verify", "regular"), made.metric("verify", "regular").evidence) == (True, "proved")


def test_one_weight_changed_by_a_trillionth_is_no_longer_developable() -> None:
    upper = {"bspline": {"degree": 2, "knots": [0, 0, 0, 1, 1, 1], "points": [[5, 0, 4], [5, 5, 4], [0, 5, 4]],
                         "weights": [1, "0.70710678118654752440", "1.000000000001"]}}  # fmt: skip
    made = passage({"kind": "ruled", "c0": ARC, "c1": upper})
    warp = made.metric("verify", "max_warp_deg")
    assert warp.evidence == "proved"
    assert 0.0 < float(warp.value or 0.0) < 1e-9


# Bending


def test_the_smallest_radius_is_on_the_inside_of_the_sheet() -> None:
    """Frustum: 1.5 mm at the top, over the slant's height: 1.5 hypot(1.5, 4) / 4; half of 0.5 mm less."""
    rho = 1.5 * hypot(1.5, 4.0) / 4.0
    assert_relative(
        [passage(RIGHT_FRUSTUM).value("verify", "min_bend_radius_mm")], [rho], bound=1e-12, why="closed form"
    )
    thick = passage(RIGHT_FRUSTUM, material=Material(thickness_mm=0.5))
    assert_relative([thick.value("verify", "min_bend_radius_mm")], [rho - 0.25], bound=1e-12, why="closed form")


@pytest.mark.parametrize(("least", "refused"), [(1.3, False), (1.4, True)])
def test_a_part_that_bends_too_sharply_is_refused(least: float, refused: bool) -> None:
    made = passage(RIGHT_FRUSTUM, material=Material(thickness_mm=0.5, bend_radius_min_mm=least))
    assert ("bend-radius" in made.codes("verify", fatal=True)) is refused
    assert (made.refused_by == "verify") is refused


def test_an_outer_fibre_that_stretches_too_far_is_refused() -> None:
    """t / (2 rho) with rho = 1.602 mm: 0.156 for 0.5 mm."""
    for strain, refused in ((0.157, False), (0.155, True)):
        made = passage(RIGHT_FRUSTUM, material=Material(thickness_mm=0.5, max_strain=strain))
        assert ("bend-strain" in made.codes("verify", fatal=True)) is refused


@pytest.mark.parametrize("table", [EXAMPLE_1, RIGHT_FRUSTUM | {"radius1": 0, "height": 0}])
def test_a_plane_part_has_no_bending_radius(table: Table) -> None:
    assert passage(table).value("verify", "min_bend_radius_mm") is None


def test_the_curvature_of_a_saddle_is_reported_free_of_scale() -> None:
    """z = a x y on a square of side 200: K = -a^2 at the middle; D^2 = 2 * 200^2 + (2 rise)^2."""
    rise = 100.0 * np.tan(np.radians(5.0))
    square = (rise / 100.0**2) ** 2 * (2 * 200.0**2 + (2 * rise) ** 2)
    for factor in (1.0, 1000.0):
        table = saddle(10.0)
        for key in ("c0", "c1"):
            curve = table[key]
            assert isinstance(curve, dict)
            table[key] = {"bezier": [[x * factor for x in point] for point in curve["bezier"]]}
        made = passage(table)
        assert_near(made.value("verify", "max_warp_deg"), 10.0, bound=1e-8, why="the proof starts 1e-10 above")
        value = made.value("verify", "max_gaussian_curvature")
        assert square * (1 - 1e-12) <= value <= square * 1.1, "a bound over the patch, within its cos(W/2)^4"


def test_a_worse_piece_of_a_strip_decides_and_is_named() -> None:
    flat = {"line": [[0, 0, 0], [1, 0, 0]]}
    lifted = {"line": [[0, 1, 0], [1, 1, 0]]}
    warped = {"line": [[1, 1, 0], [2, 1, 0.2]]}
    made = passage({
        "kind": "ruled", "c0": {"chain": [flat, {"line": [[1, 0, 0], [2, 0, 0]]}]},
        "c1": {"chain": [lifted, warped]},
    })  # fmt: skip
    where = made.metric("verify", "max_warp_deg").where
    assert where is not None
    assert 1.0 <= float(where["v"]) <= 2.0


def test_only_verify_hands_out_certificates_and_they_carry_the_surface() -> None:
    made = passage(EXAMPLE_2_CYLINDER)
    assert isinstance(made.certificate, Certificate)
    assert made.surface is made.certificate.surface
    assert made.surface is not None
    assert verify(made.surface, Tolerances()).report == made.reports["verify"], "the same surface, the same report"


NO_NORMAL_WHERE_WORST: Table = {
    "kind": "quintic-planar",
    "p0": ["-0.496", "-0.058", "1.354"], "p1": ["-2.064", "5.888", "-0.484"],
    "q0": ["-0.836", "-0.481", "0.948"], "q1": ["0.281", "1.875", "-2.489"],
    "alpha0": "0.14", "alpha1": "0.1", "beta0": "-0.72", "beta1": "-8.45",
    "alpha0_hat": "2.75", "alpha1_hat": "0.95", "beta0_hat": "4.57", "beta1_hat": "-1.82",
}  # fmt: skip
"""Both ends of the first ruling have no normal, and towards it the warp is largest."""


def test_a_sampled_warp_beside_a_ruling_without_normals_is_near_the_proved_bound() -> None:
    made = passage(NO_NORMAL_WHERE_WORST)
    proved = made.value("verify", "max_warp_deg")
    met = made.reports["verify"].detail["sampled_warp_deg"]
    assert isinstance(met, float)
    assert isinstance(proved, float)
    assert 0.99 * proved < met <= proved
