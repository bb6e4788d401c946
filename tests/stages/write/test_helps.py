"""Helps for the process in cut files: in every flavour, as read again; and faults planted in each, which are found."""

from dataclasses import replace
from functools import cache
from io import StringIO

import ezdxf
import numpy as np
import pytest

from stages.geometry.arcpath import area, length
from stages.geometry.clearance import inside, pieces
from stages.model.cutfile import CutFile, Machine
from stages.model.helps import Helps, Lead, Tabs
from stages.model.pattern import FlatPattern, Mark
from stages.model.report import Outcome, StageReport
from stages.model.sheet import Nesting, Sheet
from stages.write import judged, write
from stages.write.bridged import bridged
from stages.write.chains import Entity
from stages.write.dxf import dxf_text
from stages.write.helps import helped
from stages.write.kerf import beam_patterns
from stages.write.readback import read
from stages.write.sheets import cut_drawings
from tests.near import assert_near
from tests.stages.write.patterns import contour, line_mark, nesting, pattern, plate, polygon_edges, sector
from tests.stages.write.test_commonlines import KERF_MM, PARTS, grid, laid

BEAM_MM = 0.2
ROUNDING = 1e-8
"""Sums of ten coordinates of a file, rounded to 1e-10 mm, doubled by the chords."""

NONE = Helps(beam_mm=BEAM_MM)
OFFSET = replace(NONE, compensated=True)
LEADS = replace(NONE, lead_in=Lead("line", 3.0, 45.0), lead_out=Lead("arc", 2.0, 90.0))
TABS = replace(NONE, tabs=Tabs(0.4, count=4, holes=True))
ALL = replace(OFFSET, start="corner", lead_in=Lead("arc", 2.0, 90.0), tabs=Tabs(0.4, spacing_mm=80.0))
EVERY = {"offset": OFFSET, "mitred": replace(OFFSET, mitred=True), "leads": LEADS, "tabs": TABS, "all": ALL}
FLAVOURS = [("lines-arcs", "R2010"), ("polylines", "R2018"), ("r12", "R12")]


def machine(helps: Helps, flavour: str = "polyline-arcs", version: str = "R2000") -> Machine:
    return Machine(flavour=flavour, version=version, helps=helps)  # type: ignore[arg-type]


@cache
def usual(helps: Helps, flavour: str = "polyline-arcs", version: str = "R2000") -> Outcome[tuple[CutFile, ...]]:
    """Return the files of the usual nest, made once for all tests."""
    return made(machine(helps, flavour, version))


def made(
    how: Machine, parts: tuple[FlatPattern, ...] = (plate(), sector()), nest: Nesting | None = None
) -> Outcome[tuple[CutFile, ...]]:
    return write(parts, nest or nesting(), how)


def first_sheet(how: Machine) -> list[Entity]:
    texts = {file.path: file.text for file in usual(how.helps).product}
    return list(read(texts["cut/stock-1.dxf"], how.of_file("cut/").layers).entities)


def codes(outcome: Outcome[tuple[CutFile, ...]]) -> set[str]:
    return {finding.code for finding in outcome.report.findings}


@pytest.mark.parametrize("helps", EVERY.values(), ids=EVERY.keys())
def test_every_help_is_written_and_read(helps: Helps) -> None:
    outcome = usual(helps)
    assert outcome.report.passed, outcome.report.findings
    assert "short-piece" not in codes(outcome) or helps.mitred


@pytest.mark.parametrize("case", FLAVOURS, ids=[case[0] for case in FLAVOURS])
def test_all_together_go_into_every_flavour(case: tuple[str, str]) -> None:
    one = Nesting((replace(nesting().layouts[0], placements=nesting().layouts[0].placements[1:3]),))
    outcome = made(machine(ALL, *case), nest=one)
    assert outcome.report.passed, outcome.report.findings


def test_off_they_change_nothing_and_say_nothing() -> None:
    plain, off = made(Machine()), usual(NONE)
    assert [file.text for file in plain.product] == [file.text for file in off.product]
    assert codes(off) == codes(plain)


def test_patterns_in_flat_stay_nominal() -> None:
    plain, helped_too = usual(NONE), usual(ALL)
    flat = [[file.text for file in outcome.product if file.path.startswith("flat/")] for outcome in (plain, helped_too)]
    assert flat[0] == flat[1]


