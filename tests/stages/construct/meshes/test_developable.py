"""Meshes of developables of any sort: fitted as envelopes of their tangent planes, and laid flat."""

import numpy as np
import pytest

from stages.construct.meshes.developable import Found, developable
from stages.errors import NoSolutionError
from stages.geometry.arrays import Points2
from stages.geometry.flat.development import develop
from stages.geometry.mesh.envelope import Developed, patch_of
from stages.geometry.mesh.fit import fitted, stars
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.rulings import enveloped
from stages.geometry.mesh.topology import edges_of
from stages.geometry.ruled.ruled import frames, warp_of
from stages.unroll import unroll
from stages.unroll.sides import surface_figures
from stages.verify import verify
from tests.meshes import Known, cylinder, ruled
from tests.meshregions import flipped, loops_of, moved
from tests.near import assert_near, assert_relative
from tests.parts import AUMANN_CUBIC, DEFAULT, OBLIQUE_CONE, RIGHT_FRUSTUM, Table, part, patches

PART = part(RIGHT_FRUSTUM)
GRID = (80, 24)


def known(table: Table) -> Known:
    """Return the mesh of a developable with its exact flat positions."""
    return ruled(patches(table)[0], 0, *GRID)


def found(mesh: Mesh) -> Found | None:
    """Return what a mesh is recovered as."""
    return developable(PART, mesh, loops_of(mesh), DEFAULT)


def misfit(one: Points2, other: Points2) -> float:
    """Return the largest distance of points from those of a congruent set, laid on each other."""
    a, b = one - one.mean(axis=0), other - other.mean(axis=0)
    left, _, right = np.linalg.svd(a.T @ b)
    return float(np.hypot(*(a @ left @ right - b).T).max())


@pytest.mark.parametrize("table", [OBLIQUE_CONE, AUMANN_CUBIC], ids=["oblique cone", "with an inflection"])
def test_vertices_lie_flat_where_they_should(table: Table) -> None:
    """The goal is a millionth of the size; a smooth family of planes does much better."""
    exact = known(table)
    fit = fitted(exact.mesh, stars(exact.mesh, edges_of(exact.mesh)))
    family = enveloped(exact.mesh, fit, enough_mm=1e-10 * exact.size)
    assert family is not None
    assert_near(float(np.abs(family.off).max()) / exact.size, 0.0, bound=1e-7, why="the goal for clean meshes")
    made = patch_of(exact.mesh, family)
    assert made is not None
    flat = Developed(made.patch, made.places).flat
    assert_near(misfit(flat, exact.flat) / exact.size, 0.0, bound=1e-6, why="the goal for flat positions")


@pytest.mark.parametrize("change", [lambda mesh: mesh, flipped, moved], ids=["as it is", "flipped", "moved"])
def test_an_oblique_cone_is_found_with_its_apex(change: object) -> None:
    assert callable(change)
    exact = known(OBLIQUE_CONE)
    one = found(change(exact.mesh))
    assert one is not None
    named = one.detail["recognised"]
    assert isinstance(named, dict)
    assert named["kind"] == "general cone"
    warp = warp_of(frames(one.surface.patches[0], np.linspace(0.0, 1.0, 65)))
    assert_near(float(warp.max()), 0.0, bound=np.radians(1e-9), why="an envelope is developable: rounding is left")


def test_the_pattern_has_the_area_of_the_surface() -> None:
    one = found(known(OBLIQUE_CONE).mesh)
    assert one is not None
    certificate = verify(one.surface, DEFAULT).product
    assert certificate is not None
    outcome = unroll(certificate, DEFAULT)
    assert outcome.product is not None
    flat = outcome.report.detail["flat"]
    assert isinstance(flat, dict)
    _, area = surface_figures(patches(OBLIQUE_CONE)[:1])
    # splines through 80 points of each edge: the fourth power of the spacing, 1/80, with derivatives of some ten
    assert_relative(flat["area"], area, bound=1e-6, why="the outline between the vertices")


def test_a_cylinder_is_a_general_one_too() -> None:
    mesh = cylinder(0, *GRID).mesh
    one = found(mesh)
    assert one is not None
    named = one.detail["recognised"]
    assert isinstance(named, dict)
    assert named["kind"] == "general cylinder"
    assert_near(np.abs(named["axis"]), [0.0, 0.0, 1.0], bound=1e-7, why="the direction of all rulings")


def test_half_a_degree_of_warp_is_not_recovered() -> None:
    mesh = cylinder(0, *GRID).mesh
    x = mesh.vertices
    twist = np.radians(0.5) * x[:, 0] / 100.0 * (x[:, 2] - 25.0)
    assert found(Mesh(x + np.column_stack([0.0 * twist, twist, 0.0 * twist]), mesh.faces)) is None


def test_few_vertices_are_left_to_others() -> None:
    assert found(cylinder(0, 10, 4).mesh) is None


def test_the_chart_takes_flat_points_back() -> None:
    patch = patches(OBLIQUE_CONE)[0]
    u, v = np.meshgrid(np.linspace(0.0, 1.0, 12), np.linspace(0.0, 1.0, 20))
    chart = Developed(patch, np.column_stack([u.ravel(), v.ravel()]))
    places = np.random.default_rng(0).uniform(0.05, 0.95, (50, 2))
    points = develop((patch,)).pieces[0].positions(places[:, 0], places[:, 1])
    assert_near(chart.places(points), places, bound=1e-9, why="Newton's method from a neighbour, to rounding")


def test_a_flat_point_that_newtons_method_does_not_come_to_is_no_solution() -> None:
    """Far from every vertex there is nothing near to start from."""
    u, v = np.meshgrid(np.linspace(0.0, 1.0, 12), np.linspace(0.0, 1.0, 20))
    chart = Developed(patches(OBLIQUE_CONE)[0], np.column_stack([u.ravel(), v.ravel()]))
    with pytest.raises(NoSolutionError, match="place of a flat point on its patch"):
        chart.places(np.array([[1e4, -1e4]]))
