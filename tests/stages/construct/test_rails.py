"""Strips between rails: reference surfaces, random pairs solved or refused with a bound, kinks, seams, refusals."""

from fractions import Fraction
from itertools import pairwise
from math import degrees, pi

import numpy as np
import pytest

from stages.construct.railkind import rail_strip
from stages.construct.rails import pieces
from stages.geometry.curves import Bezier, bezier, exactly
from stages.geometry.joins import join
from stages.geometry.railgraph import Rules
from stages.geometry.railstrip import bounds, open_strip
from stages.geometry.ruled import warp
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


@pytest.mark.parametrize("by", range(4))
@pytest.mark.parametrize("backwards", [False, True])
def test_a_circle_over_a_square_takes_four_triangles_and_four_cones(by: int, backwards: bool) -> None:
    """Whatever corner the square begins in and whichever way it runs: seam and sense are found."""
    points = rotated(SQUARE, by)
    surface = rails(ROUND, {"polyline": points[::-1] if backwards else points})
    made = passage(surface)
    assert kinds(made) == ["cone"] * 4 + ["triangle"] * 4
    assert_relative([area(made)], [19.2931879458967], bound=1e-13, why="15 digits are known")
    assert made.value("construct", "join_normal_deg") < 1e-12
    assert made.value("verify", "max_warp_deg") <= 1e-9


def test_the_rails_may_be_exchanged() -> None:
    assert_relative(
        [area(passage(rails({"polyline": SQUARE}, ROUND)))], [19.2931879458967], bound=1e-13, why="the same strip"
    )


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
    coarse, fine = bounds(*((bezier([[Fraction(x) for x in p] for p in line["line"]]),) for line in SKEW))
    assert 0.0 < degrees(coarse.fold_rad) <= degrees(fine.fold_rad) + 1e-2
    assert degrees(fine.fold_rad) <= 53.9601066


def test_skew_lines_fold_along_the_better_diagonal_where_that_is_allowed() -> None:
    made = passage(rails(*SKEW, folds="allow"))
    assert_near(made.value("construct", "join_normal_deg"), 53.960106569696, bound=1e-10, why="two planes")
    assert "folds" in made.codes("construct", fatal=False)
    assert made.value("verify", "max_warp_deg") == 0.0
    enough = passage(rails(*SKEW, max_warp=54))
    assert enough.refused_by is None
    assert passage(rails(*SKEW, max_warp=33)).refused_by == "construct", "33.69 deg is a lower bound"


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


def test_rails_of_many_pieces_are_run_through_without_cones() -> None:
    """The ellipses again, interpolated: breaks without kinks make none."""
    angles = np.linspace(0.0, 2.0 * pi, 9)[:-1]
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


def test_a_least_radius_refuses_a_ruled_strip_that_bends_more_sharply() -> None:
    lower = {"ellipse": {"center": [0, 0, 0], "major": [2, 0, 0], "minor": [0, 1, 0]}}
    upper = {"ellipse": {"center": [0, 0, 2], "major": [0, 2, 0], "minor": [1, 0, 0]}}
    free = passage(rails(lower, upper, min_radius=0.1))
    assert free.refused_by is None
    radius = free.value("verify", "min_bend_radius_mm")
    assert isinstance(radius, float)
    for factor, codes in ((0.999, []), (1.01, ["min-radius"])):
        spec = read(rails(lower, upper, min_radius=factor * radius)).surface
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
    made = passage(rails(ROUND, {"polyline": SQUARE}))
    assert isinstance(made.surface, RuledSurface)
    assert made.pattern is not None
    assert_near(made.value("unroll", "area_error"), 0.0, bound=1e-14, why="quadrature")
