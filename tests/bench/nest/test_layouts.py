"""Verdict and figures of a layout: closed forms, and planted faults that must be seen."""

from math import inf, isnan

import pytest

from stages.model.sheet import NestOptions, Sheet
from tests.bench.nest.instances import FOLDER, Instance, from_json, instance
from tests.bench.nest.jigsaw import CELL_MM, SLACK, Piece, cut, jigsaw, turned
from tests.bench.nest.layouts import Spot, equivalent_density, left_over, measured, nesting_of, snapped
from tests.bench.nest.made import GAP_MM, HOLE_MM, RING_MM, SQUARE_MM, ring
from tests.near import assert_near
from tests.stages.nest.shapes import rectangle

EDGE = 5.0


def bars(rotations: tuple[float, ...] | None = (0.0, 90.0)) -> Instance:
    """Three bars of 40 x 10 on sheets of 100 x 50."""
    sheet = Sheet("sheet", 100.0, 50.0, None, EDGE)
    return Instance("bars", (rectangle("bar", 40.0, 10.0, 3, rotations),), (sheet,), NestOptions(gap_mm=2.0))


def strip() -> Instance:
    """The same bars on a strip 20 high."""
    bar = rectangle("bar", 40.0, 10.0, 3, (0.0, 90.0))
    return Instance("strip", (bar,), (Sheet("strip", inf, 20.0, kind="roll"),), NestOptions())


def on(sheet: int, x: float, y: float, angle_deg: float = 0.0, stock: str = "sheet") -> Spot:
    return Spot("bar", stock, sheet, x, y, angle_deg)


BARS, STRIP = bars(), strip()
GOOD = [on(0, 5.0, 5.0), on(0, 5.0, 17.0), on(1, 5.0, 5.0)]


def test_densities_of_two_sheets_are_those_of_the_closed_form() -> None:
    found = measured(nesting_of(GOOD, BARS), BARS)
    assert (found.verdict, found.faults, found.sheets) == ("valid", (), 2)
    assert_near(found.density, 1200.0 / 10000.0, bound=1e-15, why="whole numbers")
    spared = (50.0 - 15.0 - EDGE) / 50.0 * 5000.0
    assert_near(found.equivalent, 1200.0 / (10000.0 - spared), bound=1e-15, why="cut above the third bar")


def test_density_of_a_strip_counts_the_length_used() -> None:
    spots = [on(0, 0.0, 0.0, stock="strip"), on(0, 0.5, 10.0, stock="strip"), on(0, 51.0, 0.0, 90.0, "strip")]
    spread = [Spot(s.part, s.stock, s.sheet, s.x + k, s.y, s.angle_deg) for k, s in enumerate(spots)]
    found = measured(nesting_of(spread, STRIP), STRIP)
    assert found.length_mm == 53.0
    assert_near(found.density, 1200.0 / (53.0 * 20.0), bound=1e-15, why="whole numbers")
    assert isnan(found.equivalent)


@pytest.mark.parametrize(
    ("spots", "word"),
    [
        ([on(0, 5.0, 5.0), on(0, 5.0, 10.0), on(1, 5.0, 5.0)], "overlap"),
        ([on(0, 5.0, 5.0), on(0, 5.0, 16.9), on(1, 5.0, 5.0)], "apart"),
        ([on(0, 4.9, 5.0), on(0, 5.0, 17.0), on(1, 5.0, 5.0)], "edge"),
        ([on(0, 5.0, 5.0), on(0, 5.0, 17.0), on(1, 5.0, 5.0, 1.0)], "turned"),
        ([on(0, 5.0, 5.0), on(0, 5.0, 17.0)], "not placed"),
        ([*GOOD, on(1, 5.0, 30.0)], "not asked for"),
        ([on(0, 5.0, 5.0), on(0, 5.0, 17.0), Spot("bar", "sheet", 1, 60.0, 5.0, 0.0, mirrored=True)], "mirrored"),
    ],
)
def test_a_planted_fault_is_flagged_as_invalid(spots: list[Spot], word: str) -> None:
    found = measured(nesting_of(spots, BARS), BARS)
    assert found.verdict == "INVALID"
    assert any(word in fault for fault in found.faults)


