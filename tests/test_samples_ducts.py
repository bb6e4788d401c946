"""The duct fittings of samples/ducts have the areas that the geometry of pipes gives, by quadrature of 40 digits."""

from math import pi, radians, tan

import pytest
from mpmath import mp, mpf

from tests.near import assert_relative
from tests.oracles import Vec, add, cross, dot, norm
from tests.samples import LAST_DIGITS, assert_figures, figure, made, stage

HALF = mpf("0.5")
"""From the inside of the sheet to its middle, mm."""
MAIN = mpf("157.5")


@pytest.fixture(scope="module")
def ducts() -> dict[str, dict]:
    return made("ducts/job.toml")


def test_the_transition_is_four_triangles_and_four_cones(ducts: dict[str, dict]) -> None:
    """Each triangle touches the tilted round where its plane holds the round's tangent; the cones lie between."""
    tilt, centre = mp.radians(10), (60, 0, 400)
    level, upright = (mp.cos(tilt), mpf(0), -mp.sin(tilt)), (mpf(0), mpf(1), mpf(0))

    def round_at(a: mpf, quarter: int = 0) -> Vec:
        c, s = mp.cos(a + quarter * mp.pi / 2), mp.sin(a + quarter * mp.pi / 2)
        return tuple(MAIN * (c * x + s * y) for x, y in zip(level, upright, strict=True))

    corners = [tuple(map(mpf, xyz)) for xyz in ((250, -150, 0), (250, 150, 0), (-250, 150, 0), (-250, -150, 0))]
    sides = [(corner, corners[(k + 1) % 4]) for k, corner in enumerate(corners)]

    def triangle(k: int, a: mpf) -> Vec:
        first, last = sides[k]
        return cross(add(last, first, -1), add(add(centre, round_at(a)), first, -1))

    touch = [mp.findroot(lambda a, k=k: dot(triangle(k, a), round_at(a, 1)), k * mp.pi / 2) for k in range(4)]
    touch.append(touch[0] + 2 * mp.pi)
    area = sum(norm(triangle(k, touch[k])) / 2 for k in range(4))
    for k, (_, apex) in enumerate(sides):
        arm = add(centre, apex, -1)
        element = lambda a, arm=arm: norm(cross(add(arm, round_at(a)), round_at(a, 1))) / 2  # noqa: E731
        area += mp.quad(element, [touch[k], touch[k + 1]])
    given = stage(ducts["transition"], "unroll")["detail"]["given"]
    edges = given["edges"]
    assert_relative(given["area"], float(area), bound=LAST_DIGITS, why="quadrature")
    assert_relative([edges["c0"], edges["c1"]], [1600.0, 315.0 * pi], bound=LAST_DIGITS, why="closed form")


def test_the_elbows_gores_are_pipe_between_mitres(ducts: dict[str, dict]) -> None:
    """Cut at 90 / 8 deg; along the centre line a gore is as long as the two tangents to the bend."""
    girth = 2 * pi * 158.0
    for number in range(1, 6):
        tangents = 1 if number in {1, 5} else 2
        assert_figures(ducts[f"elbow.{number}"], {"area": girth * tangents * 400.0 * tan(radians(90 / 8))})
    for number in range(1, 5):
        here, there = (ducts[f"elbow.{n}"]["flat"]["edges"] for n in (number, number + 1))
        assert_relative(here["c1"], there["c0"], bound=LAST_DIGITS, why="the same seam")


def test_the_branch_and_the_tap_end_on_the_main(ducts: dict[str, dict]) -> None:
    """A ruling ends where the inside of the branch meets the inside of the main; it is rolled on the middle radius."""

    def branch(a: mpf) -> mpf:
        reach = mp.sqrt(MAIN**2 - (100 * mp.sin(a)) ** 2)
        return 380 - (100 * mp.cos(a) * mp.cos(mp.pi / 3) + reach) / mp.sin(mp.pi / 3)

    def tap(a: mpf) -> mpf:
        return 260 - mp.sqrt(MAIN**2 - (50 * mp.cos(a) - 80) ** 2)

    turn = [0, mp.pi, 2 * mp.pi]
    for name, radius, ruling in (("branch.1", 100, branch), ("tap", 50, tap)):
        middle = radius + HALF
        expected = {"area": middle * mp.quad(ruling, turn), "c0": middle * 2 * mp.pi}
        assert_figures(ducts[name], expected, "quadrature")


def test_the_reducer_is_a_right_cone_that_ends_on_a_plane(ducts: dict[str, dict]) -> None:
    """Each ruling ends at z = 220 + 0.2 x; of its sector the share (1 - z / H)^2 of the way to the apex is cut off."""
    apex = MAIN * 250 / mpf("57.5")
    slant = mp.hypot(MAIN, apex)

    def sector(a: mpf) -> mpf:
        lean = MAIN * mp.cos(a) / 5
        z = (220 + lean) / (1 + lean / apex)
        return MAIN * slant * (1 - (1 - z / apex) ** 2) / 2

    given = stage(ducts["reducer"], "unroll")["detail"]["given"]
    area = mp.quad(sector, [0, mp.pi, 2 * mp.pi])
    assert_relative(given["area"], float(area), bound=LAST_DIGITS, why="quadrature")
    assert_relative(given["edges"]["c0"], 315.0 * pi, bound=LAST_DIGITS, why="closed form")


def test_the_elbows_gores_fit_together_without_a_finding_on_their_seams(ducts: dict[str, dict]) -> None:
    for number in range(1, 6):
        stages = ducts[f"elbow.{number}"]["stages"]
        assert not [finding["code"] for entry in stages for finding in entry["findings"]]


@pytest.mark.parametrize(("name", "pitch"), [("transition", 60.0), ("reducer", 60.0), ("tap", 25.0)])
def test_the_lap_of_a_fitting_is_one_line_with_rivets_hole_on_hole(
    ducts: dict[str, dict], name: str, pitch: float
) -> None:
    detail, edges = stage(ducts[name], "unroll")["detail"], ducts[name]["flat"]["edges"]
    rows = {row["name"]: row for row in detail["stitches"]}
    start, end = rows["stitch-start"], rows["stitch-end"]
    assert start["count"] == end["count"] >= 2
    assert_relative([start["pitch"], edges["start"]], [end["pitch"], edges["end"]], bound=LAST_DIGITS, why="one line")
    assert abs(start["pitch"] - pitch) < pitch / start["count"], "an even division next to what is asked for"
    widened = ducts[name]["flat"]["cut"]["area"] - ducts[name]["flat"]["area"]
    both = 2 * 10.0 * edges["start"]
    assert 0.9 * both < widened < 1.1 * both, "10 mm on both sides, but for the corners"


def test_every_fitting_unrolls_without_change_of_length(ducts: dict[str, dict]) -> None:
    for part in ducts.values():
        assert figure(part, "unroll", "length_error")["value"] < LAST_DIGITS, part["name"]
