"""Surfaces of constant slope: frusta and rings in closed form, other curves in 40 digits, and refusals."""

from functools import partial
from math import cos, hypot, pi, radians, sin

import mpmath
import numpy as np
import pytest

from stages.construct import slope as construct
from stages.construct.curves import chain
from stages.geometry.arrays import EPS, dot, norm
from stages.geometry.curves.curves import Bezier, Circular, bezier, exactly
from stages.geometry.numeric.extremum import maximum
from stages.geometry.ruled.ruled import warp
from stages.model.developables import Slope
from stages.model.material import Material
from stages.model.tolerances import Tolerances
from tests import oracles
from tests.near import assert_near, assert_relative
from tests.parts import Table, part, passage, patches, troubles
from tests.strategies import rotation

CIRCLE: Table = {"circle": {"center": [0, 0, 0], "radius": 100}}
ELLIPSE: Table = {"ellipse": {"center": [10, -5, 3], "major": [100, 0, 0], "minor": [0, 50, 0]}}
HUMP = [[0, 0, 0], [40, 60, 0], [80, 60, 0], [100, 0, 0]]


def slope(curve: Table, angle: object, side: str, length: object, **keys: object) -> Table:
    return {"kind": "slope", "curve": curve, "angle": angle, "side": side, "length": length} | keys


def edges(made: object, side: str) -> dict[str, float]:
    found = made.side(side)["edges"]
    assert isinstance(found, dict)
    return found


# Closed forms


@pytest.mark.parametrize("side", ["surface", "flat"])
@pytest.mark.parametrize(("way", "angle"), [("out", 30), ("in", 30), ("out", -70), ("in", 0), ("out", 0)])
def test_over_a_circle_it_is_a_right_frustum(way: str, angle: int, side: str) -> None:
    made = passage(slope(CIRCLE, angle, way, 50))
    other = 100.0 + (50.0 if way == "out" else -50.0) * cos(radians(angle))
    found = edges(made, side)
    assert_relative([found["c0"], found["c1"]], [200.0 * pi, 2.0 * pi * other], bound=1e-14, why="closed form")
    assert_relative(made.side(side)["area"], pi * (100.0 + other) * 50.0, bound=1e-14, why="closed form")
    assert made.reports["verify"].detail["class"] == "exact"
    (patch,) = patches(slope(CIRCLE, angle, way, 50))
    assert isinstance(patch.c1, Circular)


def test_it_unrolls_to_the_sector_of_the_same_cone_given_by_radii_and_height() -> None:
    """Second method: another kind of surface for the same cone."""
    sloped = passage(slope(CIRCLE, 30, "out", 50))
    height = repr(50.0 * sin(radians(30)))
    frustum = passage({"kind": "cone", "radius0": 100, "radius1": repr(100 + 50 * cos(radians(30))), "height": height})
    assert_relative(sloped.side("flat")["area"], frustum.side("flat")["area"], bound=1e-13, why="the same sector")
    corners = (np.array(made.side("flat")["corners"]) for made in (sloped, frustum))
    assert_near(*corners, bound=1e-11, why="positions of 500 mm, radii rounded once")


def test_rulings_that_reach_the_centre_make_a_whole_cone() -> None:
    made = passage(slope(CIRCLE, 60, "in", 200))
    assert made.refused_by is None
    assert_relative(made.side("flat")["area"], pi * 100.0 * 200.0, bound=1e-14, why="closed form")
    assert edges(made, "flat")["c1"] == 0.0


@pytest.mark.parametrize(("way", "angle"), [("out", 30), ("in", 40), ("out", -20)])
def test_over_an_ellipse_the_other_edge_is_longer_by_the_turning(way: str, angle: int) -> None:
    """A convex closed curve of length E moved by w along its normals has the length E + 2 pi w."""
    with mpmath.workdps(40):
        around = 4 * 100 * mpmath.ellipe(1 - mpmath.mpf(1) / 4)
    made = passage(slope(ELLIPSE, angle, way, 20))
    other = float(around) + (2.0 if way == "out" else -2.0) * pi * 20.0 * cos(radians(angle))
    for side in ("surface", "flat"):
        found = edges(made, side)
        assert_relative([found["c0"], found["c1"]], [float(around), other], bound=1e-13, why="quadrature of positions")
        assert_relative(made.side(side)["area"], 10.0 * (float(around) + other), bound=1e-13, why="(c0 + c1) / 2 L")


def test_over_a_polynomial_curve_lengths_and_area_agree_with_40_digits() -> None:
    curve = oracles.bezier(HUMP)
    angle = mpmath.radians(45)

    def turning(v: mpmath.mpf) -> mpmath.mpf:
        _, slope, bend = curve(v)
        return oracles.cross(slope, bend)[2] / oracles.dot(slope, slope)

    made = passage(slope({"bezier": HUMP}, 45, "out", 20))
    exact0 = oracles.length(curve)
    exact1 = exact0 + 20 * mpmath.cos(angle) * oracles.Antiderivative(turning)(1)
    found = edges(made, "flat")
    assert_relative([found["c0"], found["c1"]], [exact0, exact1], bound=1e-13, why="quadrature of positions")
    assert_relative(made.side("flat")["area"], 10 * (exact0 + exact1), bound=1e-13, why="(c0 + c1) / 2 L")


