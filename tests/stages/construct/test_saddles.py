"""Saddles and tees: closed forms of equal pipes, 40-digit lengths and areas, points on the main pipe, refusals."""

import numpy as np
import pytest
from mpmath import cos, ellipe, mp, mpf, sin, sqrt

from stages.geometry.arrays import EPS, norm
from stages.geometry.ruled.ruled import warp
from tests import oracles
from tests.near import assert_near, assert_relative
from tests.parts import Table, edges, passage, patches, troubles, whole

TEE: Table = {"kind": "tee", "branch": 120, "main": 200, "length": 260, "angle": 60, "offset": 20}
BLUNT: Table = {"kind": "tee", "branch": 1.5, "main": 2, "length": 4, "angle": 125, "offset": "-0.1"}
LARGE: Table = {"kind": "tee", "branch": 2000, "main": 9000, "length": 7000}
EQUAL: Table = {"kind": "tee", "branch": 100, "main": 100, "length": 150}
SLANTED: Table = {"kind": "tee", "branch": 100, "main": 100, "length": 200, "angle": 50}
EVERY = pytest.mark.parametrize("table", [TEE, BLUNT, LARGE, EQUAL, SLANTED])
SMOOTH = pytest.mark.parametrize("table", [TEE, BLUNT, LARGE])


def values(table: Table) -> tuple[mpf, mpf, mpf, mpf, mpf]:
    """Return the radii of branch and main, length, angle and offset."""
    angle = mp.radians(oracles.exact(table.get("angle", 90)))
    r, rho = oracles.exact(table["branch"]) / 2, oracles.exact(table["main"]) / 2
    return r, rho, oracles.exact(table["length"]), angle, oracles.exact(table.get("offset", 0))


def ruling(table: Table, a: mpf) -> tuple[mpf, mpf]:
    """Return the length of the ruling at an angle about the branch, and its derivative."""
    r, rho, length, angle, offset = values(table)
    h = r * sin(a) - offset
    z = sqrt(rho**2 - h**2)
    return length - (r * cos(a) * cos(angle) + z) / sin(angle), (
        (r * sin(a) * cos(angle) + h * r * cos(a) / z) / sin(angle)
    )


@SMOOTH
def test_the_saddle_has_its_length_and_the_branch_its_area_to_40_digits(table: Table) -> None:
    r = values(table)[0]
    turn = 2 * mp.pi
    saddle = oracles.Antiderivative(lambda v: turn * sqrt(r**2 + ruling(table, turn * v)[1] ** 2))(1)
    area = oracles.Antiderivative(lambda v: turn * r * ruling(table, turn * v)[0])(1)
    for side in ("flat", "surface"):
        found = edges(table, side)
        wanted = [float(turn * r), float(saddle), *[float(ruling(table, mpf(0))[0])] * 2]
        assert_relative([found[k] for k in ("c0", "c1", "start", "end")], wanted, bound=1e-12, why="panels to rounding")
        assert_relative(whole(table).side(side)["area"], float(area), bound=1e-12, why="panels to rounding")


@pytest.mark.parametrize("table", [EQUAL, SLANTED])
def test_the_saddle_of_equal_pipes_is_made_of_two_halves_of_ellipses(table: Table) -> None:
    # the two pipes meet in the planes that halve the angles between their axes
    r, _, length, angle, _ = values(table)
    halves = [2 * r / s * ellipe(1 - s**2) for s in (sin(angle / 2), cos(angle / 2))]
    area = 2 * mp.pi * r * length - 4 * r**2 / sin(angle)
    assert len(patches(table)) == 3
    assert_relative(
        edges(table)["c1"], float(sum(halves)), bound=1e-12, why="half ellipses r by r / sin of half angles"
    )
    assert_relative(whole(table).side("flat")["area"], float(area), bound=1e-12, why="2 pi r length - 4 r^2 / sin")


@EVERY
def test_the_saddle_lies_on_the_main_and_the_other_end_is_square(table: Table) -> None:
    r, rho, length, angle, offset = (float(x) for x in values(table))
    v = np.linspace(0.0, 1.0, 33)
    outwards = np.array([np.cos(angle), 0.0, np.sin(angle)])
    for patch in patches(table):
        saddle, ring = patch.c1.jet(v, 0)[0], patch.c0.jet(v, 0)[0]
        size = length + r + rho
        assert_near(norm(saddle[:, 1:]), np.full(33, rho), bound=64 * EPS * size, why="its distance from the x axis")
        assert_near(ring @ outwards, np.full(33, length), bound=16 * EPS * size, why="the plane across the branch")
        away = ring - length * outwards - np.array([0.0, offset, 0.0])
        assert_near(norm(away), np.full(33, r), bound=16 * EPS * size, why="the radius of the branch")
        assert (saddle[:, 2] >= -16 * EPS * size).all()


@EVERY
def test_branches_are_exactly_developable_and_pass(table: Table) -> None:
    made = whole(table)
    assert made.reports["verify"].detail["class"] == "exact"
    assert made.refused_by is None
    v = np.linspace(0.0, 1.0, 65)
    assert max(float(np.nanmax(warp(patch, v))) for patch in patches(table)) <= 64 * EPS


@EVERY
def test_the_seam_is_the_shortest_ruling_where_the_branch_does_not_stand_aside(table: Table) -> None:
    rulings = [float(ruling(table, mp.pi * (2 * k + 1) / 64)[0]) for k in range(64)]
    if float(values(table)[3]) < np.pi / 2.0 and not values(table)[4]:
        assert edges(table)["start"] <= min(rulings) * (1.0 + 8 * EPS)
    assert_relative(edges(table)["start"], float(ruling(table, mpf(0))[0]), bound=1e-13, why="closed form at a = 0")


