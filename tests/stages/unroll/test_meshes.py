"""Patterns of meshes, against exact developments; and maps that are wrong on purpose."""

from dataclasses import replace
from math import pi

import msgspec
import numpy as np
import pytest

from stages.construct.meshes.features import placed_on_mesh
from stages.geometry.curves.plane import CircularArc, Segment
from stages.geometry.mesh.flat import flattened
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.nearest import at
from stages.geometry.mesh.topology import boundary_loops, edges_of
from stages.model.material import Material, Part
from stages.model.meshes import MeshFile
from stages.model.part import PartSpec
from stages.model.report import Outcome
from stages.model.surface import Certificate, MeshSurface
from stages.model.tolerances import Tolerances
from stages.unroll import unroll
from tests.meshes import Known, cylinder, right_cone
from tests.near import assert_near, assert_relative
from tests.parts import read

CELLS = (60, 16)
"""Columns and rows: 1 920 triangles, which take a third of a second."""

TOL = Tolerances(chord_mm=0.02)


def surface(mesh: Mesh, **spec: object) -> MeshSurface:
    loops = boundary_loops(mesh, edges_of(mesh))
    part = Part(PartSpec(name="part", surface=MeshFile(file="part.stl"), **spec), Material())
    return MeshSurface(part, mesh, loops, float(np.linalg.norm(np.ptp(mesh.vertices, axis=0))))


def judged(made: MeshSurface) -> Certificate:
    return Certificate(made, "fabrication", proved=False, flat=flattened(made.mesh, accuracy=1e-10 * made.size_mm))


@pytest.fixture(scope="module")
def cone() -> tuple[Known, Certificate]:
    known = right_cone(3, *CELLS)
    return known, judged(surface(known.mesh))


def figure(outcome: Outcome, name: str) -> float:
    return float(outcome.report.metric(name).value)


def test_a_cone_is_cut_as_two_lines_and_two_arcs(cone: tuple[Known, Certificate]) -> None:
    """Slant heights 100 and 200 mm, 3 rad: the mesh has facets, its pattern has not."""
    outcome = unroll(cone[1], TOL)
    assert outcome.product is not None, outcome.report
    edges = outcome.product.outer.edges
    arcs = sorted((edge for edge in edges if isinstance(edge, CircularArc)), key=lambda arc: arc.radius)
    assert len(edges) == 4
    assert sum(isinstance(edge, Segment) for edge in edges) == 2
    for arc, radius in zip(arcs, (100.0, 200.0), strict=True):
        assert_near(arc.radius, radius, bound=1e-3, why="1 920 triangles are good for 1e-6 of the size")
        assert_near(abs(arc.sweep_rad), 3.0, bound=1e-5, why="the same")
    assert_near(outcome.report.detail["flat"]["area"], 1.5 * (200.0**2 - 100.0**2), bound=0.2, why="the same")
    assert figure(outcome, "overlap_mm2") == 0.0


def test_the_distortion_of_a_good_map_is_small(cone: tuple[Known, Certificate]) -> None:
    outcome = unroll(cone[1], TOL)
    for name, most in (("length_error", 1e-5), ("area_error", 1e-6), ("angle_error_deg", 1e-2), ("max_strain", 1e-4)):
        assert figure(outcome, name) <= most, name
    assert figure(outcome, "boundary_sagitta_mm") >= 200.0 * (1.0 - np.cos(3.0 / 60 / 2.0)) * 0.9


@pytest.mark.parametrize(
    ("fault", "named"),
    [
        (np.array([[1.001, 0.0], [0.0, 1.0]]), ("length_error", "area_error", "max_strain", "metric_error")),
        (np.array([[1.001, 0.0], [0.0, 1.0 / 1.001]]), ("length_error", "max_strain", "metric_error")),
        (np.array([[1.0, 0.001], [0.0, 1.0]]), ("angle_error_deg", "max_strain", "metric_error")),
    ],
)
def test_a_wrong_map_shows(cone: tuple[Known, Certificate], fault: np.ndarray, named: tuple[str, ...]) -> None:
    certificate = cone[1]
    flat = certificate.flat
    assert flat is not None
    positions = flat.positions @ fault.T
    wrong = flat.replace(positions=positions)
    right = unroll(certificate, TOL)
    outcome = unroll(Certificate(certificate.surface, "leather", proved=False, flat=wrong), Tolerances("leather"))
    for name in named:
        assert figure(outcome, name) >= 10.0 * figure(right, name), name
        assert figure(outcome, name) >= 2e-4, name
    known = np.abs(np.linalg.svd(fault, compute_uv=False) - 1.0).max()
    assert_near(figure(outcome, "max_strain"), known, bound=1e-4, why="what the map itself is strained by")
    assert figure(outcome, "strain_energy_mm2") >= 10.0 * figure(right, "strain_energy_mm2"), "that of the positions"