# Side, angle, normal


@pytest.mark.parametrize(
    ("normal", "way", "sense"), [([0, 0, 1], "out", 1), ([0, 0, 1], "in", -1), ([0, 0, -1], "out", -1)]
)
def test_out_is_right_of_travel_and_a_positive_angle_falls_away_from_the_normal(
    normal: list[int], way: str, sense: int
) -> None:
    (patch,) = patches(slope({"line": [[0, 0, 0], [30, 0, 0]]}, 30, way, 10, normal=normal))
    ruling = patch.p.jet(np.array([0.5]), 0)[0, 0]
    assert_near(
        ruling, [0.0, -sense * 10.0 * cos(pi / 6), -normal[2] * 5.0], bound=4e-15, why="10 (cos, sin) of 30 deg"
    )


@pytest.mark.parametrize("normal", [[0, 0, 1], [0, 0, -1], [1, -2, 2], [0, 1, 0]])
def test_a_circle_has_its_own_normal_and_out_is_outside(normal: list[int]) -> None:
    curve = {"circle": {"center": [7, 8, 9], "radius": 100, "normal": normal}}
    made = passage(slope(curve, 30, "out", 50))
    assert_relative(made.side("flat")["area"], pi * (200.0 + 50.0 * cos(pi / 6)) * 50.0, bound=1e-13, why="closed form")
    (patch,) = patches(slope(curve, 30, "out", 50))
    fall = dot(patch.p.jet(np.linspace(0.0, 1.0, 5), 0)[0], np.array(normal, dtype=float)) / hypot(*normal)
    assert_near(fall, np.full(5, -25.0), bound=64 * EPS * 50.0, why="50 sin 30 deg")


@pytest.mark.parametrize(("turn", "scale"), [((3, 1, -2, 1), 0.02), ((1, 1, 0, 0), 1.0), ((2, 0, 1, 0), 100.0)])
def test_any_plane_and_any_size_gives_the_same_pattern(turn: tuple[int, ...], scale: float) -> None:
    matrix = np.array(rotation(turn), dtype=float)
    rows = (scale * (np.array(HUMP, dtype=float) @ matrix.T + np.array([30.0, 400.0, -7.0]))).tolist()
    normal = (matrix @ np.array([0.0, 0.0, 1.0])).tolist()
    made = passage(slope({"bezier": rows}, 45, "out", 20 * scale, normal=normal))
    straight = passage(slope({"bezier": HUMP}, 45, "out", 20))
    why = "control points rounded at 400, rulings of 20"
    area, corners = straight.side("flat")["area"], np.array(straight.side("flat")["corners"])
    assert isinstance(area, float)
    assert_relative(made.side("flat")["area"], scale**2 * area, bound=1e-12, why=why)
    assert_near(np.array(made.side("flat")["corners"]), scale * corners, bound=1e-10 * scale, why=why)


def test_the_plane_of_a_tilted_curve_is_found_with_its_upper_side() -> None:
    matrix = np.array(rotation((3, 1, -2, 1)), dtype=float)
    rows = (np.array(HUMP, dtype=float) @ matrix.T).tolist()
    normal = matrix @ np.array([0.0, 0.0, 1.0])
    (patch,) = patches(slope({"bezier": rows}, 30, "in", 10))
    fall = dot(patch.p.jet(np.linspace(0.0, 1.0, 5), 0)[0], normal * np.sign(normal[2]))
    assert_near(fall, np.full(5, -5.0), bound=1e-13, why="10 sin 30 deg, a plane found by least squares")


def test_at_a_right_angle_it_is_a_cylinder_over_the_curve_proved_where_that_is_polynomial() -> None:
    made = passage(slope({"bezier": HUMP}, 90, "in", 51))
    assert made.metric("verify", "max_warp_deg").evidence == "proved"
    curve = oracles.bezier(HUMP)
    assert_relative(made.side("flat")["area"], 51 * oracles.length(curve), bound=1e-14, why="closed form")
    (up,) = patches(slope({"bezier": HUMP}, -90, "out", 51))
    assert isinstance(up.p, Bezier)
    assert_near(up.p.jet(np.array([0.3]), 0)[0, 0], [0.0, 0.0, 51.0], bound=0.0, why="no rounding")


def test_over_a_line_it_is_a_plane_proved() -> None:
    made = passage(slope({"line": [[0, 0, 0], [30, 40, 0]]}, 30, "in", 10))
    assert made.value("construct", "planar") is True
    assert made.metric("verify", "max_warp_deg").evidence == "proved"
    assert_relative(made.side("flat")["area"], 500.0, bound=1e-14, why="50 x 10")


# Refusals


