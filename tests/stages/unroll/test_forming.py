"""Bend lines: equal turning in steps that add up, their sides and radii, facets, folds, and lines that cross."""

from math import ceil

import numpy as np
import pytest

from stages.construct import construct
from stages.errors import NoSolutionError
from stages.geometry.arrays import Points2, Values, cross2, norm
from stages.geometry.flat.development import develop
from stages.geometry.flat.flatmap import Development, FlatPiece
from stages.model.face import Face
from stages.model.forming import BendSpec
from stages.model.kfactor import KFactor
from stages.model.material import Material
from stages.model.scalars import Angle, Length
from stages.model.surface import RuledSurface
from stages.model.tolerances import Tolerances
from stages.unroll.bent import Bent
from stages.unroll.forming import Forming, crossing_pairs, formed
from stages.unroll.thickness import neutral
from tests.near import assert_near, assert_relative
from tests.parts import (
    AUMANN_CUBIC,
    CIRCLE,
    EXAMPLE_1,
    EXAMPLE_2_CYLINDER,
    MITRED_CYLINDER,
    OBLIQUE_CONE,
    QUINTIC_TANGENT,
    RIGHT_FRUSTUM,
    Table,
    part,
)

TOL = Tolerances()
PIPE: Table = {"kind": "cylinder", "directrix": CIRCLE, "direction": [0, 0, 1], "length": 5}


def bent_part(
    table: Table, thickness: float | None = 0.1, k: float = 0.4, face: Face = "middle"
) -> tuple[Bent, RuledSurface, Development]:
    sheet = Material(thickness_mm=thickness, bend_radius_min_mm=0.2, k_factor=KFactor(k, given=True))
    made = construct(part(table, sheet, face=face), TOL).product
    assert isinstance(made, RuledSurface)
    unrolled = neutral(made, TOL)
    return unrolled.bent, unrolled.surface, develop(unrolled.surface.patches)


def lines(table: Table, spec: BendSpec, **how: object) -> Forming:
    return formed(*bent_part(table, **how), spec)  # type: ignore[arg-type]


def every(degrees: object) -> BendSpec:
    return BendSpec(max_angle=Angle(str(degrees)))


def column(forming: Forming, key: str) -> list[float]:
    return [row[key] for row in forming.rows]  # type: ignore[misc]


def value(forming: Forming, name: str) -> float:
    (found,) = [metric.value for metric in forming.metrics if metric.name == name]
    assert found is not None
    return float(found)


# Steps


def test_a_pipe_is_bent_in_equal_steps_at_equal_pitch() -> None:
    """theta (r + K t): the first hit lies half a step from the edge."""
    made = lines(PIPE, every(10))
    step, pitch = np.radians(10.0), np.radians(10.0) * (1.95 + 0.04)
    assert_near(column(made, "angle_deg"), np.full(36, 10.0), bound=1e-12, why="equal parts of a full turn")
    y = [(i + 0.5) * pitch for i in range(36)]
    assert_near(column(made, "from"), [[0.0, h] for h in y], bound=1e-12, why="1e-14 of the length")
    assert_near(column(made, "to"), [[5.0, h] for h in y], bound=1e-12, why="1e-14 of the length")
    assert_near(column(made, "radius_mm"), np.full((36, 2), 1.95), bound=1e-13, why="inside radius")
    pitches = [row["pitch_mm"] for row in made.rows[:-1]]
    assert_near(pitches, np.full((35, 2), pitch), bound=1e-12, why="closed form")
    assert "pitch_mm" not in made.rows[-1]
    off = 2.0 * (1.0 - np.cos(step / 2.0))
    assert_near(value(made, "bend_facet_error_mm"), off, bound=1e-13, why="rho (1 - cos(delta / 2)) of the middle")


@pytest.mark.parametrize(("degrees", "count"), [(90, 4), (89.9, 5), (7, 52), ("360/7", 7)])
def test_the_step_is_the_turning_over_a_whole_number_of_hits(degrees: object, count: int) -> None:
    made = lines(PIPE, every(degrees))
    assert len(made.rows) == count
    assert_near(column(made, "angle_deg"), np.full(count, 360.0 / count), bound=1e-12, why="N hits of theta / N")


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        (BendSpec(), "exactly one of max_angle and facet_error"),
        (BendSpec(max_angle=Angle(5), facet_error=Length(1)), "exactly one of max_angle and facet_error"),
        (BendSpec(max_angle=Angle(91)), "91 deg"),
        (BendSpec(max_angle=Angle(0)), "0"),
        (BendSpec(facet_error=Length(-1)), "-1"),
    ],
)
def test_steps_that_make_no_bends_are_refused(spec: BendSpec, message: str) -> None:
    assert [trouble.message for trouble in spec.troubles()] == [message]