def test_a_pattern_lies_the_same_way_however_the_mesh_was_moved(cone: tuple[Known, Certificate]) -> None:
    known, certificate = cone
    q, _ = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))
    q *= np.sign(np.linalg.det(q))
    moved = judged(surface(Mesh(known.mesh.vertices @ q.T + (500.0, -20.0, 7.0) * np.ones(1), known.mesh.faces)))
    one, other = unroll(certificate, TOL).product, unroll(moved, TOL).product
    assert one is not None
    assert other is not None
    assert_near(other.corners, one.corners, bound=1e-6, why="rounding of a map of 400 mm at rest to 1e-10 of it")


RADIUS = 100.0


def on(angle: float, z: float, away: float = 0.0) -> list[float]:
    return [(RADIUS + away) * np.cos(angle), (RADIUS + away) * np.sin(angle), z]


@pytest.fixture(scope="module")
def pipe() -> Known:
    """2.5 rad of a cylinder of radius 100, 50 high: (angle, z) lands at (100 angle, z) but for a motion."""
    return cylinder(1, *CELLS)


def with_features(known: Known, **features: object) -> Outcome:
    plain = surface(known.mesh)
    spec = read({"kind": "flat", "outline": SQUARE}, **features)
    spec = msgspec.structs.replace(spec, surface=plain.part.spec.surface)
    placement = placed_on_mesh(spec, known.mesh, TOL)
    assert not [finding for finding in placement.findings if finding.fatal], placement.findings
    made = replace(plain, part=Part(spec, Material()), features=placement.features)
    return unroll(judged(made), TOL)


SQUARE = {"polyline": [[0, 0], [1, 0], [1, 1], [0, 0]]}


def test_features_given_in_space_lie_where_they_belong(pipe: Known) -> None:
    marks = [{"kind": "point", "at": on(0.3, 10.0)}, {"kind": "point", "at": on(2.1, 42.0, away=0.03)}]
    holes = [
        {"kind": "circle", "at": on(1.2, 25.0), "diameter": 10},
        {"kind": "drill", "at": on(1.8, 20.0), "diameter": 20},
    ]
    outcome = with_features(pipe, mark=marks, hole=holes)
    assert outcome.product is not None, outcome.report
    flat = outcome.report.detail["flat"]
    places = np.array([[row["x"], row["y"]] for row in (*flat["marks"], *flat["holes"])])
    known = RADIUS * np.array([0.3, 2.1, 1.2, 1.8]), np.array([10.0, 42.0, 25.0, 20.0])
    truth = np.column_stack(known)
    apart = np.linalg.norm(places[:, None] - places[None], axis=-1)
    # triangles of 4 mm on a radius of 100 lie up to 4^2 / 8 / 100 = 0.02 mm below it
    assert_near(apart, np.linalg.norm(truth[:, None] - truth[None], axis=-1), bound=2e-3, why="chords of 4 mm")
    assert [row["distance"] <= 0.02 + 0.03 for row in flat["marks"]] == [True, True]
    assert flat["marks"][1]["distance"] >= 0.03 - 1e-9
    assert_near(flat["holes"][0]["area"], 25.0 * pi, bound=1e-9, why="closed form")
    # at the height z the drill reaches R asin(sqrt(r^2 - z^2) / R) to either side
    z = np.linspace(-10.0, 10.0, 20001)
    drilled = float(np.trapezoid(2.0 * RADIUS * np.arcsin(np.sqrt(100.0 - z**2) / RADIUS), z))
    assert_near(flat["holes"][1]["area"], drilled, bound=2e-3 * drilled, why="72 points on triangles of 4 mm")
    sides = [outcome.report.detail[side]["area"] for side in ("surface", "flat")]  # type: ignore[index]
    assert_relative(sides, [250.0 * 50.0] * 2, bound=1e-5, why="what is cut into a curved part counts on neither side")


