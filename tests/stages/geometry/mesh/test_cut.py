"""Cutting: turnings in closed form, holes told from ends, cuts that leave discs, congruent sides, chosen seams."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.errors import NoSolutionError
from stages.geometry.arrays import Points3, norm
from stages.geometry.mesh.cut import Opened, area, ends_of, opened, turnings
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.topology import boundary_loops, edges_of, euler_characteristic, pieces, pinched
from tests.near import assert_near
from tests.tubes import dome, flat, holed, moved, rolled, rotation, shuffled, soup, tube


def is_disc(mesh: Mesh, holes: int = 0) -> bool:
    edges = edges_of(mesh)
    whole = pieces(mesh, edges)[0] == 1 and len(pinched(mesh, edges)) == 0
    return whole and euler_characteristic(mesh, edges) == 1 - holes and len(boundary_loops(mesh, edges)) == 1 + holes


def seams_agree(found: Opened) -> bool:
    """Return whether both sides of every seam are copies of the same vertices, and no vertex is on both but at ends."""
    for one, other in found.seams:
        same = np.array_equal(found.original[one], found.original[other])
        if not same or set(one[1:-1].tolist()) & set(other[1:-1].tolist()):
            return False
        along = found.mesh.vertices[one], found.mesh.vertices[other]
        if not np.array_equal(*along):
            return False
    return True


def turned(mesh: Mesh) -> list[float]:
    return sorted(turnings(mesh, boundary_loops(mesh, edges_of(mesh))).tolist())


def test_a_flat_disc_turns_by_a_full_turn_and_each_hole_by_one_back() -> None:
    mesh = holed(21, [(-0.4, 0.0, 0.25), (0.5, 0.3, 0.1)], flat)
    assert_near(np.array(turned(mesh)), np.array([-1.0, -1.0, 1.0]) * 2 * np.pi, bound=1e-12, why="sums of 80 angles")


@pytest.mark.parametrize(("radii", "height"), [((5.0, 5.0), 8.0), ((5.0, 2.0), 8.0), ((5.0, 2.0), 0.5)])
def test_the_ends_of_a_frustum_turn_by_the_angle_of_its_sector(radii: tuple[float, float], height: float) -> None:
    sector = 2.0 * np.pi * (radii[0] - radii[1]) / np.hypot(radii[0] - radii[1], height)
    coarse, fine = (np.array(turned(tube(n, n // 3, radii, height))) - [-sector, sector] for n in (30, 120))
    assert float(np.abs(coarse).max()) < 0.05
    assert float(np.abs(fine).max()) < 0.02


HOLES = [(-0.5, 0.1, 0.2), (0.4, -0.3, 0.35)]


@pytest.mark.parametrize("count", [13, 31])
@pytest.mark.parametrize("shape", [flat, rolled, dome])
def test_a_sheet_with_holes_has_one_end_and_is_not_cut(count: int, shape: object) -> None:
    mesh = holed(count, HOLES, shape)  # type: ignore[arg-type]
    found = opened(mesh)
    assert found.seams == ()
    assert np.array_equal(found.mesh.faces, mesh.faces)
    assert len(found.loops) == 3
    assert len(found.loops[0]) == 4 * (count - 1)


@pytest.mark.parametrize("around", [8, 24, 100])
@pytest.mark.parametrize("slope_deg", [1.0, 5.0, 20.0, 60.0, 89.0])
def test_a_lid_however_flat_has_two_ends(around: int, slope_deg: float) -> None:
    mesh = tube(around, max(around // 6, 2), (5.0, 2.0), 3.0 * np.tan(np.radians(slope_deg)))
    edges = edges_of(mesh)
    assert len(ends_of(mesh, edges, boundary_loops(mesh, edges))) == 2


@settings(max_examples=20)
@given(st.integers(0, 2**31), st.sampled_from([(5.0, 5.0), (5.0, 2.0), (0.3, 1.0)]), st.floats(0.0, 0.6))
def test_a_tube_is_cut_to_a_disc_whatever_its_order_and_place(
    seed: int, radii: tuple[float, float], oblique: float
) -> None:
    whole = tube(24, 7, radii, 6.0, seed=seed % 1000, oblique=oblique)
    mesh = shuffled(moved(whole, rotation(seed), np.array([10.0, -4.0, 2.0])), seed)
    found = opened(mesh)
    assert is_disc(found.mesh)
    assert len(found.seams) == 1
    assert seams_agree(found)
    assert_near(area(found.mesh), area(mesh), bound=1e-10 * area(mesh), why="the same triangles")
    on_loop = set(found.loops[0].tolist())
    assert all(set(side.tolist()) <= on_loop for side in found.seams[0])


def test_a_tube_with_a_hole_keeps_the_hole() -> None:
    mesh = tube(40, 14, (5.0, 4.0), 8.0)
    gone = norm(mesh.vertices[mesh.faces].mean(axis=1) - np.array([-4.5, 0.0, 4.0])) < 1.5
    used, numbers = np.unique(mesh.faces[~gone], return_inverse=True)
    found = opened(Mesh(mesh.vertices[used], numbers.reshape(-1, 3)))
    assert is_disc(found.mesh, holes=1)
    assert len(found.seams) == 1


def three_ends() -> Mesh:
    """Return a sphere with three openings: no two of them are ends of one tube."""
    i, j = np.meshgrid(np.arange(30), np.arange(1, 15), indexing="ij")
    turn, down = 2 * np.pi * i.ravel() / 30, np.pi * j.ravel() / 15
    points = np.column_stack([np.sin(down) * np.cos(turn), np.sin(down) * np.sin(turn), np.cos(down)])
    a, b = (14 * i + j - 1)[:, :-1].ravel(), (14 * ((i + 1) % 30) + j - 1)[:, :-1].ravel()
    faces = np.concatenate([np.stack([a, a + 1, b], 1), np.stack([b, a + 1, b + 1], 1)])
    gone = norm(points[faces].mean(axis=1) - np.array([1.0, 0, 0])) < 0.9
    used, numbers = np.unique(faces[~gone], return_inverse=True)
    return Mesh(points[used], numbers.reshape(-1, 3))


def test_a_seam_on_a_closed_surface_opens_it() -> None:
    i, j = np.meshgrid(np.arange(16), np.arange(1, 8), indexing="ij")
    turn, down = 2 * np.pi * i.ravel() / 16, np.pi * j.ravel() / 8
    points = np.column_stack([np.sin(down) * np.cos(turn), np.sin(down) * np.sin(turn), np.cos(down)])
    points = np.concatenate([points, [[0.0, 0, 1], [0, 0, -1]]])
    a, b = (7 * i + j - 1)[:, :-1].ravel(), (7 * ((i + 1) % 16) + j - 1)[:, :-1].ravel()
    rim, after = np.arange(16) * 7, (np.arange(16) + 1) % 16 * 7
    faces = np.concatenate(
        [
            np.stack([a, a + 1, b], 1),
            np.stack([b, a + 1, b + 1], 1),
            np.stack([np.full(16, 112), rim, after], 1),
            np.stack([np.full(16, 113), after + 6, rim + 6], 1),
        ]
    )
    ball = Mesh(points, faces)
    assert euler_characteristic(ball, edges_of(ball)) == 2
    found = opened(ball, np.array([[0.0, 0, 1], [0.7, 0, 0.7], [1, 0, 0], [0.7, 0, -0.7], [0, 0, -1]]))
    assert is_disc(found.mesh)
    assert seams_agree(found)
    one, _ = found.seams[0]
    assert_near(found.mesh.vertices[one][:, 1], np.zeros(len(one)), bound=1e-15, why="the meridian in the plane y = 0")


def seam_along(turn: float) -> Points3:
    return np.array([[5.0 * np.cos(turn), 5.0 * np.sin(turn), z] for z in np.linspace(0.0, 8.0, 9)])


@pytest.mark.parametrize("turn", [0.3, 2.0, -2.5])
def test_a_chosen_seam_is_followed_within_an_edge(turn: float) -> None:
    mesh = tube(40, 12, (5.0, 5.0), 8.0)
    found = opened(mesh, seam_along(turn))
    assert is_disc(found.mesh)
    one, _ = found.seams[0]
    points = found.mesh.vertices[one]
    away = np.abs(np.angle(np.exp(1j * (np.arctan2(points[:, 1], points[:, 0]) - turn))))
    assert float(away.max()) * 5.0 < 2.0 * np.pi * 5.0 / 40.0
    assert {0.0, 8.0} == {float(points[0, 2]), float(points[-1, 2])}


def test_the_shortest_cut_of_an_oblique_tube_is_on_its_short_side() -> None:
    found = opened(tube(40, 12, (5.0, 5.0), 12.0, oblique=0.5))
    points = found.mesh.vertices[found.seams[0][0]]
    assert (points[:, 0] < -4.0).all()


def test_a_surface_with_three_ends_is_cut_twice() -> None:
    mesh = three_ends()
    edges = edges_of(mesh)
    loops = boundary_loops(mesh, edges)
    assert len(loops) == 3
    found = opened(mesh)
    assert len(found.seams) == len(ends_of(mesh, edges, loops)) - 1
    assert is_disc(found.mesh, holes=2 - len(found.seams))
    assert seams_agree(found)


def test_a_seam_that_comes_to_one_vertex_is_refused() -> None:
    mesh = holed(9, [], flat)
    with pytest.raises(NoSolutionError):
        opened(mesh, np.array([[0.0, 0, 0], [1e-3, 0, 0]]))


def test_single_precision_does_not_make_ends_of_holes() -> None:
    from stages.geometry.mesh.repair import repaired

    for size in (1e-3, 1.0, 1e4):
        mesh = holed(21, HOLES, flat)
        found = opened(repaired(soup(Mesh(mesh.vertices * size, mesh.faces))).mesh)
        assert found.seams == ()
