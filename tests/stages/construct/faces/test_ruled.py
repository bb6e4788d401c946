"""Which B-spline nets are ruled, to which degree they were raised, and which are not."""

import numpy as np
import pytest

from stages.construct.faces.ruled import Rails, exchanged, parallel, rails_of, ruled_form
from stages.construct.faces.strip import arcs
from stages.geometry.arrays import norm
from stages.geometry.curves.curves import Circular
from stages.model.cadface import CadNet, CadPlane, CadSweep
from tests.near import assert_near

PROFILE = np.array([[0.0, 0, 0], [30, 20, 5], [60, -10, 0], [100, 30, 10]])
APEX = np.array([50.0, 200, 300])
CLAMPED = np.array([0.0, 0, 0, 0, 1, 1, 1, 1])


def net(shares: list[float], knots: list[float], degree: int, weights: np.ndarray | None = None) -> CadNet:
    """Return the cone from the profile half the way to the apex, its rulings in a raised degree or with more knots."""
    w = np.ones(4) if weights is None else weights
    points = np.stack([PROFILE + 0.5 * share * (APEX - PROFILE) for share in shares], axis=1)
    return CadNet(3, degree, CLAMPED, np.array(knots, dtype=float), points, np.repeat(w[:, None], len(shares), axis=1))


STRAIGHT = {
    "degree 1": net([0, 1], [0, 0, 1, 1], 1),
    "rational": net([0, 1], [0, 0, 1, 1], 1, np.array([1.0, 2, 0.5, 1])),
    "degree 3": net([0, 1 / 3, 2 / 3, 1], [0, 0, 0, 0, 1, 1, 1, 1], 3),
    "a knot inserted": net([0, 0.3, 1], [0, 0, 0.3, 1, 1], 1),
    "degree 2 and a knot": net([0, 0.125, 0.625, 1], [0, 0, 0, 0.25, 1, 1, 1], 2),
}


@pytest.mark.parametrize("name", STRAIGHT)
def test_a_net_with_straight_rows_is_ruled_along_them(name: str) -> None:
    for given in (STRAIGHT[name], exchanged(STRAIGHT[name])):
        found = ruled_form(given)
        assert isinstance(found, Rails)
        (patch,) = found.patches
        v = np.linspace(0.0, 1.0, 9)
        to_apex = APEX - patch.c0.jet(v, 0)[0]
        assert_near(patch.p.jet(v, 0)[0], 0.5 * to_apex, bound=1e-12 * 400, why="half the way to the apex")
        assert parallel(found) is found


def test_one_control_point_off_by_a_billionth_makes_no_rulings() -> None:
    points = STRAIGHT["degree 3"].points.copy()
    points[1, 1, 2] += 1e-9 * 400
    bent = STRAIGHT["degree 3"].replace(points=points)
    assert isinstance(bent, CadNet)
    assert rails_of(bent) is None
    assert ruled_form(bent) is None


def test_rulings_run_unevenly_are_no_rows_of_a_straight_line() -> None:
    uneven = net([0, 0.5, 2 / 3, 1], [0, 0, 0, 0, 1, 1, 1, 1], 3)
    assert rails_of(uneven) is None


def test_a_flat_net_is_a_plane_and_parallel_rulings_are_a_sweep() -> None:
    tilted = np.array([[1.0, 0, 0.3], [0, 1, -0.2], [0, 0, 0]])
    flat_net = STRAIGHT["degree 3"].replace(points=STRAIGHT["degree 3"].points @ tilted)
    assert isinstance(flat_net, CadNet)
    assert isinstance(ruled_form(flat_net), CadPlane)
    points = np.stack([PROFILE, PROFILE + np.array([3.0, 4.0, 12.0])], axis=1)
    found = ruled_form(CadNet(3, 1, CLAMPED, np.array([0.0, 0, 1, 1]), points, np.ones((4, 2))))
    assert isinstance(found, Rails)
    level = parallel(found)
    assert isinstance(level, CadSweep)
    assert_near(level.direction, np.array([3, 4, 12]) / 13, bound=1e-15, why="a unit vector")


@pytest.mark.parametrize("sweep", [0.1, np.pi / 2, 4.0, 2 * np.pi])
def test_arcs_lie_on_their_ellipse(sweep: float) -> None:
    ring = Circular(np.array([1.0, 2, 3]), np.array([5.0, 0, 0]), np.array([0, 1.2, 1.6]), np.zeros(3), 0.0, 2 * np.pi)
    made = arcs(ring, 0.3, 0.3 + sweep)
    assert len(made) == max(int(np.ceil(sweep / (np.pi / 2) - 1e-9)), 1)
    points = np.concatenate([arc.jet(np.linspace(0, 1, 17), 0)[0] for arc in made]) - ring.centre
    along = np.stack([points @ ring.U / 25, points @ ring.V / 4], axis=1)
    assert_near(norm(along), np.ones(len(along)), bound=1e-14, why="on the circle that it is the image of")
    ends = np.arctan2(along[[0, -1], 1], along[[0, -1], 0])
    wanted = np.arctan2(np.sin([0.3, 0.3 + sweep]), np.cos([0.3, 0.3 + sweep]))
    assert_near(ends, wanted, bound=1e-14, why="from angle to angle")
