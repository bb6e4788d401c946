"""How long 100 000 triangles take from a soup to a disc, each step with its result asserted.

Goals: welded, oriented, loops found and cut 1.5 s; crossings 5 s.  A million triangles take ten times as long.
"""

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from stages.geometry.mesh.crossing import crossings
from stages.geometry.mesh.cut import opened
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.repair import repaired
from stages.geometry.mesh.topology import edges_of, pieces, pinched, turned
from tests.tubes import soup, tube

SHELL = tube(500, 100, (50.0, 20.0), 80.0)


def disc(mesh: Mesh) -> tuple[int, int, int]:
    """Return pieces, pinched vertices and loops of the disc that a soup is."""
    clean = repaired(mesh).mesh
    edges = edges_of(clean)
    against = turned(clean, edges)
    assert against is not None
    assert len(against) == 0
    return pieces(clean, edges)[0], len(pinched(clean, edges)), len(opened(clean).loops)


@pytest.mark.benchmark(group="mesh")
def test_a_soup_becomes_a_disc(benchmark: BenchmarkFixture) -> None:
    assert benchmark.pedantic(disc, args=(soup(SHELL),), rounds=3) == (1, 0, 1)


@pytest.mark.benchmark(group="mesh")
def test_a_shell_does_not_cross_itself(benchmark: BenchmarkFixture) -> None:
    found = benchmark.pedantic(crossings, args=(SHELL, 1e-5), rounds=3)
    assert len(found.faces) == 0
