"""Faces on the strips under them: planes in any direction, and rails shortened to what their edges reach."""

from pathlib import Path

import numpy as np
import pytest
import shapely
from OCP.TopoDS import TopoDS_Shape
from scipy.integrate import quad
from scipy.interpolate import BSpline

from stages.construct.faces.based import based, normals, places
from stages.construct.faces.ruled import Rails, ruled_form
from stages.construct.faces.strip import strip_of
from stages.construct.faces.surface import face_surface
from stages.geometry.arrays import norm
from stages.geometry.ruled.ruled import size_of
from stages.model.cadface import CadFace
from stages.model.surface import RuledSurface, whole_spans
from stages.model.tolerances import Tolerances
from stages.unroll import unroll
from stages.verify import verify
from tests import cad
from tests.near import assert_near, assert_relative

TOL = Tolerances()
APEX = np.array([50.0, 20.0, 100.0])
PROFILE = np.array([[0.0, 0, 0], [30, 20, 0], [60, -10, 0], [100, 30, 0]])


def half_twisted() -> TopoDS_Shape:
    """A ruled face that is plane for its first half and twisted for its second, cut off in the plane half."""
    face = cad.between(
        cad.spline([(0, 0, 0), (50, 0, 0), (100, 0, 0)], 1), cad.spline([(10, 0, 50), (45, 0, 50), (100, 40, 50)], 1)
    )
    return cad.cut_by(cad.cut_by(face, (40, 0, 0), (1, 0, 0)), (0, 0, 30), (0, 0, 1))


def through_the_apex() -> TopoDS_Shape:
    """A cone that goes on beyond its apex, cut off before it."""
    beyond = APEX - 0.5 * (PROFILE - APEX)
    face = cad.between(cad.spline(PROFILE.tolist()), cad.spline(beyond.tolist()))
    return cad.cut_by(face, (0, 0, 60), (0, 0, 1))


def face_of(tmp_path: Path, shape: TopoDS_Shape) -> CadFace:
    (face,) = cad.read(cad.step(tmp_path / "a.step", shape)).faces
    return face


def flat_area(face: CadFace) -> float:
    made = face_surface(cad.part(face), TOL)
    assert made.product is not None, made.report.findings
    checked = verify(made.product, TOL)
    assert checked.product is not None, checked.report.findings
    assert checked.product.reached == "exact"
    flat = unroll(checked.product, TOL).report.detail["flat"]
    assert isinstance(flat, dict)
    return float(flat["area"])


def whole_passes(face: CadFace) -> bool:
    """Return whether verify passes the surface under a face as far as the file has it."""
    form = ruled_form(face.surface)
    assert isinstance(form, Rails)
    patches = strip_of(form, face)
    surface = RuledSurface(cad.part(face), patches, size_of(patches), whole_spans(len(patches)))
    return verify(surface, TOL).product is not None


def test_what_lies_beyond_the_edges_in_v_is_not_judged(tmp_path: Path) -> None:
    face = face_of(tmp_path, half_twisted())
    assert not whole_passes(face)
    kept = shapely.Polygon([(0, 0), (50, 0), (45, 50), (10, 50)]).intersection(shapely.box(-1, -1, 40, 30))
    assert_relative(flat_area(face), kept.area, bound=1e-9, why="edges of the file lie off by 1e-8")


def test_what_lies_beyond_the_edges_in_u_is_not_judged(tmp_path: Path) -> None:
    face = face_of(tmp_path, through_the_apex())
    assert not whole_passes(face)
    curve = BSpline(np.repeat([0.0, 1.0], 4), PROFILE, 3)
    slope = curve.derivative()
    whole = quad(lambda t: float(norm(np.cross(curve(t) - APEX, slope(t)))) / 2.0, 0.0, 1.0, epsrel=1e-13)[0]
    assert_relative(flat_area(face), whole * (1 - 0.4**2), bound=1e-9, why="cut at 0.6 of the way to the apex")


@pytest.mark.parametrize("shape", [half_twisted, through_the_apex])
def test_a_shortened_strip_still_covers_its_loops(tmp_path: Path, shape: object) -> None:
    assert callable(shape)
    side = based(face_of(tmp_path, shape()))
    assert side is not None
    t = np.linspace(0.0, 1.0, 129)
    every = np.concatenate([curve.at(t) for loop in side.loops.curves for curve in loop])
    assert_near(every[:, 0].clip(0.0, 1.0), every[:, 0], bound=1e-12, why="rounding")
    assert_near(every[:, 1].clip(0.0, len(side.patches)), every[:, 1], bound=1e-12, why="rounding")
    assert float(np.ptp(every[:, 0])) >= 0.99
    assert float(np.ptp(every[:, 1])) >= 0.99 * len(side.patches)


def test_a_plane_has_its_edges_where_they_are_in_space(tmp_path: Path) -> None:
    face = face_of(tmp_path, cad.turned(cad.slotted_plate(), (1, 2, 3), 0.7, (100, -50, 20)))
    side = based(face, first=3)
    assert side is not None
    t = np.linspace(0.0, 1.0, 9)
    theirs = np.concatenate([curve.jet(t, 0)[0] for loop in face.loops for edge in loop for curve in edge.curves])
    ours = np.concatenate([places(side, curve, t) for loop in side.loops.curves for curve in loop])
    apart = norm(theirs[:, None] - ours[None]).min(axis=1)
    assert float(apart.max()) <= 1e-10
    found = np.concatenate([normals(side, curve, t) for loop in side.loops.curves for curve in loop])
    assert_near(found, np.broadcast_to(face.normal, found.shape), bound=1e-12, why="a plane, seen from outside")
    assert float(side.strip.knots[0]) == 3.0
