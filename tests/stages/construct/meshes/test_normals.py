"""Ribbons whose normals are taken from a mesh, against those of the surface itself; and curves that lie on no mesh."""

from collections.abc import Sequence
from math import cos, hypot, pi, radians, sin

import numpy as np
import pytest

from stages.construct import construct
from stages.construct.curves import interpolated
from stages.construct.meshes.normals import mesh_normals
from stages.construct.ribbons import band, normals_through
from stages.geometry.arrays import Array, norm, unit
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.ruled.ruled import RuledPatch, end_normals, frames
from stages.model.material import Part
from stages.model.meshes import MeshNormals
from stages.model.report import Outcome
from stages.model.surface import RuledSurface, Surface
from stages.model.tolerances import Tolerances
from stages.unroll import unroll
from stages.verify import verify
from tests.meshes import jittered, noisy, single_precision
from tests.near import assert_near, assert_relative
from tests.parts import Table, read, troubles

FILE: Table = {"file": "last.stl", "units": "mm"}
KEY = MeshNormals(file="last.stl", units="mm")
AXES = np.array([100.0, 70.0, 50.0])


def on_ellipsoid(theta: Array, phi: Array) -> Array:
    """Return points of the ellipsoid with these half axes."""
    return AXES * np.column_stack([np.cos(theta) * np.sin(phi), np.sin(theta) * np.sin(phi), np.cos(phi)])


def ellipsoid(seed: int = 3, columns: int = 100, rows: int = 50) -> Mesh:
    """Return a piece of it, its outside outwards."""
    v, u, faces = jittered(seed, columns, rows)
    return Mesh(on_ellipsoid(0.3 + 1.8 * v, 0.5 + 1.5 * u), faces[:, ::-1])


def on_it(count: int = 9) -> tuple[Array, Array]:
    """Return points of a curve across the ellipsoid, and its normals there."""
    t = np.linspace(0.05, 0.95, count)
    points = on_ellipsoid(0.3 + 1.8 * t, 0.5 + 1.5 * (0.2 + 0.6 * t))
    return points, unit(points / AXES**2)


def pipe(seed: int = 1, radius: float = 100.0, columns: int = 100, rows: int = 50) -> Mesh:
    """Return 2.5 rad of a pipe of that radius, 1.5 radii long, its outside outwards."""
    v, u, faces = jittered(seed, columns, rows)
    points = radius * np.column_stack([np.cos(2.5 * v - 0.2), np.sin(2.5 * v - 0.2), 1.5 * u - 0.1])
    return Mesh(points, faces)


def helix(radius: float = 100.0, turns: float = 0.25) -> Table:
    return {"helix": {"radius": radius, "pitch": 4.0 * radius, "turns": turns}}


def surface(curve: Table, mesh: Mesh, **widths: object) -> RuledSurface:
    """Return the ribbon along a curve that lies on a mesh."""
    made = outcome(curve, mesh, **widths)
    assert isinstance(made.product, RuledSurface), made.report.findings
    return made.product


def outcome(curve: Table, mesh: Mesh, **widths: object) -> Outcome[Surface | None]:
    spec = read({"kind": "ribbon", "curve": curve, "normals": FILE} | (widths or {"width": 30}))
    return construct(Part(spec, meshes={KEY: mesh}), Tolerances())


def refused(curve: Table, mesh: Mesh) -> tuple[str, str]:
    """Return code and message of the one reason."""
    (finding,) = (finding for finding in outcome(curve, mesh).report.findings if finding.fatal)
    return finding.code, finding.message


def area(patches: Sequence[RuledPatch]) -> float:
    """Return the area of ruled patches, both normals of every ruling along one direction."""
    nodes, weights = np.polynomial.legendre.leggauss(12)
    found = [end_normals(frames(patch, (nodes + 1.0) / 2.0)) for patch in patches]
    return sum(float(weights @ (norm(n0) + norm(n1))) / 4.0 for n0, n1 in found)


# Known bands


def test_a_band_on_a_pipe_is_a_straight_strip_along_its_helix() -> None:
    """A helix is a geodesic: width times length, and both edges as long as the helix."""
    made = surface(helix(turns=0.125), pipe(), widths=[10, 20])
    length = hypot(pi / 2.0 * 100.0, 100.0) / 2.0
    checked = verify(made, Tolerances())
    assert checked.product is not None
    flat = unroll(checked.product, Tolerances())
    assert flat.product is not None
    assert_relative(area(made.patches), 30.0 * length, bound=1e-8, why="normals to 1e-7 rad: c0 and c1 at their widths")
    edges = flat.report.detail["surface"]["edges"]  # type: ignore[index]
    assert_relative([edges["c0"], edges["c1"]], [length, length], bound=1e-5, why="rulings lean with the error of n'")