@pytest.mark.parametrize("share", [0.1, 0.8])
def test_the_points_of_a_drilled_hole_lie_on_the_drill_however_wide(pipe: Known, share: float) -> None:
    """A drill of 0.1 and 0.8 of the pipe's radius; at 0.8 the pipe is inclined to it by 53 degrees."""
    tall = Mesh(pipe.mesh.vertices * [1.0, 1.0, 4.0], pipe.mesh.faces)
    spec = read(
        {"kind": "flat", "outline": SQUARE}, hole=[{"kind": "drill", "at": on(1.25, 100.0), "diameter": 200.0 * share}]
    )
    (hole,) = placed_on_mesh(spec, tall, TOL).features
    centre, rim = (at(tall, one, tall.vertices) for one in hole.on_mesh)
    a, b, c = tall.vertices[tall.faces[hole.on_mesh[0].faces[0]]]
    axis = np.cross(b - a, c - a) / np.linalg.norm(np.cross(b - a, c - a))
    away = rim - centre[0]
    across = np.linalg.norm(away - np.outer(away @ axis, axis), axis=1)
    assert_relative(across, np.full(len(rim), share * RADIUS), bound=1e-6, why="rounds until a millionth is left")


def test_curves_given_in_space_are_etched_and_cut(pipe: Known) -> None:
    """A helix of the cylinder is a straight line in the pattern, a loop of it a hole."""
    angles = np.linspace(0.4, 2.0, 41)
    helix = {"points": [on(a, 10.0 + 15.0 * (a - 0.4)) for a in angles]}
    ring = {"points": [on(1.0 + 0.1 * np.cos(t), 25.0 + 8.0 * np.sin(t)) for t in np.linspace(0.0, 2.0 * pi, 33)]}
    ring["points"][-1] = ring["points"][0]
    outcome = with_features(pipe, mark=[{"kind": "curve", "curve": helix}], hole=[{"kind": "curve", "curve": ring}])
    assert outcome.product is not None, outcome.report
    flat = outcome.report.detail["flat"]
    assert_near(flat["marks"][0]["length"], np.hypot(160.0, 24.0), bound=2e-2, why="chords of 4 mm")
    assert_near(flat["holes"][0]["area"], 80.0 * pi, bound=0.05, why="chords of 4 mm, a spline through 33 points")


@pytest.mark.parametrize(
    ("features", "code"),
    [
        ({"mark": [{"kind": "point", "at": [0.5, 0.5]}]}, "no-uv"),
        ({"mark": [{"kind": "point", "at": on(1.0, 55.0)}]}, "place-outside"),
        ({"hole": [{"kind": "drill", "at": on(1.0, 3.0), "diameter": 10}]}, "hole-outside"),
        (
            {"hole": [{"kind": "curve", "curve": {"points": [on(1.0, 10.0), on(1.1, 20.0), on(1.2, 10.0)]}}]},
            "open-contour",
        ),
        ({"mark": [{"kind": "rulings", "count": 3}]}, "no-rulings"),
        ({"notch": [{"edge": "c0", "at": 0.5}]}, "no-such-edge"),
    ],
)
def test_features_that_have_no_place_on_a_mesh_are_refused(pipe: Known, features: dict, code: str) -> None:
    spec = read({"kind": "flat", "outline": SQUARE}, **features)
    found = placed_on_mesh(spec, pipe.mesh, TOL)
    assert [finding.code for finding in found.findings if finding.fatal] == [code]


def test_a_mesh_of_a_face_of_thick_sheet_is_unrolled_on_its_middle(pipe: Known) -> None:
    """2.5 rad of a radius of 100, half as wide: the middle of a sheet given by its inside lies 1 mm outside."""
    plain = surface(pipe.mesh, face="inner")
    made = replace(plain, part=Part(plain.part.spec, Material(thickness_mm=2.0)))
    outcome = unroll(judged(made), TOL)
    assert outcome.product is not None, outcome.report.findings
    area = outcome.report.detail["flat"]["area"]  # type: ignore[index]
    assert_relative(area, 2.5 * 101.0 * 50.0, bound=1e-6, why="closed form, arcs within the chord")
