from math import pi

import numpy as np
import pytest

from stages.geometry.arrays import norm, unit
from stages.geometry.curves import contours
from stages.geometry.paths import arcpath
from stages.geometry.ruled.strip import Strip, jet
from stages.model.features import CircleHole, CurveMark, NotchSpec
from stages.model.material import Material, Part
from stages.model.process import Process
from stages.model.tolerances import Tolerances
from stages.unroll import unroll
from stages.verify import verify
from tests import oracles
from tests.near import assert_near, assert_relative
from tests.parts import QUINTIC_TANGENT, RIGHT_FRUSTUM, Passage, Table, construct, passage, patches, read
from tests.stages.geometry.ruled.test_drill import HALF_TUBE

SIZE = 750.0
PLATE: Table = {"kind": "flat", "outline": {"polyline": [[0, 0], [100, 0], [100, 60], [0, 60], [0, 0]]}}


def circle(at: list[object], diameter: object = 20) -> Table:
    return {"kind": "circle", "at": at, "diameter": diameter}


def rows(found: Passage, key: str) -> list[dict[str, object]]:
    listed = found.side("flat")[key]
    assert isinstance(listed, list)
    return listed


def exact_place(u: object, v: object) -> list[float]:
    """Return the flat place at 40 digits."""
    c0, c1 = (oracles.bezier(QUINTIC_TANGENT[key]["bezier"]) for key in ("c0", "c1"))  # type: ignore[index]
    return [float(x) for x in oracles.flat_map(c0, c1)(oracles.exact(u), oracles.exact(v))]


# Places


def test_what_is_given_in_u_and_v_lies_where_the_exact_development_has_it() -> None:
    marks = [{"kind": "point", "at": ["0.1", "0.9"]}, {"kind": "text", "at": ["0.75", "0.2"], "text": "A", "height": 5}]
    found = passage(QUINTIC_TANGENT, hole=[circle(["0.35", "0.6"])], mark=marks)
    (hole,), (point, text) = rows(found, "holes"), rows(found, "marks")
    for row, place in ((hole, ("0.35", "0.6")), (point, ("0.1", "0.9")), (text, ("0.75", "0.2"))):
        assert_near([row["x"], row["y"]], exact_place(*place), bound=1e-12 * SIZE, why="positions of the flat map")
        assert row["distance"] == 0.0
    assert_relative(hole["area"], 100.0 * pi, bound=1e-12, why="closed form")


@pytest.mark.parametrize("away", [0.0, 0.04])
def test_what_is_given_in_space_is_pulled_back_and_its_distance_told(away: float) -> None:
    strip = Strip(patches(QUINTIC_TANGENT), np.array([0.0, 1.0]))
    here = jet(strip, np.array([0.35]), np.array([0.6]))
    point = (here.s + away * unit(np.cross(here.s_u, here.s_v)))[0]
    found = passage(QUINTIC_TANGENT, hole=[circle([repr(float(x)) for x in point])])
    (hole,) = rows(found, "holes")
    assert_near(
        [hole["x"], hole["y"]], exact_place("0.35", "0.6"), bound=1e-11 * SIZE, why="a point rounded to doubles"
    )
    assert_near([hole["distance"]], [away], bound=1e-12 * SIZE, why="closed form")
    assert_near([found.value("construct", "feature_distance_mm")], [away], bound=1e-12 * SIZE, why="the same")
    assert found.codes("construct") == []


def test_a_place_beyond_the_chord_from_the_surface_is_told() -> None:
    found = passage(HALF_TUBE, mark=[{"kind": "point", "at": [0, 45, 50]}])
    assert found.codes("construct") == ["off-surface"]
    (mark,) = rows(found, "marks")
    assert_near([mark["distance"], mark["x"]], [5.0, 50.0], bound=1e-12, why="closed form")


@pytest.mark.parametrize(
    ("at", "code"),
    [(["0.5", "1.5"], "place-outside"), ([0, 0, 50], "ambiguous-place")],
)
def test_a_place_that_the_surface_does_not_have_is_refused(at: list[object], code: str) -> None:
    found = passage(HALF_TUBE, hole=[circle(at)])
    assert found.refused_by == "construct"
    assert found.codes("construct", fatal=True) == [code]
    assert passage(HALF_TUBE, hole=[circle(["0.5", "0.5"])]).refused_by is None


def test_a_seam_belongs_to_nobody() -> None:
    assert passage(RIGHT_FRUSTUM, mark=[{"kind": "point", "at": [3, 0, 0]}]).codes("construct") == ["ambiguous-place"]


# Holes


