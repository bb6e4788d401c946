"""The joins of a strip by name: gap, G0, G1, G2, with a jump of curvature at either end of the ruling."""

from math import hypot

import numpy as np
import pytest

from stages.model.surface import RuledSurface
from tests.near import assert_near
from tests.parts import CONE_STRIP, STRIP, Table, passage

Arc = dict[str, object]


def arc(centre: list[float], radius: float, start: float, end: float, normal: tuple[int, int, int] = (0, 0, 1)) -> Arc:
    return {"arc": {"center": centre, "radius": radius, "normal": list(normal), "start": start, "end": end}}


def pipe(*pieces: Arc) -> Table:
    """Return the cylinder along z over arcs and lines, 40 mm long."""
    return {"kind": "cylinder", "directrix": {"chain": list(pieces)}, "direction": [0, 0, 1], "length": 40}


def rows(surface: Table, **keys: object) -> list[dict[str, object]]:
    found = passage(surface, **keys).reports["construct"].detail["joins"]
    assert isinstance(found, list)
    return found


TANGENT_LINE = {"line": [[0, 10, 0], [-30, 10, 0]]}
QUARTER = arc([0, 0, 0], 10, 0, 90)


@pytest.mark.parametrize("strip", [STRIP, CONE_STRIP])
def test_patches_of_theorem_3_1_join_with_equal_curvature(strip: Table) -> None:
    made = passage(strip)
    assert {row["continuity"] for row in rows(strip)} == {"G2"}
    assert made.value("construct", "join_continuity") == 2.0


def test_a_bend_into_a_plane_is_g1_with_the_bends_curvature_at_both_ends() -> None:
    made = passage(pipe(QUARTER, TANGENT_LINE))
    (row,) = rows(pipe(QUARTER, TANGENT_LINE))
    assert isinstance(made.surface, RuledSurface)
    assert row["continuity"] == "G1"
    size = made.surface.size_mm
    assert_near(size, hypot(40, 10, 40), bound=1e-12, why="from (10, 0) over (-30, 10), 40 high")
    assert_near(row["curvature_jump"], [size / 10.0] * 2, bound=1e-12, why="1/10 against 0, in 1/D")


def test_a_kink_is_g0_with_its_angle() -> None:
    kinked = pipe(QUARTER, {"line": [[0, 10, 0], [-30, 10 + 30 * np.tan(np.radians(0.02)), 0]]})
    (row,) = rows(kinked)
    assert row["continuity"] == "G0"
    assert_near(row["normal_deg"], 0.02, bound=1e-12, why="closed form")


def test_pieces_that_do_not_touch_are_a_gap() -> None:
    apart = pipe(QUARTER, {"line": [[0, 10.005, 0], [-30, 10.005, 0]]})
    (row,) = rows(apart)
    assert row["continuity"] == "G1", "within the 0.01 mm that a join may have"
    (wide,) = passage(pipe(QUARTER, {"line": [[0, 10.02, 0], [-30, 10.02, 0]]})).reports["construct"].detail["joins"]
    assert wide["continuity"] == "gap"


def test_the_worst_join_is_the_one_in_the_metrics() -> None:
    """Line, arc, arc of another radius: jumps of 1/10 and of 1/4 - 1/10."""
    line = {"line": [[10, -30, 0], [10, 0, 0]]}
    smaller = arc([0, 6, 0], 4, 90, 180)
    made = passage(pipe(line, QUARTER, smaller))
    assert isinstance(made.surface, RuledSurface)
    jump = made.metric("construct", "join_curvature_jump")
    assert_near(jump.value, (1 / 4 - 1 / 10) * made.surface.size_mm, bound=1e-11, why="closed form")
    assert jump.where == {"v": 2}
    assert [row["continuity"] for row in rows(pipe(line, QUARTER, smaller))] == ["G1", "G1"]


def test_a_common_normal_is_found_also_where_it_vanishes_on_the_ruling() -> None:
    """Two halves of a bow whose profile stops at the join: no normal there, but one on both sides."""
    bow = {"bezier": [[0, 0, 0], [10, 8, 0], [20, 10, 0], [20, 10, 0]]}
    on = {"bezier": [[20, 10, 0], [20, 10, 0], [30, 12, 0], [40, 8, 0]]}
    (row,) = rows(pipe(bow, on))
    assert isinstance(row["normal_deg"], float)
    assert_near(row["normal_deg"], 0.0, bound=1e-3, why="both leave along (10, 2): 2**-20 off the join")
    assert row["continuity"] == "G1"