# Kerf


def test_offset_contours_follow_steiner_and_say_so_in_their_layers() -> None:
    how = machine(OFFSET)
    found = [abs(area(one.path)) for one in first_sheet(how) if one.layer == "CUT_OUTER" and one.path is not None]
    grown = 6000.0 + 320.0 * 0.1 + np.pi * 0.01
    assert_near(found[:2], [grown, grown], bound=1e-6, why="A + L d + pi d^2, rounded coordinates times the length")
    text = {file.path: file.text for file in usual(OFFSET).product}["cut/stock-1.dxf"]
    names = {layer.dxf.name for layer in ezdxf.read(StringIO(text)).layers}
    assert {"CUT_OUTER_OFFSET", "CUT_INNER_OFFSET"} <= names
    assert not {"CUT_OUTER", "CUT_INNER"} & names


def test_how_far_contours_are_offset_is_measured_on_the_files() -> None:
    report = usual(OFFSET).report
    off = report.metric("kerf_offset_error_mm")
    assert off.passed
    assert_near(float(off.value or 0.0), 0.0, bound=ROUNDING, why="rounding of the file")
    assert "kerf-compensated" in {finding.code for finding in report.findings}


@pytest.mark.parametrize("wrong", [0.19, 0.21, 0.2002])
def test_a_wrong_offset_in_the_file_is_found(wrong: float) -> None:
    """The files are written for another kerf than the one that they are judged by."""
    good, bad = machine(OFFSET), machine(replace(OFFSET, beam_mm=wrong))
    report = rejudged(bad, good)
    assert not report.metric("kerf_offset_error_mm").passed


def rejudged(written: Machine, wanted: Machine) -> StageReport:
    """Return the report on files of one machine as judged by the drawings of another, but for their helps."""
    parts = {one.part: one for one in (plate(), sector())}
    beams = {one.part: one for one in beam_patterns(tuple(parts.values()), written)[0]}
    drawings = [
        replace(helped(one, written), helps=wanted.helps) for one in cut_drawings(nesting().layouts, beams, written)
    ]
    files = [CutFile(one.path, dxf_text(one, written.of_file(one.path))) for one in drawings]
    return judged(files, drawings, parts, wanted)


def test_a_slot_narrower_than_the_kerf_is_refused_with_its_place() -> None:
    slot = polygon_edges(
        (0.0, 0.0), (40.0, 0.0), (40.0, 30.0), (20.15, 30.0), (20.15, 10.0), (20.0, 10.0), (20.0, 30.0), (0.0, 30.0)
    )
    part = pattern("plate", contour(slot), (5.0, 5.0))
    outcome = made(machine(OFFSET), (part, sector()))
    (found,) = [finding for finding in outcome.report.findings if finding.code == "narrower-than-kerf"]
    assert found.fatal
    assert found.where is not None
    assert 20.0 <= float(found.where["x"]) <= 20.15


def test_offset_common_lines_close_again() -> None:
    how = replace(machine(OFFSET), common_kerf_mm=KERF_MM)
    outcome = made(how, tuple(PARTS), Nesting((grid(3),)))
    assert outcome.report.passed, outcome.report.findings
    (told,) = [one for one in outcome.report.findings if one.code == "common-lines"]
    assert told.where is not None
    assert_near(
        float(told.where["length_mm"]), 6.0 * 50.0 + 6.0 * 30.0, bound=ROUNDING, why="12 sides, corners rounded"
    )


def test_beside_common_lines_holes_keep_their_leads_and_the_rest_is_said() -> None:
    how = replace(machine(LEADS), common_kerf_mm=KERF_MM)
    outcome = made(how, tuple(PARTS), Nesting((grid(2),)))
    assert outcome.report.passed, outcome.report.findings
    assert {"leads", "helps-and-common-lines"} <= codes(outcome)
    (leads,) = [one for one in outcome.report.findings if one.code == "leads"]
    assert leads.where is not None
    assert leads.where["leads"] == 2 * 4


# Start points


