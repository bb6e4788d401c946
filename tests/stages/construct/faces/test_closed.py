"""Splines that close on themselves and whose edges leave no seam are cut open along a ruling."""

from collections.abc import Callable
from functools import cache
from math import pi
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
import rhino3dm

from stages.construct.faces.closed import begun_at, opened
from stages.construct.faces.ruled import Rails, ruled_form
from stages.construct.faces.seams import SEAM_NUMBER
from stages.construct.faces.strip import arcs
from stages.construct.faces.surface import face_surface
from stages.geometry.curves.curves import Circular
from stages.geometry.ruled.ruled import between
from stages.model.cadface import CadEdge, CadFace, CadNet, CadSweep
from stages.model.tolerances import Tolerances
from tests import cad, cadrhino
from tests.near import assert_near, assert_relative
from tests.stages.construct.faces.test_seams import area, codes, measured, rim, window

TOL = Tolerances()
Loop = tuple[CadEdge, ...]


def frustum() -> rhino3dm.NurbsSurface:
    """The ruled surface between two circles of 20 and 35 mm, 20 mm apart."""
    circles = [rhino3dm.Circle(rhino3dm.Point3d(0, 0, z), r).ToNurbsCurve() for z, r in ((0, 20), (20, 35))]
    return rhino3dm.NurbsSurface.CreateRuledSurface(*circles)


@cache
def net(make: Callable[[], object]) -> CadFace:
    """Return the closed face of a body by Rhino."""
    with TemporaryDirectory() as folder:
        faces = cad.read(cadrhino.rhino(Path(folder) / "a.3dm", make())).faces
    return next(face for face in faces if isinstance(face.surface, CadNet) and ruled_form(face.surface) is not None)


def bare(face: CadFace) -> CadFace:
    """Return a face without its seam: every other edge a loop."""
    edges = [edge for loop in face.loops for edge in loop]
    numbers = [edge.number for edge in edges]
    made = face.replace(loops=tuple((edge,) for edge in edges if numbers.count(edge.number) == 1))
    assert isinstance(made, CadFace)
    assert len(made.loops) < len(edges)
    return made


@pytest.mark.parametrize(
    ("make", "formula"),
    [
        (cadrhino.rhino_pipe, 2 * pi * 20 * 50),
        (cadrhino.rhino_cone, pi * 30 * 50),
        (frustum, pi * (20 + 35) * 25),
    ],
)
def test_a_closed_net_has_its_area_with_a_seam_of_its_file_and_with_one_that_is_found(
    make: Callable[[], object], formula: float
) -> None:
    (given, of_file), (found, said) = measured(net(make)), measured(bare(net(make)))
    assert "seam-added" not in of_file
    assert "seam-added" in said
    assert_relative([given, found], [formula] * 2, bound=1e-9, why="closed form")


def pipe(*loops: Loop, start: float = 0.0) -> CadFace:
    """Return a pipe of 20 mm about z between 0 and 30 mm, as the sweep of four arcs."""
    ring = rim(0.0, 0.0)[0].curves[0]
    assert isinstance(ring, Circular)
    surface = CadSweep(arcs(ring, start, start + 2 * pi), np.array([0.0, 0, 1]))
    return CadFace(0, "", "spline", surface, np.array([20.0, 0, 15]), np.array([1.0, 0, 0]), loops)


def seam_angle(face: CadFace) -> float:
    """Return the angle at which a face is cut open."""
    assert isinstance(face.surface, CadSweep)
    cut, _ = opened(face, face.surface)
    seam = next(edge for loop in cut.loops for edge in loop if edge.number == SEAM_NUMBER)
    x, y, _ = seam.curves[0].jet(np.zeros(1), 0)[0][0]
    return float(np.arctan2(y, x) % (2 * pi))


def test_it_is_cut_open_where_the_spline_begins() -> None:
    face = pipe(rim(0.0, 0.4), rim(30.0, 2.5), start=1.0)
    assert_near(seam_angle(face), 1.0, bound=1e-12, why="the first ruling")
    assert_relative(area(face), 2 * pi * 20 * 30, bound=1e-9, why="closed form")


def test_a_hole_over_the_beginning_takes_the_seam_to_the_next_knot() -> None:
    face = pipe(rim(0.0, 0.4), rim(30.0, 2.5), window(-0.5, 0.5))
    assert_near(seam_angle(face), pi / 2, bound=1e-12, why="the second knot")
    assert_relative(area(face), 2 * pi * 20 * 30 - 20 * 10, bound=1e-9, why="closed form")


def test_a_hole_over_all_knots_takes_the_seam_between_them() -> None:
    face = pipe(rim(0.0, 0.4), rim(30.0, 2.5), window(-0.2, 4.9))
    assert 4.9 < seam_angle(face) < 2 * pi - 0.2
    assert_relative(area(face), 2 * pi * 20 * 30 - 5.1 * 20 * 10, bound=1e-9, why="closed form")


def test_holes_that_leave_no_ruling_are_refused() -> None:
    holes = (window(0.0, 2.4), window(2.0, 4.4), window(4.0, 6.5))
    assert codes(face_surface(cad.part(pipe(rim(0.0, 0.4), rim(30.0, 0.4), *holes)), TOL)) == ["no-seam"]


def test_a_face_that_does_not_go_round_is_left_as_it_is() -> None:
    face = pipe(window(0.5, 1.5))
    assert isinstance(face.surface, CadSweep)
    assert opened(face, face.surface) == (face, face.surface)
    whole = net(cadrhino.rhino_pipe)
    form = ruled_form(whole.surface)
    assert isinstance(form, Rails)
    assert opened(whole, form) == (whole, form)


@pytest.mark.parametrize("v", [0.0, 1.0, 1.25, 3.7, 4.0 - 1e-12])
def test_a_surface_begun_elsewhere_is_the_same_surface(v: float) -> None:
    low, high = (arcs(ring, 0.0, 2 * pi) for z in (0.0, 30.0) if isinstance(ring := rim(z, 0.0)[0].curves[0], Circular))
    rails = Rails(tuple(between(a, b) for a, b in zip(low, high, strict=True)))
    made = begun_at(rails, v)
    assert isinstance(made, Rails)
    assert len(made.patches) == (4 if abs(v - round(v)) < 1e-9 else 5)
    t = np.array([0.0, 1.0])
    ends = np.array([patch.c0.jet(t, 0)[0] for patch in made.patches])
    assert_near(ends[1:, 0], ends[:-1, 1], bound=1e-12, why="end to end")
    assert_near(ends[0, 0], ends[-1, 1], bound=1e-12, why="once round")
    i, share = int(v + 1e-9), v - int(v + 1e-9)
    assert_near(ends[0, 0], low[i % 4].jet(np.array([max(share, 0.0)]), 0)[0][0], bound=1e-9, why="at v")
