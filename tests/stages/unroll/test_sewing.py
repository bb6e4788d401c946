"""One pattern made ready to be sewn: what has no room is refused with its place, and each check is shown to fire."""

from math import pi, sqrt

import numpy as np
import pytest

from stages.geometry.curves import contours
from stages.geometry.curves.plane import CircularArc
from stages.geometry.paths import arcpath
from stages.geometry.paths.allowance import Widened, widened
from stages.model.report import Finding
from stages.model.tolerances import Tolerances
from stages.unroll import outline
from stages.unroll.seams import Seams, seams
from stages.unroll.sewing import SeamNotch, Sewn, Work, _allowance_error, sewn
from stages.unroll.stitches import Stitches
from tests.near import assert_near, assert_relative
from tests.parts import Table, part, passage, read
from tests.stages.unroll.test_seams import BOX

TOL = Tolerances()
SLOT: Table = {
    "kind": "flat",
    "outline": {"polyline": [[0, 0], [40, 0], [40, 30], [44, 30], [44, 0], [100, 0], [100, 60], [0, 60], [0, 0]]},
}
BITE: Table = {
    "kind": "flat",
    "outline": {
        "chain": [
            {"line": [[100, 0], [100, 40]]},
            {"line": [[100, 40], [0, 40]]},
            {"line": [[0, 40], [0, 0]]},
            {"line": [[0, 0], [45, 0]]},
            {"arc": {"center": [50, 0], "radius": 5, "start": 0, "end": 180, "normal": [0, 0, -1]}},
            {"line": [[55, 0], [100, 0]]},
        ]
    },
}
JAWS = [[100, 30], [60, 30], [60, 15], [30, 15], [30, 53], [60, 53], [60, 38], [100, 38]]
CLAW: Table = {"kind": "flat", "outline": {"polyline": [[0, 0], [100, 0], *JAWS, [100, 68], [0, 68], [0, 0]]}}
"""Two jaws with a gap of 8 between them, which is wider behind them."""
WHOLE: Table = {"edge": "outline", "allowance": 5}


def made(surface: Table, *tables: Table, work: Work | None = None, tol: Tolerances = TOL, **keys: object) -> Sewn:
    one = part(surface, seam=list(tables), **keys)
    pattern = passage(surface, tol, seam=list(tables), **keys).pattern
    assert pattern is not None
    known = seams(pattern, one.spec.seam)
    assert isinstance(known, Seams)
    return sewn(pattern, one, known, work or Work(), tol)


def codes(found: Sewn) -> list[str]:
    return [finding.code for finding in found.findings if finding.fatal]


def only(found: Sewn) -> Finding:
    (finding,) = found.findings
    assert finding.fatal and found.pattern is None
    return finding


def test_a_box_with_one_seam_is_larger_on_that_side_alone() -> None:
    found = made(BOX, WHOLE | {"from": 0, "to": 100})
    assert found.pattern is not None
    assert_near(arcpath.bounds(found.pattern.outer.path), (0.0, -5.0, 100.0, 40.0), bound=1e-12, why="5 below y = 0")
    assert_near([found.cut["area"], found.cut["outline_length"]], [4500.0, 290.0], bound=1e-9, why="100 x 45")
    (sew,) = found.pattern.marks
    assert (sew.layer, sew.name, sew.path.closed) == ("SEW", "outline", False)
    assert_near(sew.path.vertices, [[0.0, 0.0], [100.0, 0.0]], bound=1e-12, why="the edge that is sewn")


def test_a_slot_that_the_allowance_fills_is_refused_at_its_bottom() -> None:
    finding = only(made(SLOT, WHOLE))
    assert finding.code == "allowance-too-wide"
    assert "too narrow for an allowance of 5 mm" in finding.message and "kind = 'cut'" in finding.message
    assert finding.where is not None
    assert_near([float(finding.where["x"]), float(finding.where["y"])], [42.0, 30.0], bound=1e-9, why="its bottom")
    assert made(SLOT, WHOLE | {"allowance": "1.9"}).pattern is not None, "with room on both sides it is cut"


def test_a_hollow_is_refused_with_the_radius_that_it_has() -> None:
    finding = only(made(BITE, WHOLE))
    assert finding.code == "allowance-too-wide" and "a radius of 5 mm" in finding.message
    found = made(BITE, WHOLE | {"allowance": 4})
    assert found.pattern is not None
    arcs = [edge for edge in found.pattern.outer.edges if isinstance(edge, CircularArc)]
    assert [round(edge.radius, 9) for edge in arcs] == [1.0], "the arc stays an arc about the same centre"


def test_allowances_that_meet_across_a_gap_are_refused_there() -> None:
    finding = only(made(CLAW, {"name": "a", "edge": "outline", "allowance": 5, "from": 130, "to": 170},
                        {"name": "b", "edge": "outline", "allowance": 5, "from": 298, "to": 338}))  # fmt: skip
    assert finding.code == "contour-crosses-itself"
    assert finding.where is not None
    x, y = float(finding.where["x"]), float(finding.where["y"])
    assert 59.0 <= x <= 101.0 and 30.0 <= y <= 38.0, "in the gap, where both are"


