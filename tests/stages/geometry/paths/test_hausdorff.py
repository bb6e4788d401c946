from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.curves.plane import CircularArc, PlaneCurve, Segment
from stages.geometry.curves.rigid import Rigid2
from stages.geometry.flat.sampling import dense_points, length_and_area, resolved
from stages.geometry.paths import hausdorff as measure
from stages.geometry.paths.arcpath import ArcPath, transform
from stages.geometry.paths.biarc import fit, trace
from stages.geometry.paths.hausdorff import Deviation, hausdorff
from stages.geometry.paths.overlap import overlaps
from tests.stages.geometry.plane_curves import (
    CONE,
    ELLIPSE,
    SINE,
    TAU,
    Formula,
    brute_distance,
    polygon_distance,
    waves,
)

CIRCLE = ArcPath(np.array([[10.0, 0.0], [-10.0, 0.0]]), np.array([1.0, 1.0]), closed=True)
RECTANGLE = ArcPath(np.array([[0.0, 0.0], [40.0, 0.0], [40.0, 20.0], [0.0, 20.0]]), np.zeros(4), closed=True)


def deviation(edges: list[PlaneCurve], path: ArcPath, accuracy: float) -> Deviation:
    return hausdorff([resolved(edge, accuracy=0.01 * accuracy) for edge in edges], path, accuracy=accuracy)


def test_a_circle_of_another_radius_is_off_by_the_difference() -> None:
    found = deviation([CircularArc(np.zeros(2), 10.03, 0.0, TAU)], CIRCLE, 0.02)
    assert found.value_mm == pytest.approx(0.03, abs=2e-4)
    assert 0.03 <= found.bound_mm <= 0.031


def test_a_moved_circle_is_off_by_the_way_it_moved() -> None:
    found = deviation([CircularArc(np.array([0.3, -0.4]), 10.0, 0.0, TAU)], CIRCLE, 0.02)
    assert found.value_mm == pytest.approx(0.5, abs=1e-3)


def test_a_missing_hump_is_seen_from_both_sides() -> None:
    """A rectangle one of whose sides has a tooth of 3 mm in the path, or in the edges, only."""
    a, b, c, d = RECTANGLE.vertices
    tooth = np.array([[19.0, 0.0], [20.0, -3.0], [21.0, 0.0]])
    toothed = ArcPath(np.vstack([a, tooth, b, c, d]), np.zeros(7), closed=True)
    plain = [Segment(p, q) for p, q in ((a, b), (b, c), (c, d), (d, a))]
    ring = toothed.vertices
    edges = [Segment(ring[i - 1], ring[i]) for i in range(7)]
    assert deviation(plain, toothed, 0.02).value_mm == pytest.approx(3.0, abs=1e-9)
    assert deviation(edges, RECTANGLE, 0.02).value_mm == pytest.approx(3.0, abs=1e-9)
    assert deviation(edges, toothed, 0.02).value_mm <= 1e-12


def test_few_points_are_measured_as_many_are(monkeypatch: pytest.MonkeyPatch) -> None:
    """Comparing all pairs and asking the tree find the same distances, at corners and far away too."""
    ring = RECTANGLE.vertices + np.array([0.3, -0.2])
    edges: list[PlaneCurve] = [Segment(ring[i - 1], ring[i]) for i in range(4)]
    few = deviation(edges, RECTANGLE, 0.02)
    monkeypatch.setattr(measure, "FEW_PAIRS", 0)
    many = deviation(edges, RECTANGLE, 0.02)
    assert few.value_mm == many.value_mm == pytest.approx(float(np.hypot(0.3, 0.2)), abs=1e-12)


@settings(max_examples=12, deadline=None)
@given(waves(), st.sampled_from([0.1, 0.01]))
def test_it_agrees_with_a_brute_measure(curve: Formula, accuracy: float) -> None:
    path = fit(curve, accuracy=accuracy)
    found = deviation([curve], path, accuracy)
    brute = brute_distance([curve], path, 8000)
    assert brute <= found.bound_mm
    assert found.value_mm <= brute + 0.03 * accuracy


def test_long_lines_beside_dense_curves_give_no_false_alarm() -> None:
    ends = CONE.at(np.array([0.0, 1.0]))
    edges = [CONE, Segment(ends[1], np.zeros(2)), Segment(np.zeros(2), ends[0])]
    assert deviation(edges, trace(edges, accuracy=0.02), 0.02).bound_mm <= 0.02


def test_length_and_area_of_an_ellipse_are_the_closed_forms() -> None:
    from mpmath import ellipe

    length, area = length_and_area([resolved(ELLIPSE, accuracy=1e-3)], accuracy=1e-12)
    assert area == pytest.approx(5000.0 * pi, rel=1e-13)
    assert length == pytest.approx(400.0 * float(ellipe(0.75)), rel=1e-13)


def test_length_through_a_cusp_is_the_closed_form() -> None:
    cusp = Formula(lambda t: 100.0 * t**2 + 100j * t**3, lambda t: 200.0 * t + 300j * t**2)
    length, _ = length_and_area([resolved(cusp, accuracy=1e-3)], accuracy=1e-9)
    assert length == pytest.approx(100.0 * (13.0 * np.sqrt(13.0) - 8.0) / 27.0, rel=1e-10)


@pytest.mark.parametrize("accuracy", [0.1, 0.001])
@pytest.mark.parametrize("curve", [SINE, ELLIPSE, CONE])
def test_dense_points_are_as_near_as_they_say(curve: Formula, accuracy: float) -> None:
    points = dense_points(resolved(curve, accuracy=accuracy), accuracy=accuracy)
    fine = curve.at(np.linspace(0.0, 1.0, 20_000))
    assert polygon_distance(fine, points).max() <= accuracy


def test_a_shared_side_is_an_overlap_and_a_touching_corner_is_none() -> None:
    beside = transform(RECTANGLE, Rigid2(40.0, 5.0))
    touching = transform(RECTANGLE, Rigid2(40.0, 20.0))
    found = overlaps([RECTANGLE, beside], apart=1e-3, least=0.01)
    assert [(o.first, o.second) for o in found] == [(0, 1)]
    assert found[0].length_mm == pytest.approx(15.0)
    assert overlaps([RECTANGLE, touching], apart=1e-3, least=0.01) == []


@given(st.floats(0.0, 360.0))
def test_a_circle_cut_twice_is_an_overlap_however_it_begins(angle: float) -> None:
    found = overlaps([CIRCLE, transform(CIRCLE, Rigid2(0.0, 0.0, angle))], apart=1e-3, least=0.01)
    assert len(found) == 1
    assert found[0].length_mm == pytest.approx(20.0 * pi, rel=1e-3)


def test_a_path_that_runs_back_along_itself_is_an_overlap() -> None:
    spur = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [10.0, 15.0], [10.0, 10.0], [0.0, 10.0]])
    found = overlaps([ArcPath(spur, np.zeros(6), closed=True)], apart=1e-3, least=0.01)
    assert [(o.first, o.second) for o in found] == [(0, 0)]
    assert found[0].length_mm == pytest.approx(5.0)
