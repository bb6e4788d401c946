"""Widened outlines: corners in closed form, another program's buffer as second method, and what cannot be widened."""

from collections.abc import Sequence
from math import cos, pi, sin, sqrt, tan

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from stages.geometry.arrays import Points2, norm
from stages.geometry.curves import contours
from stages.geometry.curves.parallel import Parallel
from stages.geometry.curves.plane import CircularArc, PlaneCurve, Segment
from stages.geometry.paths.allowance import Fault, Widened, widened
from stages.geometry.paths.arcpath import polygon
from stages.geometry.paths.biarc import trace
from tests.near import assert_near, assert_relative
from tests.stages.geometry.curves.test_parallel import Ellipse

ACCURACY = 0.05
Corners = Sequence[tuple[float, float]]
BOX: Corners = [(0, 0), (100, 0), (100, 50), (0, 50)]
ELL: Corners = [(0, 0), (100, 0), (100, 40), (40, 40), (40, 90), (0, 90)]
SLOT: Corners = [(0, 0), (40, 0), (40, 30), (44, 30), (44, 0), (100, 0), (100, 60), (0, 60)]


def outline(corners: Corners) -> tuple[PlaneCurve, ...]:
    points = np.array(corners, dtype=float)
    return tuple(Segment(a, b) for a, b in zip(points, np.roll(points, -1, axis=0), strict=True))


def made(edges: Sequence[PlaneCurve], distances: Sequence[float]) -> Widened:
    found = widened(edges, [float(one) for one in distances], accuracy=ACCURACY)
    assert isinstance(found, Widened)
    ends = [edge.at(np.array([0.0, 1.0])) for edge in found.edges]
    gaps = [norm(ends[i][0] - ends[i - 1][1]) for i in range(len(ends))]
    assert_near(gaps, np.zeros(len(gaps)), bound=1e-9, why="each edge begins where the one before ends")
    return found


def starts(found: Widened) -> Points2:
    return np.array([edge.at(np.zeros(1))[0] for edge in found.edges])


@pytest.mark.parametrize(
    ("distances", "corners"),
    [
        ([8, 8, 8, 8], [(-8, -8), (108, -8), (108, 58), (-8, 58)]),
        ([8, 0, 0, 0], [(0, -8), (100, -8), (100, 50), (0, 50)]),
        ([8, 5, 3, 0], [(0, -8), (105, -8), (105, 53), (0, 53)]),
        ([0, 0, 0, 0], BOX),
    ],
)
def test_a_rectangle_gets_its_mitres_whatever_its_allowances(distances: list[float], corners: Corners) -> None:
    assert_near(starts(made(outline(BOX), distances)), corners, bound=1e-12, why="right angles")


def test_in_a_hollow_corner_both_end_where_they_cross() -> None:
    found = made(outline(ELL), [8] * 6)
    assert_near(starts(found)[3], [48, 48], bound=1e-12, why="8 outward from both edges at (40, 40)")
    assert all(isinstance(edge, Segment) for edge in found.edges) and len(found.edges) == 6


def test_a_sharp_corner_is_cut_off_between_the_ends_of_both_strips() -> None:
    found = made(outline([(0, 0), (100, 0), (100, 30)]), [6, 6, 6])
    angle = np.arctan2(30.0, 100.0)
    bevel = [(-6.0 * sin(angle), 6.0 * cos(angle)), (0.0, -6.0)]
    first = next(i for i, strip in enumerate(found.strips) if strip is None)
    assert found.strips.count(None) == 1
    ends = [starts(found)[first], starts(found)[(first + 1) % len(found.edges)]]
    assert_near(ends, bevel, bound=1e-12, why="square to both edges at (0, 0)")


@pytest.mark.parametrize("degrees", [61.0, 90.0, 120.0, 125.0])
def test_a_mitre_lies_on_both_parallels(degrees: float) -> None:
    angle = np.radians(degrees)
    far = (100.0 * cos(angle), 100.0 * sin(angle))
    found = made(outline([(0, 0), (100, 0), (100.0 + far[0], far[1] + 40.0), far]), [5.0, 7.0, 0.0, 3.0])
    (x, y), own = starts(found)[0], np.array([-sin(angle), cos(angle)])
    assert_near([y, np.array([x, y]) @ own], [-5.0, 3.0], bound=1e-10, why="5 below one edge, 3 left of the other")


