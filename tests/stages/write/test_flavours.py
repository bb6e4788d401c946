"""Every flavour and version says the same: as this project reads it, and as the library reads it by itself."""

import subprocess
import sys
from collections import Counter
from dataclasses import replace
from math import dist, pi

import ezdxf
import numpy as np
import pytest
from ezdxf.entities import DXFEntity
from ezdxf.path import make_path
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, area, length
from stages.model.cutfile import CutFile, Flavour, Machine, Side, Version
from stages.model.pattern import FlatPattern
from stages.model.sheet import Nesting, Placement, Sheet, SheetLayout
from stages.write import judged, write
from stages.write.drawing import flat_drawing
from stages.write.dxf import dxf_text
from stages.write.flavours import LARGEST_RADIUS_MM, as_cut, as_written
from stages.write.readback import read
from tests.near import assert_near
from tests.stages.write.cases import CASES, Case, document, machine, on, texts_of
from tests.stages.write.patterns import (
    CHORD_MM,
    drop,
    fan,
    line_mark,
    plate,
    sector,
    strip,
)
from tests.stages.write.planted import codes
from tests.stages.write.test_commonlines import PARTS, brick, grid

KINDS = {
    "polyline-arcs": {"LWPOLYLINE", "LINE", "CIRCLE", "TEXT"},
    "lines-arcs": {"LINE", "ARC", "CIRCLE", "TEXT"},
    "polylines": {"LWPOLYLINE", "LINE", "TEXT"},
    "r12": {"POLYLINE", "LINE", "CIRCLE", "TEXT"},
}


@pytest.mark.parametrize("case", CASES)
def test_every_flavour_passes_and_holds_only_its_entities(case: Case) -> None:
    for text in texts_of(case).values():
        kinds = {entity.dxftype() for entity in document(text).modelspace()}
        wanted = KINDS[case[0]] - ({"LWPOLYLINE"} if case[1] == "R12" else set())
        assert kinds <= wanted | ({"POLYLINE"} if case[1] == "R12" else set())
        assert document(text).acad_release == case[1]
        assert document(text).audit().errors == []


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("side", ["either", "outside"])
def test_an_apex_is_one_corner_in_every_flavour(case: Case, side: Side) -> None:
    outcome = write([fan()], None, replace(machine(case), side=side))
    assert outcome.report.findings == ()
    assert [metric.name for metric in outcome.report.metrics if not metric.passed] == []


@pytest.mark.parametrize("case", CASES)
def test_the_deviation_of_the_flavour_itself_is_measured_and_within_the_tolerance(case: Case) -> None:
    report = write([strip(), drop()], None, machine(case)).report
    deviation = report.metric("max_deviation_mm")
    assert deviation.limit == CHORD_MM
    assert 0.3 * CHORD_MM < deviation.value <= CHORD_MM
    chords = case[0] == "polylines"
    # a chord is inside a round hole by up to the tolerance: 2/3 of it on average, around the smaller of the circles
    assert report.metric("length_error").value < (2e-3 if chords else 5e-5)


@pytest.mark.parametrize("case", CASES)
def test_the_library_finds_the_same_area_by_itself(case: Case) -> None:
    """The outline of the sector, pi (100^2 - 50^2) / 3, from the entities' own points, flattened to 1e-4 mm."""
    points = [
        (point.x, point.y)
        for entity in on("CUT_OUTER", texts_of(case)["flat/sector.dxf"])
        for point in _forward(entity)
    ]
    x, y = np.array(points).T
    found = 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
    outline = 150.0 * 2.0 * pi / 3.0 + 100.0
    bound = outline * (CHORD_MM if case[0] == "polylines" else 1e-3)
    assert_near(abs(found), pi * 7500.0 / 3.0, bound=bound, why="a flattened arc is off by that along the outline")


