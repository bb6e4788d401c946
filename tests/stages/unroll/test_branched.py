"""Blanks that bend in several directions, flat: closed forms, a second way to lay them out, and planted faults."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from math import pi, sin
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from msgspec.structs import replace as with_fields
from OCP.TopoDS import TopoDS_Shape
from scipy.integrate import quad

from stages.construct.faces.surface import face_blanks, face_surface
from stages.geometry.arrays import Array, norm, unit
from stages.geometry.curves.contours import area
from stages.model.cadface import CadBody
from stages.model.kfactor import KFactor
from stages.model.material import Material, Part
from stages.model.pattern import FlatPattern
from stages.model.report import StageReport
from stages.model.surface import BranchedSurface, Certificate
from stages.model.tolerances import Tolerances
from stages.unroll import unroll
from stages.verify import verify
from tests import cad, cadmeasured, cadshells
from tests.near import assert_near, assert_relative

TOL = Tolerances()


@cache
def blank(make: Callable[[], list[TopoDS_Shape]]) -> tuple[Part, float]:
    """Return a shell as one blank, and its area as OpenCASCADE measures it."""
    shape = cadshells.sewn(make())
    with TemporaryDirectory() as folder:
        (one,) = face_blanks(cad.part(*cad.read(cad.step(Path(folder) / "a.step", shape)).faces))
    return one, cadmeasured.area(shape)


def surface(part: Part) -> BranchedSurface:
    made = face_surface(part, TOL).product
    assert isinstance(made, BranchedSurface)
    return made


def flat(part: Part) -> tuple[FlatPattern, StageReport]:
    """Return the pattern of a blank, and what unroll says."""
    checked = verify(surface(part), TOL)
    assert checked.product is not None, checked.report.findings
    made = unroll(checked.product, TOL)
    assert made.product is not None, made.report.findings
    return made.product, made.report


@cache
def unrolled(make: Callable[[], list[TopoDS_Shape]]) -> tuple[FlatPattern, StageReport]:
    """Return the pattern of a shell as it is, made once."""
    return flat(blank(make)[0])


def figure(report: StageReport, side: str, name: str) -> float:
    rows = report.detail[side]
    assert isinstance(rows, dict)
    return float(rows[name])


SHELLS = [cadshells.tray, cadshells.conical_bend, cadshells.square_to_round, cadshells.frame, cadshells.window]


@pytest.mark.parametrize("make", SHELLS)
def test_the_pattern_has_the_area_that_opencascade_measures(make: Callable[[], list[TopoDS_Shape]]) -> None:
    theirs = blank(make)[1]
    pattern, report = unrolled(make)
    ours = [figure(report, "surface", "area"), figure(report, "flat", "area")]
    assert_relative(ours, [theirs] * 2, bound=1e-9, why="digits of the file")
    enclosed = sum(area(one.edges) for one in (pattern.outer, *pattern.inner))
    assert_relative(enclosed, ours[1], bound=1e-9, why="the contour is all of the faces")
    assert float(report.metric("flat_gap_mm").value or 0.0) <= 1e-9 * np.sqrt(theirs)
    assert report.metric("overlap_mm2").value == 0.0


def test_a_tray_is_a_cross_of_its_bottom_bends_and_flanges() -> None:
    pattern, report = unrolled(cadshells.tray)
    wing = 4 * pi / 2 + 25
    sides = sorted(figure(report, "flat", name) for name in ("width", "height"))
    assert_near(sides, [80 + 2 * wing, 120 + 2 * wing], bound=1e-9, why="closed form")
    around = 2 * (120 + 80) + 8 * wing
    assert_near(figure(report, "flat", "outline_length"), around, bound=1e-9, why="closed form")
    (hole,) = pattern.inner
    assert_near(area(hole.edges), -pi * 100, bound=1e-9, why="a circle, clockwise")
    marks = {mark.layer for mark in pattern.marks}
    lengths = sorted(float(norm(mark.path.vertices[1] - mark.path.vertices[0])) for mark in pattern.marks)
    assert marks == {"BEND_UP"}
    assert_near(lengths, [80.0] * 4 + [120.0] * 4, bound=1e-9, why="both edges of each bend")


def test_bends_have_an_allowance_by_their_own_neutral_radius() -> None:
    part, _ = blank(cadshells.window)
    metal = Material(thickness_mm=2.0, k_factor=KFactor(0.4, given=True))
    _, report = flat(Part(with_fields(part.spec, face="inner"), metal, body=part.body))
    flange = 40 * ((3 + 0.4 * 2.0) * pi / 2 + 20)
    expected = 120.0**2 - 60 * (40 + 60) / 2 + flange
    assert_near(figure(report, "flat", "area"), expected, bound=1e-8, why="bend allowance theta (r + K t)")
    assert report.metric("k_factor").value == 0.4


def test_a_conical_bend_is_a_sector_between_two_planes() -> None:
    pattern, report = unrolled(cadshells.conical_bend)
    assert [mark.layer for mark in pattern.marks] == ["BEND_DOWN"] * 2
    rows = report.detail["flat_faces"]
    assert isinstance(rows, list)
    near, far, half, turn, flange = 60.0, 160.0, pi / 6, 1.2, 40.0
    sector = turn * sin(half) * (far**2 - near**2) / 2
    plane = (flange + flange / 2) / 2 * (far - near)
    found = {row["face"]: row["flat_area"] for row in rows}
    assert_relative([found[i] for i in range(3)], [sector, plane, plane], bound=1e-9, why="closed form")
    angle = np.degrees(turn * np.cos(half))
    assert_near(rows[0]["angle_deg"], -angle, bound=1e-9, why="the normal turns by the cosine of the half angle")


def corner(apex: Array, start: float, radius: float, height: float) -> float:
    """Return the angle at the apex of the oblique cone over a quarter of the circle, by its directions."""

    def rate(a: float, step: float = 1e-5) -> float:
        ways = [np.array([radius * np.cos(x), radius * np.sin(x), height]) - apex for x in (a - step, a + step)]
        return float(norm(unit(ways[1]) - unit(ways[0]))) / (2 * step)

    return float(quad(rate, start, start + pi / 2, epsabs=1e-12)[0])


def test_a_square_to_a_circle_is_a_fan_of_triangles_and_sectors() -> None:
    """Corners of the pattern, apart as in a fan laid out by hand: lengths in space and angles at each corner."""
    pattern, _ = unrolled(cadshells.square_to_round)
    apex = np.array([50.0, 50.0, 0.0])
    edge = float(np.sqrt(20.0**2 + 50.0**2 + 80.0**2))
    opening = corner(apex, 0.0, 30.0, 80.0)
    base = 2 * np.arcsin(50.0 / edge)
    foot = (pi - base) / 2
    # from the middle of the run of triangles: the feet turn by what is at each of them
    feet, way = [np.zeros(2)], 0.0
    for _ in range(4):
        feet.append(feet[-1] + 100.0 * np.array([np.cos(way), np.sin(way)]))
        way += pi - (2 * foot + opening)
    gaps = {round(float(norm(feet[i] - feet[j])), 4) for i in range(5) for j in range(i) if i - j < 4}
    ends = np.array([edge_.at(np.zeros(1))[0] for edge_ in pattern.outer.edges])
    apart = norm(ends[:, None] - ends[None])
    for gap in gaps:
        assert float(np.abs(apart - gap).min()) <= 1e-3, f"no two corners are {gap} mm apart"


def test_a_flange_in_a_window_takes_its_room_from_the_hole() -> None:
    pattern, report = unrolled(cadshells.window)
    (hole,) = pattern.inner
    flange, cut = 40 * (3 * pi / 2 + 20), 60 * (40 + 60) / 2
    assert_near(area(hole.edges), -(cut - flange), bound=1e-8, why="closed form")
    assert_near(area(pattern.outer.edges), 120.0**2, bound=1e-8, why="closed form")
    rows = figure(report, "flat", "area")
    assert_near(rows, 120.0**2 - cut + flange, bound=1e-8, why="closed form")


def test_a_ring_that_closes_flat_has_a_hole() -> None:
    pattern, _ = unrolled(cadshells.frame)
    (hole,) = pattern.inner
    assert len(pattern.outer.edges) == 4
    assert_near(area(hole.edges), -1600.0, bound=1e-9, why="a square")
    assert pattern.marks == ()


def test_a_shell_is_flat_alike_wherever_it_stands() -> None:
    def spun() -> list[TopoDS_Shape]:
        return [cad.turned(face, (1, 2, 3), 0.7, (300, -50, 20)) for face in cadshells.conical_bend()]

    (one, _), (other, _) = blank(cadshells.conical_bend), blank(spun)
    rows = [
        [figure(flat(part)[1], "flat", name) for name in ("area", "outline_length", "width")] for part in (one, other)
    ]
    assert_relative(rows[1], rows[0], bound=1e-9, why="digits of the file")


# Planted faults


def test_faces_that_cover_each_other_in_the_flat_are_refused() -> None:
    """The check before construct taken out: wings that reach over each other are joined all the same."""
    with TemporaryDirectory() as folder:
        shape = cadshells.sewn(cadshells.tray(wing=20.0, sides=2))
        body = cad.read(cad.step(Path(folder) / "a.step", shape))
    plain = blank(lambda: cadshells.tray(sides=2))[0].body
    assert isinstance(plain, CadBody)
    order = [face.index for face in plain.faces]
    part = cad.part(*body.faces)
    joined = replace(part, body=CadBody(tuple(body.faces[i] for i in order), None, plain.joints))
    checked = verify(surface(joined), TOL)
    assert checked.product is not None
    made = unroll(checked.product, TOL)
    assert made.product is None
    assert "flat-overlap" in [finding.code for finding in made.report.findings]
    doubled = (20 - 2 * pi) ** 2
    assert_near(float(made.report.metric("overlap_mm2").value or 0.0), doubled, bound=1e-6 * doubled, why="a square")


def test_flat_faces_that_miss_each_other_are_refused() -> None:
    def longer() -> list[TopoDS_Shape]:
        return cadshells.conical_bend(slant=100.1)

    good, wrong = surface(blank(cadshells.conical_bend)[0]), surface(blank(longer)[0])
    made = unroll(Certificate(replace(good, faces=(*good.faces[:2], wrong.faces[2])), "exact", proved=True), TOL)
    assert made.product is None
    assert [finding.code for finding in made.report.findings] == ["flat-gap"]
    assert_near(float(made.report.metric("flat_gap_mm").value or 0.0), 0.05, bound=1e-9, why="half on either side")


def test_a_flange_as_wide_as_its_window_would_be_cut_twice_along_its_sides() -> None:
    def tight() -> list[TopoDS_Shape]:
        return cadshells.window(splay=0.0)

    checked = verify(surface(blank(tight)[0]), TOL)
    assert checked.product is not None
    made = unroll(checked.product, TOL)
    assert made.product is None
    (finding,) = made.report.findings
    assert finding.code == "cut-twice"
    assert f"{2 * (3 * pi / 2 + 20):.4g} mm" in finding.message
