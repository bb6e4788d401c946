"""Common lines: what they excuse from the gap, and all that they do not."""

from math import cos, log2, radians, sin, tan

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from stages.geometry.arrays import Points2, Values
from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths import arcs
from stages.geometry.paths.clearance import Pieces, pieces
from stages.model.pattern import FlatPattern
from stages.model.sheet import Nesting, NestOptions, Placement, Sheet, SheetLayout
from stages.nest.legal.certify import certify, passed
from stages.nest.legal.common import Line, _cut, common_stretches
from stages.nest.legal.laid import lay
from tests.near import assert_near
from tests.stages.nest.shapes import Corners, box, contour, pattern, rectangle, ring

SHEET = Sheet("s", 2000.0, 2000.0)
KERF, GAP = 0.2, 5.0
COMMON = NestOptions(gap_mm=GAP, kerf_mm=KERF, common_line=True)
HAIR = 1e-6
Metrics = dict[str, float | bool | None]


def judged(placed: list[tuple[FlatPattern, Rigid2]], options: NestOptions = COMMON) -> tuple[list[str], Metrics]:
    """Return the codes and the metrics of parts where they lie, all of them moved and turned together."""
    parts = [part.replace(part=f"{part.part}{i}") for i, (part, _) in enumerate(placed)]
    laid = tuple(Placement(part.part, 1, motion) for part, (_, motion) in zip(parts, placed, strict=True))
    nesting = Nesting((SheetLayout(SHEET, 1, laid, 0.0),))
    metrics, findings = certify(nesting, parts, [SHEET], options)
    assert passed(metrics, findings) == (not findings)
    return [finding.code for finding in findings], {metric.name: metric.value for metric in metrics}


def codes(*placed: tuple[FlatPattern, Rigid2], options: NestOptions = COMMON) -> list[str]:
    return judged(list(placed), options)[0]


A, B = rectangle("a", 100.0, 60.0), rectangle("b", 100.0, 60.0)
HERE = Rigid2(500.0, 500.0)


def beside(apart: float, along: float = 0.0, angle: float = 0.0) -> Rigid2:
    return Rigid2(500.0 + 100.0 + apart, 500.0 + along, angle)


def test_a_kerf_between_facing_edges_is_enough_where_it_is_asked_for() -> None:
    assert codes((A, HERE), (B, beside(KERF))) == []
    assert codes((A, HERE), (B, beside(KERF)), options=NestOptions(GAP, kerf_mm=KERF)) == ["gap"]


@pytest.mark.parametrize("angle", [0.0, 31.0, 90.0, 200.0])
def test_it_holds_in_any_direction(angle: float) -> None:
    c, s = cos(radians(angle)), sin(radians(angle))
    reach = 100.0 + KERF
    other = Rigid2(800.0 + reach * c - 7.0 * s, 800.0 + reach * s + 7.0 * c, angle)
    assert codes((A, Rigid2(800.0, 800.0, angle)), (B, other)) == []


@pytest.mark.parametrize("apart", [KERF - 2.0 * HAIR, KERF + 2.0 * HAIR, 1.0, GAP - 2.0 * HAIR, 0.0])
def test_any_other_distance_under_the_gap_is_found(apart: float) -> None:
    assert "gap" in codes((A, HERE), (B, beside(apart)))


def test_a_kerf_within_the_tolerance_passes() -> None:
    assert codes((A, HERE), (B, beside(KERF + HAIR / 2.0))) == []
    assert codes((A, HERE), (B, beside(KERF - HAIR / 2.0))) == []


def test_edges_that_are_not_parallel_are_found() -> None:
    assert codes((A, HERE), (B, beside(KERF, angle=-2.0 * HAIR / 60.0 * 57.3))) == ["gap"]
    assert codes((A, HERE), (B, beside(KERF, angle=-0.2 * HAIR / 60.0 * 57.3))) == []


def test_an_overlap_of_less_than_20_mm_is_found() -> None:
    assert codes((A, HERE), (B, beside(KERF, along=40.0 - HAIR))) == []
    assert codes((A, HERE), (B, beside(KERF, along=40.0 + HAIR))) == ["gap"]


def test_no_kerf_at_all_lets_the_edges_touch() -> None:
    knife = NestOptions(GAP, kerf_mm=0.0, common_line=True)
    assert codes((A, HERE), (B, beside(0.0)), options=knife) == []
    assert codes((A, HERE), (B, beside(0.2)), options=knife) == ["gap"]
    assert set(codes((A, HERE), (B, beside(-2.0 * HAIR)), options=knife)) == {"gap", "overlap"}


def test_the_smallest_gap_leaves_common_lines_out_and_tells_theirs() -> None:
    far = rectangle("c", 50.0, 50.0)
    _, metrics = judged([(A, HERE), (B, beside(KERF)), (far, Rigid2(500.0, 560.0 + GAP + 0.5))])
    assert_near(metrics["min_gap_mm"], GAP + 0.5, bound=1e-12, why="above a")
    assert_near(metrics["min_common_gap_mm"], KERF, bound=1e-12, why="between a and b")
    _, metrics = judged([(A, HERE), (B, beside(GAP))])
    assert "min_common_gap_mm" not in metrics


