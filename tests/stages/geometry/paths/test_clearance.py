"""The distance of lines and arcs: closed forms by hand, and dense sampling as the second method."""

from math import inf, pi, sqrt, tan

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.arrays import Values
from stages.geometry.paths.arcpath import ArcPath, centres, chords, polygon, sweeps
from stages.geometry.paths.clearance import (
    Pieces,
    between,
    boxes,
    clearance,
    crossing,
    distances,
    joined,
    nearest,
    pieces,
    point_distances,
)
from stages.geometry.paths.enclosed import inside, inside_own
from tests.near import assert_near

BOUND_MM = 1e-12
Point = tuple[float, float]


def piece(start: tuple[float, float], end: tuple[float, float], bulge: float = 0.0) -> Pieces:
    return pieces(ArcPath(np.array([start, end], dtype=float), np.array([bulge, 0.0]), closed=False))


def arc(centre: tuple[float, float], radius: float, start_deg: float, sweep_deg: float) -> Pieces:
    ends = np.radians([start_deg, start_deg + sweep_deg])
    points = np.array(centre) + radius * np.stack([np.cos(ends), np.sin(ends)], axis=1)
    return piece(tuple(points[0]), tuple(points[1]), tan(np.radians(sweep_deg) / 4.0))


def sampled(some: Pieces, count: int = 2001) -> np.ndarray:
    path = ArcPath(np.concatenate([some.start, some.end]), np.array([some.bulge[0], 0.0]), closed=False)
    t = np.linspace(0.0, 1.0, count)
    if some.bulge[0] == 0.0:
        start, end = chords(path)
        return start + t[:, None] * (end - start)
    centre, sweep = centres(path)[0], sweeps(path)[0]
    arm = path.vertices[0] - centre
    c, s = np.cos(sweep * t), np.sin(sweep * t)
    return centre + np.stack([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]], axis=1)


CASES = {
    "parallel segments": (piece((0, 0), (10, 0)), piece((2, 3), (5, 3)), 3.0),
    "segments in line": (piece((0, 0), (10, 0)), piece((12, 0), (15, 0)), 2.0),
    "crossing segments": (piece((0, 0), (10, 10)), piece((0, 10), (10, 0)), 0.0),
    "end above a segment": (piece((0, 0), (10, 0)), piece((4, 1), (4, 9)), 1.0),
    "line beside a circle": (piece((-20, 8), (20, 8)), arc((0, 0), 5.0, 0.0, 180.0), 3.0),
    "line beside the missing half": (piece((-20, 8), (20, 8)), arc((0, 0), 5.0, 180.0, 180.0), 8.0),
    "chord within an arc": (piece((0, -1), (0, 1)), arc((0, 0), 5.0, 20.0, 320.0), 4.0),
    "line through an arc": (piece((0, -9), (0, 9)), arc((0, 0), 5.0, 20.0, 140.0), 0.0),
    "line through the gap of an arc": (piece((0, 0), (9, 0)), arc((0, 0), 5.0, 30.0, 300.0), 2.5),
    "circles side by side": (arc((0, 0), 5.0, -90.0, 180.0), arc((12, 0), 4.0, 90.0, 180.0), 3.0),
    "circle within a circle": (arc((0, 0), 10.0, -90.0, 180.0), arc((3, 0), 4.0, -90.0, 180.0), 3.0),
    "concentric arcs": (arc((0, 0), 10.0, 0.0, 90.0), arc((0, 0), 7.0, 30.0, 30.0), 3.0),
    "concentric arcs that miss": (arc((0, 0), 1.0, 0.0, 90.0), arc((0, 0), 1.0, 180.0, 90.0), sqrt(2.0)),
    "arcs that cross": (arc((0, 0), 5.0, -90.0, 180.0), arc((8, 0), 5.0, 90.0, 180.0), 0.0),
    "circles that cross on the absent sides": (arc((0, 0), 5.0, 90.0, 180.0), arc((6, 0), 5.0, -90.0, 180.0), 6.0),
    "a common end": (piece((0, 0), (10, 0)), piece((10, 0), (10, 5), 0.3), 0.0),
}


@pytest.mark.parametrize("name", CASES)
def test_a_distance_known_by_hand_comes_out(name: str) -> None:
    one, other, expected = CASES[name]
    assert distances(one, other)[0] == pytest.approx(expected, abs=1e-11)
    assert distances(other, one)[0] == pytest.approx(expected, abs=1e-11)


