"""The strakes of samples/strakes by a second method: rulings found one by one, in numbers of 40 digits."""

from itertools import pairwise

import pytest
from mpmath import mp, mpf

from tests.near import assert_relative
from tests.oracles import Antiderivative, Jet, Space, Vec, add, bezier, cross, dot, length, norm
from tests.samples import LAST_DIGITS, assert_figures, both_sides, made, run, stage

KEEL = [[0, 0, 60], [900, 0, -20], [1900, 0, -20], [2800, 0, 260]]
FIRST_CHINE = [[0, 380, 110], [900, 456, 40], [2050, 450, 190], [2850, 150, 330]]
SECOND_CHINE = [[0, 500, 270], [900, 600, 232], [2110, 630, 410], [2880, 240, 440]]
SHEER = [[-60, 560, 470], [834, 666, 452], [2150, 670, 540], [2920, 280, 570]]
LINES = [bezier(line) for line in (KEEL, FIRST_CHINE, SECOND_CHINE, SHEER)]
STRAKES = ("bottom", "bilge", "topside")
CASES = pytest.mark.parametrize(("name", "a", "b"), [(n, *ab) for n, ab in zip(STRAKES, pairwise(LINES), strict=True)])


@pytest.fixture(scope="module")
def strakes() -> dict[str, dict]:
    return made("strakes/job.toml")


def ruling(r: Jet, c: Jet) -> tuple[mpf, mpf, mpf]:
    """Return F = det(r', c - r, c') and its derivatives along r and c."""
    p = add(c[0], r[0], -1)
    return dot(r[1], cross(p, c[1])), dot(r[2], cross(p, c[1])), dot(r[1], cross(p, c[2]))


def partner(rail_a: Space, rail_b: Space, t: mpf) -> mpf:
    """Return where on rail_b the ruling from rail_a(t) ends, from the same parameter on by Newton's steps."""
    r, s = rail_a(t), t
    for _ in range(50):
        f, _, by_s = ruling(r, rail_b(s))
        step = f / by_s
        s -= step
        if abs(step) < mpf(10) ** -30:
            return s
    raise AssertionError(f"no ruling from {t}")


def strip_area(rail_a: Space, rail_b: Space) -> mpf:
    """Return the integral of (|p x r'| + |p x c'| ds/dt) / 2 over the rulings, ds/dt from dF = 0."""

    def element(t: mpf) -> mpf:
        s = partner(rail_a, rail_b, t)
        r, c = rail_a(t), rail_b(s)
        p = add(c[0], r[0], -1)
        _, by_t, by_s = ruling(r, c)
        return (norm(cross(p, r[1])) - norm(cross(p, c[1])) * by_t / by_s) / 2

    return Antiderivative(element)(1)


@CASES
def test_a_strake_keeps_its_lines_and_has_the_area_of_its_rulings(
    strakes: dict[str, dict], name: str, a: Space, b: Space
) -> None:
    part = strakes[name]
    expected = {"c0": length(a), "c1": length(b), "start": norm(add(b(mpf(0))[0], a(mpf(0))[0], -1))}
    assert_figures(part, expected, "quadrature")
    assert_relative(both_sides(part, "area"), [float(strip_area(a, b))] * 2, bound=LAST_DIGITS, why="quadrature")


def test_neighbours_meet_along_the_whole_of_a_line(strakes: dict[str, dict]) -> None:
    for lower, upper in pairwise(strakes[name]["flat"]["edges"] for name in STRAKES):
        assert_relative(lower["c1"], upper["c0"], bound=LAST_DIGITS, why="the same line")


def test_the_lines_agree_at_the_ends_so_that_no_cone_is_needed(strakes: dict[str, dict]) -> None:
    for name in STRAKES:
        assert [piece["kind"] for piece in strakes[name]["surface"]["pieces"]] == ["ruled"]
    for a, b in pairwise(LINES):
        assert [ruling(a(mpf(v)), b(mpf(v)))[0] for v in (0, 1)] == [0, 0]


def bending_radius(rail: Jet, p: Vec) -> mpf:
    """Return the radius across a ruling p at a point of a rail: II(r', r') = |r' across p|^2 / radius."""
    along = dot(rail[1], p) / dot(p, p)
    across = add(rail[1], p, -along)
    normal = cross(rail[1], p)
    return dot(across, across) * norm(normal) / abs(dot(rail[2], normal))


@CASES
def test_the_roll_schedule_begins_and_ends_with_the_radii_of_the_surface(
    strakes: dict[str, dict], name: str, a: Space, b: Space
) -> None:
    rows = stage(strakes[name], "unroll")["detail"]["rolls"]
    for row, v in ((rows[0], mpf(0)), (rows[-1], mpf(1))):
        p = add(b(v)[0], a(v)[0], -1)
        inside = [float(bending_radius(rail(v), p)) - 1.5 for rail in (a, b)]
        assert_relative(row["radius_mm"], inside, bound=1e-9, why="closed form, less half the sheet")


def test_the_hood_is_four_triangles_and_four_cones(strakes: dict[str, dict]) -> None:
    r, a, h = mpf(80), mpf(250), mpf(300)
    cone = mp.quad(lambda x: r * mp.sqrt(h**2 + (r - a * (mp.cos(x) + mp.sin(x))) ** 2), [0, mp.pi / 2]) / 2
    area = 4 * (a * mp.hypot(a - r, h) + cone)
    assert_figures(strakes["hood"], {"area": area, "c0": 8 * a, "c1": 2 * mp.pi * r}, "quadrature")
    kinds = [piece["kind"] for piece in strakes["hood"]["surface"]["pieces"]]
    assert (kinds.count("cone"), kinds.count("triangle")) == (4, 4)


def fold_deg(first: Vec, second: Vec, tips: tuple[Vec, Vec]) -> float:
    """Return by how much two triangles on one diagonal are folded, degrees."""
    diagonal = add(second, first, -1)
    one, other = (cross(diagonal, add(tip, first, -1)) for tip in tips)
    return float(mp.degrees(mp.pi - mp.atan2(norm(cross(one, other)), dot(one, other))))


def test_two_straight_lines_are_refused_with_a_bound_a_place_and_a_cure() -> None:
    report, code, files = run("strakes/as-drawn.toml")
    assert (code, report["status"]) == (1, "rejected")
    assert not [file for file in files if file.endswith(".dxf")]
    (finding,) = [f for f in stage(report["parts"][0], "construct")["findings"] if f["fatal"]]
    assert finding["code"] == "no-smooth-strip"
    assert 'folds = "allow"' in finding["message"]
    assert set(finding["where"]) == {"a", "b"}
    chine, sheer = [(0, 500, 270), (2800, 240, 440)], [(0, 560, 470), (2800, 420, 600)]
    (a, b), (c, d) = ([tuple(map(mpf, point)) for point in line] for line in (chine, sheer))
    single = min(fold_deg(a, d, (b, c)), fold_deg(b, c, (a, d)))
    said = float(finding["message"].split("the largest ")[1].split(" deg")[0])
    assert said <= single * (1 + 1e-5), "no worse than two triangles on the better diagonal; six digits are written"
    least = float(finding["message"].split("at least ")[1].split(" deg")[0])
    assert 0.0 < least < said
