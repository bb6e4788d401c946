"""Strips between rails: reference surfaces, random pairs solved or refused with a bound, kinks, seams, refusals."""

from fractions import Fraction
from functools import cache
from itertools import pairwise
from math import degrees, pi

import numpy as np
import pytest

from stages.construct.railkind import rail_strip
from stages.construct.rails import pieces
from stages.geometry.curves.curves import Bezier, bezier, exactly
from stages.geometry.rails.graph import Rules
from stages.geometry.rails.strip import bounds, open_strip
from stages.geometry.ruled.joins import join
from stages.geometry.ruled.ruled import warp
from stages.model.rails import Rails
from stages.model.surface import RuledSurface
from stages.model.tolerances import Tolerances
from tests.near import assert_near, assert_relative
from tests.parts import Passage, Table, passage, read, troubles

SQUARE = [[1.5, -1.5, 0], [1.5, 1.5, 0], [-1.5, 1.5, 0], [-1.5, -1.5, 0], [1.5, -1.5, 0]]
ROUND: Table = {"circle": {"center": [0, 0, 2], "radius": 1, "normal": [0, 0, 1]}}
SKEW = {"line": [[0, 0, 0], [4, 0, 0]]}, {"line": [[0, 0, 2], [3, 2, 2]]}


def rails(a: Table, b: Table, **keys: object) -> Table:
    return {"kind": "rails", "rail_a": a, "rail_b": b} | keys


@cache
def over_square(*, exchanged: bool = False) -> Passage:
    """Return what becomes of the circle over the square."""
    return passage(rails({"polyline": SQUARE}, ROUND) if exchanged else rails(ROUND, {"polyline": SQUARE}))


def area(made: Passage) -> float:
    value = made.side("surface")["area"]
    assert isinstance(value, float)
    return value


def kinds(made: Passage) -> list[str]:
    found = made.reports["construct"].detail["pieces"]
    assert isinstance(found, list)
    return sorted(row["kind"] for row in found)


def rotated(points: list[list[float]], by: int) -> list[list[float]]:
    return [*points[by:-1], *points[: by + 1]]


@pytest.mark.parametrize(("by", "backwards"), [(0, False), (1, True), (2, False), (3, True)])
def test_a_circle_over_a_square_takes_four_triangles_and_four_cones(by: int, backwards: bool) -> None:
    """Whatever corner the square begins in and whichever way it runs: seam and sense are found."""
    points = rotated(SQUARE, by)
    surface = rails(ROUND, {"polyline": points[::-1] if backwards else points})
    made = passage(surface) if by else over_square()
    assert kinds(made) == ["cone"] * 4 + ["triangle"] * 4
    assert_relative([area(made)], [19.2931879458967], bound=1e-13, why="15 digits are known")
    assert made.value("construct", "join_normal_deg") < 1e-12
    assert made.value("verify", "max_warp_deg") <= 1e-9


def test_the_rails_may_be_exchanged() -> None:
    assert_relative([area(over_square(exchanged=True))], [19.2931879458967], bound=1e-13, why="the same strip")


def test_the_pieces_of_a_strip_begin_where_the_ones_before_end() -> None:
    """Exactly, by the parameters of the report: no 1e-32 beside a 0."""
    for exchanged in (False, True):
        rows = over_square(exchanged=exchanged).reports["construct"].detail["pieces"]
        assert isinstance(rows, list)
        for rail in ("a", "b"):
            ends = [row[rail] for row in rows]
            assert [end for _, end in ends[:-1]] == [start for start, _ in ends[1:]]


@pytest.mark.parametrize("minor", [[1, 0, 0], [-1, 0, 0]])
def test_an_ellipse_over_an_ellipse_is_one_ruled_strip(minor: list[int]) -> None:
    lower = {"ellipse": {"center": [0, 0, 0], "major": [2, 0, 0], "minor": [0, 1, 0]}}
    surface = rails(lower, {"ellipse": {"center": [0, 0, 2], "major": [0, 2, 0], "minor": minor}})
    made = passage(surface)
    assert set(kinds(made)) == {"ruled"}
    assert_relative([area(made)], [20.7300282819194], bound=1e-13, why="15 digits are known")
    assert_relative([made.side("surface")["edges"]["c0"]], [9.68844822054768], bound=1e-13, why="the ellipse")
    assert made.value("verify", "max_warp_deg") <= 1e-9


