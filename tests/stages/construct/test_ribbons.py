"""Ribbons on cylinders, cones and spheres, where the band is known; and what no ribbon can do."""

from math import atan2, cos, hypot, pi, radians, sin, sqrt

import numpy as np
import pytest

from stages.construct.curves import chain
from stages.construct.ribbons import normal_chain, ribbon
from stages.geometry.arrays import cross3, dot, norm, unit
from stages.geometry.ruled.ruled import at, end_normals, frames, warp
from stages.model.envelopes import Ribbon
from stages.model.tolerances import Tolerances
from tests.near import assert_near, assert_relative
from tests.parts import Table, passage, patches, read, troubles

V = np.linspace(0.0, 1.0, 9)


def on_a_pipe(count: int, *, size: float = 1.0, sweep: float = 90.0, **widths: object) -> Table:
    """Return a band along a helix of radius 100 that rises by 120 per 90 deg."""
    angles = np.radians(np.linspace(0.0, sweep, count)).tolist()
    points = [[repr(size * 100.0 * cos(a)), repr(size * 100.0 * sin(a)), repr(size * 120.0 * a / (pi / 2.0))]
              for a in angles]  # fmt: skip
    normals = [[repr(cos(a)), repr(sin(a)), 0] for a in angles]
    return {"kind": "ribbon", "curve": {"points": points}, "normals": normals} | (widths or {"width": 30 * size})


def circle(radius: float, normals: list[list[object]], **widths: object) -> Table:
    """Return a band along a quarter of a circle in z = 0."""
    arc = {"arc": {"center": [0, 0, 0], "radius": radius, "start": 0, "end": 90}}
    return {"kind": "ribbon", "curve": arc, "normals": normals} | widths


def leaning(degrees: float, count: int = 9) -> list[list[object]]:
    """Return normals along the quarter of a circle, outwards, leaning up by an angle: those of a sphere or a cone."""
    rise = radians(degrees)
    angles = np.linspace(0.0, pi / 2.0, count).tolist()
    return [[repr(cos(rise) * cos(a)), repr(cos(rise) * sin(a)), repr(sin(rise))] for a in angles]


def area(table: Table) -> float:
    """Return the area of the surface, mm2, both normals of a ruling along one direction."""
    nodes, weights = np.polynomial.legendre.leggauss(20)
    found = [end_normals(frames(patch, (nodes + 1.0) / 2.0)) for patch in patches(table)]
    return sum(float(weights @ (norm(n0) + norm(n1))) / 4.0 for n0, n1 in found)


def developable(table: Table) -> float:
    """Return the largest warp, rad."""
    return max(float(warp(patch, V).max()) for patch in patches(table))


# Known bands


def test_normals_of_a_pipe_give_a_band_of_the_pipe_to_fourth_order() -> None:
    """Width times length in the flat; the spline through twice the points is sixteen times nearer."""
    wanted = 30.0 * hypot(50.0 * pi, 120.0)
    errors = [abs(area(on_a_pipe(count)) / wanted - 1.0) for count in (5, 9, 17)]
    assert errors[0] < 1e-2
    assert errors[0] / errors[1] > 8.0 and errors[1] / errors[2] > 8.0


def test_rulings_of_a_band_of_a_pipe_run_along_the_pipe() -> None:
    for patch in patches(on_a_pipe(17)):
        assert_near(np.abs(unit(patch.p.jet(V, 0)[0])[:, 2]), np.ones(V.size), bound=1e-3, why="within 2.6 deg of z")


def test_the_band_touches_the_normals_that_were_given() -> None:
    table = on_a_pipe(9)
    normals = np.array([[float(str(x)) for x in row] for row in table["normals"]])  # type: ignore[union-attr]
    for i, patch in enumerate(patches(table)):
        n0, n1 = end_normals(frames(patch, np.array([0.0, 1.0])))
        for normal, given in zip(unit(n0 + n1), normals[i : i + 2], strict=True):
            assert dot(normal, given) > cos(radians(0.2)), "the side of p x c0' is that of the normals"


@pytest.mark.parametrize("degrees", [20.0, 45.0, 70.0])
def test_the_cone_that_touches_a_sphere_along_a_circle(degrees: float) -> None:
    """Normals of one lean along a circle: a frustum, its apex at radius / tan(lean) along the ruling."""
    table = circle(50.0, leaning(degrees), widths=[6, 9])
    wanted = pi / 2.0 * 15.0 * (50.0 + (9.0 - 6.0) / 2.0 * sin(radians(degrees)))
    assert_relative(area(table), wanted, bound=1e-3, why="mean radius times slant; splines 11 deg apart")
    assert developable(table) < 1e-12


