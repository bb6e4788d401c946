"""Bend table, roll schedule and table of holes of a part, from its report."""

from collections.abc import Iterator

from pipeline.report.shopentries import DetailEntry, FlatEntry, PartEntry
from pipeline.report.traveller.flow import Column, Row, Table
from pipeline.report.traveller.numbers import DASH, degrees, millimetres, square
from pipeline.sidelines import BendRow, Radii, RollRow

NUMBER_MM = 12.0
FLAT = "flat"


def forming_tables(part: PartEntry, width_mm: float) -> Iterator[Table]:
    """Yield the tables of a part that have any rows."""
    for stage in part.stages:
        if stage.detail.bends:
            yield _bend_table(stage.detail, width_mm)
        if stage.detail.rolls:
            yield _roll_table(stage.detail, width_mm)
    if part.flat is not None and (part.flat.holes or part.flat.marks):
        yield _place_table(part.flat, width_mm)


def _k_note(detail: DetailEntry) -> str:
    k = None if detail.thickness is None else detail.thickness.k_factor
    return "" if k is None else f" K = {k:.4g}."


def _bend_table(detail: DetailEntry, width_mm: float) -> Table:
    """Return the bend table, in the order of the lines on the blank."""
    rest = width_mm - NUMBER_MM - 34.0
    columns = (
        Column("no.", NUMBER_MM),
        Column("line", 34.0),
        Column("to", rest * 0.10),
        Column("angle", rest * 0.14, "right", "\N{DEGREE SIGN}"),
        Column("inside radius", rest * 0.26, "right", "mm"),
        Column("pitch to the next", rest * 0.28, "right", "mm"),
        Column("facet error", rest * 0.22, "right", "mm"),
    )
    rows = tuple(Row(_bend_cells(number, bend)) for number, bend in enumerate(detail.bends, 1))
    note = f"From the first ruling on; up is towards you. Two values: at edge c0 and at edge c1.{_k_note(detail)}"
    return Table("Bend", columns, rows, note)


def _bend_cells(number: int, bend: BendRow) -> tuple[str, ...]:
    radius = "fold" if bend.fold else _pair(bend.radius_mm)
    pitch = DASH if bend.pitch_mm is None else _pair(bend.pitch_mm)
    return (
        str(number), bend.name, bend.side, degrees(bend.angle_deg), radius, pitch, millimetres(bend.facet_error_mm),
    )  # fmt: skip


def _roll_table(detail: DetailEntry, width_mm: float) -> Table:
    """Return the roll schedule."""
    rest = width_mm - NUMBER_MM
    columns = (
        Column("no.", NUMBER_MM),
        Column("fed by", rest * 0.16, "right", "mm"),
        Column("to", rest * 0.10),
        Column("inside radius", rest * 0.26, "right", "mm"),
        Column("roll to", rest * 0.26, "right", "mm"),
        Column("cone tilt", rest * 0.22, "right", "\N{DEGREE SIGN}"),
    )
    rows = tuple(Row(_roll_cells(number, roll)) for number, roll in enumerate(detail.rolls, 1))
    by = sorted({roll.tool_radius_by for roll in detail.rolls if roll.tool_radius_by})
    springback = f" Roll to, by springback: {'; '.join(by)}." if by else ""
    sharp = "".join(sorted({f" {roll.note[:1].upper()}{roll.note[1:]}." for roll in detail.rolls if roll.note}))
    note = (
        "Fed across the rulings from the first on. Two values: at edge c0 and at edge c1."
        f"{springback}{_k_note(detail)}{sharp}"
    )
    return Table("Roll", columns, rows, note)


def _roll_cells(number: int, roll: RollRow) -> tuple[str, ...]:
    return (
        str(number), millimetres(roll.distance_mm), roll.side, _pair(roll.radius_mm), _tools(roll),
        degrees(roll.cone_tilt_deg),
    )  # fmt: skip


def _tools(roll: RollRow) -> str:
    """Return the radius to roll to at both edges: flat where the part is, a dash where no tool leaves its radius."""
    if roll.tool_radius_mm is None:
        return DASH
    ends = zip(roll.radius_mm, roll.tool_radius_mm, strict=True)
    return _once(*(_length(tool, DASH if radius is not None else FLAT) for radius, tool in ends))


def _pair(values: Radii) -> str:
    """Return a value at both edges; flat where there is no radius."""
    return _once(*(_length(value, FLAT) for value in values))


def _length(value: float | None, without: str) -> str:
    return without if value is None else millimetres(value)


def _once(first: str, last: str) -> str:
    """Return what is written at both edges, once where it is the same."""
    return first if first == last else f"{first} / {last}"


def _place_table(flat: FlatEntry, width_mm: float) -> Table:
    """Return holes and marks with their places."""
    columns = (
        Column("name", width_mm * 0.4),
        Column("x", width_mm * 0.2, "right", "mm"),
        Column("y", width_mm * 0.2, "right", "mm"),
        Column("area", width_mm * 0.2, "right"),
    )
    holes = [Row((one.name, millimetres(one.x), millimetres(one.y), square(one.area))) for one in flat.holes]
    marks = [Row((one.name, millimetres(one.x), millimetres(one.y), DASH)) for one in flat.marks]
    note = "In the frame of the flat pattern: x to the right, y up, as it is drawn unturned."
    return Table("Holes and marks", columns, (*holes, *marks), note)