def test_the_band_that_touches_a_sphere_along_a_circle_is_a_frustum() -> None:
    """At latitude 40 deg of a ball of radius 80: mean radius times angle times width."""
    v, u, faces = jittered(2, 110, 40)
    rise, turn = 1.2 * u + 0.1, 2.2 * v - 0.3
    ball = 80.0 * np.column_stack([np.cos(turn) * np.cos(rise), np.sin(turn) * np.cos(rise), np.sin(rise)])
    latitude = radians(40.0)
    arc: Table = {"arc": {"center": [0, 0, repr(80.0 * sin(latitude))], "radius": repr(80.0 * cos(latitude)),
                          "start": 0, "end": 90}}  # fmt: skip
    found = surface(arc, Mesh(ball, faces), widths=[6, 9])
    wanted = pi / 2.0 * 15.0 * (80.0 * np.cos(latitude) + 1.5 * sin(latitude))
    assert_relative(area(found.patches), wanted, bound=1e-6, why="normals to 1e-7 rad, n' to 1e-6")


def test_a_band_around_a_ball_closes() -> None:
    v, u, faces = jittered(4, 150, 24)
    turn, rise = 2.0 * pi * v, 0.8 * u
    ball = 50.0 * np.column_stack([np.cos(turn) * np.cos(rise), np.sin(turn) * np.cos(rise), np.sin(rise)])
    circle: Table = {"circle": {"center": [0, 0, repr(50.0 * sin(0.4))], "radius": repr(50.0 * cos(0.4))}}
    made = outcome(circle, Mesh(ball, faces), width=4)
    assert isinstance(made.product, RuledSurface), made.report.findings
    assert_relative(area(made.product.patches), 8.0 * pi * 50.0 * np.cos(0.4), bound=1e-6, why="mean radius")
    ends = [end_normals(frames(patch, np.array([v])))[0][0] for patch, v in
            ((made.product.patches[0], 0.0), (made.product.patches[-1], 1.0))]  # fmt: skip
    assert_near(unit(ends[0]), unit(ends[1]), bound=1e-9, why="a periodic spline")


@pytest.mark.parametrize(("what", "bound"), [("doubles", 1e-6), ("single precision", 4e-6)])
def test_normals_of_an_ellipsoid_are_those_of_the_ellipsoid(what: str, bound: float) -> None:
    mesh = ellipsoid() if what == "doubles" else single_precision(ellipsoid())
    points, normals = on_it(81)
    link = interpolated(points)
    found = mesh_normals(link, mesh, Tolerances())
    assert found.normals is not None and not found.findings
    spline = found.normals
    places = np.array([float(b) for b in link.breaks]) * len(spline.curves)
    piece = np.minimum(places.astype(int), len(spline.curves) - 1)
    got = np.stack([spline.curves[i].jet(np.array([t - i]), 0)[0, 0] for i, t in zip(piece, places, strict=True)])
    assert_near(unit(got), normals, bound=bound, why="10 000 triangles of 2 mm, radii from 25 mm")


def test_the_band_is_that_of_normals_from_a_list() -> None:
    points, normals = on_it()
    link = interpolated(points)
    given = band(link, normals_through(normals, link.breaks, closed=False), (6.0, 9.0))
    points_of: Table = {"points": [[repr(float(x)) for x in row] for row in points]}
    found = surface(points_of, ellipsoid(), widths=[6, 9])
    assert_relative(area(found.patches), area(given.patches), bound=1e-2, why="the list is 10 deg apart, cubic")


def test_noise_is_smoothed() -> None:
    """Half a hundredth of a millimetre on triangles of 2 mm: single normals are off by 6e-3 rad."""
    points, _ = on_it(41)
    clean, rough = (mesh_normals(interpolated(points), mesh, Tolerances()) for mesh in
                    (ellipsoid(), noisy(ellipsoid(), 3e-5)))  # fmt: skip
    spans = [next(m.value for m in found.metrics if m.name == "normal_spans") for found in (clean, rough)]
    assert spans[1] <= spans[0] / 2.0, "fewer spans than the clean mesh takes"


def test_a_mesh_turned_over_turns_the_band_over() -> None:
    mesh = pipe()
    up, down = (surface(helix(), m, widths=[10, 20]) for m in (mesh, Mesh(mesh.vertices, mesh.faces[:, ::-1])))
    left, right = (frames(s.patches[0], np.array([0.0])).c0[0] for s in (up, down))
    middle = np.array([100.0, 0.0, 0.0])
    assert_near(norm(left - middle), norm(right - middle), bound=1e-4, why="10 mm to the left, seen from either side")
    assert (left - middle) @ (right - middle) < 0.0


def test_faces_that_run_against_each_other_do_not_matter() -> None:
    mesh = pipe()
    faces = mesh.faces.copy()
    faces[1::7] = faces[1::7, ::-1]
    other = surface(helix(), Mesh(mesh.vertices, faces))
    assert_relative(area(other.patches), area(surface(helix(), mesh).patches), bound=1e-12, why="turned alike first")


# What is refused


def test_a_curve_off_the_mesh_is_refused_with_its_distance() -> None:
    code, message = refused(helix(radius=104.0), pipe())
    assert code == "curve-off-mesh" and "4 mm" in message