coordinates = st.floats(-50.0, 50.0)
points = st.tuples(coordinates, coordinates)
bulges = st.one_of(st.just(0.0), st.floats(0.02, 8.0), st.floats(-8.0, -0.02))


@given(st.tuples(points, points, bulges), st.tuples(points, points, bulges))
@settings(max_examples=150, deadline=None)
def test_dense_sampling_finds_the_same_distance(
    first_piece: tuple[Point, Point, float], second_piece: tuple[Point, Point, float]
) -> None:
    (a, b, bulge), (c, d, swell) = first_piece, second_piece
    if min(np.hypot(a[0] - b[0], a[1] - b[1]), np.hypot(c[0] - d[0], c[1] - d[1])) < 1e-3:
        return
    one, other = piece(a, b, bulge), piece(c, d, swell)
    first, second = sampled(one, 301), sampled(other, 301)
    least = float(np.sqrt(((first[:, None] - second[None]) ** 2).sum(axis=2).min()))
    step = max(np.hypot(*np.diff(points_, axis=0).T).max() for points_ in (first, second))
    exact = distances(one, other)[0]
    assert exact <= least + BOUND_MM * 1e3, "a sampled pair is nearer than the exact distance"
    assert exact >= least - step, "the exact distance is not reached by the curves"


@given(points, st.floats(-50.0, 50.0), st.floats(-50.0, 50.0), st.floats(-3.0, 3.0))
@settings(max_examples=100, deadline=None)
def test_a_moved_pair_keeps_its_distance(at: tuple[float, float], x: float, y: float, turn: float) -> None:
    def moved(some: Pieces) -> Pieces:
        rotation = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
        return piece(
            tuple((some.start @ rotation + [x, y])[0]), tuple((some.end @ rotation + [x, y])[0]), float(some.bulge[0])
        )

    one, other = arc((0, 0), 10.0, 10.0, 200.0), arc(at, 3.0, -60.0, 250.0)
    assert distances(moved(one), moved(other))[0] == pytest.approx(distances(one, other)[0], abs=1e-9)


@pytest.mark.parametrize("bulge", [1e-11, 1e-9, 1e-7, 1e-5, 1e-3])
def test_flat_arcs_lose_no_digits(bulge: float) -> None:
    flat = piece((0.0, 0.0), (100.0, 0.0), bulge)
    point = np.array([[50.0, -7.0]])
    assert point_distances(point, flat)[0] == pytest.approx(7.0 - 50.0 * bulge, abs=1e-12)
    below = piece((0.0, -7.0), (100.0, -7.0), -bulge)
    assert distances(flat, below)[0] == pytest.approx(7.0 - 100.0 * bulge, abs=1e-12)


@given(points, st.floats(1.0, 20.0), st.floats(0.0, 360.0), st.floats(-340.0, 340.0))
@settings(max_examples=100, deadline=None)
def test_a_box_contains_its_arc(centre: tuple[float, float], radius: float, start: float, sweep: float) -> None:
    if abs(sweep) < 1.0:
        return
    one = arc(centre, radius, start, sweep)
    low_x, low_y, high_x, high_y = boxes(one)[0]
    dense = sampled(one, 101)
    assert low_x - 1e-9 <= dense[:, 0].min() and dense[:, 0].max() <= high_x + 1e-9
    assert low_y - 1e-9 <= dense[:, 1].min() and dense[:, 1].max() <= high_y + 1e-9


def disc(x: float, y: float, radius: float) -> ArcPath:
    return ArcPath(np.array([[x + radius, y], [x - radius, y]]), np.ones(2), closed=True)


def test_the_clearance_of_two_discs_is_the_distance_of_centres_less_the_radii() -> None:
    a, b = pieces(disc(0.0, 0.0, 5.0)), pieces(disc(30.0, 40.0, 7.0))
    assert clearance(a, b, within=100.0) == pytest.approx(38.0, abs=BOUND_MM)
    assert clearance(a, joined([b, pieces(disc(20.0, 0.0, 1.0))]), within=100.0) == pytest.approx(14.0, abs=BOUND_MM)


def test_what_is_farther_than_asked_is_infinitely_far() -> None:
    assert clearance(pieces(disc(0.0, 0.0, 5.0)), pieces(disc(30.0, 0.0, 5.0)), within=19.0) == inf


