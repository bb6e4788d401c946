"""What finished jobs are nested on: a file of stock, or the stock that the first of them was nested on.

A file of stock is a job file without parts: `[[stock]]`, `[nest]`, `[process]`, `[dxf]`, `[report]`.  A row that states
material or thickness serves the groups of that material or thickness only, any other row every group.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Literal

from msgspec import Meta, field

from pipeline.dxftables import DxfTable, machine_of
from pipeline.helps import help_troubles, helps_of
from pipeline.jobfile import Given, ReportTable, read_as
from pipeline.jobrules import repeated
from pipeline.materials import are_same
from pipeline.processes import limits
from pipeline.processtables import ProcessTable
from pipeline.rates import Rates, rates_of
from pipeline.stock import options_of, stock_of
from pipeline.stocktables import NestTable, StockTable
from stages.model.caps import MOST_STOCK
from stages.model.curves import Table, Trouble
from stages.model.cutfile import Machine
from stages.model.material import Material
from stages.model.report import Finding
from stages.model.sheet import NestOptions, Sheet


class StockFile(Table, frozen=True, kw_only=True):
    """A file of stock."""

    schema: Literal[1]
    stock: Annotated[tuple[StockTable, ...], Meta(min_length=1, max_length=MOST_STOCK)]
    units: Literal["mm", "cm", "m", "in"] = "mm"
    nest: NestTable = field(default_factory=NestTable)
    process: ProcessTable = ProcessTable()
    dxf: DxfTable = DxfTable()
    report: ReportTable = ReportTable()

    def troubles(self) -> Iterator[Trouble]:
        """Yield names that occur twice, and helps that do not go together."""
        yield from repeated("stock", "id", [stock.name for stock in self.stock])
        yield from help_troubles(self.process, self.dxf, self.nest, self.stock, None)
        if self.nest.layout is not None:
            yield Trouble("nest.layout", "a layout is that of one job", "leave it out: all parts are placed anew")


@dataclass(frozen=True, slots=True)
class Row:
    """One kind of stock, and what it is made of as far as that is stated."""

    sheet: Sheet
    material: str | None = None
    thickness_mm: float | None = None

    def serves(self, material: str, thickness_mm: float | None) -> bool:
        """Return whether parts of a material and a thickness may be cut from it."""
        return (not self.material or are_same(self.material, material)) and self.thickness_mm in (None, thickness_mm)


@dataclass(frozen=True, slots=True)
class Supply:
    """Stock, and how it is to be nested, cut and paid for.

    origin: the file or the job that it comes from.  inputs: name and sha256 of what was read for it.
    repairs: what of it had to be put right.
    """

    origin: str
    rows: tuple[Row, ...]
    options: NestOptions
    machine: Machine
    rates: Rates
    formats: tuple[str, ...]
    inputs: tuple[tuple[str, str], ...] = ()
    notes: tuple[str, ...] = ()
    repairs: tuple[Finding, ...] = ()

    def doubled(self) -> list[str]:
        """Return the stock of which there is a number, and of which no material or thickness is stated."""
        return [
            row.sheet.id
            for row in self.rows
            if row.sheet.quantity is not None and not row.material and row.thickness_mm is None
        ]

    def serving(self, material: str, thickness_mm: float | None) -> tuple[Sheet, ...]:
        """Return the stock for a material and a thickness."""
        return tuple(row.sheet for row in self.rows if row.serves(material, thickness_mm))


def supply_of(file: Path, allow: Sequence[Path] = ()) -> Supply:
    """Return what a file of stock gives; `BadInputError` with every problem, each with its place.

    allow: folders that the files which it names may lie in, beside its own.
    """
    tables, sources, inputs = read_as(StockFile, file, given=Given(allow=tuple(allow)))
    stock = stock_of(tables.stock, None)
    known = limits(tables.process, None).get("kerf")
    kerf = None if known is None else known.value
    return Supply(
        origin=file.name,
        rows=tuple(_rows(tables.stock, stock.sheets)),
        options=options_of(tables.nest, kerf),
        machine=replace(machine_of(tables.dxf), helps=helps_of(tables.process, kerf, Material())),
        rates=rates_of(tables.process, tables.nest),
        formats=tables.report.formats,
        inputs=inputs,
        notes=(*sources.notes, *stock.told),
        repairs=stock.repairs,
    )


def _rows(tables: Sequence[StockTable], sheets: Sequence[Sheet]) -> Iterator[Row]:
    for table, sheet in zip(tables, sheets, strict=True):
        yield Row(sheet, table.material, None if table.thickness is None else float(table.thickness))
