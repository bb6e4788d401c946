"""The cost of a nest: closed forms, sums that agree, and what is not known stays unknown."""

import dataclasses
from math import pi

import numpy as np
import pytest

from pipeline.rates import Rates
from pipeline.report.costs import Costs, cost_line, costs, costs_entry
from pipeline.report.cuts import UNKNOWN, Cuts, cuts_of_copies, cuts_of_files
from stages.geometry.curves.rigid import Rigid2
from stages.model.pattern import FlatPattern
from stages.model.report import StageReport
from stages.model.sheet import Placement, Rectangle, Sheet, SheetLayout
from tests.near import assert_near
from tests.stages.nest.shapes import circle, contour, pattern, rectangle

SHEET = Sheet("plate", 1000.0, 500.0, price=20.0)
ROLL = Sheet("coil", np.inf, 500.0, price=30.0, kind="roll")
OFFCUT = Rectangle(600.0, 0.0, 400.0, 500.0)
RATES = Rates(speed_mm_min=3000.0, pierce_time_s=0.5, offcut_credit=0.25)
SQUARE = rectangle("square", 100.0, 100.0, 2)
HOLED = pattern("holed", contour([(0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0)]), circle(20.0, hole=True))
PATTERNS: dict[str, FlatPattern] = {one.part: one for one in (SQUARE, HOLED)}
CUTS = Cuts(1200.0 + 40.0 * pi, 4)


def layout(sheet: Sheet = SHEET, offcut: Rectangle | None = OFFCUT, index: int = 1) -> SheetLayout:
    names = (("square", 1), ("square", 2), ("holed", 1))
    copies = tuple(Placement(part, copy, Rigid2(150.0 * i)) for i, (part, copy) in enumerate(names))
    return SheetLayout(sheet, index, copies, 0.1, offcut)


def reckoned(*layouts: SheetLayout, rates: Rates = RATES) -> Costs:
    return costs(layouts, PATTERNS, [CUTS] * len(layouts), rates)


def test_an_offcut_is_worth_its_share_of_the_price_by_area() -> None:
    (one,) = reckoned(layout()).sheets
    assert (one.price, one.credit, one.net) == (20.0, 0.25 * 20.0 * 0.4, 18.0)
    (none,) = reckoned(layout(offcut=None)).sheets
    assert (none.credit, none.net) == (0.0, 20.0)


def test_a_roll_costs_the_metres_that_are_used() -> None:
    (one,) = reckoned(layout(ROLL, None)).sheets
    assert one.price is not None
    assert_near(one.price, 30.0 * 0.4, bound=1e-12, why="the last part ends at 400 mm")


def test_time_is_length_over_speed_and_pierces() -> None:
    made = reckoned(layout(), layout(index=2))
    seconds = made.cuts.seconds(RATES)
    assert seconds is not None
    assert_near(seconds, 2.0 * ((1200.0 + 40.0 * pi) / 50.0 + 2.0), bound=1e-9, why="closed form")


def test_parts_share_a_sheet_by_their_areas() -> None:
    made = reckoned(layout())
    square, holed = made.parts
    net, hole = 18.0, 400.0 * pi
    assert (square.part, square.copies, holed.part, holed.copies) == ("square", 2, "holed", 1)
    share = 20000.0 / (30000.0 - hole)
    found = [square.sheets, square.price, square.credit, square.net]
    assert_near(found, [share, 20.0 * share, 2.0 * share, net * share], bound=1e-12, why="closed form")
    assert (square.cuts.pierces, holed.cuts.pierces) == (2, 2)
    assert holed.cuts.length_mm is not None
    assert_near(holed.cuts.length_mm, 400.0 + 40.0 * pi, bound=1e-12, why="closed form")