def rounded(radius: float = 20.0, width: float = 350.0, height: float = 95.0) -> tuple[PlaneCurve, ...]:
    x, y, r = width, height, radius
    corners = [(x - r, r, -0.5), (x - r, y - r, 0.0), (r, y - r, 0.5), (r, r, 1.0)]
    arcs = [CircularArc(np.array([cx, cy]), r, a * pi, pi / 2.0) for cx, cy, a in corners]
    ends = [(arc.at(np.zeros(1))[0], arc.at(np.ones(1))[0]) for arc in arcs]
    return tuple(edge for i, arc in enumerate(arcs) for edge in (Segment(ends[i - 1][1], ends[i][0]), arc))


def test_rounded_corners_stay_arcs_of_a_larger_radius() -> None:
    edges = rounded()
    found = made(edges, [8.0] * 8)
    assert [type(edge) for edge in found.edges] == [Segment, CircularArc] * 4
    length, area = contours.length(edges), contours.area(edges)
    assert_relative([contours.area(found.edges)], [area + 8.0 * length + 64.0 * pi], bound=1e-13, why="Steiner")


def test_where_an_allowance_ends_on_a_smooth_outline_it_ends_at_a_right_angle() -> None:
    found = made(rounded(), [8.0, *[0.0] * 7])
    steps = [edge for edge, strip in zip(found.edges, found.strips, strict=True) if strip is None]
    ends = [(edge.at(np.zeros(1))[0], edge.at(np.ones(1))[0]) for edge in steps]
    assert_near(ends, [[(330, -8), (330, 0)], [(20, 0), (20, -8)]], bound=1e-12, why="square to the straight edge")


@pytest.mark.parametrize(("a", "b"), [(10.0, 2.0), (2.0, 10.0)])
def test_a_shallow_corner_between_unequal_strips_gets_a_step(a: float, b: float) -> None:
    turn = np.radians(10.0)
    edges = outline([(0, 0), (100, 0), (100 + 100 * cos(turn), 100 * sin(turn)), (100, 200), (0, 200)])
    found = made(edges, [a, b, 0, 0, 0])
    place = starts(found)
    step = next(i for i, strip in enumerate(found.strips) if strip is None)
    out = np.array([0.0, -1.0]) if a > b else np.array([sin(turn), -cos(turn)])
    foot, top = np.array([100.0, 0.0]) + min(a, b) / cos(turn) * out, np.array([100.0, 0.0]) + max(a, b) * out
    assert_near(place[step : step + 2], [top, foot] if a > b else [foot, top], bound=1e-12, why="along the normal")


@pytest.mark.parametrize(("a", "b"), [(10.0, 2.0), (2.0, 10.0)])
def test_a_shallow_hollow_corner_between_unequal_strips_gets_a_step(a: float, b: float) -> None:
    turn = np.radians(-10.0)
    far = (100 + 100 * cos(turn), 100 * sin(turn))
    found = made(outline([(0, 0), (100, 0), far, (200, 200), (0, 200)]), [a, b, 0, 0, 0])
    step = next(i for i, strip in enumerate(found.strips) if strip is None)
    ends = starts(found)[step : step + 2]
    assert_near([norm(ends[1] - ends[0])], [abs(a - b) + min(a, b) * (1 - 1 / cos(turn))], bound=1e-9, why="a - b/cos")
    along = np.array([1.0, 0.0]) if a > b else np.array([cos(turn), sin(turn)])
    assert_near([(ends[1] - ends[0]) @ along], [0.0], bound=1e-9, why="square to the edge of the wider strip")


def test_a_curved_edge_is_met_by_its_tangent() -> None:
    half = np.array([1.0, 0.0])
    found = made((Segment(-100.0 * half, 100.0 * half), Half()), [5.0, 10.0])
    assert [type(edge) for edge in found.edges] == [Segment, Segment, Parallel, Segment]
    assert_near(starts(found), [(-110, -5), (110, -5), (110, 0), (-110, 0)], bound=1e-9, why="the ellipse ends upright")


class Half(Ellipse):
    """The upper half of an ellipse."""

    def at(self, t: np.ndarray) -> Points2:
        return super().at(t / 2.0)

    def derivative(self, t: np.ndarray) -> Points2:
        return super().derivative(t / 2.0) / 2.0


def test_short_edges_in_a_hollow_are_passed_over() -> None:
    angle = np.linspace(pi, 0.0, 60)
    round_it = [(60.0 * cos(a), 60.0 * sin(a)) for a in angle]
    corners = [(200.0, 100.0), (-200.0, 100.0), (-200.0, 0.0), *round_it, (200.0, 0.0)]
    found = made(outline(corners), [8.0] * len(corners))
    want = shapely.Polygon(corners).buffer(8.0, join_style="mitre", mitre_limit=2.0).area
    assert_relative([contours.area(found.edges)], [want], bound=1e-9, why="another program's mitred buffer")


