"""Many paths measured together: digit for digit what measuring one by one says, whatever there is among them."""

import numpy as np
import pytest

from stages.geometry.arrays import norm
from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths import manypaths
from stages.geometry.paths.arcpath import (
    ArcPath,
    area,
    bounds,
    curvatures,
    length,
    lengths,
    piece_count,
    polygon,
    transform,
)
from stages.geometry.paths.clearance import pieces

COUNTS = [2, 3, 4, 4, 4, 7, 8, 9, 17, 40, 130]
"""Sums of eight numbers and more are not taken from first to last."""


def made(seed: int, *, closed: bool | None = None) -> list[ArcPath]:
    """Return lines, arcs, and both, open and closed, of many counts of vertices, in no order."""
    random = np.random.default_rng(seed)
    paths = []
    for count in random.permutation(np.repeat(COUNTS, 3)).tolist():
        shut = bool(random.integers(2)) if closed is None else closed
        bulges = random.normal(size=count) * random.integers(0, 2, count) * random.integers(0, 2)
        bulges[-1] *= shut
        paths.append(ArcPath(1000.0 * random.normal(size=(count, 2)), bulges, shut))
    return paths


@pytest.mark.parametrize("seed", range(5))
def test_figures_are_those_of_each_by_itself(seed: int) -> None:
    paths = made(seed)
    assert manypaths.lengths(paths).tolist() == [length(path) for path in paths]
    assert manypaths.shortest(paths).tolist() == [float(lengths(path).min()) for path in paths]
    assert manypaths.boxes(paths).tolist() == [list(bounds(path)) for path in paths]
    assert manypaths.end_curvatures(paths).tolist() == [curvatures(path)[[0, -1]].tolist() for path in paths]
    steep = [float(np.abs(path.bulges[: piece_count(path)]).max()) for path in paths]
    assert manypaths.steepest(paths).tolist() == steep
    closed = made(seed, closed=True)
    assert manypaths.areas(closed).tolist() == [area(path) for path in closed]


def test_the_nearest_vertices_that_follow_each_other_are_found_across_the_end_where_a_path_is_closed() -> None:
    corners = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 8.0], [0.5, 0.0]])
    both = [ArcPath(corners, np.zeros(4), closed) for closed in (True, False)]
    assert manypaths.shortest_chords(both).tolist() == [0.5, 8.0]


def test_tips_are_where_a_path_is_entered_and_left() -> None:
    paths = made(7)
    starts, ends = manypaths.ends(paths)
    assert starts.tolist() == [path.vertices[0].tolist() for path in paths]
    assert ends.tolist() == [path.vertices[0 if path.closed else -1].tolist() for path in paths]


@pytest.mark.parametrize("accuracy", [0.1, 5.0])
def test_polygons_are_those_of_each_by_itself(accuracy: float) -> None:
    paths = made(8)
    points, owner = manypaths.polygons(paths, accuracy)
    for number, path in enumerate(paths):
        assert points[owner == number].tolist() == polygon(path, accuracy=accuracy).tolist()


def test_pieces_are_those_of_each_by_itself() -> None:
    paths = made(9)
    doubled = ArcPath(np.repeat(paths[0].vertices, 2, axis=0), np.zeros(2 * paths[0].bulges.size), closed=True)
    together, owner = manypaths.pieces([*paths, doubled])
    some = [pieces(path) for path in (*paths, doubled)]
    assert owner.tolist() == [number for number, one in enumerate(some) for _ in one.bulge]
    for name in ("start", "end", "bulge", "centre", "radius"):
        assert getattr(together, name).tolist() == np.concatenate([getattr(one, name) for one in some]).tolist()
    assert (norm(together.end - together.start) > 0.0).all()


def test_a_path_of_no_length_is_refused() -> None:
    point = ArcPath(np.ones((3, 2)), np.zeros(3), closed=True)
    with pytest.raises(ValueError, match="length 0"):
        manypaths.pieces([*made(1), point])


@pytest.mark.parametrize("motion", [Rigid2(3.0, -7.0, 33.0), Rigid2(3.0, -7.0, 90.0, mirrored=True)])
def test_paths_are_moved_like_each_by_itself(motion: Rigid2) -> None:
    paths = made(10)
    for found, path in zip(manypaths.moved(paths, motion), paths, strict=True):
        wanted = transform(path, motion)
        assert (found.vertices.tolist(), found.bulges.tolist()) == (wanted.vertices.tolist(), wanted.bulges.tolist())


def test_no_paths_have_no_figures() -> None:
    for figure in (
        manypaths.lengths,
        manypaths.shortest,
        manypaths.shortest_chords,
        manypaths.steepest,
        manypaths.areas,
    ):
        assert figure([]).shape == (0,)
    assert manypaths.boxes([]).shape == (0, 4)
    assert [one.size for one in manypaths.ends([])] == [0, 0]
    assert manypaths.polygons([], 0.1)[0].shape == (0, 2)
    assert manypaths.pieces([])[1].size == 0
    assert manypaths.moved([], Rigid2()) == []