def test_every_hole_comes_out_once_and_clockwise() -> None:
    ellipse = {"center": ["0.2", "0.5"], "major": ["0.1", 0], "minor": [0, "0.05"]}
    holes = [circle(["0.5", "0.3"]), {"kind": "drill", "at": ["0.5", "0.7"], "diameter": 20},
             {"kind": "curve", "name": "window", "curve": {"ellipse": ellipse}}]  # fmt: skip
    found = passage(QUINTIC_TANGENT, hole=holes)
    assert found.pattern is not None
    assert [hole.name for hole in found.pattern.inner] == ["hole-1", "hole-2", "window"]
    assert all(arcpath.area(hole.path) < 0.0 and contours.area(hole.edges) < 0.0 for hole in found.pattern.inner)
    # the development keeps areas: that of a curve of u and v is the integral of |S_u x S_v| inside it
    r, a = np.meshgrid((np.polynomial.legendre.leggauss(24)[0] + 1) / 2, np.arange(64) / 64 * 2 * pi, indexing="ij")
    u, v = (0.2 + 0.1 * r * np.cos(a)).ravel(), (0.5 + 0.05 * r * np.sin(a)).ravel()
    here = jet(Strip(patches(QUINTIC_TANGENT), np.array([0.0, 1.0])), u, v)
    weight = np.polynomial.legendre.leggauss(24)[1] / 2
    density = (norm(np.cross(here.s_u, here.s_v)) * 0.1 * 0.05 * r.ravel()).reshape(r.shape)
    assert_relative(
        rows(found, "holes")[2]["area"], weight @ density.mean(axis=1) * 2 * pi, bound=1e-12, why="isometry"
    )


def test_a_curve_in_space_makes_the_hole_of_its_nearest_places() -> None:
    """A circle 10 mm above a tube of radius 40: its feet are the circle seen from the axis of the tube."""
    ring = {"center": [0, 50, 50], "radius": 6, "normal": [0, 1, 0]}
    found = passage(HALF_TUBE, hole=[{"kind": "curve", "curve": {"circle": ring}}])
    assert found.pattern is not None
    (hole,) = found.pattern.inner
    t = np.linspace(0.0, 1.0, 101)
    flat = np.concatenate([edge.at(t) for edge in hole.edges])
    # x of the flat runs along the rulings (z), y along the arc
    along, angle = flat[:, 0] - 50.0, (flat[:, 1] - 20.0 * pi) / 40.0
    # a foot at the angle a from y belongs to the point x = 50 tan a of the ring, at the height sqrt(36 - x^2)
    assert_near(along**2 + (50.0 * np.tan(angle)) ** 2, np.full(t.size, 36.0), bound=1e-10, why="closed form, mm2")
    assert found.codes("construct") == ["off-surface"]


@pytest.mark.parametrize(
    ("holes", "codes"),
    [
        ([circle(["0.5", "0.02"])], ["hole-outside"]),
        ([circle(["0.5", "0.5"]), circle(["0.5", "0.6"])], ["holes-cross"]),
        ([circle(["0.5", "0.5"], 40), circle(["0.5", "0.5"], 10)], ["hole-nested"]),
        ([{"kind": "drill", "at": ["0.95", "0.5"], "diameter": 20}], ["hole-outside"]),
        ([{"kind": "curve", "curve": {"polyline": [["0.2", "0.3"], ["0.6", "0.7"], ["0.6", "0.3"], ["0.2", "0.9"],
                                                   ["0.2", "0.3"]]}}], ["contour-crosses-itself"]),
    ],
)  # fmt: skip
def test_one_bad_hole_is_found_and_nothing_else(holes: list[Table], codes: list[str]) -> None:
    found = passage(HALF_TUBE, hole=holes)
    assert found.refused_by == "unroll"
    assert found.codes("unroll", fatal=True) == codes


@pytest.mark.parametrize(
    "curve",
    [
        {"polyline": [["0.2", "0.3"], ["0.6", "0.3"], ["0.6", "0.7"]]},
        {"arc": {"center": ["0.5", "0.5"], "radius": "0.2", "start": 0, "end": 300}},
    ],
)
def test_an_open_curve_is_no_hole_but_a_mark(curve: Table) -> None:
    assert passage(HALF_TUBE, hole=[{"kind": "curve", "curve": curve}]).codes("construct") == ["open-contour"]
    found = passage(HALF_TUBE, mark=[{"kind": "curve", "curve": curve}])
    assert found.pattern is not None
    assert [mark.path.closed for mark in found.pattern.marks] == [False]


# What the process can cut


def judged(holes: list[Table], process: Process, surface: Table = HALF_TUBE) -> tuple[list[str], Passage]:
    found = passage(surface, hole=holes)
    assert found.certificate is not None
    given = Part(read(surface, hole=holes), Material(), process)
    made = construct(given, Tolerances()).product
    assert made is not None
    certificate = verify(made, Tolerances()).product
    assert certificate is not None
    outcome = unroll(certificate, Tolerances())
    assert outcome.product is not None
    return [f"{finding.code}: {finding.message}" for finding in outcome.report.findings], found


def test_holes_too_small_or_too_close_are_told_with_both_numbers() -> None:
    # the tube is 100 mm wide: 4 mm are left beside the first hole, 6 mm between the two
    holes = [circle(["0.14", "0.5"]), circle(["0.38", "0.5"], 16)]
    assert judged(holes, Process("laser", min_hole_mm=16.0, min_web_mm=4.0))[0] == []
    assert judged(holes, Process("laser", min_hole_mm=16.5, min_web_mm=4.5))[0] == [
        "small-hole: hole-2 is 16 mm wide, the process wants 16.5 mm",
        "narrow-web: 4 mm between hole-1 and the outline, the process wants 4.5 mm",
    ]
    found = judged(holes, Process(min_web_mm=6.01))[0]
    assert found[-1] == "narrow-web: 6 mm between hole-2 and hole-1, the process wants 6.01 mm"


