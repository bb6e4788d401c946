"""Holes, marks and notches of the job on blanks that bend in several directions: closed forms and planted faults."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache
from math import cos, pi, sin, sqrt
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from msgspec.structs import replace as with_fields
from OCP.TopoDS import TopoDS_Shape

from stages.construct.faces.based import Based, based
from stages.construct.faces.features import on_faces
from stages.construct.faces.surface import face_blanks, face_surface
from stages.construct.features import Placement
from stages.geometry.arrays import Points2, norm
from stages.geometry.curves import contours
from stages.model.cadface import CadBody
from stages.model.curves import CurveSpec
from stages.model.features import CircleHole, CurveHole, CurveMark, DrilledHole, Feature, NotchSpec, PointMark, TextMark
from stages.model.kfactor import KFactor
from stages.model.material import Material, Part
from stages.model.part import PartSpec
from stages.model.pattern import FlatPattern
from stages.model.report import Outcome
from stages.model.scalars import Coordinate, Length, coordinate
from stages.model.surface import BranchedSurface, Certificate
from stages.model.tolerances import Tolerances
from stages.unroll import unroll
from stages.verify import verify
from tests import cad, cadshells
from tests.near import assert_near

TOL = Tolerances()
WIDE, DEEP, RADIUS, HIGH = 120.0, 80.0, 4.0, 25.0
BEND = RADIUS * pi / 2.0
ROUND_OFF = 1e-9
"""mm; digits of the file, at some 200 mm."""


@cache
def shell(name: str) -> Part:
    """Return a shell as one blank, read once."""
    makers: dict[str, Callable[[], list[TopoDS_Shape]]] = {
        "tray": cadshells.tray,
        "square": cadshells.square_to_round,
        "window": cadshells.window,
    }
    faces = makers[name]()
    with TemporaryDirectory() as folder:
        body = cad.read(cad.step(Path(folder) / "a.step", cadshells.sewn(faces)))
    (one,) = face_blanks(cad.part(*body.faces))
    return one


def space(*xyz: float) -> tuple[Coordinate, ...]:
    return tuple(coordinate(Fraction(float(x)), None) for x in xyz)


def mm(value: float) -> Length:
    return Length(Fraction(value))


@cache
def sides(name: str) -> tuple[Based, ...]:
    """Return the faces of a shell on their strips."""
    body = shell(name).body
    assert isinstance(body, CadBody)
    first, made = 0, []
    for face in body.faces:
        side = based(face, first)
        assert side is not None
        first += len(side.patches)
        made.append(side)
    return tuple(made)


@cache
def bare(name: str) -> BranchedSurface:
    """Return the surface of a shell without features."""
    made = face_surface(shell(name), TOL).product
    assert isinstance(made, BranchedSurface)
    return made


def spec_of(name: str, *features: Feature) -> PartSpec:
    """Return the job's description of a part with features."""
    holes = tuple(one for one in features if isinstance(one, CircleHole | DrilledHole | CurveHole))
    marks = tuple(one for one in features if isinstance(one, PointMark | TextMark | CurveMark))
    notches = tuple(one for one in features if isinstance(one, NotchSpec))
    return with_fields(shell(name).spec, hole=holes, mark=marks, notch=notches)


def placed(name: str, *features: Feature) -> Placement:
    return on_faces(spec_of(name, *features), sides(name), TOL)


def unrolled(name: str, *features: Feature) -> Outcome[FlatPattern | None]:
    """Return the pattern of a shell with features; of these verify looks at none."""
    found = placed(name, *features)
    assert not [one for one in found.findings if one.fatal], found.findings
    surface = replace(bare(name), features=found.features)
    return unroll(Certificate(surface, "exact", proved=True), TOL)


def pattern(made: Outcome[FlatPattern | None]) -> FlatPattern:
    assert made.product is not None, made.report.findings
    return made.product


def refused(*features: Feature) -> tuple[str, str]:
    """Return code and message of what is refused on the tray."""
    (finding,) = [one for one in placed("tray", *features).findings if one.fatal]
    return finding.code, finding.message


def rows(made: Outcome[FlatPattern | None], key: str) -> dict[str, Points2]:
    """Return the places of marks, or the centroids of holes, in the flat, by name."""
    flat = made.report.detail["flat"]
    assert isinstance(flat, dict)
    return {row["name"]: np.array([row["x"], row["y"]]) for row in flat[key]}