@pytest.mark.parametrize(
    "table", [AUMANN_CUBIC, QUINTIC_TANGENT, OBLIQUE_CONE, MITRED_CYLINDER, RIGHT_FRUSTUM, EXAMPLE_2_CYLINDER]
)
def test_the_hits_add_up_to_the_turning_and_none_is_larger_than_asked(table: Table) -> None:
    made = lines(table, every(3), thickness=0.01)
    assert value(made, "bend_angle_error_deg") <= 0.1
    assert all(metric.passed for metric in made.metrics)
    assert not made.findings
    assert max(map(abs, column(made, "angle_deg"))) <= 3.0


def test_a_lost_hit_shows_in_the_sum_of_the_angles() -> None:
    bent, surface, flat = bent_part(OBLIQUE_CONE)
    stretch = bent.bends.stretches[0]
    short = type(stretch)(stretch.piece, stretch.low, stretch.high, stretch.angle_rad * (1.0 - 0.2 / 327.0))
    lame = type(bent)(bent.surface, type(bent.bends)(bent.bends.pieces, (short,)), bent.sheet, bent.k)
    metrics = {m.name: m for m in formed(lame, surface, flat, every(10)).metrics}
    assert not metrics["bend_angle_error_deg"].passed


# Sides


def test_bends_towards_the_viewer_are_up_and_the_others_down() -> None:
    up = lines(PIPE, every(45))
    down = lines(PIPE | {"direction": [0, 0, -1]}, every(45))
    assert {mark.layer for mark in up.marks} == {"BEND_UP"}
    assert {mark.layer for mark in down.marks} == {"BEND_DOWN"}
    assert set(column(up, "side")) == {"up"}
    assert min(column(up, "angle_deg")) > 0.0 > max(column(down, "angle_deg"))


def test_no_bend_mixes_the_two_ways_of_an_inflection() -> None:
    made = lines(EXAMPLE_2_CYLINDER, every(20))
    signs = np.sign(column(made, "angle_deg"))
    assert signs.tolist() == [-1.0] * 4 + [1.0] * 4
    v = column(made, "v")
    assert v[3] < 0.5090984889689595 < v[4]
    assert_near(sum(column(made, "angle_deg")), 0.0, bound=1e-10, why="the end tangents are parallel")
    assert [mark.layer for mark in made.marks] == ["BEND_DOWN"] * 4 + ["BEND_UP"] * 4


# Places


@pytest.mark.parametrize("table", [AUMANN_CUBIC, OBLIQUE_CONE, EXAMPLE_2_CYLINDER])
def test_lines_are_whole_rulings_of_their_own_place(table: Table) -> None:
    bent, surface, flat = bent_part(table, 0.01, 0.3)
    made = formed(bent, surface, flat, every(9))
    for row, mark in zip(made.rows, made.marks, strict=True):
        ends = np.array([row["from"], row["to"]])
        assert_near(mark.path.vertices, ends, bound=0.0, why="the mark is the row")
        ruling = bent.surface.patches[0].p.jet(np.array([row["v"]], dtype=float), 0)[0, 0]
        assert_relative([norm(ends[1] - ends[0])], [norm(ruling)], bound=1e-12, why="rulings keep their length")


def test_radii_are_those_of_the_inside_at_both_ends_of_the_line() -> None:
    made = lines(RIGHT_FRUSTUM, every(30), face="outer")
    slant = np.hypot(4.0, 1.5) / 4.0
    wanted = np.array([3.0, 1.5]) * slant - 0.1
    assert_relative(column(made, "radius_mm"), np.tile(wanted, (len(made.rows), 1)), bound=1e-13, why="closed form")


# Facets


@pytest.mark.parametrize("table", [PIPE, OBLIQUE_CONE, AUMANN_CUBIC])
@pytest.mark.parametrize("error", ["0.01", "0.001"])
def test_as_many_hits_as_the_facet_error_needs(table: Table, error: str) -> None:
    made = lines(table, BendSpec(facet_error=Length(error)), thickness=0.01)
    assert value(made, "bend_facet_error_mm") <= float(error)
    assert value(lines(table, every(45), thickness=0.01), "bend_facet_error_mm") > float(error)


