"""Faces of files that OpenCASCADE and Rhino's library wrote: areas as they measure them, joins, refusals."""

from collections.abc import Callable
from functools import cache
from math import hypot, pi
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from OCP.TopoDS import TopoDS_Shape

from stages.construct.faces.surface import face_blanks, face_surface
from stages.geometry.arrays import norm
from stages.geometry.curves.curves import bezier, exactly
from stages.geometry.ruled.strip import Strip, points
from stages.model.cadface import CadBody, CadEdge, CadFace
from stages.model.material import Part
from stages.model.pattern import FlatPattern
from stages.model.report import StageReport
from stages.model.surface import Plate, RuledSurface, Surface
from stages.model.tolerances import Tolerances
from stages.unroll import unroll
from stages.verify import verify
from tests import cad, cadmeasured
from tests.near import assert_near, assert_relative

TOL = Tolerances()
A = [(0, 0, 0), (30, 20, 5), (60, -10, 0), (100, 30, 10), (130, 0, 0)]
FLAT = [(x, y, 0) for x, y, _ in A]


def constructed(part: Part) -> Surface:
    made = face_surface(part, TOL)
    assert made.product is not None, made.report.findings
    return made.product


def flat(part: Part) -> tuple[FlatPattern, StageReport, StageReport]:
    """Return the pattern of a part, and what verify and unroll say."""
    checked = verify(constructed(part), TOL)
    assert checked.product is not None, checked.report.findings
    made = unroll(checked.product, TOL)
    assert made.product is not None, made.report.findings
    return made.product, checked.report, made.report


@cache
def faces_of(make: Callable[[], TopoDS_Shape], write: Callable[..., Path] = cad.step) -> tuple[CadFace, ...]:
    """Return the faces of a shape, written and read once."""
    with TemporaryDirectory() as folder:
        return cad.read(write(Path(folder) / ("a.step" if write is cad.step else "a.iges"), make())).faces


@cache
def laid(make: Callable[[], TopoDS_Shape], place: int = 0) -> tuple[FlatPattern, StageReport, StageReport]:
    """Return what becomes of one face of a shape, made once."""
    return flat(cad.part(faces_of(make)[place]))


def areas(report: StageReport) -> tuple[float, float]:
    """Return the area of the surface and that of the flat pattern, mm2."""
    sides = [report.detail[side] for side in ("surface", "flat")]
    return tuple(float(side["area"]) for side in sides if isinstance(side, dict))


def between() -> TopoDS_Shape:
    return cad.between(cad.spline(A), cad.spline([(x, y, z + 80) for x, y, z in A]))


def oblique_cone_of_splines() -> TopoDS_Shape:
    """Ruled between two similar rational splines: a cone that is no cone of revolution."""
    apex = np.array([50, 200, 300])
    weights = [1, 2, 0.5, 1, 1.5]
    top = [apex + 0.4 * (np.array(point) - apex) for point in A]
    return cad.between(cad.spline(A, weights=weights), cad.spline(top, weights=weights))


SHAPES: dict[str, Callable[[], TopoDS_Shape]] = {
    "a box with a rounded edge": cad.filleted_box,
    "a pipe cut obliquely": cad.oblique_pipe,
    "a cone up to its apex": cad.pointed_cone,
    "a cylinder over a spline": between,
    "a cone over a rational spline": oblique_cone_of_splines,
    "a plate with a hole, an ellipse and a slot": lambda: cad.slotted_plate(tilt=0.3),
}


IN_IGES = ("a pipe cut obliquely", "a cylinder over a spline", "a plate with a hole, an ellipse and a slot")


@pytest.mark.parametrize(("name", "write"), [*((n, cad.step) for n in SHAPES), *((n, cad.iges) for n in IN_IGES)])
def test_every_face_has_the_area_that_opencascade_measures(
    tmp_path: Path, name: str, write: Callable[[Path, TopoDS_Shape], Path]
) -> None:
    file = write(tmp_path / ("a.step" if write is cad.step else "a.iges"), SHAPES[name]())
    body, theirs = cad.read(file), cad.faces(cadmeasured.reread(file))
    assert len(body.faces) == len(theirs)
    for place, (face, its) in enumerate(zip(body.faces, theirs, strict=True)):
        _, checked, report = laid(SHAPES[name], place) if write is cad.step else flat(cad.part(face))
        assert_relative(
            areas(report), [cadmeasured.fine_area(its)] * 2, bound=1e-9, why="edges lie off their faces by 1e-8"
        )
        warp = checked.metric("max_warp_deg")
        assert warp.evidence == "proved"
        assert warp.value is not None and warp.value <= 1e-9


def test_a_cone_has_the_area_of_its_formula() -> None:
    cone = faces_of(cad.pointed_cone)[0]
    assert_relative(areas(laid(cad.pointed_cone)[2]), [pi * 30 * 50] * 2, bound=1e-12, why="pi r l")
    surface = constructed(cad.part(cone))
    assert isinstance(surface, RuledSurface)
    assert surface.trim is None