@pytest.mark.parametrize(
    ("curve", "angle", "radius"), [(CIRCLE, 60, 100.0), (ELLIPSE, 60, 25.0), (ELLIPSE, 10, 25.0), (ELLIPSE, -45, 25.0)]
)
def test_past_the_ridge_it_is_refused_with_the_longest_rulings_that_do(curve: Table, angle: int, radius: float) -> None:
    longest = radius / cos(radians(angle))
    made = passage(slope(curve, angle, "in", longest * 1.001))
    (finding,) = (f for f in made.reports["construct"].findings if f.fatal)
    assert finding.code == "slope-past-ridge"
    said = float(finding.message.split("at most ")[1].split(" mm")[0])
    assert_near(said, longest, bound=1e-6 + 1e-12, why="rounded down to 1e-6 mm")
    assert said <= longest * (1.0 + 4 * EPS)
    assert passage(slope(curve, angle, "in", said)).refused_by is None


def test_the_place_of_the_ridge_is_named() -> None:
    made = passage(slope({"bezier": [[0, 0, 0], [40, 60, 0], [60, 60, 0], [100, 0, 0]]}, 0, "out", 100))
    (finding,) = (f for f in made.reports["construct"].findings if f.fatal)
    assert_near(finding.where["v"], 0.5, bound=1e-6, why="a symmetric hump, its sharpest place sampled")


@pytest.mark.parametrize(("way", "share", "folded"), [("out", 0.999, False), ("out", 1.001, True), ("in", 3, False)])
def test_the_patches_fold_just_where_the_ridge_is_passed(way: str, share: float, folded: bool) -> None:
    """Second method: the warp of the patches that construct has built all the same."""
    curve = bezier([exactly([float(x) for x in row]) for row in HUMP])
    _, d1, d2 = curve.jet(np.linspace(0.0, 1.0, 4001), 2)
    longest = 1.0 / (np.abs(np.cross(d1, d2)[:, 2] / norm(d1) ** 3).max() * cos(radians(45)))
    spec = part(slope({"bezier": HUMP}, 45, way, share * longest)).spec.surface
    assert isinstance(spec, Slope)
    (patch,), _, findings = construct.slope(spec, chain(spec.curve), Tolerances())
    largest, _ = maximum(partial(warp, patch))
    assert (largest > pi / 2.0) == bool(findings) == folded


def test_a_curve_that_leaves_its_plane_is_refused_with_the_distance() -> None:
    made = passage(slope({"bezier": [[0, 0, 0], [40, 60, 2], [80, 60, 0], [100, 0, 0]]}, 30, "in", 5, normal=[0, 0, 1]))
    highest = 2.0 * 3.0 * (1.0 / 3.0) * (2.0 / 3.0) ** 2
    assert made.codes("construct", fatal=True) == ["not-planar"]
    metric = made.metric("construct", "planar_error_mm")
    assert_relative(metric.value, highest / 2.0, bound=1e-3, why="65 samples of a height over the middle plane")
    assert not metric.passed


def test_a_slanting_line_makes_a_plane_with_a_normal() -> None:
    line = {"line": [[0, 0, 0], [40, 60, 10]]}
    made = passage(slope(line, 30, "in", 20, normal=[1, -1, 2]))
    assert_relative(made.side("flat")["area"], 20.0 * hypot(40, 60, 10), bound=1e-14, why="closed form")


@pytest.mark.parametrize(
    ("curve", "code"),
    [
        ({"bezier": [[0, 0, 0], [0, 0, 0], [80, 60, 0], [100, 0, 0]]}, "curve-stops"),
        ({"polyline": [[0, 0, 0], [50, 0, 0], [20, 0, 0]]}, "kink"),
        ({"line": [[0, 0, 0], [40, 60, 10]]}, "no-plane"),
    ],
)
def test_a_curve_without_tangent_or_plane_or_that_turns_back_is_refused(curve: Table, code: str) -> None:
    assert passage(slope(curve, 30, "out", 5)).codes("construct", fatal=True) == [code]


def test_the_sides_of_a_thick_sheet_differ_by_its_bending() -> None:
    """The sheet over a circle: its middle is t/2 further along the normal, its radii change by sin(angle) t / 2."""
    sheet = Material(thickness_mm=2.0)
    made = passage(slope(CIRCLE, 30, "out", 50), material=sheet, face="outer")
    assert made.refused_by is None
    middle = 100.0 - 1.0 * sin(radians(30))
    other = middle + 50.0 * cos(radians(30))
    assert_relative(made.side("flat")["area"], pi * (middle + other) * 50.0, bound=1e-12, why="closed form")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"length": 0}, "0"),
        ({"length": -3}, "-3"),
        ({"angle": 91}, "91 deg"),
        ({"normal": [0, 0, 0]}, "the vector has length 0"),
        ({"curve": {"line": [[0, 0], [1, 2]]}}, "a point with two coordinates"),
    ],
)
def test_what_the_job_file_alone_shows_is_a_trouble(change: Table, message: str) -> None:
    assert troubles(slope(CIRCLE, 30, "out", 50)) == []
    assert troubles(slope(CIRCLE, 30, "out", 50) | change) == [message]
