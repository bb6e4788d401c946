"""Strips of pieces: whichever way round each piece comes, the strip is the same; what does not join is refused."""

from itertools import product
from math import pi

import numpy as np
import pytest

from stages.construct.pieces import in_order
from stages.geometry.ruled.backwards import exchanged, reversed_patch
from stages.geometry.ruled.ruled import RuledPatch
from tests.near import assert_near, assert_relative
from tests.parts import (
    AUMANN_CUBIC,
    EXAMPLE_1,
    EXAMPLE_2_PRINTED,
    OBLIQUE_CONE,
    RIGHT_FRUSTUM,
    Table,
    passage,
    patches,
    troubles,
)

FLANGE: Table = {
    "kind": "cylinder",
    "directrix": {"line": [[0, 0, 0], [0, 50, 0]]},
    "direction": [1, 0, 0],
    "length": 80,
}
BEND: Table = {
    "kind": "cylinder", "direction": [1, 0, 0], "length": 80,
    "directrix": {"arc": {"center": [0, 50, 30], "radius": 30, "normal": [1, 0, 0], "start": -90, "end": 0}},
}  # fmt: skip
BACK: Table = {
    "kind": "cylinder", "direction": [-1, 0, 0], "length": 80,
    "directrix": {"arc": {"center": [80, 50, 30], "radius": 30, "normal": [1, 0, 0], "start": 0, "end": -90}},
}  # fmt: skip
WEB: Table = {
    "kind": "ruled", "c0": {"line": [[0, 80, 30], [0, 80, 90]]}, "c1": {"line": [[80, 80, 30], [80, 80, 90]]},
}  # fmt: skip
PROFILE: Table = {"kind": "strip", "pieces": [FLANGE, BEND, WEB]}


def test_flange_bend_and_web_are_one_blank_of_known_size() -> None:
    made = passage(PROFILE)
    flat = made.side("flat")
    assert_relative([flat["area"]], [80 * (50 + 30 * pi / 2 + 60)], bound=1e-13, why="three rectangles")
    assert made.value("construct", "join_continuity") == 1.0, "a flat and a pipe agree in tangent plane only"
    assert_near(made.value("construct", "join_gap_mm"), 0.0, bound=1e-13, why="rounding of 80 mm")
    assert not made.codes("construct")


def test_a_piece_that_runs_the_other_way_with_its_edges_exchanged_is_turned() -> None:
    turned = passage(PROFILE | {"pieces": [FLANGE, BACK, WEB]})
    assert turned.refused_by is None
    first, second = turned.side("flat"), passage(PROFILE).side("flat")
    assert_near([first["area"], first["width"]], [second["area"], second["width"]], bound=1e-9, why="one surface")


@pytest.mark.parametrize("ways", [*product(range(4), repeat=2)])
def test_all_sixteen_ways_round_give_the_strip_of_the_first_piece(ways: tuple[int, int]) -> None:
    (low,), (middle,), (high,) = patches(FLANGE), patches(BEND), patches(WEB)
    runs, gaps = in_order([(low,), (_way(middle, ways[0]),), (_way(high, ways[1]),)])
    assert_near(gaps, [0.0, 0.0], bound=1e-13, why="rounding")
    assert runs[0] == (low,)


def test_a_first_piece_that_starts_at_the_second_is_reversed() -> None:
    runs, gaps = in_order([(reversed_patch(patches(FLANGE)[0]),), patches(BEND)])
    assert_near(gaps, [0.0], bound=1e-13, why="rounding")
    assert_near(runs[0][0].c0.jet(np.array([0.0]), 0)[0, 0], [0, 0, 0], bound=0.0, why="its free end first")


def _way(patch: RuledPatch, way: int) -> RuledPatch:
    patch = reversed_patch(patch) if way & 1 else patch
    return exchanged(patch) if way & 2 else patch


def over(start: int, end: int) -> Table:
    """Return half of a right cone over an arc, to its apex on the z axis."""
    arc: Table = {"center": [0, 0, 0], "radius": 4, "normal": [0, 0, 1], "start": start, "end": end}
    return {"kind": "cone", "apex": [0, 0, 9], "fraction": [0, 0.5], "directrix": {"arc": arc}}


def test_a_cone_and_its_continuation_meet_with_equal_curvature() -> None:
    made = passage({"kind": "strip", "pieces": [over(0, 90), over(200, 90)]})
    assert made.value("construct", "join_continuity") == 2.0
    whole = passage(over(0, 200))
    assert_relative([made.side("flat")["area"]], [whole.side("flat")["area"]], bound=1e-12, why="one surface")


def test_pieces_that_do_not_meet_are_refused_with_the_gap_and_the_place() -> None:
    made = passage(PROFILE | {"pieces": [FLANGE, BEND, WEB | {"c0": {"line": [[0, 83, 34], [0, 83, 90]]}}]})
    (finding,) = [f for f in made.reports["construct"].findings if f.fatal]
    assert finding.code == "pieces-apart"
    assert "5 mm" in finding.message
    assert finding.where == {"v": 2}
    assert made.refused_by == "construct"


def test_what_is_wrong_with_one_piece_is_told_with_its_number() -> None:
    bad = OBLIQUE_CONE | {"apex": [2, 0, 0]}
    made = passage({"kind": "strip", "pieces": [FLANGE, bad]})
    (finding,) = [f for f in made.reports["construct"].findings if f.fatal]
    assert finding.code == "apex-on-directrix"
    assert finding.message.startswith("pieces[1]: ")
    assert finding.where is not None
    assert finding.where["in"] == "pieces[1]"


def test_what_pieces_measure_is_reported_once_at_its_worst() -> None:
    made = passage({"kind": "strip", "pieces": [EXAMPLE_1, EXAMPLE_2_PRINTED]})
    metrics = [metric for metric in made.reports["construct"].metrics if metric.name == "normal_tangent_dot"]
    (metric,) = metrics
    assert metric.value == passage(EXAMPLE_2_PRINTED).value("construct", "normal_tangent_dot")
    assert metric.where is not None
    assert metric.where["in"] == "pieces[1]"
    residual = made.value("construct", "theorem_residual")
    assert isinstance(residual, float)
    assert residual > 0.0


@pytest.mark.parametrize("alone", [AUMANN_CUBIC, RIGHT_FRUSTUM, OBLIQUE_CONE])
def test_a_strip_of_one_piece_is_that_piece(alone: Table) -> None:
    made, same = passage({"kind": "strip", "pieces": [alone]}), passage(alone)
    assert made.side("flat")["area"] == same.side("flat")["area"]


def test_pieces_have_no_rules_of_their_own_beyond_those_of_their_kinds() -> None:
    assert not troubles(PROFILE)
