"""Drawings on many pages of a usual size: which show something, that they cover it, and how they are laid together."""

import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stages.geometry.paths.arcpath import ArcPath
from stages.model.cutfile import Machine, Paper
from stages.model.pattern import FlatPattern
from stages.write.drawing import Drawing, Item
from stages.write.pdfpages import REGISTER_LAYER, drawing_pdf, too_many_pages
from stages.write.tiles import BORDER_MM, MOST_PAGES, OVERLAP_MM, PAPERS, Grid, Tile, tiling
from tests.near import assert_near
from tests.stages.write.patterns import drop, plate, sector, strip
from tests.stages.write.pictures import pdf_shapes
from tests.stages.write.test_pdf import check_ends, contents, flat, pages

A4 = Machine(also=("pdf",), paper="A4")


def tiled(part: FlatPattern, paper: Paper = "A4") -> str:
    return drawing_pdf(flat(part), Machine(also=("pdf",), paper=paper))


def test_a_part_that_fits_one_page_takes_one() -> None:
    assert_near(pages(tiled(plate())), [PAPERS["A4"]], bound=1e-6, why="upright, six decimals of a point")


def test_every_page_has_its_own_place_and_100_mm() -> None:
    text = tiled(strip())
    assert_near(pages(text), [PAPERS["A4"][::-1]] * 6, bound=1e-6, why="628 x 300 mm and more: two rows of three")
    found = contents(text)
    places = [re.search(r"row (\d) of 2, column (\d) of 3", content) for content in found]
    assert [place and place.groups() for place in places] == [(row, column) for row in "12" for column in "123"]
    for content in found:
        (x0, y0), (x1, y1) = check_ends(content)
        assert_near([x1 - x0, y1 - y0], [100.0, 0.0], bound=1e-9, why="exact")
        assert y0 < BORDER_MM


def window(content: str) -> tuple[np.ndarray, np.ndarray]:
    """Return what a page shows of the drawing: from and to, in its frame."""
    frame = re.search(r"(\S+) (\S+) (\S+) (\S+) re W n 1 0 0 1 (\S+) (\S+) cm /D Do", content)
    assert frame is not None
    x, y, width, height, right, up = map(float, frame.groups())
    low = np.array([x - right, y - up])
    return low, low + np.array([width, height])


@pytest.mark.parametrize("part", [strip(), sector(), drop(), plate()], ids=lambda part: part.part)
@pytest.mark.parametrize("paper", ["A4", "A3"])
def test_the_pages_together_show_all_of_the_drawing(part: FlatPattern, paper: Paper) -> None:
    text = tiled(part, paper)
    windows = [window(content) for content in contents(text)]
    points = np.concatenate([shape.points for shape in pdf_shapes(text)])
    shown = [((low <= points) & (points <= high)).all(axis=1) for low, high in windows]
    assert np.any(shown, axis=0).all()


def crosses_on(content: str) -> np.ndarray:
    """Return the places of the crosses that a page draws, shape (n, 2), in the frame of the drawing."""
    register = content[: content.index("EMC")]
    level = re.findall(r"\n(\S+) (\S+) m (\S+) \2 l S", register)
    return np.array([[(float(x) + float(to_x)) / 2.0, float(y)] for x, y, to_x in level]).reshape(-1, 2)


def test_neighbours_overlap_and_show_the_same_crosses() -> None:
    text = tiled(strip())
    found = contents(text)
    windows = [window(content) for content in found]
    assert_near(windows[0][1][0] - windows[1][0][0], OVERLAP_MM, bound=1e-9, why="ten decimals")
    assert_near(windows[3][1][1] - windows[0][0][1], OVERLAP_MM, bound=1e-9, why="ten decimals")
    crosses = np.unique(np.concatenate([crosses_on(content) for content in found]), axis=0)
    seen = [
        np.flatnonzero([(low < cross).all() and (cross < high).all() for low, high in windows]) for cross in crosses
    ]
    neighbours = [(0, 1), (0, 3), (1, 2), (1, 4), (2, 5), (3, 4), (4, 5)]
    assert sorted(map(tuple, map(np.ndarray.tolist, seen))) == sorted(neighbours * 2)


def box(width: float, height: float, x: float = 0.0) -> ArcPath:
    corners = np.array([[x, 0.0], [x + width, 0.0], [x + width, height], [x, height]])
    return ArcPath(corners, np.zeros(4), closed=True)


def laid(
    extent: tuple[float, float, float, float], path: ArcPath, paper: Paper = "A4"
) -> tuple[Grid, tuple[Tile, ...]]:
    found = tiling(extent, [path], paper)
    assert found is not None
    return found.grid, found.tiles


