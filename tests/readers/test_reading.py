"""The judge of readers: a perfect reading passes, and every way to read a file wrong is seen."""

from collections.abc import Callable
from dataclasses import replace
from math import pi

import numpy as np
import pytest

from stages.geometry.arrays import Points2
from stages.geometry.paths.arcpath import ArcPath, polygon
from tests.near import assert_near
from tests.readers.drawings import Sample, samples
from tests.readers.reading import Figures, Fineness, Piece, Reader, Reading, complaints, loops, measured

CHORD_MM = 1e-6
LEAST_RADIUS_MM = 4.0
STEP_RAD = float(np.sqrt(8.0 * CHORD_MM / LEAST_RADIUS_MM))


def perfect(sample: Sample, layered: bool = True) -> Reading:
    """Return what a reader would hand over that reads all as it is, arcs in fine chords."""
    pieces = tuple(
        Piece(item.layer if layered else "", _points(item.path), item.path.closed) for item in sample.drawing.items
    )
    return Reading(pieces, tuple(label.text for label in sample.drawing.labels))


def _points(path: ArcPath) -> Points2:
    points = polygon(path, accuracy=CHORD_MM)
    return np.concatenate([points, points[:1]]) if path.closed else points


def reader(layered: bool = True) -> Reader:
    return Reader("a reader", lambda: True, lambda _: {}, Fineness(step_rad=STEP_RAD), layered)


def sample(name: str) -> Sample:
    return next(one for one in samples("polyline-arcs", "R2000") if one.name == name)


@pytest.mark.parametrize("layered", [True, False])
@pytest.mark.parametrize("name", [one.name for one in samples("polyline-arcs", "R2000")])
def test_a_perfect_reading_passes(name: str, layered: bool) -> None:
    assert complaints(reader(layered), perfect(sample(name), layered), sample(name)) == []


@pytest.mark.parametrize("layered", [True, False])
def test_contours_in_loose_pieces_that_meet_are_closed(layered: bool) -> None:
    good = perfect(sample("sector"), layered)
    loose = [Piece(one.layer, part) for one in good.pieces for part in _shuffled(one.points)]
    assert complaints(reader(layered), replace(good, pieces=tuple(loose)), sample("sector")) == []


def _shuffled(points: Points2) -> list[Points2]:
    """Return a line cut into three pieces, out of order, one of them backwards."""
    third = len(points) // 3
    first, second, last = points[: third + 1], points[third : 2 * third + 1], points[2 * third :]
    return [last, second[::-1], first]


def scaled(by: float) -> Callable[[Reading], Reading]:
    return lambda one: replace(one, pieces=tuple(replace(piece, points=piece.points * by) for piece in one.pieces))


def moved(one: Reading) -> Reading:
    return replace(
        one, pieces=tuple(replace(piece, points=piece.points + np.array([0.0, 0.1])) for piece in one.pieces)
    )


def without_a_circle(one: Reading) -> Reading:
    gone = next(piece for piece in one.pieces if piece.layer == "CUT_INNER")
    return replace(one, pieces=tuple(piece for piece in one.pieces if piece is not gone))


def twice(one: Reading) -> Reading:
    return replace(one, pieces=(*one.pieces, one.pieces[-1]))


def opened(one: Reading) -> Reading:
    last = replace(one.pieces[-1], points=one.pieces[-1].points[:-1])
    return replace(one, pieces=(*one.pieces[:-1], last))


def with_straight_arcs(one: Reading) -> Reading:
    """A reader that passes over bulges: circles become the squares of their quarters."""
    pieces = [_thinned(piece) if piece.layer == "CUT_INNER" else piece for piece in one.pieces]
    return replace(one, pieces=tuple(pieces))


def _thinned(piece: Piece) -> Piece:
    quarter = (len(piece.points) - 1) // 4
    return replace(piece, points=piece.points[::quarter])


def on_another_layer(one: Reading) -> Reading:
    return replace(one, pieces=(replace(one.pieces[0], layer="0"), *one.pieces[1:]))


def without_texts(one: Reading) -> Reading:
    return replace(one, texts=())


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        (scaled(25.4), "length"),
        (scaled(1.0 / 1000.0), "length"),
        (scaled(1.001), "length"),
        (moved, "box"),
        (without_a_circle, "closed contours"),
        (twice, "closed contours"),
        (opened, "closed contours"),
        (with_straight_arcs, "area"),
        (on_another_layer, "layers"),
        (without_texts, "texts"),
    ],
)
def test_a_planted_fault_is_told(fault: Callable[[Reading], Reading], words: str) -> None:
    good = perfect(sample("plate"))
    assert any(words in line for line in complaints(reader(), fault(good), sample("plate")))


def test_a_flipped_bulge_is_told_by_the_area_alone() -> None:
    """Lengths do not see it: the arc bends to the other side."""
    item = sample("sector").drawing.items[-1]
    flipped = ArcPath(item.path.vertices, item.path.bulges * [-1.0, *[1.0] * (item.path.bulges.size - 1)], closed=True)
    found = complaints(reader(), Reading((Piece(item.layer, _points(flipped)),), ("sector",)), sample("sector"))
    assert found
    assert not any(line.startswith("length") for line in found)
    assert any(line.startswith("area") for line in found)


def test_the_figures_of_a_chorded_circle_are_those_of_its_polygon() -> None:
    """A regular polygon of n corners on radius r: perimeter 2 n r sin(pi/n), area n/2 r^2 sin(2 pi/n)."""
    angles = np.linspace(0.0, 2.0 * pi, 73)
    points = 10.0 * np.column_stack([np.cos(angles), np.sin(angles)]) + [1000.0, 2000.0]
    figures: Figures = measured(Reading((Piece("a", points),)), Fineness(), layered=True)["a"]
    assert_near(figures.length, 1440.0 * np.sin(pi / 72.0), bound=1e-9, why="72 sums of numbers near 2000")
    assert_near(figures.contours[0][0], 3600.0 * np.sin(pi / 36.0), bound=1e-8, why="products of numbers near 20")


def test_the_bounds_of_chords_hold_and_are_reached() -> None:
    """Of a full circle both are what the chords lose, to the next order."""
    fine = Fineness(step_rad=2.0 * pi / 72.0)
    length, area = 20.0 * pi, 100.0 * pi
    lost = length - 1440.0 * np.sin(pi / 72.0), area - 3600.0 * np.sin(pi / 36.0)
    allowed = fine.length_bound(length, 2.0 * pi, 1), fine.area_bound(area, length)
    assert lost[0] <= allowed[0] <= 1.001 * lost[0]
    assert lost[1] <= allowed[1] <= 1.001 * lost[1]


def test_pieces_that_do_not_meet_make_no_loop() -> None:
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]])
    sides = [square[k : k + 2] for k in range(4)]
    assert len(loops(sides, 1e-6)) == 1
    assert loops([*sides[:3], sides[3] + [1e-3, 0.0]], 1e-6) == []