@pytest.mark.parametrize(("factor", "said"), [(1.0 / 25.4, "25.4 times"), (1000.0, "0.001 times"), (0.1, "10 times")])
def test_a_mesh_in_another_unit_is_named(factor: float, said: str) -> None:
    mesh = pipe()
    code, message = refused(helix(), Mesh(mesh.vertices * factor, mesh.faces))
    assert code == "curve-off-mesh" and said in message


def test_a_curve_that_leaves_the_mesh_is_refused() -> None:
    arc: Table = {"arc": {"center": [0, 0, 50], "radius": 100, "start": -30, "end": 60}}
    code, message = refused(arc, pipe())
    assert code == "curve-leaves-mesh" and "beyond it" in message


def test_a_curve_that_leaves_the_mesh_by_little_is_refused() -> None:
    """The mesh begins at -0.2 rad, 11.46 deg; a curve from -13.4 deg lies 3.38 mm beyond it."""
    arc: Table = {"arc": {"center": [0, 0, 50], "radius": 100, "start": -13.4, "end": 60}}
    code, message = refused(arc, pipe())
    assert code == "curve-leaves-mesh" and "3.3" in message


def test_a_curve_along_the_edge_of_the_mesh_is_on_it() -> None:
    arc: Table = {"arc": {"center": [0, 0, -10], "radius": 100, "start": 0, "end": 90}}
    found = surface(arc, pipe(), widths=[5, 5])
    assert_relative(area(found.patches), 10.0 * pi / 2.0 * 100.0, bound=1e-6, why="a pipe")


def test_a_mesh_too_coarse_to_have_normals_is_refused() -> None:
    code, _ = refused(helix(), pipe(columns=7, rows=4))
    assert code == "mesh-normals"


def test_a_crease_is_refused() -> None:
    """Two planes that meet at a right angle under the curve."""
    v, u, faces = jittered(6, 60, 30)
    x, y = 200.0 * (v - 0.5), 100.0 * u
    roof = Mesh(np.column_stack([x, y, -np.abs(x)]), faces)
    line: Table = {"bezier": [[-60, 20, -60], [-20, 40, -20], [20, 40, -20], [60, 20, -60]]}
    assert refused(line, roof)[0] in {"mesh-normals", "curve-off-mesh"}


def test_a_curve_that_cuts_through_the_mesh_is_refused() -> None:
    """A wave of 0.9 mm about a pipe, within the distance allowed, leans by 6 deg."""
    t = np.linspace(0.0, 1.0, 41)
    around, radius = 1.2 * t, 100.0 + 0.9 * np.sin(8.0 * pi * t)
    points = np.column_stack([radius * np.cos(around), radius * np.sin(around), 20.0 + 60.0 * t])
    code, message = refused({"points": [[repr(float(x)) for x in row] for row in points]}, pipe())
    assert code == "normals-not-perpendicular" and "runs into the mesh" in message


def test_a_moebius_strip_has_no_normals() -> None:
    turn = np.linspace(0.0, 2.0 * pi, 41)[:-1]
    points = [[(50.0 + s * np.cos(a / 2.0)) * np.cos(a), (50.0 + s * np.cos(a / 2.0)) * np.sin(a), s * np.sin(a / 2.0)]
              for a in turn for s in (-10.0, 10.0)]  # fmt: skip
    faces = []
    for i in range(40):
        a, b, c, d = 2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 3
        if i == 39:
            c, d = 1, 0
        faces += [[a, c, b], [b, c, d]]
    strip = Mesh(np.array(points), np.array(faces))
    assert refused({"circle": {"center": [0, 0, 0], "radius": 50}}, strip)[0] == "mesh-one-sided"


def test_a_curve_beside_the_mesh_is_told_and_made() -> None:
    made = outcome(helix(radius=100.3), pipe())
    assert made.product is not None
    (finding,) = made.report.findings
    assert finding.code == "curve-beside-mesh" and not finding.fatal
    assert_near(float(made.report.metric("mesh_distance_mm").value or 0.0), 0.3, bound=1e-5, why="radii")


# The job file


def test_the_rules_of_lists_do_not_hold_for_meshes() -> None:
    assert troubles({"kind": "ribbon", "curve": helix(), "normals": FILE, "width": 3}) == []
    assert troubles({"kind": "ribbon", "curve": helix(), "normals": FILE}) != []


def test_a_ribbon_in_a_strip_takes_its_own_mesh() -> None:
    piece = {"kind": "ribbon", "curve": helix(), "normals": FILE, "width": 30}
    made = construct(Part(read({"kind": "strip", "pieces": [piece]}), meshes={KEY: pipe()}), Tolerances())
    assert isinstance(made.product, RuledSurface)


def test_places_where_it_is_measured_are_told() -> None:
    report = outcome(helix(), pipe()).report
    assert {"t", "x", "y", "z"} <= set(report.metric("normal_change_deg").where or {})
    assert report.metric("mesh_distance_mm").limit == pytest.approx(0.01 * hypot(100.0, 100.0, 100.0), rel=1e-2)