def test_left_is_left_of_travel_with_the_normals_up() -> None:
    """Counter-clockwise around the z axis, normals outwards: up is to the left."""
    (first, *_) = patches(circle(50.0, leaning(0.0), widths=[6, 9]))
    f = frames(first, V)
    assert_near(f.c0[:, 2], np.full(V.size, 6.0), bound=1e-12, why="c0 is the left edge")
    assert_near(f.c0[:, 2] + f.p[:, 2], np.full(V.size, -9.0), bound=1e-12, why="c1 the right one")
    turned = [[repr(-float(str(x))) for x in row] for row in leaning(0.0)]
    (other, *_) = patches(circle(50.0, turned, widths=[6, 9]))
    assert_near(frames(other, V).c0[:, 2], np.full(V.size, -6.0), bound=1e-12, why="turned over, left is down")


def test_half_the_width_lies_on_either_side() -> None:
    assert area(on_a_pipe(5, width=30)) == area(on_a_pipe(5, widths=[15, 15]))


@pytest.mark.parametrize("size", [0.01, 60.0])
def test_bands_of_all_sizes_are_alike(size: float) -> None:
    ratio = area(on_a_pipe(5, size=size)) / area(on_a_pipe(5))
    assert_relative(ratio, size**2, bound=1e-11, why="decimals of the job rounded once, the spline's slopes")


def test_a_band_run_backwards_is_the_same_band() -> None:
    table = on_a_pipe(9, widths=[10, 25])
    curve = table["curve"]
    assert isinstance(curve, dict) and isinstance(table["normals"], list)
    back = table | {"curve": {"points": curve["points"][::-1]}, "normals": table["normals"][::-1], "widths": [25, 10]}
    assert_relative(area(back), area(table), bound=1e-12, why="the same surface")


def test_every_band_is_developable_whatever_the_normals() -> None:
    """Normals a little off any surface, of unlike lengths: still the envelope of a family of planes."""
    rng = np.random.default_rng(5)
    table = on_a_pipe(9, width=4)
    rows = [[float(str(x)) for x in row] for row in table["normals"]]  # type: ignore[union-attr]
    angles = np.radians(np.linspace(0.0, 90.0, 9))
    tangents = unit(np.stack([-100.0 * np.sin(angles), 100.0 * np.cos(angles), np.full(9, 240.0 / pi)], axis=1))
    moved = np.array(rows) + 0.01 * rng.normal(size=(9, 1)) * cross3(np.array(rows), tangents)
    table["normals"] = [[repr(float(x)) for x in row] for row in moved * rng.uniform(0.5, 3.0, (9, 1))]
    assert developable(table) < 1e-11


def test_a_band_passes_all_stages() -> None:
    made = passage(on_a_pipe(5))
    assert made.refused_by is None
    assert made.value("verify", "max_warp_deg") < 1e-9
    assert made.value("construct", "join_gap_mm") < 1e-11
    assert_relative(made.side("flat")["area"], area(on_a_pipe(5)), bound=1e-12, why="two quadratures")


def test_a_closed_band_closes() -> None:
    table = {"kind": "ribbon", "curve": {"circle": {"center": [0, 0, 0], "radius": 50}}, "width": 10}
    angles = np.linspace(0.0, 2.0 * pi, 13).tolist()
    normals = [[repr(cos(a)), repr(sin(a)), 1] for a in angles[:-1]]
    found = patches(table | {"normals": [*normals, normals[0]]})
    ends = [at(patch, np.array([0.0, 1.0]), np.full(2, v)) for patch, v in ((found[0], 0.0), (found[-1], 1.0))]
    assert_near(ends[0], ends[1], bound=1e-12, why="a periodic spline")


# Normals of curves that have no points


def test_normals_of_a_smooth_curve_stand_at_equal_steps() -> None:
    spec = read(circle(50.0, leaning(30.0, 5), width=3)).surface
    assert isinstance(spec, Ribbon)
    made = normal_chain(spec, chain(spec.curve), Tolerances())
    assert [float(b) for b in made.breaks] == [0.0, 0.25, 0.5, 0.75, 1.0]
    for i, curve in enumerate(made.curves):
        a = pi / 8.0 * i
        wanted = [sqrt(0.75) * cos(a), sqrt(0.75) * sin(a), 0.5]
        assert_near(curve.jet(np.zeros(1), 0)[0, 0], wanted, bound=1e-15, why="a unit vector as given")


# Refusals


def test_normals_that_lean_along_the_curve_are_refused_with_the_worst() -> None:
    table = on_a_pipe(9)
    rows = table["normals"]
    assert isinstance(rows, list)
    rows[3] = [repr(float(str(rows[3][0])) * 0.9), rows[3][1], 0]
    angle = radians(33.75)
    n = np.array([0.9 * cos(angle), sin(angle), 0.0])
    t = np.array([-100.0 * sin(angle), 100.0 * cos(angle), 240.0 / pi])
    off = 90.0 - np.degrees(atan2(norm(np.cross(n, t)), float(n @ t)))
    made = passage(table)
    assert made.codes("construct", fatal=True) == ["normals-not-perpendicular"]
    metric = made.metric("construct", "normal_lean_deg")
    assert_near(metric.value, off, bound=0.02, why="the tangent of a spline through points 11 deg apart")
    assert metric.where == {"normal": 3, "v": 3} and not metric.passed
    assert "normals[3]" in made.reports["construct"].findings[0].message