@pytest.mark.parametrize(
    ("rule", "wanted"),
    [
        ("corner", (10.0, 10.0)),
        ("line", (60.0, 10.0)),
        ("left", (10.0, 10.0)),
        ("right", (110.0, 10.0)),
        ("top", (10.0, 70.0)),
        (0.25, (90.0, 10.0)),
        (100.0 / 320.0, (110.0, 10.0)),
    ],
)
def test_contours_begin_where_the_rule_says(rule: str | float, wanted: tuple[float, float]) -> None:
    how = machine(replace(NONE, start=rule))  # type: ignore[arg-type]
    outline = next(one for one in first_sheet(how) if one.layer == "CUT_OUTER")
    assert outline.path is not None
    assert_near(outline.path.vertices[0], wanted, bound=ROUNDING, why="the plate lies at (10, 10)")
    assert_near(area(outline.path), 6000.0, bound=1e-6, why="the same contour")


def test_a_circle_begins_where_the_rule_says() -> None:
    holes = [one for one in first_sheet(machine(replace(NONE, start=0.0))) if one.layer == "CUT_INNER"]
    assert {one.kind for one in holes} == {"LWPOLYLINE"}


# Tabs


@pytest.mark.parametrize("helps", [TABS, replace(TABS, compensated=True)], ids=["nominal", "offset"])
def test_tabs_leave_gaps_of_their_width_and_the_beam(helps: Helps) -> None:
    entities = first_sheet(machine(helps))
    whole = bridged(entities, 0.6)
    cut = [[one.path for one in some if one.layer.startswith("CUT_") and one.path] for some in (entities, whole)]
    assert all(path.closed for path in cut[1])
    assert not any(path.closed for path in cut[0])
    assert len(cut[0]) == 4 * len(cut[1])
    closed = [one for one in first_sheet(machine(replace(helps, tabs=None))) if one.layer.startswith("CUT_")]
    wanted = [abs(area(one.path)) for one in closed if one.path is not None]
    assert_near([abs(area(path)) for path in cut[1]], wanted, bound=1e-5, why="gaps follow the contour; 600 mm around")
    total = sum(map(length, cut[0]))
    assert_near(total, sum(map(length, cut[1])) - 0.6 * len(cut[0]), bound=1e-6, why="0.6 mm each")


def test_only_small_parts_have_tabs_where_that_is_asked_for() -> None:
    small = replace(NONE, tabs=Tabs(0.4, count=3, below_mm=61.0))
    outlines = [one for one in first_sheet(machine(small)) if one.layer == "CUT_OUTER"]
    assert sum(one.closed for one in outlines) == 2
    assert sum(not one.closed for one in outlines) == 3 * 2


def test_tabs_stay_clear_of_bend_lines() -> None:
    bends = tuple(
        Mark("bend", line_mark((x, 0.0), (x, 30.0)).path, "BEND_UP") for x in (10.0, 20.0, 30.0, 40.0, 50.0, 60.0)
    )
    bar = pattern("plate", contour(polygon_edges((0.0, 0.0), (70.0, 0.0), (70.0, 30.0), (0.0, 30.0))), (5.0, 5.0))
    helps = replace(NONE, tabs=Tabs(0.4, spacing_mm=10.0))
    outcome = made(machine(helps), (bar.replace(marks=bends), sector()))
    text = {file.path: file.text for file in outcome.product}["cut/stock-1.dxf"]
    ends = [one.path.vertices[[0, -1]] for one in read(text).entities if one.layer == "CUT_OUTER" and one.path]
    lines = [one.path.vertices for one in read(text).entities if one.layer == "BEND_UP" and one.path]
    away = np.hypot(*(np.concatenate(ends)[:, None] - np.concatenate(lines)[None]).transpose(2, 0, 1))
    assert len(lines) == 2 * 6
    assert away.min() >= 2.0 - ROUNDING


# Leads


def test_leads_stand_beside_their_contours_in_the_order_of_cutting() -> None:
    layers = [one.layer for one in first_sheet(machine(LEADS)) if one.layer in ("LEAD", "CUT_INNER", "CUT_OUTER")]
    assert [layers[k : k + 3][::2] for k in range(0, len(layers), 3)] == [["LEAD", "LEAD"]] * 8