@given(st.integers(0, 2**32 - 1), st.floats(0.5, 6.0))
def test_random_stars_are_widened_as_another_program_does(seed: int, wide: float) -> None:
    rng = np.random.default_rng(seed)
    count = int(rng.integers(3, 12))
    angle = (np.arange(count) + rng.uniform(0.1, 0.9, count)) * 2.0 * pi / count
    corners = (rng.uniform(60.0, 100.0, count) * np.array([np.cos(angle), np.sin(angle)])).T
    region = shapely.Polygon(corners)
    sharp = _sharpest(corners)
    if not region.is_valid or region.area < 100.0 or sharp < pi / 2.5:
        return
    found = widened(outline([tuple(p) for p in corners]), [wide] * count, accuracy=ACCURACY)
    assert isinstance(found, Widened)
    want = region.buffer(wide, join_style="mitre", mitre_limit=10.0).area
    assert_relative([contours.area(found.edges)], [want], bound=1e-9, why="mitres without a limit, above 72 degrees")


def _sharpest(corners: Points2) -> float:
    step = np.roll(corners, -1, axis=0) - corners
    before = -np.roll(step, 1, axis=0)
    cosine = np.einsum("ij,ij->i", step, before) / norm(step) / norm(before)
    return float(np.arccos(np.clip(cosine, -1.0, 1.0)).min())


def test_a_slot_that_an_allowance_fills_is_a_fault_at_its_bottom() -> None:
    found = widened(outline(SLOT), [8.0] * 8, accuracy=ACCURACY)
    assert isinstance(found, Fault)
    assert_near(found.at, [42.0, 30.0], bound=1e-12, why="the middle of the edge that has no room")
    assert isinstance(widened(outline(SLOT), [1.9] * 8, accuracy=ACCURACY), Widened), "with room it is widened"


def test_a_hollow_of_too_small_a_radius_is_a_fault_with_that_radius() -> None:
    bite = CircularArc(np.array([50.0, 0.0]), 5.0, pi, -pi)
    corners = [(55.0, 0.0), (100.0, 0.0), (100.0, 50.0), (0.0, 50.0), (0.0, 0.0), (45.0, 0.0)]
    edges = (*outline(corners)[:-1], bite)
    found = widened(edges, [6.0] * 6, accuracy=ACCURACY)
    assert isinstance(found, Fault)
    assert (found.edge, found.radius_mm) == (5, 5.0)


@pytest.mark.parametrize("turn", range(0, 360, 45))
def test_turning_an_outline_turns_what_it_is_widened_to(turn: int) -> None:
    angle = np.radians(turn)
    matrix = np.array([[cos(angle), -sin(angle)], [sin(angle), cos(angle)]])
    turned = [tuple(matrix @ corner) for corner in ELL]
    distances = [8.0, 3.0, 5.0, 0.0, 4.0, 2.0]
    plain, moved = made(outline(ELL), distances), made(outline(turned), distances)
    assert_near(starts(moved), starts(plain) @ matrix.T, bound=1e-11, why="a rotation of 130 mm")


def test_what_is_cut_holds_the_sew_line_and_is_as_wide_as_asked_across_from_it() -> None:
    edges = rounded(radius=12.0, width=120.0, height=70.0)
    found = made(edges, [8.0, 8.0, 8.0, 8.0, 4.0, 4.0, 4.0, 4.0])
    inner, outer = (shapely.Polygon(polygon(trace(e, accuracy=1e-3), accuracy=1e-4)) for e in (edges, found.edges))
    assert outer.buffer(1e-6).covers(inner)
    for edge, wide in ((edges[2], 8.0), (edges[6], 4.0)):
        middle = shapely.Point(edge.at(np.array([0.5]))[0])
        assert_near([outer.exterior.distance(middle)], [wide], bound=2e-3, why="trace and polygon within 1.1e-3")


def test_the_limit_of_a_mitre_is_a_corner_of_sixty_degrees() -> None:
    for degrees, bevels in ((59.0, 1), (61.0, 0)):
        rise = 100.0 * tan(np.radians(degrees))
        found = made(outline([(0, 0), (100, 0), (100, rise)]), [6, 6, 6])
        near = [i for i, point in enumerate(starts(found)) if norm(point) < 6.0 * sqrt(5.0)]
        assert sum(found.strips[i] is None for i in near) == bevels