def test_a_band_past_its_edge_of_regression_is_refused_with_the_largest_width() -> None:
    """The apex of the cone: radius / sin(lean) up the ruling."""
    made = passage(circle(50.0, leaning(45.0), widths=[80, 5]))
    assert made.codes("construct", fatal=True) == ["ribbon-too-wide"]
    assert "the width on the left 80 mm" in made.reports["construct"].findings[0].message
    limit = made.metric("construct", "width_left_max_mm").value
    assert limit is not None
    assert_relative(limit, 50.0 * sqrt(2.0), bound=0.05, why="second derivatives of the spline: 11 deg squared")
    for factor, bad in ((0.999, False), (1.001, True)):
        assert ("ribbon-too-wide" in wide(repr(float(limit) * factor))) == bad


def wide(left: str) -> list[str]:
    """Return what is wrong with the cone of 45 deg at that width."""
    spec = read(circle(50.0, leaning(45.0), widths=[left, 5])).surface
    assert isinstance(spec, Ribbon)
    return [finding.code for finding in ribbon(spec, chain(spec.curve), Tolerances()).findings]


def test_a_flat_band_has_no_rulings() -> None:
    made = passage(circle(50.0, [[0, 0, 1]] * 5, width=3))
    assert made.codes("construct", fatal=True) == ["ribbon-flat"]


def test_a_normal_that_turns_about_the_curve_is_refused_with_its_place() -> None:
    """A straight line on a twisted surface; and a helicoid's curve, flat across itself half-way."""
    line = {"line": [[0, 0, 0], [0, 0, 50]]}
    normals = [[repr(cos(a)), repr(sin(a)), 0] for a in (0.0, 0.25, 0.5, 0.75, 1.0)]
    made = passage({"kind": "ribbon", "curve": line, "normals": normals, "width": 3})
    assert made.codes("construct", fatal=True) == ["ribbon-ruling-along-curve"]
    over = [[repr(sin(a)), 0, repr(cos(a))] for a in np.linspace(-0.5, 0.5, 9).tolist()]
    arc = {"bezier": [[0, -10, 0], [0, 0, 4], [0, 10, 0], [0, 20, 4]]}
    half_way = passage({"kind": "ribbon", "curve": arc, "normals": _binormals(over), "width": 1})
    (finding,) = [f for f in half_way.reports["construct"].findings if f.fatal]
    assert finding.code == "ribbon-ruling-along-curve"
    assert finding.where is not None and finding.where["v"] == pytest.approx(4.0, abs=1e-6)


def _binormals(rows: list[list[object]]) -> list[list[object]]:
    """Return the normals of the S-curve in x = 0, turned about it: across it, from -0.5 to 0.5 rad out of its plane."""
    made = []
    for v, (s, _, c) in zip(np.linspace(0.0, 1.0, len(rows)), rows, strict=True):
        points = np.array([[0.0, -10.0, 0.0], [0.0, 0.0, 4.0], [0.0, 10.0, 0.0], [0.0, 20.0, 4.0]])
        d = 3.0 * np.diff(points, axis=0)
        t = (1.0 - v) ** 2 * d[0] + 2.0 * v * (1.0 - v) * d[1] + v**2 * d[2]
        up = np.array([0.0, -t[2], t[1]]) / hypot(t[1], t[2])
        made.append([repr(float(x)) for x in float(str(c)) * up + float(str(s)) * np.array([1.0, 0.0, 0.0])])
    return made


def test_normals_too_far_apart_say_nothing() -> None:
    made = passage(circle(50.0, [[1, 0, 0], [0, "-0.7071", "0.7071"], [0, 1, 0]], width=3))
    assert made.codes("construct", fatal=True)[0] in ("normals-not-perpendicular", "normals-too-far-apart")
    over = circle(50.0, [[0, 0, 1], [0, 0, -1], [0, 0, 1]], width=3)
    assert passage(over).codes("construct", fatal=True) == ["normals-too-far-apart"]


def test_a_curve_that_stops_has_no_ribbon() -> None:
    curve = {"bezier": [[0, 0, 0], [0, 0, 0], [1, 1, 0], [2, 1, 1]]}
    made = passage({"kind": "ribbon", "curve": curve, "normals": [[0, 0, 1], [1, 0, 1]], "width": 1})
    assert made.codes("construct", fatal=True) == ["curve-stops"]


def test_what_the_job_file_alone_shows() -> None:
    good = on_a_pipe(5)
    assert isinstance(good["normals"], list)
    assert troubles(good) == []
    assert troubles(good | {"normals": good["normals"][:4]}) == ["4 normals for 5 points"]
    assert troubles(good | {"normals": [[0, 0, 0], *good["normals"][1:]]}) == ["the vector has length 0"]
    assert troubles(good | {"widths": [1, 2]}) == ["exactly one of width and widths"]
    assert troubles(good | {"width": 0}) == ["0"]
    for bad in ([-1, 2], [0, 0]):
        table = {key: value for key, value in good.items() if key != "width"} | {"widths": bad}
        assert troubles(table) == ["a negative width, or none at all"]
