"""Marked rulings: at equal turning of the normal, as many as the angle between two asks for."""

import pytest

from tests.near import assert_near
from tests.parts import (
    ELLIPTIC_CYLINDER,
    passage,
)


def test_marked_rulings_turn_the_normal_by_equal_angles() -> None:
    """An elliptic cylinder: normals at equal angles, so denser where it bends more."""
    table = {"kind": "cylinder", "directrix": {"ellipse": {"center": [0, 0, 0], "major": [5, 0, 0],
             "minor": [0, 2, 0]}}, "direction": [0, 0, 1], "length": 3}  # fmt: skip
    pattern = passage(table, mark=[{"kind": "rulings", "count": 7}]).pattern
    assert pattern is not None
    assert [mark.name for mark in pattern.marks] == [f"rulings-{i}" for i in range(1, 8)]
    quarter = passage(table).side("flat")["edges"]["c0"] / 4
    heights = [mark.path.vertices[0, 1] for mark in pattern.marks]
    assert_near(heights[1::2], [quarter, 2 * quarter, 3 * quarter], bound=1e-4, why="1024 chords: 1e-6 of the part")
    for mark in pattern.marks:
        assert_near(mark.path.vertices[:, 0], [0.0, 3.0], bound=1e-12, why="edge to edge")
    # the normal is at 45 deg where tan t = 2/5 of the way: x = a^2 / sqrt(a^2 + b^2)
    assert heights[0] < quarter / 2, "the tip of the ellipse bends most"


@pytest.mark.parametrize(("angle", "count"), [(90, 3), (89, 4), (360, 0), (30, 11)])
def test_marks_per_angle_never_leave_more_than_that_angle(angle: float, count: int) -> None:
    pattern = passage(ELLIPTIC_CYLINDER, mark=[{"kind": "rulings", "max_angle": angle}]).pattern
    assert pattern is not None
    assert len(pattern.marks) == count


def test_a_plane_part_is_marked_evenly_or_not_at_all() -> None:
    table = {"kind": "ruled", "c0": {"line": [[0, 0, 0], [8, 0, 0]]}, "c1": {"line": [[0, 1, 0], [8, 1, 0]]}}
    pattern = passage(table, mark=[{"kind": "rulings", "count": 3}, {"kind": "rulings", "max_angle": 5}]).pattern
    assert pattern is not None
    heights = [mark.path.vertices[0, 1] for mark in pattern.marks]
    assert_near(heights, [2.0, 4.0, 6.0], bound=1e-12, why="quarters of 8 mm")
