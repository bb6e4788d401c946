"""Verdicts on meshes: developables pass, warp is read in degrees, a smooth hemisphere is refused, noise is admitted."""

import numpy as np
import pytest

from stages.geometry.mesh import Mesh
from stages.geometry.meshcurvature import defects
from stages.geometry.meshflat import flattened
from stages.geometry.meshlengths import chords
from stages.geometry.meshtopology import edges_of
from stages.model.surface import MeshSurface
from stages.model.tolerances import Tolerances
from stages.verify.meshbounds import cells
from stages.verify.meshes import Verdict, verdict
from tests.meshes import KNOWN, OBLIQUE_CONE, cylinder, hemisphere, noisy, single_precision, square_saddle, warped
from tests.near import assert_relative
from tests.parts import EXAMPLE_1, part

PART = part(EXAMPLE_1)


def judged(mesh: Mesh, accept: str = "fabrication") -> Verdict:
    size = float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    return verdict(MeshSurface(PART, mesh, (), size), Tolerances(accept=accept))  # type: ignore[arg-type]


def value(made: Verdict, name: str) -> float:
    (found,) = (metric.value for metric in made.metrics if metric.name == name)
    assert found is not None
    return float(found)


@pytest.mark.parametrize("name", KNOWN)
def test_an_irregular_mesh_of_a_developable_passes(name: str) -> None:
    made = judged(KNOWN[name](11).mesh)
    assert (made.reached, made.findings) == ("fabrication", ())
    assert value(made, "equivalent_warp_largest_deg") < 0.1


def test_single_precision_does_not_forbid_a_verdict() -> None:
    assert judged(single_precision(cylinder(1).mesh)).reached == "fabrication"


@pytest.mark.parametrize("warp_deg", [0.5, 2.0, 10.0])
def test_the_warp_of_a_hyperbolic_paraboloid_is_read_in_degrees(warp_deg: float) -> None:
    made = judged(square_saddle(warp_deg, 3))
    assert made.reached == "rejected"
    assert [finding.code for finding in made.findings] == ["not-developable"]
    assert_relative(value(made, "equivalent_warp_deg"), warp_deg, bound=0.02,
                    why="K is the mean over a circle; it falls by w^2 towards the edges, 3 % at 10 deg")  # fmt: skip
    assert_relative(
        value(made, "max_strain"), 1.5e-5 * warp_deg**2, bound=0.2, why="the cells reach to the edge, not the corner"
    )


def test_half_a_degree_of_warp_on_an_oblique_cone_is_seen() -> None:
    made = judged(warped(OBLIQUE_CONE, 0.5, 2))
    assert made.reached == "rejected"
    assert value(made, "equivalent_warp_least_deg") > 0.1


def test_a_hemisphere_whose_every_vertex_looks_innocent_is_rejected() -> None:
    mesh = hemisphere(0)
    edges = edges_of(mesh)
    assert np.median(np.abs(defects(mesh, edges, chords(mesh.vertices, edges.ends)))) < 2e-3
    made = judged(mesh, "leather")
    assert made.reached == "rejected"
    assert_relative(
        value(made, "defect_sum_rad"), 2.0 * np.pi, bound=0.05, why="2 pi less what the vertices at the rim hold"
    )


def test_noise_is_admitted_and_what_it_permits_is_said() -> None:
    mesh = noisy(cylinder(2).mesh, 3e-6)
    made = judged(mesh)
    assert made.reached == "inconclusive"
    (finding,) = made.findings
    assert finding.fatal
    assert "noisy" in finding.message
    assert "permits accept = 'metal'" in finding.message
    assert judged(mesh, "metal").reached == "metal" or judged(mesh, "metal").reached == "fabrication"


@pytest.mark.parametrize("amount", [1e-5, 1e-4])
@pytest.mark.parametrize("name", KNOWN)
def test_noise_alone_rejects_nothing(name: str, amount: float) -> None:
    assert judged(noisy(KNOWN[name](1, 100, 20).mesh, amount)).reached != "rejected"


def test_a_strip_without_vertices_inside_allows_no_verdict() -> None:
    made = judged(cylinder(0, 20, 1).mesh)
    assert made.reached == "inconclusive"


def test_a_mesh_is_never_exact() -> None:
    made = judged(cylinder(0, 40, 8).mesh, "exact")
    assert made.reached == "rejected"
    assert "never" in made.findings[0].message


def test_the_map_of_the_verdict_is_the_flattening() -> None:
    mesh = cylinder(0, 40, 8).mesh
    size = float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    assert np.array_equal(judged(mesh).flat.positions, flattened(mesh, accuracy=1e-10 * size).positions)


def test_cells_hold_what_they_may_and_everything() -> None:
    cell = cells(np.random.default_rng(0).normal(size=(1000, 2)), 64)
    count = np.bincount(cell)
    assert count.sum() == 1000
    assert count.max() <= 64
    assert count.min() >= 31