def test_skew_lines_are_refused_with_a_bound_and_the_best_fold() -> None:
    made = passage(rails(*SKEW))
    assert made.refused_by == "construct"
    (finding,) = made.reports["construct"].findings
    assert finding.code == "no-smooth-strip"
    assert "1 fold, the largest 53.9601 deg" in finding.message
    assert "trim" not in finding.message, "no part of skew lines has a strip"
    assert 'folds = "allow"' in finding.message
    coarse, fine = bounds(*((bezier([[Fraction(x) for x in p] for p in line["line"]]),) for line in SKEW))
    assert 0.0 < degrees(coarse.fold_rad) <= degrees(fine.fold_rad) + 1e-2
    assert degrees(fine.fold_rad) <= 53.9601066


def test_skew_lines_fold_along_the_better_diagonal_where_that_is_allowed() -> None:
    made = passage(rails(*SKEW, folds="allow"))
    assert_near(made.value("construct", "join_normal_deg"), 53.960106569696, bound=1e-10, why="two planes")
    assert "folds" in made.codes("construct", fatal=False)
    assert made.value("verify", "max_warp_deg") == 0.0
    for most, fatal in ((54, False), (33, True)):  # 33.69 deg is a lower bound
        spec = read(rails(*SKEW, max_warp=most)).surface
        assert isinstance(spec, Rails)
        assert any(finding.fatal for finding in rail_strip(spec, Tolerances()).findings) == fatal


def random_pair(seed: int, amplitude: float) -> tuple[Bezier, Bezier]:
    """Return two cubics over 6 of length, 2.5 apart, their control points off by some amplitude."""
    rng = np.random.default_rng(seed)
    x = np.linspace(0.0, 6.0, 4)
    made = []
    for level in (0.0, 2.5):
        points = np.stack([x, rng.normal(0.0, amplitude, 4), level + rng.normal(0.0, amplitude, 4)], axis=1)
        made.append(bezier([exactly(point) for point in points]))
    return made[0], made[1]


@pytest.mark.parametrize("amplitude", [0.2, 0.5, 1.0])
def test_a_random_pair_has_an_exact_strip_or_a_bound_on_its_folds(amplitude: float) -> None:
    solved = 0
    for seed in range(4):
        a, b = random_pair(seed, amplitude)
        strip = open_strip((a,), (b,), Rules())
        if strip is None:
            coarse, fine = bounds((a,), (b,))
            assert max(coarse.fold_rad, fine.fold_rad) > np.radians(1e-3), f"seed {seed}: neither strip nor bound"
            continue
        solved += 1
        patches = [piece.patch for piece in pieces(strip)]
        v = np.linspace(0.0, 1.0, 65)[1:-1]
        assert max(float(warp(patch, v).max()) for patch in patches) < np.radians(1e-9)
        joins = [join(p, q) for p, q in pairwise(patches)]
        assert max((met.normal_rad for met in joins), default=0.0) < np.radians(1e-6)
        assert max((met.gap_mm for met in joins), default=0.0) < 1e-11
        ends = [patches[0].c0.jet(np.zeros(1), 0)[0, 0], patches[-1].c1.jet(np.ones(1), 0)[0, 0]]
        assert_near(ends, [a.points[0], b.points[-1]], bound=1e-12, why="from the first points to the last")
    assert solved >= (amplitude < 0.5)


NEARLY = (
    [[0, -0.006375583, -0.107204882], [2, -0.098429587, 0.013406896], [4, 0.005970697, -0.113097991],
     [6, -0.085189022, 0.222667448]],
    [[0.012829628, 0.454177263, 2.334939194], [2.053105662, 0.161681919, 2.436371205],
     [4.072109334, 0.371156653, 2.840088024], [6.035330536, -0.390842236, 2.306226751]],
)  # fmt: skip


def test_two_small_folds_are_named_where_the_single_one_is_large() -> None:
    """One fold is 13.1 deg at least; 1.3 deg is what no strip avoids, and two folds come close to it."""
    spec = read(rails(*({"bezier": points} for points in NEARLY), folds="allow")).surface
    assert isinstance(spec, Rails)
    built = rail_strip(spec, Tolerances())
    folds, smaller = (finding.message for finding in built.findings if "folds" in finding.code)
    assert folds == "the strip folds along 1 ruling, by at most 13.0912 deg"
    assert smaller.startswith("another strip has 2 folds, the largest 1.317")
    most = float(smaller.split()[-1])
    again = read(rails(*({"bezier": points} for points in NEARLY), max_warp=most)).surface
    assert isinstance(again, Rails)
    assert "along 2 rulings" in next(f.message for f in rail_strip(again, Tolerances()).findings if f.code == "folds")