def test_a_hole_in_a_cone_lies_where_the_drill_meets_it(tmp_path: Path) -> None:
    face = cad.read(cad.step(tmp_path / "a.step", cad.drilled_cone())).faces[0]
    surface = constructed(cad.part(face))
    assert isinstance(surface, RuledSurface)
    assert surface.trim is not None
    assert len(surface.trim.inner) == 1
    strip = Strip(surface.patches, np.arange(len(surface.patches) + 1.0))
    t = np.linspace(0.0, 1.0, 7)
    hole = np.concatenate([points(strip, *curve.at(t).T) for curve in surface.trim.inner[0]])
    off = norm((hole - np.array([0.0, 0.0, 25.0]))[:, [0, 2]])
    assert_near(off, np.full_like(off, 8.0), bound=1e-6, why="to what OpenCASCADE finds intersections")


@pytest.mark.parametrize(("unit", "write"), [("INCH", cad.step), ("M", cad.step), ("IN", cad.iges), ("M", cad.iges)])
def test_units_of_the_file_become_mm(
    tmp_path: Path, unit: str, write: Callable[[Path, TopoDS_Shape, str], Path]
) -> None:
    file = tmp_path / ("a.step" if write is cad.step else "a.iges")
    faces = cad.read(write(file, cad.filleted_box((100, 60, 40), 10.0), unit)).faces
    expected = sorted([2000, 100 * 60 - 100 + 25 * pi, 4000, 100 * 60 - 100 + 25 * pi, 3600, 2400, 200 * pi])
    found = sorted(areas(flat(cad.part(face))[2])[1] for face in faces)
    assert_relative(found, expected, bound=1e-9, why="digits of the file")


def test_a_face_is_seen_from_outside_the_body(tmp_path: Path) -> None:
    body = cad.read(cad.step(tmp_path / "a.step", cad.prism([(0, 0), (60, 0), (10, 40)], 20.0)))
    seen = {}
    for face in body.faces:
        surface = constructed(cad.part(face))
        assert isinstance(surface, Plate)
        corners = np.array([edge.at(np.zeros(1))[0] for edge in surface.outline])
        sides = norm(np.roll(corners, -1, axis=0) - corners)
        if len(sides) == 3:
            first = int(np.argmax(sides))
            seen[float(np.sign(face.normal[2]))] = np.roll(sides, -first)
    top = [60.0, hypot(50, 40), hypot(10, 40)]
    assert_near(seen[1.0], [top[1], top[2], top[0]] if max(top) == top[1] else top, bound=1e-10, why="closed form")
    assert_near(seen[-1.0][1:], seen[1.0][:0:-1], bound=1e-10, why="digits of the file")


@pytest.mark.parametrize("shape", [cad.filleted_box, cad.oblique_pipe])
def test_strips_are_seen_from_outside_too(shape: Callable[[], TopoDS_Shape]) -> None:
    for face in faces_of(shape):
        surface = constructed(cad.part(face))
        if isinstance(surface, RuledSurface):
            patch = surface.patches[0]
            half = np.array([0.5])
            p, c0, c0_d1 = patch.p.jet(half, 0)[0], *patch.c0.jet(half, 1)
            axis = np.array([0.0, 0.0, 1.0])
            centre = np.array([10.0, 10.0, 0.0]) if shape is cad.filleted_box else np.zeros(3)
            outwards = (c0 + p / 2 - centre)[0] * (1 - axis)
            assert np.cross(p, c0_d1)[0] @ outwards > 0.0


# Rhino


# Refused


@pytest.mark.parametrize(("shape", "sort"), [(cad.sphere, "sphere"), (cad.torus, "torus")])
def test_a_face_without_rulings_is_refused_with_the_way_out(
    tmp_path: Path, shape: Callable[[], TopoDS_Shape], sort: str
) -> None:
    (face,) = cad.read(cad.step(tmp_path / "a.step", shape())).faces
    made = face_surface(cad.part(face), TOL)
    (finding,) = made.report.findings
    assert made.product is None
    assert (finding.code, finding.fatal, finding.where) == ("not-ruled", True, {"face": 0})
    assert f"face 0 is not ruled: it is a {sort}" in finding.message
    assert 'kind = "mesh"' in finding.message


def test_a_loop_that_lacks_an_edge_is_refused() -> None:
    face = faces_of(cad.oblique_pipe)[0]
    numbers = [edge.number for edge in face.loops[0]]
    rim = next(i for i, number in enumerate(numbers) if numbers.count(number) == 1)
    broken = face.replace(loops=((*face.loops[0][:rim], *face.loops[0][rim + 1 :]),))
    assert isinstance(broken, CadFace)
    assert [finding.code for finding in face_surface(cad.part(broken), TOL).report.findings] == ["open-contour"]
    nothing = face.replace(loops=())
    assert isinstance(nothing, CadFace)
    assert [finding.code for finding in face_surface(cad.part(nothing), TOL).report.findings] == ["no-edges"]


