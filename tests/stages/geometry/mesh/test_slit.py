"""Slits and lines on meshes: one more side, nothing else; ways that follow their lines."""

import numpy as np

from stages.geometry.arrays import norm
from stages.geometry.mesh.cut import along, distance_to, edge_lengths
from stages.geometry.mesh.slit import followed, slit
from stages.geometry.mesh.topology import (
    boundary_loops,
    edge_numbers,
    edges_of,
    euler_characteristic,
    on_border,
    pieces,
    pinched,
)
from tests.caps import cap

MESH = cap(0.6, cells=16)
EDGES = edges_of(MESH)
RIM = 100.0 * np.array([np.sin(0.6), 0.0, np.cos(0.6)])
LINE = np.array([RIM, 100.0 * np.array([np.sin(0.1), 0.0, np.cos(0.1)])])


def test_a_slit_doubles_its_vertices_but_the_last_and_leaves_a_disc() -> None:
    other = LINE * np.array([-1.0, 1.0, 1.0])
    ways = tuple(along(MESH, EDGES, line, ()) for line in (LINE, other))
    made = slit(MESH, EDGES, ways)
    after = edges_of(made.mesh)
    assert len(made.mesh.vertices) == len(MESH.vertices) + sum(len(way) - 1 for way in ways)
    assert (euler_characteristic(made.mesh, after), pieces(made.mesh, after)[0]) == (1, 1)
    assert len(pinched(made.mesh, after)) == 0
    assert len(boundary_loops(made.mesh, after)) == 1
    for way, (one, side) in zip(ways, made.sides, strict=True):
        assert one[-1] == side[-1] == way[-1]
        assert not set(one[:-1].tolist()) & set(side[:-1].tolist())
        assert np.array_equal(made.original[one], way)
        assert np.array_equal(made.original[side], way)
        assert (edge_numbers(after, np.stack([one[:-1], one[1:]], axis=1)) >= 0).all()


def test_nothing_is_slit_without_ways() -> None:
    made = slit(MESH, EDGES, ())
    assert np.array_equal(made.mesh.faces, MESH.faces)
    assert made.sides == ()


def test_a_way_stays_within_an_edge_of_its_line_and_may_run_along_the_boundary() -> None:
    longest = float(edge_lengths(MESH, EDGES).max())
    turn = np.linspace(0.2, 1.7, 40)
    rim = 100.0 * np.column_stack([np.sin(0.6) * np.cos(turn), np.sin(0.6) * np.sin(turn), 0.0 * turn + np.cos(0.6)])
    way = followed(MESH, EDGES, rim)
    assert on_border(MESH, EDGES)[way].all()
    assert norm(MESH.vertices[way] - RIM).max() >= 100.0 * np.sin(0.6)
    across = 100.0 * np.column_stack([np.sin(turn - 1.0), 0.1 + 0.0 * turn, np.cos(turn - 1.0)])[5:-5]
    inner = followed(MESH, EDGES, across)
    assert distance_to(MESH.vertices[inner], across).max() <= longest
    assert len(np.unique(inner)) == len(inner)


def test_edges_are_found_by_their_ends_in_any_order() -> None:
    pairs = EDGES.ends[[3, 8, 5]][:, ::-1].copy()
    assert edge_numbers(EDGES, pairs).tolist() == [3, 8, 5]
    assert edge_numbers(EDGES, np.array([[0, 10**6], [7, 7]])).tolist() == [-1, -1]
