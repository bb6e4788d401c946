"""Patterns at true scale and the check line, measured in what another program makes of the pages."""

import json
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from scipy import ndimage

from tests.near import assert_near
from tests.pipeline.report.traveller.test_book import PLATE, produced
from tests.poppler import PIXELS_PER_MM, grey, needs_poppler, words

pytestmark = needs_poppler
NEAR_MM = 0.1
"""A pixel."""
INK, PAPER = 100, 250
"""Grey of lines, and that of paper and of all that is lighter than the inside of a pattern."""
LINE_MM = 0.4
CHECK_Y_MM, CHECK_ROOM_MM = 9.0, 120.0
LETTER_MM = 6.0

SIZES = {
    "in the first page": (60.0, 45.0),
    "on A4": (150.0, 190.0),
    "on A4 across": (230.0, 120.0),
    "on A3": (250.0, 330.0),
    "on A3 across": (360.0, 240.0),
}


class Drawn(NamedTuple):
    """A page: its pixels; those of the pattern and its letters, turned back to where they lie in the flat frame."""

    grey: np.ndarray
    corners: dict[str, np.ndarray]
    pattern: np.ndarray
    letters: dict[str, np.ndarray]


def job(width: float, height: float) -> str:
    """Return a job of a quadrilateral that is alike to none of its mirror images and turns."""
    corners = [[0, 0], [width, 0], [0.9 * width, height], [0.25 * width, 0.7 * height], [0, 0]]
    return PLATE.replace("[[0, 0], [40, 0], [40, 30], [0, 30], [0, 0]]", str(corners))


@pytest.fixture(scope="module", params=SIZES.values(), ids=SIZES)
def drawn(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Drawn:
    folder = tmp_path_factory.mktemp("scale")
    files = produced(folder, job(*request.param))
    file = folder / "traveller.pdf"
    file.write_bytes(files["traveller.pdf"])
    spots = json.loads(files["report.json"])["parts"][0]["tape"]["spots"]
    corners = {letter: np.array([spot["x"], spot["y"]]) for spot in spots for letter in spot["letters"]}
    page = 1 if request.param == SIZES["in the first page"] else 2
    pixels = grey(file, page)
    pattern = filled(pixels)
    around = letters(file, page, pattern)
    if abs(around["B"] - around["A"])[1] > abs(around["B"] - around["A"])[0]:
        wide = pixels.shape[1] / PIXELS_PER_MM
        pattern, around = pattern.T[::-1], {text: np.array([y, wide - x]) for text, (x, y) in around.items()}
    return Drawn(pixels, corners, pattern, around)


def filled(pixels: np.ndarray) -> np.ndarray:
    """Return the pattern to the outside of its line: the largest area that is not paper."""
    areas, _ = ndimage.label(pixels < PAPER)
    return ndimage.binary_fill_holes(areas == np.bincount(areas.ravel())[1:].argmax() + 1)


def test_the_check_line_is_a_hundred_millimetres_long(drawn: Drawn) -> None:
    rows = drawn.grey[round((CHECK_Y_MM + 0.6) * PIXELS_PER_MM) : round((CHECK_Y_MM + 1.2) * PIXELS_PER_MM)]
    dark = np.flatnonzero((rows < INK).all(axis=0)) / PIXELS_PER_MM
    ticks = dark[dark < CHECK_ROOM_MM]
    first, last = ticks[ticks < ticks[0] + 1.0].mean(), ticks[ticks > ticks[-1] - 1.0].mean()
    assert_near(last - first, 100.0, bound=NEAR_MM, why="a pixel")


def test_the_pattern_is_as_large_as_the_part_along_every_row(drawn: Drawn) -> None:
    corners = placed(drawn)
    low, high = corners[:, 1].min(), corners[:, 1].max()
    for share in (0.1, 0.25, 0.4, 0.55, 0.65):
        y = low + share * (high - low)
        found = np.flatnonzero(drawn.pattern[round(y * PIXELS_PER_MM)]) / PIXELS_PER_MM
        inside = [found[0] + LINE_MM / 2.0, found[-1] + NEAR_MM - LINE_MM / 2.0]
        assert_near(inside, crossings(corners, y), bound=2.5 * NEAR_MM, why="pixels, and lines that lean")


def test_the_extent_is_that_of_the_part(drawn: Drawn) -> None:
    low, high = extent(drawn.pattern)
    size = np.ptp([*drawn.corners.values()], axis=0)
    assert_near(high - low, size + LINE_MM, bound=2.0 * NEAR_MM, why="a pixel at each end; joins are round")


def test_letters_stand_at_their_corners(drawn: Drawn) -> None:
    assert {*drawn.letters} == {*drawn.corners}
    for letter, corner in zip(drawn.corners, placed(drawn), strict=True):
        assert np.hypot(*(drawn.letters[letter] - corner)) < LETTER_MM


def extent(pattern: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the lower left and the upper right corner of what is drawn, mm."""
    rows, columns = (np.flatnonzero(pattern.any(axis=axis)) / PIXELS_PER_MM for axis in (1, 0))
    return np.array([columns[0], rows[0]]), np.array([columns[-1], rows[-1]]) + NEAR_MM


def letters(file: Path, page: int, pattern: np.ndarray) -> dict[str, np.ndarray]:
    """Return the places of the letters around a pattern."""
    low, high = extent(pattern)
    found = [(word.text, np.array([word.x, word.y])) for word in words(file, page) if word.text in "ABCD"]
    near = 2.0 * LETTER_MM
    return {text: at for text, at in found if (low - near <= at).all() and (at <= high + near).all()}


def placed(drawn: Drawn) -> np.ndarray:
    """Return the corners where they are drawn, mm: moved so that the middle of their area is that of the pixels."""
    corners = np.array([*drawn.corners.values()])
    rows, columns = np.nonzero(drawn.pattern)
    middle = (np.array([columns.mean(), rows.mean()]) + 0.5) / PIXELS_PER_MM
    return corners + middle - centroid(corners)


def centroid(corners: np.ndarray) -> np.ndarray:
    following = np.roll(corners, -1, axis=0)
    cross = corners[:, 0] * following[:, 1] - following[:, 0] * corners[:, 1]
    return ((corners + following) * cross[:, None]).sum(axis=0) / (3.0 * cross.sum())


def crossings(corners: np.ndarray, y: float) -> list[float]:
    """Return where a row enters and leaves a polygon."""
    found = []
    for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if (y0 <= y) != (y1 <= y):
            found.append(x0 + (y - y0) * (x1 - x0) / (y1 - y0))
    return [min(found), max(found)]
