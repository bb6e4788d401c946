"""What the cost of a nest is reckoned with: how fast the cutter is, and what an offcut is worth.

The tables of processes hold no speeds: they depend on the machine and its power as much as on the sheet.  A job gives
its own, and where it gives none no time is told.
"""

from dataclasses import dataclass

from pipeline.processtables import ProcessTable
from pipeline.stocktables import NestTable


@dataclass(frozen=True, slots=True)
class Rates:
    """Rates of a shop; None: not known.

    speed_mm_min: way of the cutter in a minute.  pierce_time_s: for each cut begun.
    offcut_credit: worth of an offcut as a share of the price of its area, 0 to 1.
    """

    speed_mm_min: float | None = None
    pierce_time_s: float | None = None
    offcut_credit: float = 0.0


def rates_of(process: ProcessTable, nest: NestTable) -> Rates:
    """Return the rates that a job gives."""
    return Rates(
        None if process.speed is None else float(process.speed),
        None if process.pierce_time is None else float(process.pierce_time),
        float(nest.offcut_credit),
    )