@pytest.mark.parametrize("sheets", [1, 3])
def test_the_parts_together_cost_what_the_sheets_cost(sheets: int) -> None:
    made = reckoned(*(layout(index=i) for i in range(1, sheets + 1)))
    rows = [(part.sheets, part.price, part.credit, part.net, part.cuts.length_mm) for part in made.parts]
    whole = [sheets, made.price, made.credit, made.net, made.cuts.length_mm]
    assert_near(np.sum(np.array(rows, dtype=float), axis=0), whole, bound=1e-9, why="rounding; no cut is shared")


def test_what_is_not_known_stays_unknown_and_nothing_else() -> None:
    free = dataclasses.replace(layout(), sheet=SHEET.replace(price=None))
    entry = costs_entry(reckoned(free, layout(index=2), rates=Rates(speed_mm_min=3000.0)))
    assert entry["total"] == {
        "sheets": 2, "price": None, "offcut_credit": 0.0, "net": None,
        "cut_length_mm": 2 * (CUTS.length_mm or 0.0), "pierces": 8, "time_s": None,
    }  # fmt: skip
    unwritten = costs([layout()], PATTERNS, [UNKNOWN], RATES)
    assert (unwritten.price, unwritten.cuts, unwritten.cuts.seconds(RATES)) == (20.0, UNKNOWN, None)
    assert reckoned(free).credit is None, "an offcut of a sheet of no price has no worth that is known"


def test_cuts_are_those_of_the_files_as_read_back() -> None:
    report = StageReport("write", "x", detail={"files": {"cut/a-1.dxf": {"cut_length_mm": 12.5, "pierces": 2.0}}})
    assert cuts_of_files(report, ["cut/a-1.dxf", "cut/a-2.dxf"]) == [Cuts(12.5, 2.0), UNKNOWN]
    assert cuts_of_files(StageReport("write", "x"), ["cut/a-1.dxf"]) == [UNKNOWN]


def helped(files: dict[str, dict[str, Cuts]]) -> StageReport:
    """Return a report on files whose parts have those cuts, each of two copies."""
    rows = {
        path: {
            part: {"cut_length_mm": cuts.length_mm, "pierces": cuts.pierces, "copies": 2.0}
            for part, cuts in parts.items()
        }
        for path, parts in files.items()
    }
    return StageReport("write", "x", detail={"parts": rows})


def test_parts_with_leads_and_tabs_take_what_their_paths_in_the_files_take() -> None:
    report = helped({"cut/a-1.dxf": {"square": Cuts(820.0, 8.0)}, "cut/a-2.dxf": {"square": Cuts(816.0, 8.0)}})
    one = cuts_of_copies(report)
    assert one == {"square": Cuts(1636.0 / 4.0, 4.0)}
    square, holed = costs([layout()], PATTERNS, [CUTS], RATES, one).parts
    assert square.cuts == Cuts(2.0 * 409.0, 8)
    assert holed.cuts.pierces == 2, "no helps in the files: its contours"
    assert costs([layout()], PATTERNS, [CUTS], RATES, {"square": UNKNOWN}).parts[0].cuts == UNKNOWN
    assert cuts_of_copies(StageReport("write", "x")) == {}


@pytest.mark.parametrize(
    ("made", "words"),
    [
        (
            reckoned(layout()),
            "price 20.00, offcuts worth 2.00, net 18.00, cut 1.326 m, 4 pierces, time 0:29 min",
        ),
        (reckoned(layout(), rates=Rates()), "price 20.00, cut 1.326 m, 4 pierces, time not known (speed and pierce_"),
        (reckoned(layout(SHEET.replace(price=None))), "price not known (price under [[stock]])"),
        (
            reckoned(layout(), layout(SHEET.replace(id="old", price=None))),
            'price of "old" not known (price under [[stock]])',
        ),
        (costs([layout()], PATTERNS, [Cuts(1.0, 1.0)], RATES), "cut 0.001 m, 1 pierce, time"),
    ],
)
def test_the_terminal_says_the_cost_and_what_is_not_known(made: Costs, words: str) -> None:
    assert words in cost_line(made)