CORNERS = {"origin": (20.0, 10.0), "x": (100.0, 10.0), "y": (20.0, 70.0)}
FRAME = [PointMark(name=name, at=space(x, y, 0.0)) for name, (x, y) in CORNERS.items()]
"""Three marks on the bottom of the tray, from which the flat is measured in the coordinates of the bottom."""


def in_bottom(made: Outcome[FlatPattern | None], key: str = "marks") -> dict[str, Points2]:
    """Return flat places in the coordinates of the bottom."""
    frame, found = rows(made, "marks"), rows(made, key)
    x, y = ((frame[way] - frame["origin"]) / length for way, length in (("x", 80.0), ("y", 60.0)))
    start = np.array(CORNERS["origin"])
    return {
        name: start + np.array([(at - frame["origin"]) @ x, (at - frame["origin"]) @ y]) for name, at in found.items()
    }


def folded(x: float, s: float, radius: float = RADIUS) -> tuple[float, float, float]:
    """Return the point of the tray at x, and s beyond the front edge of its bottom as it lies flat."""
    if s <= BEND:
        return x, -RADIUS * sin(s / RADIUS), RADIUS * (1.0 - cos(s / RADIUS))
    return x, -RADIUS, RADIUS + s - BEND


def loop(low: float, high: float) -> list[tuple[float, float, float]]:
    """Return a band about the tray between two x, from 10 mm inside the bottom to 10 mm up the front flange."""
    run = [-10.0, 0.0, BEND / 3.0, 2.0 * BEND / 3.0, BEND, BEND + 10.0]
    there = [(low, -s, 0.0) if s < 0.0 else folded(low, s) for s in run]
    back = [(high, y, z) for _, y, z in there[::-1]]
    return [*there, *back, there[0]]


def polyline(points: Sequence[Sequence[float]]) -> CurveSpec:
    return CurveSpec(polyline=tuple(space(*row) for row in points))


# What is drawn on the tray and cut into it, all at once, and where it must lie in the coordinates of the bottom

UP = BEND + 10.0
MARKS = {
    "front": ((85.0, -RADIUS, RADIUS + 10.0), (85.0, -UP)),
    "back": ((50.0, DEEP + RADIUS, RADIUS + 10.0), (50.0, DEEP + UP)),
    "left": ((-RADIUS, 30.0, RADIUS + 10.0), (-UP, 30.0)),
    "right": ((WIDE + RADIUS, 30.0, RADIUS + 10.0), (WIDE + UP, 30.0)),
    "bend": (folded(90.0, 0.3 * BEND), (90.0, -0.3 * BEND)),
    "edge": ((80.0, 0.0, 0.0), (80.0, 0.0)),
}
CIRCLES = {"flange": (10.0, UP, 5.0), "bend": (30.0, BEND / 2.0, 5.0), "edge": (110.0, 0.0, 5.0)}
"""x, how far beyond the front edge of the bottom, and radius."""


@cache
def tray() -> Outcome[FlatPattern | None]:
    """Return the tray with everything on it, unrolled once."""
    at = folded(35.0, BEND + 12.0)
    return unrolled(
        "tray",
        *FRAME,
        *(PointMark(name=name, at=space(*at)) for name, (at, _) in MARKS.items()),
        *(CircleHole(name=n, at=space(*folded(x, s)), diameter=mm(2.0 * r)) for n, (x, s, r) in CIRCLES.items()),
        CircleHole(name="moved", at=space(80.0, 40.0, 0.0), diameter=mm(20.0)),
        DrilledHole(name="drilled", at=space(*at), diameter=mm(10.0)),
        CurveHole(name="slot", curve=polyline(loop(50.0, 70.0))),
        CurveMark(name="line", curve=polyline(loop(95.0, 96.0)[:6])),
        TextMark(name="number", at=space(70.0, DEEP + RADIUS, RADIUS + 10.0), text="A1", height=mm(5.0)),
        NotchSpec(edge="outline", distance=mm(16.0), width=mm(4.0), depth=mm(3.0)),
    )


def hole(name: str) -> float:
    """Return the area of a hole of the tray, negative if it runs clockwise."""
    return contours.area(next(one for one in pattern(tray()).inner if one.name == name).edges)


# Places


@pytest.mark.parametrize("name", MARKS)
def test_a_place_on_a_flange_or_bend_of_a_tray_lies_beside_its_bottom(name: str) -> None:
    assert_near(in_bottom(tray())[name], MARKS[name][1], bound=ROUND_OFF, why="closed form")


