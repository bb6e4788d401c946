"""What of its stock a nested sheet takes: for the report, the terminal and the pictures."""

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from pipeline.report.traveller.numbers import counted

if TYPE_CHECKING:
    from pipeline.run import JobResult
    from stages.model.pattern import FlatPattern
    from stages.model.sheet import SheetLayout

MM_PER_M = 1000.0
MOST_LINES = 12
"""Sheets of which the terminal tells; the report holds them all."""


def stock_figures(layout: "SheetLayout", patterns: "Mapping[str, FlatPattern]") -> dict[str, object]:
    """Return kind, used length of a roll, what is left over, and cost; None for what is not known or not there."""
    free = layout.offcut
    return {
        "kind": layout.sheet.kind,
        "used_length_mm": used_of_roll(layout, patterns),
        "offcut": None
        if free is None
        else {"x": free.x, "y": free.y, "width_mm": free.width_mm, "height_mm": free.height_mm},
        "cost": cost(layout, patterns),
    }


def used_of_roll(layout: "SheetLayout", patterns: "Mapping[str, FlatPattern]") -> float | None:
    """Return how much of a roll is used, mm; None for other stock, which is used whole."""
    from stages.model.used import used_length_mm

    return used_length_mm(layout, patterns) if layout.sheet.is_roll else None


def cost(layout: "SheetLayout", patterns: "Mapping[str, FlatPattern]") -> float | None:
    """Return the price of the sheet, or of the used metres of a roll; None where the stock has no price."""
    price, used = layout.sheet.price, used_of_roll(layout, patterns)
    return price if price is None or used is None else price * used / MM_PER_M


def sheet_lines(result: "JobResult") -> Iterator[str]:
    """Return a line for each nested sheet of a job."""
    patterns = {run.part.name: run.pattern for run in result.parts if run.pattern is not None}
    return layout_lines(() if result.nest.product is None else result.nest.product.layouts, patterns)


def layout_lines(layouts: "Sequence[SheetLayout]", patterns: "Mapping[str, FlatPattern]") -> Iterator[str]:
    """Yield a line for each sheet: what it is, what lies on it, what is used of it and what is left over."""
    for layout in layouts[:MOST_LINES]:
        yield "  ".join(["sheet", *_words(layout, patterns)])
    if len(layouts) > MOST_LINES:
        yield f"sheet  and {len(layouts) - MOST_LINES} more: see report.json"


def _words(layout: "SheetLayout", patterns: "Mapping[str, FlatPattern]") -> Iterator[str]:
    used, free = used_of_roll(layout, patterns), layout.offcut
    yield f"{layout.sheet.id} {layout.index}"
    if layout.sheet.kind != "sheet":
        yield layout.sheet.kind
    yield counted(len(layout.placements), "piece")
    yield f"utilisation {100.0 * layout.utilisation:.1f} %"
    if used is not None:
        yield f"used {used:.6g} mm"
    if free is not None:
        yield f"left over {free.width_mm:.6g} x {free.height_mm:.6g} mm"