def test_rails_of_many_pieces_are_run_through_without_cones() -> None:
    """The ellipses again, interpolated: breaks without kinks make none."""
    angles = np.linspace(0.0, 2.0 * pi, 7)[:-1]
    low = [[float(2 * np.cos(a)), float(np.sin(a)), 0.0] for a in angles]
    high = [[float(np.cos(a + 0.1)), float(2 * np.sin(a + 0.1)), 2.0] for a in angles]
    spec = read(rails({"points": [*low, low[0]]}, {"points": [*high, high[0]]})).surface
    assert isinstance(spec, Rails)
    built = rail_strip(spec, Tolerances())
    assert not built.findings
    assert isinstance(built.detail["pieces"], list)
    assert {row["kind"] for row in built.detail["pieces"]} == {"ruled"}
    assert max(join(p, q).normal_rad for p, q in pairwise(built.patches)) < 1e-9


def test_a_least_radius_refuses_cones_on_a_rail() -> None:
    made = passage(rails(ROUND, {"polyline": SQUARE}, min_radius=0.1))
    assert made.codes("construct", fatal=True) == ["min-radius"]


@pytest.mark.parametrize(("factor", "codes"), [(0.999, []), (1.001, ["min-radius"])])
def test_a_least_radius_refuses_a_ruled_strip_that_bends_more_sharply(factor: float, codes: list[str]) -> None:
    """A quarter of a pipe of radius 50."""
    arc = {"radius": 50, "normal": [0, 0, 1], "start": 0, "end": 90}
    low, high = ({"arc": arc | {"center": [0, 0, z]}} for z in (0, 80))
    spec = read(rails(low, high, min_radius=50 * factor)).surface
    assert isinstance(spec, Rails)
    assert [finding.code for finding in rail_strip(spec, Tolerances()).findings] == codes


@pytest.mark.parametrize(
    ("a", "b", "words"),
    [
        (ROUND, {"line": [[0, 0, 0], [1, 0, 0]]}, "rail_a is closed and rail_b is open"),
        (ROUND, ROUND, "the same curve as rail_a"),
        ({"line": [[0, 0], [1, 0]]}, {"line": [[0, 0, 1], [1, 0, 1]]}, "a point with two coordinates"),
    ],
)
def test_what_the_job_file_alone_shows(a: Table, b: Table, words: str) -> None:
    assert words in troubles(rails(a, b))


def test_a_strip_is_a_surface_like_any_other() -> None:
    made = over_square()
    assert isinstance(made.surface, RuledSurface)
    assert made.pattern is not None
    assert_near(made.value("unroll", "area_error"), 0.0, bound=1e-14, why="quadrature")


S_SHAPED = [[0, 0, 0], [3, 4, 1], [6, -3, 0], [9, 2, 2]]
TOP = [6, 1, 9]


def on_one_cone(weight: str, points: list[list[int]] = S_SHAPED) -> Table:
    """Return two rails of the cone with its apex at TOP, the second half-way: its s is t of the same ruling by
    t = w s / (1 - s + w s), since its weights are 1, w, w^2 and w^3."""
    half = [[str(Fraction(x + a) / 2) for x, a in zip(point, TOP, strict=True)] for point in points]
    weights = [str(Fraction(weight) ** k) for k in range(4)]
    knots = [0] * 4 + [1] * 4
    b = {"bspline": {"degree": 3, "knots": knots, "points": half, "weights": weights}}
    return rails({"bezier": points}, b)


@pytest.mark.parametrize("weight", ["1/10", "2/5", "3/5", "7/5", "29/10", "12", "20"])
def test_rails_of_one_cone_need_no_apex_on_a_rail_where_they_bend_back(weight: str) -> None:
    """Another arc crosses at the inflection, through the same side of a cell: with the lattice alone that is unseen."""
    made = passage(on_one_cone(weight))
    assert kinds(made) == ["ruled", "ruled"]
    found = made.reports["construct"].detail["pieces"]
    assert isinstance(found, list)
    w, (t, s) = float(Fraction(weight)), (found[0][rail][1] for rail in "ab")
    assert_near([t], [w * s / (1.0 - s + w * s)], bound=1e-12, why="one ruling of the cone")
    assert "sharp-apex" not in made.codes("verify")
    assert_relative([made.side("flat")["area"]], [made.side("surface")["area"]], bound=1e-13, why="an isometry")
