"""Closed cylinders and cones without a seam are cut open along a ruling that meets no hole."""

from collections.abc import Callable
from functools import cache
from math import pi
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from OCP.TopoDS import TopoDS_Shape

from stages.construct.faces.seams import SAMPLES, SEAM_NUMBER, _met, seamed
from stages.construct.faces.spline import straight
from stages.construct.faces.surface import face_surface
from stages.geometry.arrays import norm
from stages.geometry.curves.curves import Circular
from stages.geometry.ruled.backwards import backwards
from stages.model.cadface import CadCone, CadEdge, CadFace, CadSweep
from stages.model.report import Outcome
from stages.model.surface import RuledSurface, Surface
from stages.model.tolerances import Tolerances
from stages.unroll import unroll
from stages.verify import verify
from tests import cad
from tests.near import assert_near, assert_relative

TOL = Tolerances()


@cache
def read(make: Callable[[], TopoDS_Shape]) -> CadFace:
    with TemporaryDirectory() as folder:
        return cad.read(cad.step(Path(folder) / "a.step", make())).faces[0]


def bare(make: Callable[[], TopoDS_Shape]) -> CadFace:
    """Return the closed face of a body without its seam: every rim a loop, as other programs write it."""
    face = read(make)
    numbers = [edge.number for edge in face.loops[0]]
    rims = tuple((edge,) for edge in face.loops[0] if numbers.count(edge.number) == 1)
    made = face.replace(loops=(*rims, *face.loops[1:]))
    assert isinstance(made, CadFace)
    return made


def measured(face: CadFace) -> tuple[float, list[str]]:
    """Return the flat area of a face, and the codes of what construct finds."""
    made = face_surface(cad.part(face), TOL)
    assert made.product is not None, made.report.findings
    checked = verify(made.product, TOL)
    assert checked.product is not None
    flat = unroll(checked.product, TOL).report.detail["flat"]
    assert isinstance(flat, dict)
    return float(flat["area"]), codes(made)


def area(face: CadFace) -> float:
    """Return the flat area of a face."""
    return measured(face)[0]


def codes(made: Outcome[Surface | None]) -> list[str]:
    return [finding.code for finding in made.report.findings]


BODIES = [cad.oblique_pipe, cad.pointed_cone]


@pytest.mark.parametrize("make", BODIES)
def test_a_face_has_its_area_with_a_seam_of_its_file_and_with_one_that_is_found(
    make: Callable[[], TopoDS_Shape],
) -> None:
    (found, said), (given, of_file) = measured(bare(make)), measured(read(make))
    assert "seam-added" in said
    assert "seam-added" not in of_file
    assert_relative(found, given, bound=1e-9, why="edges of the file lie off by 1e-8")


def test_both_rims_may_run_the_same_way() -> None:
    face = bare(cad.oblique_pipe)
    (edge,) = face.loops[1]
    other = (CadEdge(edge.number, tuple(backwards(curve) for curve in edge.curves[::-1])),)
    turned = face.replace(loops=(face.loops[0], other))
    assert isinstance(turned, CadFace)
    assert_relative(area(turned), 2 * pi * 20 * 25, bound=1e-9, why="closed form")


def rim(z: float, start: float) -> tuple[CadEdge, ...]:
    """Return a circle of 20 mm about z that begins at an angle."""
    axes = np.array([20.0, 0, 0]), np.array([0, 20.0, 0]), np.zeros(3)
    return (CadEdge(int(z) + 1, (Circular(np.array([0, 0, z]), *axes, start, 2 * pi),)),)


def pipe(*loops: tuple[CadEdge, ...]) -> CadFace:
    ring = rim(0.0, 0.0)[0].curves[0]
    assert isinstance(ring, Circular)
    surface = CadSweep((ring,), np.array([0.0, 0, 1]))
    return CadFace(0, "", "cylinder", surface, np.array([20.0, 0, 15]), np.array([1.0, 0, 0]), loops)


