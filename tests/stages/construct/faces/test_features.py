"""Where a curve passes from face to face: planted changes are found to the last digit, also of a face between two."""

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stages.construct.faces.features import FINEST, SHORTEST, _between, changes, on_faces
from stages.construct.faces.ground import Ground, ground_of
from stages.geometry.arrays import Values
from stages.model.curves import CurveSpec
from stages.model.features import CurveMark
from tests.near import assert_near
from tests.stages.unroll.test_branchfeatures import BEND, DEEP, TOL, folded, polyline, sides, space, spec_of


def owners(cuts: Sequence[float]) -> Callable[[Values], list[int]]:
    """Return whose places are: of face i from the i-th cut on, of face 0 before."""
    return lambda t: [int(np.searchsorted(cuts, x, side="right")) for x in t]


@given(st.lists(st.floats(0.01, 0.99), min_size=1, max_size=5, unique=True))
def test_every_change_is_found(cuts: list[float]) -> None:
    rising = sorted(cuts)
    if min(np.diff(rising), default=1.0) < 10.0 * FINEST:
        return
    found = changes(owners(rising), (0.0, 0), (1.0, len(rising)))
    assert [face for _, face in found] == list(range(1, len(rising) + 1))
    assert_near([t for t, _ in found], rising, bound=FINEST, why="the last interval")


def test_a_narrow_face_between_two_is_not_passed_over() -> None:
    cuts = [0.3, 0.3 + 1e-9]
    found = changes(owners(cuts), (0.0, 0), (1.0, 2))
    assert [face for _, face in found] == [1, 2]
    assert_near([t for t, _ in found], cuts, bound=FINEST, why="the last interval")


def test_what_is_no_longer_than_rounding_is_left_to_its_neighbours() -> None:
    made = _between([(0.0, 7), (SHORTEST / 2, 1), (0.5, 2), (0.5 + SHORTEST / 2, 3), (1.0 - SHORTEST / 2, 4), (1.0, 4)])
    assert [face for _, _, face in made] == [1, 3]
    assert [low for low, _, _ in made] == [0.0, 0.5]
    assert [high for _, high, _ in made] == [0.5, 1.0]


@pytest.fixture(scope="module")
def grounds() -> list[Ground]:
    """Return the faces of the tray as grounds."""
    return [ground_of(side) for side in sides("tray")]


def test_the_distance_from_a_face_is_to_what_its_edges_enclose(grounds: list[Ground]) -> None:
    points = np.array([(20.0, 10.0, 3.0), (20.0, -5.0, 0.0), (40.0, 40.0, 0.0)])
    expected = [3.0, 5.0, 10.0]
    hole = 10.0 * (1.0 - np.cos(np.pi / 64))
    assert_near(grounds[0].reach(points)[0], expected, bound=hole + 1e-9, why="the sagitta of the polygon of the hole")


def test_no_face_is_nearer_than_its_box(grounds: list[Ground]) -> None:
    every = np.random.default_rng(1).uniform((-40, -40, -40), (160, 120, 60), (50, 3))
    for ground in grounds:
        assert (ground.beyond_box(every) <= ground.reach(every)[0] + 1e-9).all()


def test_a_line_over_several_faces_is_divided_where_they_meet() -> None:
    run = [(60.0, 40.0 - 5.0, 0.0), (60.0, 0.0, 0.0), folded(60.0, BEND / 2.0), folded(60.0, BEND + 10.0)]
    (line,) = on_faces(spec_of("tray", CurveMark(curve=polyline(run))), sides("tray"), TOL).features
    assert len(line.faces) == len(line.curve)
    assert list(dict.fromkeys(line.faces)) == [0, line.faces[1], line.faces[-1]]
    assert len(set(line.faces)) == 3


def test_a_line_along_a_bend_edge_belongs_to_the_first_of_its_faces() -> None:
    line = CurveMark(curve=CurveSpec(line=(space(20.0, DEEP, 0.0), space(100.0, DEEP, 0.0))))
    found = on_faces(spec_of("tray", line), sides("tray"), TOL)
    assert found.findings == ()
    assert found.features[0].faces == (0,)
