"""Helps for the process in cut files: in every flavour, as read again; start points, tabs, and what is cut in all."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from stages.geometry.arrays import Points2
from stages.geometry.curves.rigid import Rigid2, matrix
from stages.geometry.paths.arcpath import ArcPath, area, length
from stages.model.cutfile import Machine
from stages.model.helps import Helps, StartRule, Tabs
from stages.model.pattern import FlatPattern, Mark
from stages.model.sheet import Nesting, Placement, Sheet, SheetLayout
from stages.write.bridged import bridged
from stages.write.helpplans import Plan, plan
from stages.write.readback import read
from tests.near import assert_near
from tests.stages.write.helpcases import (
    ALL,
    BEAM_MM,
    EVERY,
    FLAVOURS,
    LEADS,
    NONE,
    OFFSET,
    ROUNDING,
    TABS,
    codes,
    first_sheet,
    machine,
    made,
    usual,
)
from tests.stages.write.patterns import contour, line_mark, nesting, pattern, plate, polygon_edges, sector


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


def test_tabs_closer_than_there_is_room_for_are_said_to_be_missing() -> None:
    outcome = made(machine(replace(NONE, tabs=Tabs(0.4, spacing_mm=1e-9))), (plate(), sector()))
    (told,) = [one for one in outcome.report.findings if one.code == "tabs" and "stock-2" in one.message]
    assert told.where is not None
    assert 0 < int(told.where["tabs"]) < 320.0 / (0.4 + BEAM_MM)
    assert "tab-left-out" in codes(outcome)


TURNS = (0.0, 17.0, 90.0, 213.0)


def turned_copies(helps: Helps, *, mirrored: bool, part: FlatPattern) -> list[list[Points2]]:
    """Return where each copy is cut, turned back into the frame of its part: the vertices of its paths."""
    places = [
        Placement("plate", k + 1, Rigid2(150.0 + 250.0 * k, 150.0, turn, mirrored)) for k, turn in enumerate(TURNS)
    ]
    layout = SheetLayout(Sheet("stock", 1100.0, 300.0), 1, tuple(places), 0.2)
    outcome = made(machine(helps), (part,), Nesting((layout,)))
    assert outcome.report.passed, outcome.report.findings
    text = {file.path: file.text for file in outcome.product}["cut/stock-1.dxf"]
    cut = [one.path for one in read(text).entities if one.layer in ("LEAD", "CUT_INNER", "CUT_OUTER") and one.path]
    rows = np.array_split(np.arange(len(cut)), len(TURNS))
    return [
        [(cut[number].vertices - [one.motion.x, one.motion.y]) @ matrix(one.motion) for number in row]
        for one, row in zip(places, rows, strict=True)
    ]


@pytest.mark.parametrize("mirrored", [False, True], ids=["as drawn", "mirrored"])
@pytest.mark.parametrize("helps", [TABS, LEADS, replace(TABS, lead_in=LEADS.lead_in)], ids=["tabs", "leads", "both"])
def test_copies_of_a_part_are_cut_alike_however_they_are_turned(helps: Helps, mirrored: bool) -> None:
    first, *others = turned_copies(helps, mirrored=mirrored, part=plate())
    for other in others:
        for one, same in zip(first, other, strict=True):
            assert_near(same, one, bound=ROUNDING, why="the same places of the part")


@pytest.mark.parametrize(("start", "plans"), [("corner", 3), ("left", 4 * 3)])
def test_copies_have_one_plan_unless_the_rule_names_a_side_of_the_sheet(
    monkeypatch: pytest.MonkeyPatch, start: StartRule, plans: int
) -> None:
    """Four copies of a plate with two holes, each turned in another way."""
    made_for: list[ArcPath] = []

    def counted(contour: ArcPath, *args: Any, **keys: Any) -> Plan:
        made_for.append(contour)
        return plan(contour, *args, **keys)

    monkeypatch.setattr("stages.write.helps.plan", counted)
    turned_copies(replace(LEADS, start=start), mirrored=False, part=plate())
    assert len(made_for) == plans


def test_whether_a_part_is_small_does_not_depend_on_how_it_lies() -> None:
    """A bar of 100 x 10 is 78 high where it lies at 45 degrees; it has a side of 10 all the same."""
    bar = pattern("plate", contour(polygon_edges((0.0, 0.0), (100.0, 0.0), (100.0, 10.0), (0.0, 10.0))), (50.0, 5.0))
    counts = [
        len(copy)
        for copy in turned_copies(replace(NONE, tabs=Tabs(0.4, count=3, below_mm=11.0)), mirrored=False, part=bar)
    ]
    assert counts == [3] * len(TURNS)


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