def nosed(nose: float, off: float) -> FlatPattern:
    """A plate 100 x 60 whose left side has a recess between the common edge and a nose that is `off` mm behind it."""
    recess = 40.0
    corners: Corners = [
        (0.0, 0.0),
        (100.0, 0.0),
        (100.0, 200.0),
        (off, 200.0),
        (off, 200.0 - nose),
        (recess, 200.0 - nose),
        (recess, 40.0),
        (0.0, 40.0),
    ]
    return pattern("n", contour(corners))


TALL = rectangle("t", 100.0, 200.0)


def test_a_nose_that_comes_back_further_on_keeps_the_gap() -> None:
    assert codes((TALL, HERE), (nosed(30.0, GAP - KERF), beside(KERF))) == []
    assert codes((TALL, HERE), (nosed(30.0, GAP - KERF - 2.0 * HAIR), beside(KERF))) == ["gap"]


def test_a_nose_near_the_common_line_that_does_not_hang_together_with_it_keeps_the_gap() -> None:
    """Its tip is 8 mm from the end of the common line, within two gaps, but the way there leads round a recess."""
    assert codes((TALL, HERE), (nosed(152.0, GAP - KERF), beside(KERF))) == []
    assert codes((TALL, HERE), (nosed(152.0, 1.0), beside(KERF))) == ["gap"]


def test_two_common_lines_of_one_pair_are_both_excused() -> None:
    assert codes((TALL, HERE), (nosed(30.0, 0.0), beside(KERF))) == []
    assert codes((TALL, HERE), (nosed(19.0, 0.0), beside(KERF))) == ["gap"], "the nose is too short for a common line"


def slit(opening_deg: float) -> FlatPattern:
    """A plate whose left side is vertical over 60 mm and then recedes at an angle."""
    top = 60.0 + 60.0 / tan(radians(opening_deg))
    return pattern("s", contour([(0.0, 0.0), (100.0, 0.0), (100.0, top), (60.0, top), (0.0, 60.0)]))


@pytest.mark.parametrize(
    ("opening", "wanted"), [(90.0 - 1e-9, []), (60.0, []), (30.0, []), (28.0, ["gap"]), (5.0, ["gap"])]
)
def test_a_slit_at_the_end_of_a_common_line_opens_by_30_degrees(opening: float, wanted: list[str]) -> None:
    long = rectangle("l", 100.0, 1000.0)
    assert codes((long, Rigid2(500.0, 200.0)), (slit(opening), beside(KERF))) == wanted


@pytest.mark.parametrize("sharp", [60.0, 18.4, 6.0])
def test_the_sharp_ends_of_two_triangles_along_their_long_sides_are_excused(sharp: float) -> None:
    """Two halves of a rectangle: beside a tip, the other side of the same triangle is near its neighbour as well."""
    height = 300.0 * tan(radians(sharp))
    triangle = pattern("w", contour([(0.0, 0.0), (300.0, 0.0), (300.0, height)]))
    away = KERF * np.array([-sin(radians(sharp)), cos(radians(sharp))])
    other = Rigid2(500.0 + 300.0 + away[0], 500.0 + height + away[1], 180.0)
    assert codes((triangle, HERE), (triangle, other)) == []


def test_rounded_corners_at_the_end_of_a_common_line_are_excused_if_they_are_small() -> None:
    def rounded(radius: float) -> FlatPattern:
        quarter = tan(radians(22.5))
        corners = [(0.0, 0.0), (100.0, 0.0), (100.0, 80.0), (radius, 80.0), (0.0, 80.0 - radius)]
        return pattern("r", contour(corners, [0.0, 0.0, 0.0, quarter, 0.0]))

    assert codes((TALL, HERE), (rounded(3.0), beside(KERF))) == []
    assert codes((TALL, HERE), (rounded(40.0), beside(KERF))) == ["gap"], "a slit that opens slowly at first"


def lens(bulge: float) -> Pieces:
    """A plate 100 mm wide whose right side is the straight one of a common line, and whose other three are arcs."""
    corners = [(0.0, 0.0), (100.0, 0.0), (100.0, 80.0), (0.0, 80.0)]
    return pieces(contour(corners, [bulge, 0.0, bulge, bulge]).path)


def cut(plate: Pieces, gap: float) -> tuple[Pieces, NDArray[np.bool_]]:
    some, near = _cut(plate, [Line(0, 1, np.stack([plate.start[1], plate.end[1]]))], gap)
    return some, near[:, 0]


@pytest.mark.parametrize("gap", [5.0, 1e-3, 2e-6])
def test_however_small_the_gap_arcs_are_cut_into_few_pieces(gap: float) -> None:
    """Three arcs of some 300 mm, eight places each at most, two parts to a halving down to a quarter of the gap."""
    some, _ = cut(lens(0.3), gap)
    assert some.bulge.size <= 1 + 3 * 8 * 2 * log2(100.0 / (gap / 4.0))