def test_a_whole_path_is_as_near_as_its_fine_polygon() -> None:
    a, b = disc(0.0, 0.0, 50.0), disc(90.0, 20.0, 30.0)
    near = [polygon(path, accuracy=1e-4) for path in (a, b)]
    least = np.sqrt(((near[0][:, None] - near[1][None]) ** 2).sum(axis=2).min())
    exact = clearance(pieces(a), pieces(b), within=100.0)
    assert exact == pytest.approx(np.hypot(90.0, 20.0) - 80.0, abs=BOUND_MM * 10)
    assert exact == pytest.approx(least, abs=0.1)


def test_crossing_does_not_need_an_end_inside() -> None:
    a, b = arc((0, 0), 5.0, -170.0, 340.0), piece((-3, -9), (-3, 9))
    assert crossing(a, b)[0]
    assert not crossing(a, piece((-6, -9), (-6, 9)))[0]


def test_pieces_of_length_zero_are_left_out() -> None:
    path = ArcPath(np.array([[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]), np.zeros(4), closed=True)
    assert pieces(path).bulge.size == 3
    with pytest.raises(ValueError, match="length 0"):
        pieces(ArcPath(np.zeros((2, 2)), np.zeros(2), closed=False))


def test_the_sweep_of_the_helper_arc_is_as_asked() -> None:
    values: Values = arc((1, 2), 3.0, 0.0, 270.0).bulge
    assert 4.0 * np.arctan(values[0]) == pytest.approx(1.5 * pi, abs=1e-12)


def test_the_nearest_of_several_owners_is_what_two_at_a_time_say() -> None:
    rng = np.random.default_rng(5)
    some = [arc(tuple(rng.uniform(0.0, 300.0, 2)), 9.0, float(rng.uniform(0.0, 360.0)), 120.0) for _ in range(40)]
    to = joined([piece((100.0, 0.0), (100.0, 300.0)), arc((220.0, 150.0), 20.0, 0.0, 200.0)])
    found = nearest(joined(some), np.arange(40), to, within=30.0)
    single = {i: clearance(one, to, within=30.0) for i, one in enumerate(some)}
    assert found == {i: value for i, value in single.items() if value <= 30.0}
    assert 0 < len(found) < 40


def test_pieces_between_points_are_those_of_the_path() -> None:
    path = ArcPath(
        np.array([[0.0, 0.0], [50.0, 0.0], [60.0, 30.0], [0.0, 40.0]]), np.array([0.2, -1.0, 0.0, 1e-14]), True
    )
    start, end = chords(path)
    made, known = between(start, end, path.bulges), pieces(path)
    assert_near(
        made.centre, np.where(known.bulge[:, None] == 0.0, 0.0, centres(path)), bound=BOUND_MM, why="one formula"
    )
    assert made.bulge[3] == 0.0, "flatter than any rounding"


def test_points_are_inside_their_own_contours_as_shapely_says() -> None:
    """Contours with lines, shallow arcs and arcs beyond a half circle, points all over each; none next to an edge."""
    rng = np.random.default_rng(11)
    square = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 8.0], [0.0, 8.0]])
    bulges = [[0.0, 0.0, 0.0, 0.0], [0.3, -0.2, 0.0, 0.1], [1.4, 0.0, -0.3, 0.0], [-0.2, 0.4, 1.0, -0.1]]
    paths = [ArcPath(square + 40.0 * k, np.array(row), closed=True) for k, row in enumerate(bulges)]
    some = [pieces(path) for path in paths]
    owner = np.repeat(np.arange(len(some)), [one.bulge.size for one in some])
    own = rng.integers(0, len(paths), 2000)
    points = rng.uniform(-12.0, 22.0, (2000, 2)) + 40.0 * own[:, None]
    regions = [shapely.Polygon(polygon(path, accuracy=1e-4)) for path in paths]
    wanted = np.array([regions[k].contains(shapely.Point(point)) for k, point in zip(own, points, strict=True)])
    near = [regions[k].boundary.distance(shapely.Point(point)) for k, point in zip(own, points, strict=True)]
    clear = np.array(near) > 1e-3
    found = inside_own(points, own, joined(some), owner)
    assert (found == wanted)[clear].all()
    assert 100 < np.count_nonzero(wanted) < 1900
    for k, one in enumerate(some):
        assert (inside(points[own == k], one) == found[own == k]).all(), "one contour after the other"