def test_the_seam_is_a_ruling_through_the_end_of_an_edge_and_divides_the_other_rim() -> None:
    face = pipe(rim(0.0, 0.4), rim(30.0, 2.5))
    assert isinstance(face.surface, CadSweep)
    (loop,) = seamed(face, face.surface).loops
    seams = [edge.curves[0].jet(np.array([0.0, 1.0]), 0)[0] for edge in loop if edge.number == SEAM_NUMBER]
    foot = 20 * np.array([np.cos(0.4), np.sin(0.4), 0])
    assert_near(seams[0], [foot, foot + np.array([0, 0, 30])], bound=1e-12, why="a ruling")
    assert_near(seams[1], seams[0][::-1], bound=0.0, why="the way back")
    ends = [curve.jet(np.array([0.0, 1.0]), 0)[0] for edge in loop for curve in edge.curves]
    gaps = [float(norm(one[1] - other[0])) for one, other in zip(ends, [*ends[1:], ends[0]], strict=True)]
    assert max(gaps) <= 1e-12
    assert len({edge.number for edge in loop}) == len(loop) - 1
    assert_relative(area(face), 2 * pi * 20 * 30, bound=1e-12, why="closed form")


def window(low: float, high: float) -> tuple[CadEdge, ...]:
    """Return four edges round a window between two angles, from z = 10 to z = 20."""
    axes = np.array([20.0, 0, 0]), np.array([0, 20.0, 0])
    sides = [
        (low, high - low, 10.0, 0.0),
        (high, 0.0, 10.0, 10.0),
        (high, low - high, 20.0, 0.0),
        (low, 0.0, 20.0, -10.0),
    ]
    made = []
    for n, (start, sweep, z, rise) in enumerate(sides):
        curve = Circular(np.array([0, 0, z]), *axes, np.zeros(3), start, sweep) if sweep else None
        foot = np.array([20 * np.cos(start), 20 * np.sin(start), z])
        made.append(CadEdge(100 + n, (curve or straight(foot, foot + np.array([0, 0, rise])),)))
    return tuple(made)


def test_the_seam_goes_round_a_hole() -> None:
    face = pipe(rim(0.0, 0.4), rim(30.0, 2.5), window(0.0, 3.0))
    assert isinstance(face.surface, CadSweep)
    loop, _ = seamed(face, face.surface).loops
    foot = next(edge for edge in loop if edge.number == SEAM_NUMBER).curves[0].jet(np.zeros(1), 0)[0][0]
    angle = float(np.arctan2(foot[1], foot[0])) % (2 * pi)
    assert 3.0 < angle < 2 * pi
    assert_relative(area(face), 2 * pi * 20 * 30 - 3.0 * 20 * 10, bound=1e-9, why="closed form")


@pytest.mark.parametrize("loops", [(rim(0.0, 0.4),), (rim(0.0, 0.0), rim(10.0, 0.0), rim(30.0, 0.0))])
def test_rims_that_bound_no_pipe_are_refused(loops: tuple[tuple[CadEdge, ...], ...]) -> None:
    made = face_surface(cad.part(pipe(*loops)), TOL)
    assert made.product is None
    assert codes(made) == ["no-seam"]


def test_a_pipe_without_a_ruling_that_is_free_of_holes_is_refused() -> None:
    holes = (window(0.0, 2.4), window(2.0, 4.4), window(4.0, 6.5))
    assert codes(face_surface(cad.part(pipe(rim(0.0, 0.4), rim(30.0, 0.4), *holes)), TOL)) == ["no-seam"]


def test_a_face_with_a_seam_is_left_as_it_is() -> None:
    face = read(cad.pointed_cone)
    assert isinstance(face.surface, CadCone)
    assert seamed(face, face.surface) is face
    assert isinstance(face_surface(cad.part(face), TOL).product, RuledSurface)


def test_a_curve_that_goes_round_more_than_once_meets_a_ruling_in_every_round() -> None:
    """From half a turn before the ruling to one and a half behind it, evenly."""
    angles = 2.0 * pi * np.linspace(-0.5, 1.5, SAMPLES)
    assert_near(_met(angles + 0.3, 0.3), [0.25, 0.75], bound=1e-12, why="straight lines between samples")
    assert_near(sorted(_met(0.3 - angles, 0.3)), [0.25, 0.75], bound=1e-12, why="the other way round")