def test_a_contour_off_its_place_is_seen() -> None:
    pattern = passage(BOX, TOL, seam=[WHOLE]).pattern
    assert pattern is not None
    known = seams(pattern, read(BOX, seam=[WHOLE]).seam)
    assert isinstance(known, Seams)
    right, wrong = (widened(known.outline, [wide] * 4, accuracy=0.05) for wide in (5.0, 5.3))
    assert isinstance(right, Widened) and isinstance(wrong, Widened)
    good, bad = (outline.contour(one.edges, TOL.chord_mm) for one in (right, wrong))
    metric = _allowance_error(known, right, good, TOL)
    assert metric.passed
    assert_near([float(metric.value or 0.0)], [0.0], bound=1e-12, why="lines where they belong")
    metric = _allowance_error(known, right, bad, TOL)
    assert not metric.passed
    assert_near([float(metric.value or 0.0)], [0.3], bound=1e-9, why="0.3 mm too wide")


NOTCH: Table = {"seam": "outline", "fraction": "1/2", "depth": 4, "width": 2}


def notched(depth: float, surface: Table = BOX, **place: object) -> Sewn:
    notch = NOTCH | {"depth": str(depth)} | place
    one = read(surface, seam=[WHOLE], notch=[notch])
    spec = one.notch[0]
    work = Work((SeamNotch("notch-1", "outline", spec, float(spec.fraction or 0)),))
    return made(surface, WHOLE, work=work, notch=[notch])


@pytest.mark.parametrize("depth", [4.0, 5.0])
def test_a_notch_may_be_as_deep_as_the_allowance(depth: float) -> None:
    found = notched(depth)
    assert found.pattern is not None and found.pattern.boundary is not None
    areas = [contours.area(one.edges) for one in (found.pattern.boundary, found.pattern.outer)]
    assert_near([areas[0] - areas[1]], [depth], bound=1e-9, why="a triangle 2 wide")


def test_a_deeper_one_is_refused_with_the_room_that_there_is() -> None:
    finding = only(notched(5.01))
    assert finding.code == "notch-too-deep"
    assert "the allowance of outline is 5 mm" in finding.message and "no deeper" in finding.message


def test_a_notch_that_a_hollow_corner_leaves_no_edge_for_is_refused() -> None:
    claw: Table = {
        "kind": "flat",
        "outline": {"polyline": [[0, 0], [90, 0], [90, 40], [40, 40], [40, 90], [0, 90], [0, 0]]},
    }
    at_corner = (90.0 + 40.0 + 48.0) / 360.0
    finding = only(notched(3.0, claw, fraction=str(at_corner)))
    assert finding.code == "notch-off-edge"
    assert "move it away from the corner" in finding.message


def test_stitches_are_holes_of_their_own_purpose_and_hold_their_distance() -> None:
    (spec,) = read(BOX, seam=[WHOLE], stitch=[{"seam": "outline", "pitch": 10, "diameter": 2, "margin": 3}]).stitch
    fractions = np.array([10.0, 50.0, 110.0, 260.0]) / 280.0
    found = made(BOX, WHOLE, work=Work(stitches=(Stitches("row", "outline", spec, fractions),)))
    assert found.pattern is not None and found.counts == {"outline": 4}
    places = [contours.area_and_centroid(hole.edges)[1:] for hole in found.pattern.inner]
    want = [[10.0, 3.0], [50.0, 3.0], [97.0, 10.0], [3.0, 20.0]]
    assert_near(places, want, bound=1e-9, why="3 into the part")
    assert {hole.purpose for hole in found.pattern.inner} == {"stitch"}
    assert_relative([found.holes[0][2]], [pi], bound=1e-12, why="a circle of radius 1")


@pytest.mark.parametrize(("angle", "ends"), [(0, [[49, 0], [51, 0]]), (90, [[50, -1], [50, 1]])])
def test_slits_turn_counter_clockwise_from_the_seam(angle: int, ends: list[list[float]]) -> None:
    (spec,) = read(BOX, seam=[WHOLE], stitch=[{"seam": "outline", "pitch": 10, "slit": 2, "angle": angle}]).stitch
    found = made(BOX, WHOLE, work=Work(stitches=(Stitches("row", "outline", spec, np.array([50.0 / 280.0])),)))
    assert found.pattern is not None
    (slit,) = (mark for mark in found.pattern.marks if mark.layer == "CUT_SLIT")
    assert_near(slit.path.vertices, ends, bound=1e-9, why="2 long about (50, 0)")


def test_a_slit_that_leaves_the_part_is_refused() -> None:
    (spec,) = read(BOX, seam=[WHOLE], stitch=[{"seam": "outline", "pitch": 10, "slit": 20, "angle": 90}]).stitch
    found = made(BOX, WHOLE, work=Work(stitches=(Stitches("row", "outline", spec, np.array([50.0 / 280.0])),)))
    assert codes(found) == ["slit-outside"]


def test_a_sharp_corner_reaches_no_farther_than_its_limit() -> None:
    wedge: Table = {"kind": "flat", "outline": {"polyline": [[0, 0], [100, 0], [100, 20], [0, 0]]}}
    found = made(wedge, WHOLE)
    assert found.pattern is not None
    low_x, *_ = arcpath.bounds(found.pattern.outer.path)
    assert -2.0 * 5.0 <= low_x <= 0.0
    assert sqrt(100.0**2 + 20.0**2) * 5.0 < found.cut["area"] < 3000.0
