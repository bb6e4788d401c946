"""A pattern that was written comes back from its drawing: contours, marks, label and texts."""

import numpy as np
import pytest

from pipeline.readpatterns import NoPatternError, read_pattern
from stages.geometry.paths.arcpath import ArcPath, area, backwards, bounds, length
from stages.model.cutfile import Machine
from stages.model.pattern import Contour, FlatPattern, Mark, Text
from stages.write import write
from tests.near import assert_near, assert_relative

DECIMALS = 0.5e-10
"""Half of the last decimal of a drawing, mm."""

CORNERS = np.array([[0.0, 0.0], [100.0 / 3.0, 0.0], [100.0 / 3.0, 20.0], [0.0, 70.0 / 3.0]])
OUTER = ArcPath(CORNERS, np.array([0.0, 0.25, 0.0, -0.1]), closed=True)
ROUND = ArcPath(np.array([[12.0, 10.0], [8.0, 10.0]]), np.array([-1.0, -1.0]), closed=True)
SLOT = backwards(ArcPath(np.array([[20.0, 8.0], [26.0, 8.0], [26.0, 11.0]]), np.array([0.0, 0.4, 0.0]), closed=True))
LINE = ArcPath(np.array([[2.0, 2.0], [9.0, 3.0]]), np.zeros(2), closed=False)
BEND = ArcPath(np.array([[2.0, 5.0], [9.0, 6.0], [30.0, 5.0]]), np.array([0.1, 0.0, 0.0]), closed=False)


def contour(path: ArcPath) -> Contour:
    from stages.geometry.paths.edges import edges_of

    return Contour(edges_of(path), path, 0.05)


@pytest.fixture
def pattern() -> FlatPattern:
    return FlatPattern(
        part="plate",
        quantity=3,
        outer=contour(OUTER),
        inner=(contour(SLOT), contour(ROUND)),
        marks=(Mark("line", LINE), Mark("bend", BEND, "BEND_DOWN")),
        label_at=np.array([15.0, 15.0]),
        corners=np.zeros((4, 2)),
        texts=(Text("note", "THIS SIDE UP", np.array([5.0, 18.0]), 1.5, 30.0),),
    )


def drawn(pattern: FlatPattern) -> str:
    (file,) = write([pattern], None, Machine()).product
    return file.text


def test_contours_marks_label_and_texts_come_back(pattern: FlatPattern) -> None:
    back = read_pattern(drawn(pattern), 0.05)
    assert (back.part, back.quantity, back.outer.chord_mm) == ("plate", 1, 0.05)
    pairs = zip((back.outer, *back.inner), (pattern.outer, *pattern.inner), strict=True)
    for found, meant in pairs:
        assert_near(bounds(found.path), bounds(meant.path), bound=4.0 * DECIMALS, why="decimals of the drawing")
        assert_relative(length(found.path), length(meant.path), bound=1e-10, why="decimals of the drawing")
        assert_relative(area(found.path), area(meant.path), bound=1e-10, why="decimals, and the same sense")
    assert [(mark.layer, mark.path.closed) for mark in back.marks] == [("MARK", False), ("BEND_DOWN", False)]
    for found, meant in zip(back.marks, pattern.marks, strict=True):
        assert_near(bounds(found.path), bounds(meant.path), bound=4.0 * DECIMALS, why="decimals of the drawing")
    assert_near(back.label_at, pattern.label_at, bound=DECIMALS, why="decimals of the drawing")
    (text,), (meant,) = back.texts, pattern.texts
    assert (text.text, text.height_mm, text.angle_deg) == (meant.text, meant.height_mm, meant.angle_deg)
    assert_near(text.at, meant.at, bound=DECIMALS, why="decimals of the drawing")


def test_what_came_back_is_written_again_as_it_was(pattern: FlatPattern) -> None:
    once = drawn(pattern)
    assert drawn(read_pattern(once, 0.05)) == once


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda text: text.replace("CUT_OUTER", "CUT_INNER"), "0 outer contours"),
        (lambda text: text.replace("CUT_INNER", "CUT_OUTER"), "3 outer contours"),
        (lambda text: text.replace("\nMARK\n", "\nSHEET\n"), "LINE on SHEET"),
        (lambda text: text.replace("\nLABEL\n", "\nMARK\n"), "TEXT on MARK"),
        (lambda text: text[: len(text) // 2], "cannot be read"),
        (lambda _: "", "cannot be read"),
    ],
)
def test_what_is_not_the_drawing_of_one_part_is_refused(pattern: FlatPattern, change, message: str) -> None:
    with pytest.raises(NoPatternError, match=message):
        read_pattern(change(drawn(pattern)), 0.05)