def test_a_pipe_takes_the_least_number_of_hits_for_its_facets() -> None:
    made = lines(PIPE, BendSpec(facet_error=Length("0.01")), thickness=None)
    wanted = ceil(np.pi / np.arccos(1.0 - 0.01 / 2.0))
    assert wanted <= len(made.rows) <= 1.05 * wanted + 1


def test_a_facet_error_that_takes_countless_hits_is_refused() -> None:
    with pytest.raises(NoSolutionError, match="facet"):
        lines(PIPE, BendSpec(facet_error=Length("1e-9")))


# Folds and planes


def test_every_fold_is_a_line_of_its_own_with_its_angle_and_the_radius_of_the_material() -> None:
    zigzag = {"kind": "cylinder", "directrix": {"polyline": [[0, 0, 0], [3, 0, 0], [3, 4, 0], [9, 4, 0]]},
              "direction": [0, 0, 1], "length": 5}  # fmt: skip
    made = lines(zigzag, every(10))
    assert_near(column(made, "angle_deg"), [90.0, -90.0], bound=1e-12, why="right angles")
    assert column(made, "fold") == [True, True]
    assert column(made, "radius_mm") == [[0.2, 0.2], [0.2, 0.2]]
    assert_near(column(made, "from"), [[0.0, 3.0], [0.0, 7.0]], bound=1e-14, why="vertices of the polyline")


def test_a_plane_has_no_bend_lines() -> None:
    made = lines(EXAMPLE_1, every(10))
    assert (made.rows, made.marks, made.findings) == ((), (), ())


# Crossings


def test_lines_that_cross_inside_are_found_and_those_that_meet_at_their_ends_are_not() -> None:
    fan = np.array([[[0.0, 0.0], [np.cos(a), np.sin(a)]] for a in (0.1, 0.2, 0.3)])
    assert not crossing_pairs(fan)
    across = np.array([[[0.5, -1.0], [0.5, 1.0]]])
    assert crossing_pairs(np.concatenate([fan, across])) == [(0, 3), (1, 3), (2, 3)]
    beside = np.array([[[1.5, -1.0], [1.5, 1.0]]])
    assert not crossing_pairs(np.concatenate([fan, beside]))
    assert not crossing_pairs(np.zeros((0, 2, 2)))


def test_a_line_that_touches_another_does_not_cross_it() -> None:
    touching = np.array([[[0.0, 0.0], [4.0, 0.0]], [[2.0, 1e-12], [2.0, 3.0]]])
    assert not crossing_pairs(touching)
    touching[1, 0, 1] = -1e-6
    assert crossing_pairs(touching) == [(0, 1)]


class Askew:
    """A flat piece whose rulings near v = 0.5 are laid across their neighbours."""

    def __init__(self, piece: FlatPiece) -> None:
        self.piece = piece

    def __getattr__(self, name: str) -> object:
        return getattr(self.piece, name)

    def positions(self, u: Values, v: Values) -> Points2:
        return self.piece.positions(u, np.where(np.abs(v - 0.5) < 0.02, v + 0.3 * (u - 0.5), v))


def test_a_bend_line_turned_across_the_others_is_refused() -> None:
    bent, surface, flat = bent_part(PIPE)
    lame = Development(tuple(Askew(piece) for piece in flat.pieces))
    assert not formed(bent, surface, flat, every("360/17")).findings
    (found,) = formed(bent, surface, lame, every("360/17")).findings
    assert (found.code, found.fatal) == ("bend-lines-cross", True)


def test_hits_on_a_cone_fan_out_without_crossing() -> None:
    made = lines({"kind": "cone", "radius0": 3, "radius1": 0, "height": 4}, every(5))
    assert not made.findings
    ends = np.array([[row["from"], row["to"]] for row in made.rows], dtype=float)
    step = ends[:, 1] - ends[:, 0]
    turns = np.arcsin(cross2(step[:-1], step[1:]) / norm(step[:-1]) / norm(step[1:]))
    assert_near(turns, np.full(turns.size, turns[0]), bound=1e-12, why="a right cone: equal hits, equal fans")
