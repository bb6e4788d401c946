"""Verdicts on meshes: developables pass, warp is read in degrees, a smooth hemisphere is refused, noise is admitted."""

import numpy as np
import pytest

from stages.geometry.mesh.curvature import defects
from stages.geometry.mesh.fit import MOST_TRIANGLES
from stages.geometry.mesh.flat import flattened
from stages.geometry.mesh.lengths import chords
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.topology import edges_of
from stages.model.material import Material
from stages.model.surface import MeshSurface
from stages.model.tolerances import Tolerances
from stages.verify import verify
from stages.verify.meshbounds import cells, closer, curvatures, warp
from stages.verify.meshes import Verdict, verdict
from stages.verify.meshstudy import study
from tests.meshes import (
    KNOWN,
    OBLIQUE_CONE,
    cylinder,
    hemisphere,
    in_a_quarter,
    jittered,
    noisy,
    single_precision,
    square_saddle,
    twisted,
    warped,
)
from tests.near import assert_relative
from tests.parts import EXAMPLE_1, part

FOIL = Material(thickness_mm=1e-6, bend_radius_min_mm=0.0, max_strain=1.0)
"""It may be bent as sharply as it likes, so that nothing but the mesh is judged."""
PART = part(EXAMPLE_1, FOIL)


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


@pytest.mark.parametrize("name", ["cylinder", "strap"])
def test_half_a_degree_of_warp_throughout_is_seen(name: str) -> None:
    made = judged(twisted(name, 0.5, 4))
    assert made.reached == "rejected"
    assert value(made, "equivalent_warp_least_deg") > 0.4


def test_the_warp_of_a_twisted_cylinder_is_read_in_degrees() -> None:
    """Its normal turns by the same angle along all rulings, all of one length: K is that of every ruling."""
    made = judged(twisted("cylinder", 0.5, 1))
    assert_relative(value(made, "equivalent_warp_deg"), 0.5, bound=0.01,
                    why="the twist turns rulings by 0.5 deg against the axis; fits see 0.1 %")  # fmt: skip


def test_half_a_degree_of_warp_in_a_quarter_alone_is_seen_there() -> None:
    mesh = twisted("strap", 0.5, 3, in_a_quarter)
    made = judged(mesh)
    assert made.reached == "rejected"
    (finding,) = made.findings
    assert finding.where is not None
    v = jittered(3)[0][int(finding.where["vertex"])]
    assert 0.25 < v < 0.5


def test_warp_is_at_least_at_most_and_in_between() -> None:
    for mesh in (cylinder(1, 60, 16).mesh, twisted("right cone", 0.5, 2, in_a_quarter), noisy(cylinder(1).mesh, 1e-5)):
        made = judged(mesh)
        least, likely, most = (value(made, f"equivalent_warp_{which}deg") for which in ("least_", "", "largest_"))
        assert least <= likely <= most


def test_closer_fits_settle_a_doubt_of_coarse_ones() -> None:
    mesh = KNOWN["oblique cone"](1, 100, 24).mesh
    studied = study(MeshSurface(PART, mesh, (), 1.0))
    first, second = (np.degrees(warp(curvatures(one)).largest) for one in (studied, closer(studied)))
    assert first > 0.1, "the case is one of doubt"
    assert second < first / 3.0
    made = judged(mesh)
    assert made.reached == "fabrication"
    assert_relative(value(made, "equivalent_warp_largest_deg"), second, bound=1e-9, why="the same, but for scale")


def test_what_regions_hold_is_told_one_by_one() -> None:
    made = judged(square_saddle(2.0, 3))
    assert len(made.regions) > 5
    for region in made.regions:
        x, y, radius = (float(str(region[name])) for name in ("x", "y", "radius_mm"))
        assert max(abs(x), abs(y)) + radius < 1.05, "circles within the square of half side 1"
        assert_relative(float(str(region["defect_rad"])), -np.pi * (radius * np.tan(np.radians(1.0))) ** 2, bound=0.01,
                        why="z = x y tan(w / 2): K is the square of that, less 2 w^2; 1e-3 of fits")  # fmt: skip
        assert 0.0 < float(str(region["defect_doubt_rad"])) < 1e-5


def test_a_dent_is_in_one_region_and_in_no_other() -> None:
    """The planted fault: a developable, and one bump in its middle."""
    known = cylinder(6)
    assert judged(known.mesh).reached == "fabrication"
    far = np.hypot(*(known.flat - known.flat.mean(axis=0)).T) / 15.0
    lift = 1.0 + 2e-5 * np.clip(1.0 - far**2, 0.0, None) ** 4
    made = judged(Mesh(known.mesh.vertices * np.column_stack([lift, lift, np.ones_like(lift)]), known.mesh.faces))
    assert made.reached == "rejected"
    (finding,) = made.findings
    assert finding.where is not None
    assert far[int(finding.where["vertex"])] < 2.0


def test_a_mesh_too_fine_to_be_laid_flat_is_refused_at_once_with_the_remedy() -> None:
    mesh = Mesh(np.eye(3), np.tile(np.arange(3), (MOST_TRIANGLES + 1, 1)))
    outcome = verify(MeshSurface(part(EXAMPLE_1), mesh, (np.arange(3),), 1.0), Tolerances())
    assert outcome.product is None
    (finding,) = outcome.report.findings
    assert (finding.code, finding.fatal) == ("mesh-too-fine", True)
    assert "coarser" in finding.message


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


def test_a_coarse_noisy_mesh_bent_sharply_in_places_is_not_rejected() -> None:
    """Its noise counts for most where it is bent most: one mean is off by 8.6 of the deviations of all."""
    assert judged(noisy(KNOWN["oblique cone"](300, 100, 20).mesh, 1e-7, 300)).reached == "inconclusive"


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


@pytest.mark.parametrize("steps", [1, 2, 3])
def test_a_mesh_with_too_few_vertices_for_a_fit_is_called_coarse_and_nothing_infinite_is_told(steps: int) -> None:
    x, y = (axis.ravel() for axis in np.meshgrid(*[np.linspace(0.0, 100.0, steps + 1)] * 2, indexing="ij"))
    at = np.arange((steps + 1) ** 2).reshape(steps + 1, -1)
    a, b, c, d = (corner.ravel() for corner in (at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]))
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    made = judged(Mesh(np.stack([x, y, x * y / 500.0], axis=1), faces))
    (finding,) = made.findings[:1]
    assert finding.code == "inconclusive" and finding.message.startswith("the mesh is too coarse for a verdict")
    assert "inf" not in finding.message and "nan" not in finding.message
