"""Lines and arcs as paths again: direction, closing, gaps."""

from itertools import pairwise

import numpy as np

from stages.geometry.paths.arcpath import ArcPath, area
from stages.write.chains import JOINT_MM, Entity, chained
from tests.near import assert_near


def piece(*ends: tuple[float, float], bulge: float = 0.0, begins: bool = False, layer: str = "MARK") -> Entity:
    path = ArcPath(np.array(ends), np.array([bulge, 0.0]), closed=False)
    return Entity("ARC" if bulge else "LINE", layer, 3, path, closed=False, begins=begins)


SQUARE = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)]


def square() -> list[Entity]:
    return [piece(a, b, begins=k == 0) for k, (a, b) in enumerate(pairwise(SQUARE))]


def test_four_lines_are_a_closed_square() -> None:
    (whole,) = chained(square())
    assert (whole.kind, whole.closed, whole.count, whole.gap_mm) == ("CHAIN", True, 4, 0.0)
    assert whole.path is not None
    assert_near(area(whole.path), 1.0, bound=1e-15, why="closed form")


def test_without_one_line_it_is_open_and_in_another_order_it_falls_apart() -> None:
    (rest,) = chained(square()[:3])
    assert not rest.closed
    a, b, c, d = square()
    assert len(chained([a, c, b, d])) > 1


def test_arcs_are_turned_to_where_they_go_on() -> None:
    """A half disc: the arc is counter-clockwise from (1, 0) to (-1, 0), the line comes back."""
    for first in (piece((1.0, 0.0), (-1.0, 0.0), bulge=1.0), piece((-1.0, 0.0), (1.0, 0.0), bulge=-1.0)):
        line = piece((-1.0, 0.0), (1.0, 0.0))
        for order in ([first, line], [line, first]):
            (whole,) = chained(order)
            assert whole.path is not None
            assert_near(area(whole.path), np.pi / 2.0, bound=1e-15, why="half a disc")


def test_a_gap_is_measured_and_a_wider_one_parts() -> None:
    a, b, *rest = square()
    near = piece((1.0, JOINT_MM / 2.0), (1.0, 1.0))
    (whole,) = chained([a, near, *rest])
    assert_near(whole.gap_mm, JOINT_MM / 2.0, bound=1e-12, why="planted")
    assert len(chained([a, piece((1.0, 3.0 * JOINT_MM), (1.0, 1.0)), *rest])) > 1
    assert b.count == 1


def test_a_named_line_type_another_layer_or_a_closed_path_begins_anew() -> None:
    one, other = piece((0.0, 0.0), (1.0, 0.0)), ((1.0, 0.0), (2.0, 0.0))
    assert len(chained([one, piece(*other)])) == 1
    assert len(chained([one, piece(*other, begins=True)])) == 2
    assert len(chained([one, piece(*other, layer="BEND_UP")])) == 2
    assert [entity.count for entity in chained([*square(), piece((0.0, 0.0), (-1.0, 0.0))])] == [4, 1]