def _forward(entity: DXFEntity) -> list[ezdxf.math.Vec3]:
    """Return the points of an entity in the direction of a counter-clockwise ring: its inner arc runs clockwise."""
    points = list(make_path(entity).flattening(1e-4))
    inner = entity.dxftype() == "ARC" and entity.dxf.radius < 75.0
    return points[::-1] if inner else points


@pytest.mark.parametrize("version", ["R12", "R2000"])
def test_lines_and_arcs_join_where_a_reader_computes_their_ends(version: Version) -> None:
    text = texts_of(("lines-arcs", version))["flat/strip.dxf"]
    entities = on("CUT_OUTER", text)
    ends = [(e.dxf.start, e.dxf.end) if e.dxftype() == "LINE" else (e.start_point, e.end_point) for e in entities]
    corners = [(point.x, point.y) for pair in ends for point in pair]
    nearest = [min(dist(a, b) for j, b in enumerate(corners) if j // 2 != i // 2) for i, a in enumerate(corners)]
    # ten decimals of centre and radius; the doubles of a radius of 1e5 mm
    assert max(nearest) < 1e-9


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("kerf_mm", [0.0, 0.2])
def test_outlines_that_share_cuts_are_whole_again(case: Case, kerf_mm: float) -> None:
    how = replace(machine(case), common_kerf_mm=kerf_mm)
    for layout in (grid(3, kerf_mm), brick(kerf_mm)):
        outcome = write(PARTS, Nesting((layout,)), how)
        assert outcome.report.passed, outcome.report.findings
        assert [finding.code for finding in outcome.report.findings] == ["common-lines"]


def test_an_outline_of_which_one_straight_line_is_left_is_told_from_a_common_line() -> None:
    """The middle of three panels in a row that end alike has two lines of its own left, above and below."""
    layout = SheetLayout(
        Sheet("stock", 500.0, 300.0),
        1,
        tuple(Placement("a", k + 1, Rigid2(10.0 + 50.2 * k, 10.0)) for k in range(3)),
        0.1,
    )
    how = Machine(flavour="lines-arcs", common_kerf_mm=0.2)
    outcome = write(PARTS, Nesting((layout,)), how)
    assert outcome.report.passed, outcome.report.findings
    text = {file.path: file.text for file in outcome.product}["cut/stock-1.dxf"]
    outer = [entity for entity in read(text).entities if entity.layer == "CUT_OUTER"]
    assert Counter(entity.kind for entity in outer) == {"CHAIN": 4, "LINE": 2}


def test_marks_that_begin_where_the_one_before_ended_stay_marks_of_their_own() -> None:
    marks = (
        line_mark((10.0, 10.0), (20.0, 10.0)),
        line_mark((20.0, 10.0), (20.0, 20.0)),
        line_mark((20.0, 20.0), (10.0, 10.0)),
    )
    part = plate().replace(marks=marks)
    for case in CASES:
        outcome = write([part], None, machine(case))
        assert outcome.report.passed, outcome.report.findings
        entities = read(outcome.product[0].text).entities
        assert [entity.kind for entity in entities if entity.layer == "MARK"] == ["LINE"] * 3


def test_a_lens_of_two_arcs_keeps_its_direction_in_arcs() -> None:
    bulges = np.array([-0.3, -0.3])
    lens = ArcPath(np.array([[0.0, 0.0], [10.0, 0.0]]), bulges, closed=True)
    cut = as_written(lens, Machine(flavour="lines-arcs"), outline=True)
    assert cut.bulges.size == 4
    assert_near(area(cut), area(lens), bound=1e-12, why="the same arcs in halves")
    assert as_written(lens, Machine(), outline=True) is lens


def test_an_arc_that_doubles_place_badly_is_a_line() -> None:
    bulge = 0.25 * 100.0 / (2.0 * LARGEST_RADIUS_MM)
    corners = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 50.0], [0.0, 50.0]])
    path = ArcPath(corners, np.array([bulge, 0.0, 0.4, 0.0]), closed=True)
    found = as_written(path, Machine(flavour="lines-arcs"), outline=True)
    assert found.bulges.tolist() == [0.0, 0.0, 0.4, 0.0]