def test_a_place_beside_the_surface_is_taken_to_the_nearest_face_and_told() -> None:
    at = space(85.0, -RADIUS, RADIUS + 10.0), space(85.0, -RADIUS + 1.5, RADIUS + 10.0)
    found = placed("tray", *(PointMark(at=one) for one in at))
    on, off = found.features
    assert [one.code for one in found.findings] == ["off-surface"]
    assert on.at is not None
    assert off.at is not None
    assert_near(float(off.distance_mm or 0.0), 1.5, bound=ROUND_OFF, why="as given")
    assert_near(off.at, on.at, bound=ROUND_OFF, why="along the normal")


def test_a_blank_with_features_is_constructed_and_verified_like_any_other_and_its_flange_is_an_allowance_away() -> None:
    metal = Material(thickness_mm=2.0, k_factor=KFactor(0.4, given=True))
    spec = spec_of("tray", *FRAME, PointMark(name="front", at=space(50.0, -RADIUS, RADIUS + 10.0)))
    made = face_surface(Part(with_fields(spec, face="inner"), metal, body=shell("tray").body), TOL)
    assert made.product is not None
    assert made.report.metric("feature_distance_mm").value is not None
    checked = verify(made.product, TOL)
    assert checked.product is not None
    allowance = (RADIUS + 0.4 * 2.0) * pi / 2.0
    found = in_bottom(unroll(checked.product, TOL))["front"]
    assert_near(found, (50.0, -allowance - 10.0), bound=ROUND_OFF, why="theta (r + K t)")


def test_a_text_lies_where_its_place_does() -> None:
    (one,) = pattern(tray()).texts
    assert_near(one.at, rows(tray(), "marks")["number"], bound=0.0, why="the same place")
    assert_near(in_bottom(tray())["number"], (70.0, DEEP + UP), bound=ROUND_OFF, why="closed form")


# Holes


def test_a_hole_of_the_job_is_that_of_the_drawing_moved() -> None:
    found = in_bottom(tray(), "holes")
    assert_near(found["moved"] - found["hole-1"], (40.0, 0.0), bound=ROUND_OFF, why="the drawn one is at (40, 40)")


@pytest.mark.parametrize("name", CIRCLES)
def test_a_circle_on_a_flange_or_across_a_bend_is_round_in_the_flat(name: str) -> None:
    x, beyond, radius = CIRCLES[name]
    assert_near(hole(name), -pi * radius**2, bound=ROUND_OFF, why="a circle, clockwise")
    assert_near(in_bottom(tray(), "holes")[name], (x, -beyond), bound=ROUND_OFF, why="closed form")


def test_a_drilled_hole_on_a_flange_is_round() -> None:
    assert_near(hole("drilled"), -pi * 25.0, bound=1e-8, why="a plane across the drill, digits of the file")
    assert_near(in_bottom(tray(), "holes")["drilled"], (35.0, -BEND - 12.0), bound=1e-8, why="closed form")


def test_a_hole_drawn_across_a_bend_is_one_rectangle_in_the_flat() -> None:
    assert_near(hole("slot"), -20.0 * (20.0 + BEND), bound=1e-8, why="closed form, digits of the file")
    assert_near(in_bottom(tray(), "holes")["slot"], (60.0, -BEND / 2.0), bound=1e-8, why="closed form")


# Lines


def length_of(name: str) -> float:
    return sum(
        float(norm(np.diff(one.path.vertices, axis=0)).sum()) for one in pattern(tray()).marks if name in one.name
    )


def test_bend_lines_end_at_the_holes_across_them() -> None:
    whole = 4 * WIDE + 4 * DEEP
    slot, edge, bend = 2 * 20.0, 10.0, 2 * 2.0 * sqrt(5.0**2 - (BEND / 2.0) ** 2)
    ends = 10
    bound = ends * 0.02 / (BEND / 2.0 / 5.0)
    assert_near(length_of("tangency"), whole - slot - edge - bend, bound=bound, why="0.01 mm of a polygon, aslant")


def test_a_line_across_a_bend_is_drawn_in_one_length() -> None:
    assert_near(length_of("line"), 20.0 + BEND, bound=1e-6, why="closed form")


def test_a_notch_in_the_outline_takes_its_triangle() -> None:
    whole = WIDE * DEEP + 2.0 * (WIDE + DEEP) * (BEND + HIGH)
    assert_near(contours.area(pattern(tray()).outer.edges), whole - 6.0, bound=1e-8, why="closed form less a triangle")


# The ring of a transition


# Refused places