def test_the_narrowest_hole_and_web_are_measured_exactly() -> None:
    found = passage(HALF_TUBE, hole=[circle(["0.14", "0.5"]), circle(["0.38", "0.5"], 16)])
    web, hole = found.metric("unroll", "min_web_mm"), found.metric("unroll", "min_hole_mm")
    assert_near([web.value, hole.value], [4.0, 16.0], bound=1e-12, why="closed form")
    assert web.where is not None and (web.where["hole"], web.where["to"]) == ("hole-1", "the outline")


def test_a_slot_is_as_narrow_as_its_width() -> None:
    slot = {"polyline": [[20, 20], [60, 20], [60, 23], [20, 23], [20, 20]]}
    found = passage(PLATE, hole=[{"kind": "curve", "curve": slot}])
    assert_near([found.value("unroll", "min_hole_mm")], [3.0], bound=0.01 * 0.05 * 2, why="a hundredth of the chord")


# Marks


def test_a_cross_stands_along_the_ruling_and_ends_at_the_outline() -> None:
    found = passage(HALF_TUBE, mark=[{"kind": "point", "at": ["0.01", "0.5"], "size": 6, "name": "p"}])
    assert found.pattern is not None
    ends = np.array([mark.path.vertices for mark in found.pattern.marks])
    y = 20.0 * pi
    wanted = [[[0.0, y], [4.0, y]], [[1.0, y - 3.0], [1.0, y + 3.0]]]
    assert_near(ends, wanted, bound=1e-9, why="closed form; the outline as a polygon, straight there")
    assert {mark.name for mark in found.pattern.marks} == {"p"}


def test_a_marked_curve_is_traced_within_the_chord() -> None:
    curve = {"points": [["0.1", "0.1"], ["0.4", "0.3"], ["0.6", "0.8"], ["0.9", "0.9"]]}
    found = passage(QUINTIC_TANGENT, mark=[{"kind": "curve", "curve": curve}])
    assert found.pattern is not None and isinstance(found.pattern.marks, tuple)
    (mark,), (row,) = found.pattern.marks, rows(found, "marks")
    assert_relative(arcpath.length(mark.path), row["length"], bound=1e-4, why="arcs within 0.05 mm of 500 mm")
    assert_near(mark.path.vertices[0], exact_place("0.1", "0.1"), bound=1e-12 * SIZE, why="ends are exact")
    assert_near(mark.path.vertices[-1], exact_place("0.9", "0.9"), bound=1e-12 * SIZE, why="ends are exact")


@pytest.mark.parametrize("angle", [0, 30])
def test_a_text_stands_along_its_ruling(angle: int) -> None:
    text = {"kind": "text", "at": ["0.5", "0.5"], "text": "OUT 1", "height": 7, "angle": angle}
    found = passage(RIGHT_FRUSTUM, mark=[text])
    assert found.pattern is not None
    (made,) = found.pattern.texts
    # the middle ruling of a sector of 2 pi r / slant, seen from the first one
    sector = 2.0 * pi * 1.5 / np.hypot(1.5, 4.0)
    assert_near(abs(made.angle_deg - angle), np.degrees(sector) / 2.0, bound=1e-11, why="closed form")
    assert (made.text, made.height_mm) == ("OUT 1", 7.0)


# Plates


def test_on_a_plate_two_numbers_are_x_and_y_and_a_drill_is_round() -> None:
    holes = [circle([30, 20]), {"kind": "drill", "at": [70, 20, "0.03"], "diameter": 10}]
    found = passage(PLATE, hole=holes, mark=[{"kind": "text", "at": [50, 50], "text": "P", "height": 4, "angle": 90}])
    assert found.pattern is not None
    (a, b) = rows(found, "holes")
    assert_near([a["x"], a["y"], a["area"]], [30.0, 20.0, 100.0 * pi], bound=1e-11, why="closed form")
    assert_near([b["x"], b["y"], b["distance"]], [70.0, 20.0, 0.03], bound=1e-12, why="closed form")
    assert_near([found.side("flat")["area"]], [6000.0 - 125.0 * pi], bound=1e-10, why="closed form")
    assert found.pattern.texts[0].angle_deg == 90.0


# Pieces of a divided part


def test_the_specifications_have_names_of_their_own() -> None:
    spec = read(HALF_TUBE, hole=[circle(["0.5", "0.5"])], mark=[{"kind": "curve", "curve": {"line": [[0, 0], [1, 1]]}}],
                notch=[{"edge": "c0", "at": "0.5"}])  # fmt: skip
    assert isinstance(spec.hole[0], CircleHole) and isinstance(spec.mark[0], CurveMark)
    assert isinstance(spec.notch[0], NotchSpec)