MOTIONS = st.builds(
    Rigid2, st.floats(-1000.0, 1000.0), st.floats(-1000.0, 1000.0), st.floats(0.0, 360.0), mirrored=st.booleans()
)


@settings(max_examples=8, deadline=None)
@given(MOTIONS, st.sampled_from(CASES), st.sampled_from([sector(), drop(), plate()]))
def test_a_placed_part_reads_back_with_its_length_and_area(motion: Rigid2, case: Case, part: FlatPattern) -> None:
    how = machine(case)
    laid = (Placement(part.part, 1, motion),)
    layout = SheetLayout(Sheet("stock", 500.0, 300.0), 1, laid, 0.1)
    outcome = write([part], Nesting((layout,)), how)
    assert outcome.report.passed, outcome.report.findings
    text = outcome.product[-1].text
    outer = next(entity.path for entity in read(text).entities if entity.layer == "CUT_OUTER")
    drawn = as_cut(part, how).outer.path
    assert_near(length(outer), length(drawn), bound=1e-7, why="some 40 pieces, ends rounded to 1e-10 mm or computed")
    assert_near(area(outer), area(drawn), bound=1e-7 * length(drawn), why="the same along the whole outline")


def test_two_processes_write_the_same_bytes_in_every_flavour() -> None:
    """Of these seeds, sets of the names of DXF classes are run through in different orders."""
    code = "\n".join([
        "from hashlib import sha256",
        "from tests.stages.write.cases import CASES, good, machine",
        "for case in CASES: print(sha256(good(machine(case)).encode()).hexdigest())",
    ])  # fmt: skip
    seen = [
        subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True, env={"PYTHONHASHSEED": seed}
        )
        for seed in ("1", "4")
    ]
    assert len(seen[0].stdout.split()) == len(CASES)
    assert seen[0].stdout == seen[1].stdout


@pytest.mark.parametrize("flavour", ["lines-arcs", "polylines", "r12"])
def test_r12_says_millimetres_in_both_variables_that_it_does_not_know(flavour: Flavour) -> None:
    text = texts_of((flavour, "R12"))["flat/sector.dxf"]
    assert text.count("$INSUNITS\n 70\n4\n") == 1
    assert text.count("$MEASUREMENT\n 70\n1\n") == 1
    header = document(text).header
    assert header["$EXTMAX"][:2] == pytest.approx((100.0, 100.0), abs=CHORD_MM)
    for gone in ("$INSUNITS\n 70\n4", "$MEASUREMENT\n 70\n1"):
        broken = text.replace(f"  9\n{gone}\n", "")
        assert codes(broken) == {"readback-units"}


@pytest.mark.parametrize("case", CASES)
def test_what_lies_inside_the_exact_outline_is_told_where_it_must_not(case: Case) -> None:
    how = replace(machine(case), side="outside")
    made = write([strip(), sector()], None, how).report
    assert made.passed
    assert made.metric("inside_mm").value <= 1e-9
    assert made.metric("max_deviation_mm").value <= CHORD_MM
    assert "inside_mm" not in [metric.name for metric in write([sector()], None, machine(case)).report.metrics]
    # planted: what was traced for either side, called an outer one
    part = as_cut(strip(), machine(case))
    called = part.replace(outer=replace(part.outer, side="outside"))
    drawn = flat_drawing(called, how)
    report = judged([CutFile(drawn.path, dxf_text(drawn, how))], [drawn], {called.part: called}, how)
    assert not report.passed
    assert report.metric("inside_mm").value > 0.3 * CHORD_MM


def test_a_pattern_on_the_outer_side_is_made_once() -> None:
    how = Machine(side="outside")
    once = as_cut(strip(), how)
    assert as_cut(once, how).outer is once.outer
