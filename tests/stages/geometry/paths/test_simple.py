"""The quick proof that contours do not meet themselves: never given wrongly, given for ordinary ones."""

from math import cos, pi, sin, tan

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import Polygon

from stages.geometry.paths.arcpath import ArcPath, backwards, polygon
from stages.geometry.paths.simple import certainly_simple

APART = 1e-3


def closed(corners: list[tuple[float, float]], bulges: list[float] | None = None) -> ArcPath:
    return ArcPath(np.array(corners, dtype=float), np.array(bulges or [0.0] * len(corners)), closed=True)


def known(*paths: ArcPath) -> list[bool]:
    found = certainly_simple(paths, apart=APART)
    assert certainly_simple([backwards(path) for path in paths], apart=APART).tolist() == found.tolist()
    return found.tolist()


QUARTER = tan(pi / 8.0)
ORDINARY = {
    "a rectangle": closed([(0, 0), (100, 0), (100, 50), (0, 50)]),
    "a circle of two halves": closed([(50, 0), (-50, 0)], [1.0, 1.0]),
    "a slot": closed([(0, 0), (100, 0), (100, 20), (0, 20)], [0.0, 1.0, 0.0, 1.0]),
    "a rounded corner": closed([(0, 0), (90, 0), (100, 10), (100, 50), (0, 50)], [0.0, QUARTER, 0.0, 0.0, 0.0]),
    "a sharp triangle": closed([(0, 0), (100, 0), (100, 25)]),
    "a crescent of thick arcs": closed([(50, 0), (-50, 0), (-40, 0), (40, 0)], [1.0, 0.0, -1.0, 0.0]),
}
MEETING = {
    "a bow-tie": closed([(0, 0), (100, 100), (100, 0), (0, 100)]),
    "a spike": closed([(0, 0), (100, 0), (100, 50), (100, 90), (100, 50), (0, 50)]),
    "a needle": closed([(0, 0), (100, 0), (100, 0.5)]),
    "a line there and back": closed([(0, 0), (100, 0)]),
    "a vertex on an edge": closed([(0, 0), (100, 0), (100, 50), (50, 0), (0, 50)]),
    "edges nearer than asked": closed([(0, 0), (100, 0), (100, 5e-4), (0, 5e-4)]),
    "an arc through an edge": closed([(0, 0), (100, 0), (100, 50), (0, 50)], [-1.0, 0.0, -1.0, 0.0]),
    "a vertex twice": closed([(0, 0), (0, 0), (100, 0), (100, 50)]),
}


@pytest.mark.parametrize("name", ORDINARY)
def test_ordinary_contours_are_known_to_be_simple(name: str) -> None:
    assert known(ORDINARY[name]) == [True]


@pytest.mark.parametrize("name", MEETING)
def test_contours_that_meet_themselves_are_never_called_simple(name: str) -> None:
    assert known(MEETING[name]) == [False]


def test_each_of_many_is_judged_by_itself() -> None:
    paths = [*ORDINARY.values(), *MEETING.values(), *ORDINARY.values()]
    assert known(*paths) == [True] * len(ORDINARY) + [False] * len(MEETING) + [True] * len(ORDINARY)


@given(st.lists(st.tuples(st.floats(5.0, 50.0), st.floats(-0.9, 0.9)), min_size=3, max_size=9), st.booleans())
@settings(max_examples=150, deadline=None)
def test_what_is_called_simple_is_a_valid_polygon(rays: list[tuple[float, float]], shuffled: bool) -> None:
    angles = [2.0 * pi * i / len(rays) for i in range(len(rays))]
    order = list(range(0, len(rays), 2)) + list(range(1, len(rays), 2)) if shuffled else list(range(len(rays)))
    corners = [(rays[i][0] * cos(angles[i]), rays[i][0] * sin(angles[i])) for i in order]
    path = closed(corners, [rays[i][1] for i in order])
    if known(path) == [True]:
        assert Polygon(polygon(path, accuracy=APART / 4.0)).is_valid