def cylinder(table: Table, **keys: object) -> Table:
    """Return the branch of a tee as a cylinder with a saddle, standing on z = 0."""
    r, rho, length, _, offset = (float(x) for x in values(table))
    saddle = {"radius": rho, "angle": table.get("angle", 90), "offset": offset}
    circle = {"circle": {"center": [3, 4, 0], "radius": r}}
    return {"kind": "cylinder", "directrix": circle, "direction": [0, 0, 2], "length": length, "saddle": saddle} | keys


@EVERY
def test_a_cylinder_with_a_saddle_is_the_branch_of_the_tee(table: Table) -> None:
    made = passage(cylinder(table))
    found = made.side("flat")["edges"]
    assert isinstance(found, dict)
    assert_relative([*found.values()], [*edges(table).values()], bound=1e-12, why="the same pipe in another place")


def test_a_start_plane_takes_off_what_lies_below_it() -> None:
    r = values(TEE)[0]
    plane = {"point": [3, 4, 10], "normal": ["0.25", 0, 1]}
    made = passage(cylinder(TEE, start_plane=plane))
    less = float(2 * mp.pi * r * 10)
    wanted = float(str(whole(TEE).side("flat")["area"])) - less
    assert_relative(made.side("flat")["area"], wanted, bound=1e-12, why="10 mm of the axis")
    found = made.side("flat")["edges"]
    assert isinstance(found, dict)
    long = sqrt(1 + mpf("0.25") ** 2)
    ellipse = float(4 * r * long * ellipe(1 - 1 / long**2))
    assert_relative(found["c0"], ellipse, bound=1e-12, why="an ellipse r by r sqrt(1 + slope^2)")


def test_a_saddle_on_an_arc_of_an_oblique_pipe_lies_on_the_crossing_pipe() -> None:
    arc = {"arc": {"center": [1, 2, 3], "radius": 40, "start": -50, "end": 100}}
    saddle = {"radius": 60, "angle": 70, "offset": 5}
    table: Table = {"kind": "cylinder", "directrix": arc, "direction": [0.3, 0.1, 1], "length": 150, "saddle": saddle}
    made = passage(table)
    assert made.refused_by is None
    e = np.array([0.3, 0.1, 1.0]) / np.sqrt(1.1)
    x = np.array([1.0, 0.0, 0.0]) - e[0] * e
    x /= norm(x)
    m = np.sin(np.radians(70)) * x - np.cos(np.radians(70)) * e
    foot = np.array([1.0, 2.0, 3.0]) + 150.0 * e + 5.0 * np.cross(e, x)
    (patch,) = patches(table)
    arm = patch.c1.jet(np.linspace(0.0, 1.0, 17), 0)[0] - foot
    off = norm(arm - (arm @ m)[:, None] * m)
    assert_near(off, np.full(17, 60.0), bound=64 * EPS * 250.0, why="the radius of the crossing pipe")


def refusal(table: Table) -> dict[str, float | int | str]:
    report = passage(table).reports["construct"]
    (finding,) = report.findings
    assert finding.fatal and finding.where is not None
    return {"code": finding.code} | finding.where


def test_a_branch_larger_than_the_main_is_refused_with_the_largest_branch() -> None:
    found = refusal(TEE | {"branch": 201, "offset": 0})
    assert (found["code"], found["largest_branch_mm"], found["least_radius_mm"]) == ("saddle-misses", 200.0, 100.5)
    assert passage(TEE | {"branch": 200, "offset": 0}).reports["construct"].passed


def test_a_branch_that_stands_aside_is_refused_with_the_largest_offset() -> None:
    found = refusal(TEE | {"offset": "40.001"})
    assert (found["code"], found["largest_offset_mm"]) == ("saddle-misses", 40.0)
    made = passage(TEE | {"offset": 40})
    assert made.reports["construct"].passed
    assert made.refused_by is None


@pytest.mark.parametrize("table", [TEE | {"length": 100}, SLANTED | {"length": 90}])
def test_a_branch_that_ends_inside_the_main_is_refused_with_the_least_length(table: Table) -> None:
    """Of two patches of the slanted branch one alone is too short."""
    found = refusal(table)
    assert found["code"] == "saddle-too-near"
    least = float(found["least_length_mm"])
    short = float(min(ruling(table | {"length": 0}, mp.pi * (2 * k + 1) / 4096)[0] for k in range(4096)))
    assert_near(least, -short, bound=1e-3, why="60 mm / 2 times half of (pi / 4096)^2, sampled")
    assert passage(table | {"length": repr(least + 1e-6)}).reports["construct"].passed


@pytest.mark.parametrize(
    ("change", "message"),
    [({"branch": 0}, "0"), ({"main": -5}, "-5"), ({"length": 0}, "0"), ({"angle": 180}, "180 deg")],
)
def test_sizes_that_make_no_tee_are_errors_of_the_job_file(change: Table, message: str) -> None:
    assert troubles(TEE | change) == [message]


def test_a_saddle_asks_for_a_directrix_with_a_centre_and_for_the_length() -> None:
    line = {"directrix": {"line": [[0, 0, 0], [1, 0, 0]]}}
    assert troubles(cylinder(TEE) | line) == ["on a directrix that has no centre"]
    plane = {"end_plane": {"point": [0, 0, 5], "normal": [0, 0, 1]}}
    without = {key: value for key, value in cylinder(TEE).items() if key != "length"}
    assert troubles(without | plane) == ["beside end_plane"]