def test_a_lead_into_a_neighbour_makes_the_contour_begin_elsewhere() -> None:
    """Beside the middle of the long sides lie neighbours, 2 mm off: a lead of 3 mm fits the short sides alone."""
    bare = [one.replace(inner=(), marks=()) for one in PARTS]
    row = laid(*(("a", 20.0, 20.0 + 32.0 * k) for k in range(3)))
    helps = replace(NONE, lead_in=Lead("line", 3.0, 90.0), start="line")
    outcome = made(machine(helps), tuple(bare), Nesting((row,)))
    assert outcome.report.passed, outcome.report.findings
    (leads,) = [one for one in outcome.report.findings if one.code == "leads"]
    assert leads.where is not None
    assert (leads.where["leads"], leads.where["moved"]) == (3, 2)


def test_where_no_lead_fits_that_is_said_and_the_part_is_cut() -> None:
    tight = Sheet("stock", 54.0, 34.0)
    bare = [one.replace(inner=(), marks=()) for one in PARTS]
    outcome = made(machine(LEADS), tuple(bare), Nesting((laid(("a", 2.0, 2.0), sheet=tight),)))
    assert outcome.report.passed, outcome.report.findings
    assert "lead-left-out" in codes(outcome)


def cut_length(entities: list[Entity]) -> float:
    return sum(length(one.path) for one in entities if one.layer.startswith("CUT_") and one.path is not None)


def test_leads_change_no_contour() -> None:
    assert_near(cut_length(first_sheet(machine(LEADS))), cut_length(first_sheet(machine(NONE))), bound=1e-7, why="same")


OFF_CHORDS = np.array([1e-3, 2e-3])
"""Points on the chord of an arc may count either way."""


def test_a_mirrored_copy_keeps_its_leads_on_the_waste() -> None:
    """Of the second sheet, which holds a mirrored plate with its holes: none begins on the part."""
    texts = {file.path: file.text for file in usual(LEADS).product}
    entities = read(texts["cut/stock-2.dxf"]).entities
    ways = [one.path for one in entities if one.layer == "LEAD" and one.path is not None]
    contours = [pieces(one.path) for one in entities if one.layer.startswith("CUT_") and one.path is not None]
    ends = np.stack([way.vertices[0 if number % 2 == 0 else -1] for number, way in enumerate(ways)])
    held = sum(inside(ends + OFF_CHORDS, contour).astype(int) for contour in contours)
    assert len(ways) == 6
    assert set(held.tolist()) == {0, 2}


# Length of the cuts and pierces


def part_figures(helps: Helps, path: str = "cut/stock-1.dxf") -> tuple[dict[str, float], dict[str, dict[str, float]]]:
    """Return the figures of a file with plates of 100 x 60 with two holes, and of its parts by themselves."""
    one = Nesting((replace(nesting().layouts[0], placements=nesting().layouts[0].placements[:2]),))
    detail = made(machine(helps), (plate(),), one).report.detail
    return detail["files"][path], detail.get("parts", {}).get(path, {})  # type: ignore[index, attr-defined, no-any-return]


PLAIN_MM = 2.0 * (320.0 + 28.0 * np.pi)
"""Two plates: an outline of 100 x 60, holes of radius 10 and 4."""


@pytest.mark.parametrize(
    ("helps", "long", "pierces"),
    [
        (NONE, PLAIN_MM, 6),
        (LEADS, PLAIN_MM + 6.0 * (3.0 + np.pi), 6),
        (TABS, PLAIN_MM - 6.0 * 4.0 * (0.4 + BEAM_MM), 24),
        (OFFSET, PLAIN_MM + 2.0 * 2.0 * np.pi * (0.1 - 2.0 * 0.1), 6),
        (replace(LEADS, tabs=TABS.tabs), PLAIN_MM + 24.0 * (3.0 + np.pi - 0.6), 24),
    ],
    ids=["none", "line of 3 in, quarter of radius 2 out", "4 tabs", "offset by 0.1", "leads and tabs"],
)
def test_what_is_cut_is_counted_with_leads_and_without_gaps(helps: Helps, long: float, pierces: int) -> None:
    whole, parts = part_figures(helps)
    assert whole["pierces"] == pierces
    assert_near(whole["cut_length_mm"], long, bound=1e-7, why="coordinates rounded to 1e-10 mm")
    if helps is NONE:
        assert parts == {}
    else:
        assert {name: row["copies"] for name, row in parts.items()} == {"plate": 2.0}
        found = [parts["plate"]["cut_length_mm"], parts["plate"]["pierces"]]
        assert_near(found, [whole["cut_length_mm"], pierces], bound=1e-9, why="there is no other part")