def on_arcs(some: Pieces, share: Values) -> Points2:
    """Return points at the same shares of all pieces, one piece after the other."""
    start, end, bulge = (np.repeat(one, share.size, axis=0) for one in (some.start, some.end, some.bulge))
    found: Points2 = arcs.between(start, end, arcs.sweeps(bulge), np.tile(share, some.bulge.size))
    return found


def off_side(points: Points2) -> Values:
    """Return how far points are from the right side of the plate, mm."""
    away: Values = np.hypot(points[:, 0] - 100.0, points[:, 1] - np.clip(points[:, 1], 0.0, 80.0))
    return away


@settings(max_examples=40, deadline=None)
@given(st.floats(-0.6, 0.9), st.floats(-2.0, 1.8))
def test_of_an_arc_is_excused_what_is_near_but_for_a_quarter_gap_and_nothing_else(bulge: float, decade: float) -> None:
    gap, plate = 10.0**decade, lens(bulge)
    some, near = cut(plate, gap)
    away = off_side(on_arcs(some.take(np.flatnonzero(near)), np.linspace(0.0, 1.0, 41)))
    assert away.max() <= 2.0 * gap + 1e-9, "1e-9: rounding of places and shares at 100 mm"
    below = (some.start[:, 1] + some.end[:, 1] < 80.0) & (some.start[:, 0] + some.end[:, 0] < 200.0)
    back = on_arcs(plate.take(np.array([0])), np.linspace(1.0, 0.0, 20_001))
    surely = np.cumprod(off_side(back) <= 1.75 * gap).sum() - 1
    whole = float(arcs.lengths(plate.start, plate.end, arcs.sweeps(plate.bulge))[0])
    excused = arcs.lengths(some.start, some.end, arcs.sweeps(some.bulge))[near & below].sum()
    assert excused >= whole * surely / 20_000 - gap / 4.0 - 1e-9, "a part may begin a quarter of a gap before the edge"


def test_a_hole_near_the_common_edge_needs_no_excuse_of_its_own() -> None:
    holed = pattern("h", contour(box(100.0, 60.0)), contour(box(20.0, 20.0, 2.0, 20.0), hole=True))
    assert codes((A, HERE), (holed, beside(KERF))) == []


def test_in_a_hole_there_are_no_common_lines() -> None:
    frame = pattern("f", contour(box(200.0, 200.0)), contour(box(100.0, 100.0, 50.0, 50.0), hole=True))
    lid = rectangle("l", 100.0 - KERF - GAP, 100.0 - 2.0 * GAP)
    assert codes((frame, HERE), (lid, Rigid2(550.0 + KERF, 550.0 + GAP))) == ["gap"]
    assert (
        codes((ring("o", 90.0, 70.0), Rigid2(800.0, 800.0)), (rectangle("q", 60.0, 60.0), Rigid2(770.0, 770.0))) == []
    )


def test_three_in_a_row_share_two_lines_and_a_fourth_keeps_the_gap() -> None:
    row = [(A, HERE), (B, beside(KERF)), (A, beside(100.0 + 2.0 * KERF))]
    assert codes(*row) == []
    assert codes(*row, (B, beside(KERF, along=60.0 + GAP))) == []
    assert codes(*row, (B, beside(KERF, along=60.0 + GAP - 2.0 * HAIR))) == ["gap"]


def crossed(kerf: float, shift: float = 0.0) -> list[tuple[FlatPattern, Rigid2]]:
    """Four plates about a cross; the upper two moved to the right."""
    upper = [Rigid2(500.0 + x + shift, 560.0 + kerf) for x in (0.0, 100.0 + kerf)]
    return [(A, HERE), (B, beside(kerf)), (A, upper[0]), (B, upper[1])]


@pytest.mark.parametrize("kerf", [KERF, 0.0, 2.0])
def test_four_corners_about_a_cross_are_excused_across_too(kerf: float) -> None:
    options = NestOptions(GAP, kerf_mm=kerf, common_line=True)
    assert codes(*crossed(kerf), options=options) == []
    assert codes(*crossed(kerf, shift=30.0), options=options) == [], "bricks"
    diagonal = [crossed(kerf)[0], crossed(kerf)[3]]
    assert codes(*diagonal, options=options) == ["gap"], "two corners alone have no common line"


def test_a_part_that_is_near_a_cross_but_shares_no_line_keeps_the_gap() -> None:
    three = [(A, HERE), (B, beside(KERF)), (rectangle("c", 15.0, 60.0), Rigid2(592.0, 560.0 + KERF))]
    assert codes(*three) == ["gap"], "8 mm of it face a, 7 mm face b"


def test_where_a_common_line_lies_and_how_long_it_is() -> None:
    one, other = lay(A, Placement("a", 1, HERE)), lay(B, Placement("b", 1, beside(KERF, along=25.0)))
    (stretch,) = common_stretches(one.region, other.region, KERF)
    assert_near(np.sort(stretch.on_first[:, 1]), np.array([525.0, 560.0]), bound=1e-12, why="the overlap of the sides")
    assert_near(stretch.on_second[:, 0] - stretch.on_first[:, 0], np.full(2, KERF), bound=1e-12, why="kerf")
    assert_near(stretch.on_second[:, 1], stretch.on_first[:, 1], bound=1e-12, why="they face each other")
