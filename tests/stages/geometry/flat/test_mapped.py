import numpy as np
import pytest

from stages.geometry.curves.plane import CircularArc, PlaneCurve, Segment
from stages.geometry.flat.development import develop
from stages.geometry.flat.mapped import FlatStrip, MappedEdge, images
from tests import oracles
from tests.near import assert_near
from tests.parts import AUMANN_CUBIC, OBLIQUE_CONE, QUINTIC_TANGENT, Table, patches
from tests.stages.geometry.ruled.test_drill import HALF_TUBE

DIAGONAL = Segment(np.array([0.1, 0.2]), np.array([0.9, 0.7]))
RING = CircularArc(np.array([0.5, 0.5]), 0.3, 0.4, 5.0)


def flat_of(table: Table) -> FlatStrip:
    made = develop(patches(table))
    return FlatStrip(made.pieces, np.arange(len(made.pieces) + 1.0))


@pytest.mark.parametrize("curve", [DIAGONAL, RING])
def test_a_mapped_curve_lies_where_the_exact_development_has_it(curve: PlaneCurve) -> None:
    c0, c1 = (oracles.bezier(QUINTIC_TANGENT[key]["bezier"]) for key in ("c0", "c1"))  # type: ignore[index]
    exact = oracles.flat_map(c0, c1)
    (edge,) = images(flat_of(QUINTIC_TANGENT), [curve])
    t = np.linspace(0.0, 1.0, 9)
    wanted = [[float(x) for x in exact(*place)] for place in curve.at(t)]
    assert_near(edge.at(t), wanted, bound=1e-12 * 750.0, why="positions of the flat map, 750 mm")


@pytest.mark.parametrize("table", [QUINTIC_TANGENT, AUMANN_CUBIC, HALF_TUBE])
@pytest.mark.parametrize("curve", [DIAGONAL, RING])
def test_the_derivative_is_that_of_the_points(table: Table, curve: PlaneCurve) -> None:
    (edge,) = images(flat_of(table), [curve])
    t, step = np.linspace(0.1, 0.9, 17), 1e-5
    slopes = (edge.at(t + step) - edge.at(t - step)) / (2.0 * step)
    scale = float(np.abs(slopes).max())
    assert_near(edge.derivative(t), slopes, bound=1e-8 * scale, why="differences: step^2, and 1e-15 / step")


def test_a_curve_is_cut_where_it_passes_a_joint_and_only_there() -> None:
    table = HALF_TUBE | {"directrix": {"polyline": [[0, 0, 0], [10, 0, 0], [10, 20, 0], [0, 40, 0]]}}
    flat = flat_of(table)
    across = Segment(np.array([0.2, 0.5]), np.array([0.4, 2.9]))
    edges = images(flat, [across])
    assert_near([edge.low for edge in edges], [0.0, 0.5 / 2.4, 1.5 / 2.4], bound=1e-15, why="closed form")
    # within one flat panel a straight line of u, v is straight
    for edge in edges:
        first, middle, last = edge.at(np.array([0.0, 0.5, 1.0]))
        assert_near(middle, (first + last) / 2.0, bound=1e-13, why="an affine map of 100 mm")
    assert len(images(flat, [Segment(np.array([0.2, 0.5]), np.array([0.9, 0.5]))])) == 1


def test_a_stretch_run_backwards_has_the_same_points() -> None:
    flat = flat_of(QUINTIC_TANGENT)
    there, back = MappedEdge(flat, RING, 0.2, 0.9), MappedEdge(flat, RING, 0.9, 0.2)
    t = np.linspace(0.0, 1.0, 33)
    assert_near(back.at(t), there.at(1.0 - t), bound=1e-12, why="one rounding of t")
    assert_near(back.derivative(t), -there.derivative(1.0 - t), bound=1e-9, why="one rounding of t, and its slope")


def test_the_image_of_a_spline_is_integrated_between_its_knots() -> None:
    """A rough spline: over grids that do not know its knots the two rules differ by more than is asked for."""
    from stages.geometry.curves.planespline import spline
    from stages.geometry.flat.sampling import length_and_area, resolved

    made = patches(OBLIQUE_CONE)
    flat = FlatStrip(develop(made).pieces, np.arange(len(made) + 1.0))
    angle = np.linspace(0.0, 2.0 * np.pi, 81)
    radius = 0.3 + 0.01 * np.random.default_rng(0).standard_normal(81)
    ring = 0.5 + radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    ring[-1] = ring[0]
    edges = images(flat, (spline(ring, periodic=True),))
    assert edges[0].breaks.size == angle.size
    length, _ = length_and_area([resolved(edge, accuracy=1e-3) for edge in edges], accuracy=1e-10)
    assert length > 0.0
