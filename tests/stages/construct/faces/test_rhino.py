"""Faces of 3DM files: areas of their formulas, ruled surfaces of any degree, and what is refused."""

from math import pi
from pathlib import Path

import numpy as np
import rhino3dm
from scipy.integrate import quad
from scipy.interpolate import BSpline

from stages.construct.faces.surface import face_surface
from stages.geometry.arrays import norm
from stages.verify import verify
from tests import cad, cadrhino
from tests.near import assert_near, assert_relative
from tests.stages.construct.faces.test_surface import FLAT, TOL, areas, constructed, flat


def test_the_sides_of_a_cylinder_by_rhino_have_the_areas_of_their_formulas(tmp_path: Path) -> None:
    body = cad.read(
        cadrhino.rhino(tmp_path / "Rohr groß.3dm", cadrhino.rhino_pipe(20.0, 50.0), unit="Inches", name="Rohr groß")
    )
    assert [(face.sort, face.name) for face in body.faces] == [
        ("cylinder", "Rohr groß"), ("plane", "Rohr groß"), ("plane", "Rohr groß")
    ]  # fmt: skip
    found = [areas(flat(cad.part(face))[2]) for face in body.faces]
    expected = [[value * 25.4**2] * 2 for value in (2 * pi * 20 * 50, pi * 400, pi * 400)]
    assert_relative(found, expected, bound=1e-12, why="closed form")


def test_a_cone_by_rhino_has_the_area_of_its_formula(tmp_path: Path) -> None:
    body = cad.read(cadrhino.rhino(tmp_path / "a.3dm", cadrhino.rhino_cone(30.0, 40.0), unit="Meters"))
    _, checked, report = flat(cad.part(*body.faces))
    assert_relative(areas(report), [pi * 30 * 50 * 1e6] * 2, bound=1e-12, why="pi r l")
    assert float(checked.metric("max_warp_deg").value or 0.0) <= 1e-9


def length(points: list[tuple[int, int, int]]) -> float:
    """Return the length of the spline through control points, by scipy."""
    count = len(points) - 3
    knots = np.concatenate([np.zeros(3), np.arange(count + 1), np.full(3, count)])
    slope = BSpline(knots, np.array(points, dtype=float), 3).derivative()
    return sum(quad(lambda t: float(norm(slope(t))), i, i + 1, epsabs=0, epsrel=1e-13)[0] for i in range(count))


def test_ruled_surfaces_by_rhino_are_ruled_whatever_their_degree(tmp_path: Path) -> None:
    plain, raised = (cadrhino.rhino_ruled(FLAT, [(x, y, 80) for x, y, _ in FLAT]) for _ in range(2))
    assert raised.IncreaseDegreeV(3)
    body = cad.read(cadrhino.rhino(tmp_path / "a.3dm", plain, raised))
    found = [areas(flat(cad.part(face))[2]) for face in body.faces]
    assert_relative(found, [[80 * length(FLAT)] * 2] * 2, bound=1e-12, why="parallel rulings of 80")


def test_an_extrusion_by_rhino_is_read(tmp_path: Path) -> None:
    body = cad.read(
        cadrhino.rhino(tmp_path / "a.3dm", cadrhino.rhino_extrusion([(0, 0, 0), (50, 0, 0), (50, 40, 0)], 30.0))
    )
    found = [areas(flat(cad.part(face))[2])[1] for face in body.faces]
    assert_near(found, [1500.0, 1200.0], bound=1e-10, why="two rectangles")


def test_a_twisted_ruled_face_goes_to_verify_and_is_refused_there(tmp_path: Path) -> None:
    twisted = cadrhino.rhino_ruled([(0, 0, 0), (100, 0, 0)], [(0, 0, 50), (100, 40, 50)], 1)
    (face,) = cad.read(cadrhino.rhino(tmp_path / "a.3dm", twisted)).faces
    report = verify(constructed(cad.part(face)), TOL).report
    assert "not-developable" in [finding.code for finding in report.findings]


def test_a_sphere_by_rhino_is_refused_too(tmp_path: Path) -> None:
    ball = rhino3dm.Brep.CreateFromSphere(rhino3dm.Sphere(rhino3dm.Point3d(0, 0, 0), 5.0))
    (face,) = cad.read(cadrhino.rhino(tmp_path / "a.3dm", ball)).faces
    assert [finding.code for finding in face_surface(cad.part(face), TOL).report.findings] == ["not-ruled"]
