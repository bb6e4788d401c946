"""Paths in one pass: the extents of each are those of it alone, what is drawn stays on its arcs."""

import re

import numpy as np

from pipeline.report.traveller.paths import DECIMALS, OFF_MM, extents, joined, outlines
from pipeline.report.view.entries import PathView
from stages.geometry.paths.arcpath import ArcPath, bounds
from tests.near import assert_near

DISC = PathView(True, [-500.0, 0.0, 1.0, 500.0, 0.0, 1.0])
SLOT = PathView(True, [0.0, -5.0, 0.0, 80.0, -5.0, 1.0, 80.0, 5.0, 0.0, 0.0, 5.0, 1.0])
LINE = PathView(False, [1.0, 2.0, 0.0, 30.0, 40.0, 0.0])
ROUNDING = 2.0 * 10.0**-DECIMALS


def places(operators: str) -> np.ndarray:
    """Return points along what is drawn: ends of lines, and places along cubic pieces."""
    found: list[np.ndarray] = []
    for numbers, operator in re.findall(r"((?:-?[\d.]+ )+)([mlc])", operators):
        rows = np.array(numbers.split(), dtype=float).reshape(-1, 2)
        if operator != "c":
            found.append(rows)
            continue
        t = np.linspace(0.0, 1.0, 21)[:, None]
        a, b, c, d = found[-1][-1], *rows
        found.append((1 - t) ** 3 * a + 3 * (1 - t) ** 2 * t * b + 3 * (1 - t) * t**2 * c + t**3 * d)
    return np.concatenate(found)


def test_extents_are_those_of_each_path_alone() -> None:
    paths = [DISC, LINE, SLOT]
    for path, found in zip(paths, extents(joined(paths)), strict=True):
        rows = np.array(path.points).reshape(-1, 3)
        assert_near(found, bounds(ArcPath(rows[:, :2], rows[:, 2], path.closed)), bound=1e-9, why="hundreds of mm")


def test_arcs_are_drawn_to_what_can_be_seen() -> None:
    disc, line, slot = outlines(joined([DISC, LINE, SLOT]))
    radii = np.hypot(*places(disc).T)
    assert_near(radii, np.full_like(radii, 500.0), bound=OFF_MM + ROUNDING, why="cubic pieces are off outwards")
    assert line == "1 2 m 30 40 l"
    x, y = places(slot).T
    away = np.hypot(np.maximum(np.maximum(x - 80.0, -x), 0.0), y)
    assert_near(away, np.full_like(away, 5.0), bound=OFF_MM + ROUNDING, why="round ends, straight sides")


def test_every_path_begins_and_ends_where_it_does() -> None:
    for path, operators in zip((DISC, LINE, SLOT), outlines(joined([DISC, LINE, SLOT])), strict=True):
        drawn = places(operators)
        ends = np.array(path.points).reshape(-1, 3)[:, :2]
        assert_near(drawn[0], ends[0], bound=ROUNDING, why="decimals")
        assert_near(drawn[-1], ends[0] if path.closed else ends[-1], bound=ROUNDING, why="decimals")


def test_a_number_never_has_an_exponent() -> None:
    (operators,) = outlines(joined([PathView(False, [1e-17, 1e-7, 0.0, 123456.78901, -1e-5, 0.0])]))
    assert "e" not in operators
    assert operators == "0 0 m 123456.789 -0 l"