def test_what_single_precision_leaves_is_rounding_and_ten_times_that_is_not() -> None:
    noise = 1e-6 * 100.0
    near, far = ([on(0, 5.0, 5.0), on(0, 5.0, 17.0 - by), on(1, 5.0, 5.0)] for by in (noise / 2.0, 10.0 * noise))
    assert measured(nesting_of(near, BARS), BARS).verdict == "rounding"
    assert measured(nesting_of(far, BARS), BARS).verdict == "INVALID"


def test_overlaps_are_told_apart_by_their_depth() -> None:
    for by, verdict in ((1e-10, "valid"), (5e-5, "rounding"), (1e-2, "INVALID")):
        spots = [on(0, 0.0, 0.0, stock="strip"), on(0, 0.0, 10.0 - by, stock="strip"), on(0, 41.0, 0.0, stock="strip")]
        assert measured(nesting_of(spots, STRIP), STRIP).verdict == verdict


def test_an_angle_of_single_precision_is_the_allowed_one_and_no_other() -> None:
    pattern = BARS.patterns[0]
    assert snapped(89.9999974, pattern, NestOptions()) == 90.0
    assert snapped(-270.0000033, pattern, NestOptions()) == 90.0
    assert snapped(89.99, pattern, NestOptions()) == 89.99
    free = bars(rotations=None)
    assert snapped(89.9999974, free.patterns[0], NestOptions()) == 89.9999974
    assert snapped(89.9999974, free.patterns[0], NestOptions(rotations=(0.0, 90.0))) == 90.0


def test_what_a_cut_leaves_is_the_largest_of_the_four_sides() -> None:
    sheet = Sheet("sheet", 100.0, 50.0, edge_gap_mm=EDGE)
    assert left_over(sheet, (5.0, 5.0, 35.0, 45.0)) == 0.6
    assert left_over(sheet, (65.0, 5.0, 95.0, 45.0)) == 0.6
    assert left_over(sheet, (5.0, 5.0, 95.0, 15.0)) == 0.6
    assert left_over(sheet, (5.0, 5.0, 95.0, 45.0)) == 0.0


def test_no_equivalent_density_is_told_of_a_hide() -> None:
    hide = from_json("hide_synth_a", (FOLDER / "hide_synth_a.json").read_bytes()).stock[0]
    assert isnan(equivalent_density(1.0, [hide], [(0.0, 0.0, 1.0, 1.0)]))


def test_the_solution_of_a_jigsaw_has_its_known_density() -> None:
    pieces = cut(1)
    made = instance("jigsaw", jigsaw(1))
    found = measured(nesting_of([_home(k, piece) for k, piece in enumerate(pieces)], made), made)
    assert found.verdict in ("valid", "rounding")
    assert_near(found.length_mm, 5 * CELL_MM[0], bound=1e-9, why="sums of multiples of 1e-4")
    assert_near(found.density, 1.0 / SLACK, bound=1e-12, why="the rectangle, over its strip")


def _home(number: int, piece: Piece) -> Spot:
    """Return the placement that takes a piece handed out back to where it was cut."""
    ring_ = turned(piece)
    x, y = min(x for x, _ in ring_), min(y for _, y in ring_)
    for _ in range(piece.quarters):
        x, y = y, -x
    return Spot(f"part-{number}", "strip", 0, x, y, -90.0 * piece.quarters % 360.0)


def test_a_square_in_the_hole_of_a_ring_is_valid_with_the_gap_and_invalid_without() -> None:
    made = instance("ring", ring())
    hole = 5.0 + (RING_MM - HOLE_MM) / 2.0
    for at, verdict in ((hole + (HOLE_MM - SQUARE_MM) / 2.0, "valid"), (hole + GAP_MM - 0.1, "INVALID")):
        spots = [Spot("part-0", "sheet-0", 0, 5.0, 5.0, 0.0), Spot("part-1", "sheet-0", 0, at, at, 0.0)]
        assert measured(nesting_of(spots, made), made).verdict == verdict
