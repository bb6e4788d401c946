"""From the mesh of a file to a disc, or to its refusal: each planted fault gives its finding and no other fatal one."""

from fractions import Fraction

import numpy as np
import pytest

from stages.construct import construct
from stages.construct.sets import parts_of
from stages.geometry.arrays import norm
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.topology import boundary_loops, edges_of
from stages.model.material import Part
from stages.model.meshes import MeshFile
from stages.model.part import PartSpec
from stages.model.report import Finding, Outcome
from stages.model.scalars import Length, Point
from stages.model.surface import MeshSurface, Surface
from stages.model.tolerances import Tolerances
from tests.near import assert_near
from tests.tubes import dome, flat, holed, moebius, moved, rolled, rotation, soup, together, tube, turned_over

TOL = Tolerances()
SHEET = holed(13, [(0.3, 0.2, 0.3)], dome)
"""Of no developable, so that nothing is recognised."""


def part(mesh: Mesh, *, recognise: bool = False, seam: tuple[Point, ...] | None = None) -> Part:
    spec = PartSpec(name="m", surface=MeshFile(file="m.stl", recognise=recognise, seam=seam))
    return Part(spec, body=mesh)


def made(mesh: Mesh, **keys: object) -> Outcome[Surface | None]:
    return construct(part(mesh, **keys), TOL)  # type: ignore[arg-type]


def fatal(outcome: Outcome[Surface | None]) -> list[str]:
    return [finding.code for finding in outcome.report.findings if finding.fatal]


def told(outcome: Outcome[Surface | None]) -> list[str]:
    return [finding.code for finding in outcome.report.findings if not finding.fatal]


def number(outcome: Outcome[Surface | None], name: str) -> float:
    value = outcome.report.metric(name).value
    assert value is not None
    return float(value)


def surface(outcome: Outcome[Surface | None]) -> MeshSurface:
    assert isinstance(outcome.product, MeshSurface), outcome.report.findings
    return outcome.product


@pytest.mark.parametrize("size", [1.0, 300.0, 10_000.0])
def test_a_sound_mesh_is_a_disc_with_its_holes_and_its_figures(size: float) -> None:
    mesh = Mesh(SHEET.vertices * size, SHEET.faces)
    outcome = made(soup(mesh))
    found = surface(outcome)
    assert (fatal(outcome), told(outcome)) == ([], [])
    assert [number(outcome, key) for key in ("triangles", "vertices", "boundary_loops", "euler_characteristic")] == [
        len(mesh.faces), len(mesh.vertices), 2, 0,
    ]  # fmt: skip
    assert [len(loop) for loop in found.loops] == [48, 12]
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    area = float(norm(np.cross(b - a, c - a)).sum() / 2.0)
    assert_near(number(outcome, "mesh_area_mm2"), area, bound=1e-6 * area, why="float32")
    assert_near(found.size_mm, float(norm(np.ptp(mesh.vertices, axis=0))), bound=1e-6 * size, why="float32")
    assert number(outcome, "edge_min_mm") < number(outcome, "edge_mean_mm") < number(outcome, "edge_max_mm")


def test_motion_changes_no_figure() -> None:
    here = made(SHEET).report
    there = made(moved(SHEET, rotation(5), np.array([40.0, 3.0, -7.0]))).report
    moves = {metric.name: metric for metric in there.metrics if metric.name != "size_mm"}
    assert len(moves) == len(here.metrics) - 1
    for one, other in ((metric, moves[metric.name]) for metric in here.metrics if metric.name in moves):
        assert_near(float(one.value or 0.0), float(other.value or 0.0), bound=1e-12, why=one.name)


def test_a_tube_is_cut_and_its_seam_straight_in_the_loop_that_is_refitted() -> None:
    outcome = made(tube(30, 8, (50.0, 20.0), 60.0))
    found = surface(outcome)
    assert number(outcome, "seams") == 1
    (loop,) = found.straight_loops
    one, other = found.seams[0]
    assert len(found.loops[0]) - len(loop) == 2 * (len(one) - 2)
    assert {one[0], one[-1], other[0], other[-1]} <= set(loop.tolist())
    assert {row["sort"] for row in outcome.report.detail["loops"]} == {"end"}  # type: ignore[attr-defined]


