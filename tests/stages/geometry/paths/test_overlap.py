"""Where paths run along each other: by closed form, and nowhere else."""

from math import pi, sqrt, tan

import numpy as np
import pytest

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, backwards, split, transform
from stages.geometry.paths.overlap import Overlap, overlaps
from tests.near import assert_near

APART, LEAST = 1e-3, 0.01
EXACT = 1e-9
RADIUS = 10.0
CIRCLE = ArcPath(np.array([[RADIUS, 0.0], [-RADIUS, 0.0]]), np.ones(2), closed=True)
"""Two half circles, counter-clockwise from the right."""


def line(*points: tuple[float, float]) -> ArcPath:
    return ArcPath(np.array(points, dtype=np.float64), np.zeros(len(points)), closed=False)


def arc(start: float, sweep: float) -> ArcPath:
    """Return a part of the circle, angles in rad."""
    ends = RADIUS * np.array([[np.cos(at), np.sin(at)] for at in (start, start + sweep)])
    return ArcPath(ends, np.array([tan(sweep / 4.0), 0.0]), closed=False)


def found(*paths: ArcPath) -> list[Overlap]:
    return overlaps(paths, apart=APART, least=LEAST)


@pytest.mark.parametrize("turn", [0.0, 33.0, 90.0])
@pytest.mark.parametrize("other", [line((3.0, 0.0), (20.0, 0.0)), line((20.0, 0.0), (3.0, 0.0))])
def test_lines_share_what_lies_within_both(other: ArcPath, turn: float) -> None:
    paths = [transform(path, Rigid2(5.0, -2.0, turn)) for path in (line((0.0, 0.0), (10.0, 0.0)), other)]
    (shared,) = found(*paths)
    assert (shared.first, shared.second) == (0, 1)
    assert_near(shared.length_mm, 7.0, bound=EXACT, why="from 3 to 10")


@pytest.mark.parametrize(("start", "sweep"), [(0.3, 1.0), (-2.0, 3.0), (1.0, -0.5)])
def test_arcs_share_what_lies_within_both_however_they_are_divided(start: float, sweep: float) -> None:
    part = arc(start, sweep)
    for circle in (CIRCLE, backwards(CIRCLE), split(CIRCLE, max_bulge=0.1)):
        (shared,) = found(circle, split(part, max_bulge=0.3))
        assert_near(shared.length_mm, RADIUS * abs(sweep), bound=1e-6, why="the part lies on the circle")


def test_a_path_that_runs_back_along_itself_overlaps_with_itself() -> None:
    (shared,) = found(line((0.0, 0.0), (10.0, 0.0), (10.0, 5.0), (10.0, 0.0), (4.0, 0.0)))
    assert (shared.first, shared.second) == (0, 0)
    assert_near(shared.length_mm, 5.0 + 6.0, bound=EXACT, why="up and down, and back from 10 to 4")


@pytest.mark.parametrize(
    "other",
    [
        line((5.0, -5.0), (5.0, 5.0)),
        line((10.0, 0.0), (20.0, 0.0)),
        line((0.0, 2.0 * APART), (10.0, 2.0 * APART)),
        line((0.0, -0.1), (10.0, 0.1)),
        arc(-pi / 2.0, 0.2),
        line((3.0, 0.0), (3.0 + 0.9 * LEAST, 0.0)),
    ],
    ids=["crosses", "goes on", "beside", "at a small angle", "elsewhere", "too short to count"],
)
def test_nothing_else_is_an_overlap(other: ArcPath) -> None:
    assert found(line((0.0, 0.0), (10.0, 0.0)), other) == []


def test_an_arc_that_touches_a_line_is_beside_it_for_less_than_counts() -> None:
    """An arc of radius 10 leaves its tangent by a thousandth of a millimetre after 0.14 mm: pieces are longer."""
    assert found(line((-8.0, -RADIUS), (8.0, -RADIUS)), arc(-pi / 2.0 - 0.5, 1.0)) == []
    assert sqrt(2.0 * RADIUS * APART) < RADIUS / 4.0


def test_a_piece_of_no_length_shares_nothing() -> None:
    assert found(line((0.0, 0.0), (10.0, 0.0), (10.0, 0.0), (20.0, 0.0))) == []