def test_an_edge_that_leaves_its_face_is_measured() -> None:
    (face,) = faces_of(between)
    here = face_surface(cad.part(face), TOL).report.metric("edge_distance_mm")
    assert float(here.value or 0.0) <= 1e-12
    edges = list(face.loops[0])
    straight = next(i for i, edge in enumerate(edges) if len(edge.curves) == 1)
    start, end = edges[straight].curves[0].jet(np.array([0.0, 1.0]), 0)[0]
    off = (start + end) / 2 + 2 * 0.1 * face.normal
    edges[straight] = CadEdge(edges[straight].number, (bezier([exactly(row) for row in (start, off, end)]),))
    bulged = face.replace(loops=(tuple(edges),))
    assert isinstance(bulged, CadFace)
    moved = face_surface(cad.part(bulged), TOL).report.metric("edge_distance_mm")
    assert not moved.passed


# Joined


def blanks(body_of: tuple[CadFace, ...]) -> tuple[Part, ...]:
    return face_blanks(cad.part(*body_of))


@pytest.mark.parametrize("write", [cad.step, cad.iges])
def test_a_channel_is_one_blank_with_its_bend_lines(
    tmp_path: Path, write: Callable[[Path, TopoDS_Shape], Path]
) -> None:
    shape = cad.channel()
    body = cad.read(write(tmp_path / ("a.step" if write is cad.step else "a.iges"), shape))
    (one,) = blanks(body.faces)
    pattern, checked, report = flat(one)
    assert one.name == "part"
    assert_relative(areas(report), [cadmeasured.area(shape, 1e-12)] * 2, bound=1e-12, why="planes and cylinders")
    assert len(pattern.inner) == 1
    assert checked.metric("max_warp_deg").evidence == "proved"
    lines = [mark for mark in pattern.marks if mark.layer.startswith("BEND")]
    assert len(lines) == 4
    assert len({mark.layer for mark in lines}) == 1
    lengths = [float(norm(mark.path.vertices[1] - mark.path.vertices[0])) for mark in lines]
    assert_near(lengths, [120.0] * 4, bound=1e-9, why="along the whole channel")
    flat_side = report.detail["flat"]
    assert isinstance(flat_side, dict)
    sides = sorted([float(flat_side["width"]), float(flat_side["height"])])
    assert_near(sides, [120.0, 2 * 25 + 70 + 5 * pi], bound=1e-9, why="closed form")


def test_faces_with_a_fold_between_them_are_blanks_of_their_own() -> None:
    found = blanks(faces_of(cad.filleted_box))
    assert [one.name for one in found] == [f"part.{i}" for i in range(1, 6)]
    counts = [len(one.body.faces) for one in found if one.body is not None and not hasattr(one.body, "vertices")]
    assert sorted(counts) == [1, 1, 1, 1, 3]
    total = sum(areas(flat(one)[2])[1] for one in found)
    assert_relative(total, cadmeasured.area(cad.filleted_box(), 1e-12), bound=1e-12, why="planes and a cylinder")


def test_a_ring_of_faces_is_cut_open_and_says_where(tmp_path: Path) -> None:
    body = cad.read(cad.step(tmp_path / "a.step", cad.rounded_tube()))
    (ring,) = [one for one in blanks(body.faces) if isinstance(one.body, CadBody) and len(one.body.faces) > 1]
    remark, edges = ring.remarks
    assert [(one.code, one.fatal) for one in (remark, edges)] == [("not-joined", False), ("edges-apart", False)]
    assert "they meet at an angle of 90 deg" in edges.message
    assert "the ring is cut open there" in remark.message
    made = face_surface(ring, TOL)
    assert isinstance(made.product, RuledSurface)
    assert made.product.trim is None
    assert made.report.findings == ring.remarks
    rows = made.report.detail["faces"]
    assert isinstance(rows, list)
    assert len(rows) == 8
    lengths = [float(norm(patch.p.jet(np.zeros(1), 0)[0])[0]) for patch in made.product.patches]
    assert_near(lengths, [40.0] * 8, bound=1e-12, why="the depth")


def test_a_part_is_the_same_wherever_its_body_stands(tmp_path: Path) -> None:
    spun = cad.read(cad.step(tmp_path / "a.step", cad.turned(cad.oblique_pipe(), (1, 2, 3), 0.7, (1000, -500, 20))))
    _, checked, report = flat(cad.part(spun.faces[0]))
    assert checked.metric("max_warp_deg").value == 0.0
    assert_relative(areas(report), [2 * pi * 20 * 25] * 2, bound=1e-11, why="digits of the file, 50 times the radius")


def test_a_strip_of_a_face_covers_its_loops() -> None:
    surface = constructed(cad.part(faces_of(cad.oblique_pipe)[0]))
    assert isinstance(surface, RuledSurface)
    assert surface.trim is not None
    strip = Strip(surface.patches, np.arange(len(surface.patches) + 1.0))
    t = np.linspace(0.0, 1.0, 257)
    every = np.concatenate([curve.at(t) for curve in surface.trim.outer])
    assert_near(every[:, 0].clip(0.0, 1.0), every[:, 0], bound=1e-12, why="rounding")
    assert_near(every[:, 1].min(), strip.knots[0], bound=0.0, why="the seam")
    assert_near(every[:, 1].max(), strip.knots[-1], bound=0.0, why="the seam")