def test_pages_on_which_there_is_nothing_are_left_out_and_all_else_is_there() -> None:
    """An L of two arms of 1000 x 20 mm: their corner and what they cover, not the square between them."""
    corners = np.array([[0.0, 0.0], [1000.0, 0.0], [1000.0, 20.0], [20.0, 20.0], [20.0, 1000.0], [0.0, 1000.0]])
    path = ArcPath(corners, np.zeros(6), closed=True)
    grid, tiles = laid((0.0, 0.0, 1000.0, 1000.0), path)
    assert len(tiles) == grid.rows + grid.columns - 1
    assert {(tile.row, tile.column) for tile in tiles} == {
        *((row + 1, 1) for row in range(grid.rows)), *((grid.rows, column + 1) for column in range(grid.columns)),
    }  # fmt: skip


def test_pages_within_a_part_are_there() -> None:
    grid, tiles = laid((0.0, 0.0, 900.0, 900.0), box(900.0, 900.0))
    assert len(tiles) == grid.rows * grid.columns > 9


@given(st.floats(1.0, 4000.0), st.floats(1.0, 4000.0), st.floats(-1e4, 1e4), st.sampled_from(["A4", "A3"]))
def test_pages_cover_any_extent_with_no_row_too_many(width: float, height: float, x: float, paper: Paper) -> None:
    grid, tiles = laid((x, 0.0, x + width, height), box(width, height, x), paper)
    wide, high = grid.window_mm
    low = np.array([[tile.x, tile.y] for tile in tiles]).min(axis=0)
    top = np.array([[tile.x + wide, tile.y + high] for tile in tiles]).max(axis=0)
    assert (low <= np.array([x, 0.0]) + 1e-9).all()
    assert (top >= np.array([x + width, height]) - 1e-9).all()
    for count, long, shown in ((grid.columns, width, wide), (grid.rows, height, high)):
        assert count == 1 or (count - 1) * (shown - OVERLAP_MM) + OVERLAP_MM < long + 1e-6


def drawn(path: ArcPath) -> Drawing:
    return Drawing("flat/big.dxf", (Item("CUT_OUTER", "big", path),), ())


def test_a_page_holds_its_own_crosses_and_no_others_however_many_pages_there_are() -> None:
    for side in (900.0, 3000.0):
        found = contents(drawing_pdf(drawn(box(side, side)), A4))
        for content in found:
            low, high = window(content)
            crosses = crosses_on(content)
            assert ((low < crosses) & (crosses < high)).all()
            assert 4 <= len(crosses) <= 8, "two to each neighbour"


def square_of(rows: int, columns: int) -> ArcPath:
    """Return a square that so many A4 pages show, upright as they are fewer."""
    wide, high = (side - 2.0 * BORDER_MM - OVERLAP_MM for side in PAPERS["A4"])
    return box(columns * wide, rows * high)


def test_a_ream_of_pages_and_no_more_are_laid_together() -> None:
    most, more = drawn(square_of(20, 25)), drawn(square_of(21, 25))
    assert len(pages(drawing_pdf(most, A4))) == MOST_PAGES == 20 * 25
    assert not list(too_many_pages(most, A4))
    text = drawing_pdf(more, A4)
    assert_near(pages(text), [(25 * 176.0 + 30.0, 21 * 263.0 + 30.0)], bound=1e-6, why="the drawing and its margins")
    assert REGISTER_LAYER not in text
    (finding,) = too_many_pages(more, A4)
    assert (finding.code, finding.fatal) == ("pdf-pages", False)
    assert finding.where == {"file": "flat/big.pdf", "rows": 21, "columns": 25}
    assert "4.4 x 5.523 m" in finding.message
    assert not list(too_many_pages(more, replace(A4, paper="fit")))
    assert not list(too_many_pages(more, replace(A4, paper="A3")))


@pytest.mark.parametrize("side", [1e5, 1e8])
def test_what_spans_more_rows_and_columns_is_not_looked_at(side: float) -> None:
    assert tiling((0.0, 0.0, side, side), [], "A4") is None


def test_a_long_strip_across_the_pages_takes_those_on_its_way() -> None:
    """From corner to corner of 20 x 20 m: far more than a ream of pages, of which it crosses a few."""
    strip = ArcPath(np.array([[0.0, 0.0], [20_000.0, 20_000.0]]), np.zeros(2), closed=False)
    grid, tiles = laid((0.0, 0.0, 20_000.0, 20_000.0), strip)
    assert grid.rows + grid.columns - 1 <= len(tiles) <= MOST_PAGES < grid.rows * grid.columns