def test_faces_that_run_the_other_way_are_turned_and_told() -> None:
    outcome = made(turned_over(SHEET, np.array([3, 8, 20])))
    assert (fatal(outcome), told(outcome)) == ([], ["mesh-turned"])
    assert number(outcome, "faces_turned") == 3


def test_duplicates_and_faces_of_no_area_are_dropped_and_told() -> None:
    faces = np.concatenate([SHEET.faces, SHEET.faces[5:6], [[1, 1, 2]]])
    outcome = made(Mesh(SHEET.vertices, faces))
    assert told(outcome) == ["mesh-duplicates-dropped", "mesh-zero-area-dropped"]
    assert number(outcome, "faces_dropped") == 2
    assert np.array_equal(surface(outcome).mesh.faces, surface(made(SHEET)).mesh.faces)


def test_corners_that_rounding_parted_are_welded_and_told() -> None:
    broken = soup(SHEET)
    points = broken.vertices.copy()
    points[:40] *= 1.0 + 2.0**-23
    outcome = made(Mesh(points, broken.faces))
    assert (fatal(outcome), told(outcome)) == ([], ["mesh-welded"])
    assert number(outcome, "vertices_welded") > 0


def fin(mesh: Mesh) -> Mesh:
    """Return the mesh with a third face at one of its inner edges."""
    a, b, _ = mesh.faces[len(mesh.faces) // 2]
    points = np.concatenate([mesh.vertices, [(mesh.vertices[a] + mesh.vertices[b]) / 2 + [0.0, 0.0, 0.5]]])
    return Mesh(points, np.concatenate([mesh.faces, [[a, b, len(mesh.vertices)]]]))


def pinch(mesh: Mesh) -> Mesh:
    """Return a mesh whose boundary touches itself in one vertex."""
    i, j = 0, 12 * 13 + 6
    faces = np.where(mesh.faces == j, i, mesh.faces)
    points = mesh.vertices.copy()
    points[i] = (points[i] + points[j]) / 2.0
    return Mesh(points, faces)


def torn(mesh: Mesh) -> Mesh:
    """Return a mesh with a vertex on an inner edge that only the faces on one side know."""
    border = np.concatenate(boundary_loops(mesh, edges_of(mesh)))
    which = int(np.flatnonzero(~np.isin(mesh.faces, border).any(axis=1))[0])
    a, b, c = (int(v) for v in mesh.faces[which])
    d = len(mesh.vertices)
    points = np.concatenate([mesh.vertices, [(mesh.vertices[a] + mesh.vertices[b]) / 2.0]])
    faces = np.delete(mesh.faces, which, axis=0)
    return Mesh(points, np.concatenate([faces, [[a, d, c], [d, b, c]]]))


def box() -> Mesh:
    corners = np.array([[x, y, z] for x in (0.0, 9) for y in (0.0, 5) for z in (0.0, 3)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return Mesh(corners, np.array([[q[0], q[i], q[i + 1]] for q in quads for i in (1, 2)]))


def torus() -> Mesh:
    i, j = (axis.ravel() for axis in np.meshgrid(np.arange(12), np.arange(8), indexing="ij"))
    u, v = 2 * np.pi * i / 12, 2 * np.pi * j / 8
    points = np.column_stack([(3 + np.cos(v)) * np.cos(u), (3 + np.cos(v)) * np.sin(u), np.sin(v)])
    a, b, c, d = i * 8 + j, (i + 1) % 12 * 8 + j, (i + 1) % 12 * 8 + (j + 1) % 8, i * 8 + (j + 1) % 8
    return Mesh(points, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]))


def folded() -> Mesh:
    points = np.array([[0.0, 0, 0], [10, 0, 0], [3, 8, 0], [4, 7, 0]])
    return Mesh(points, np.array([[0, 1, 2], [1, 0, 3]]))


def overlapping_roll() -> Mesh:
    """Return a sheet rolled up by more than a full turn: it passes through its own beginning."""
    p = holed(25, [], flat).vertices
    turn = (p[:, 0] + 1.0) * 3.5
    radius = 1.0 + 0.05 * np.sin(turn)
    return Mesh(np.column_stack([radius * np.cos(turn), radius * np.sin(turn), p[:, 1]]), holed(25, [], flat).faces)


FAULTS = {
    "mesh-nonmanifold": fin(SHEET),
    "mesh-one-sided": moebius(),
    "mesh-pinched": pinch(holed(13, [], rolled)),
    "mesh-cracks": torn(SHEET),
    "mesh-pieces": together(SHEET, moved(SHEET, np.eye(3), np.array([5.0, 0, 0]))),
    "mesh-closed": box(),
    "mesh-handles": torus(),
    "mesh-folded": folded(),
    "self-crossing": overlapping_roll(),
    "mesh-empty": Mesh(np.zeros((3, 3)), np.array([[0, 1, 2]])),
}


@pytest.mark.parametrize("code", FAULTS)
def test_a_planted_fault_gives_its_finding_and_no_other(code: str) -> None:
    outcome = made(FAULTS[code])
    assert outcome.product is None
    assert fatal(outcome) == [code]


@pytest.mark.parametrize(
    "code", sorted(set(FAULTS) - {"mesh-empty", "mesh-closed", "mesh-handles", "mesh-pieces", "mesh-one-sided"})
)
def test_a_fault_is_named_with_its_place(code: str) -> None:
    (finding,) = (finding for finding in made(FAULTS[code]).report.findings if finding.fatal)
    assert finding.where is not None
    assert {"x", "y", "z"} <= set(finding.where)
    at = np.array([float(finding.where[axis]) for axis in "xyz"])
    low, high = FAULTS[code].vertices.min(axis=0), FAULTS[code].vertices.max(axis=0)
    assert (low - 1e-9 <= at).all()
    assert (at <= high + 1e-9).all()


def at(x: float, y: float, z: float) -> Point:
    return Length(Fraction(x)), Length(Fraction(y)), Length(Fraction(z))


def test_a_closed_mesh_is_opened_along_a_seam_that_is_given() -> None:
    outcome = made(box(), seam=(at(0, 0, 3), at(0, 0, 0), at(0, 5, 0)))
    assert len(surface(outcome).loops) == 1
    refused = made(box(), seam=(at(0, 0, 0), at(9, 0, 0)))
    assert fatal(refused) == ["mesh-seam"]


def test_a_seam_far_from_the_mesh_is_refused_with_its_distance() -> None:
    outcome = made(tube(20, 6, (5.0, 5.0), 8.0), seam=(at(5, 0, 0), at(5, 0, 108)))
    assert fatal(outcome) == ["mesh-seam"]
    assert_near(number(outcome, "seam_distance_mm"), 100.0, bound=1e-12, why="108 - 8")


def test_what_was_found_in_the_file_is_in_the_report() -> None:
    remark = Finding("mesh-units", "odd")
    spec = PartSpec(name="m", surface=MeshFile(file="m.stl", recognise=False))
    outcome = construct(Part(spec, body=SHEET, remarks=(remark,)), TOL)
    assert told(outcome) == ["mesh-units"]


def test_pieces_become_parts_with_numbers_and_one_piece_stays_itself() -> None:
    other = moved(tube(12, 3, (1.0, 1.0), 2.0), np.eye(3), np.array([9.0, 0, 0]))
    whole = part(together(SHEET, other))
    one, two = parts_of(whole)
    assert (one.name, two.name) == ("m.1", "m.2")
    assert isinstance(one.body, Mesh)
    assert isinstance(two.body, Mesh)
    assert (len(one.body.faces), len(two.body.faces)) == (len(SHEET.faces), len(other.faces))
    assert [finding.code for finding in two.remarks] == ["mesh-pieces"]
    assert [piece.name for piece in parts_of(part(SHEET))] == ["m"]


def test_a_part_whose_mesh_was_not_read_is_a_defect() -> None:
    with pytest.raises(ValueError, match="not read"):
        construct(Part(PartSpec(name="m", surface=MeshFile(file="m.stl"))), TOL)
