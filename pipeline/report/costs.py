"""What a nest costs: per sheet and per part the stock that is used, what an offcut is worth, cuts, pierces and time.

    net of a sheet     its price (of a roll: of the metres used) less `offcut_credit` x the price of its offcut's area
    share of a part    for each copy what its area is of that of all parts on its sheet: of the sheet, its price and net
    time               length of the cuts / speed + pierces x pierce_time; travel between the cuts is not counted

Lengths and pierces of a sheet are those of its file as read back: leads are cut, gaps of tabs are not.  Those of a part
are of its own contours, or with helps for the process of its paths in the files, so that together they are more where
neighbours share a cut.  What is not known is None, and whatever follows from it is too.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import fsum
from typing import TYPE_CHECKING

from pipeline.files import file_names
from pipeline.rates import Rates
from pipeline.report.cuts import SECONDS_PER_MINUTE, Cuts, cuts_of_copies, cuts_of_sheets, whole
from pipeline.report.figures import figures
from pipeline.report.stockfigures import MM_PER_M, cost
from pipeline.report.traveller.numbers import counted

if TYPE_CHECKING:
    from pipeline.run import JobResult
    from stages.model.pattern import FlatPattern
    from stages.model.sheet import Sheet, SheetLayout

Document = dict[str, object]
NOBODY: Mapping[str, Cuts] = {}


@dataclass(frozen=True, slots=True)
class SheetCost:
    """One sheet: its price, what its offcut is worth, and its cuts."""

    layout: "SheetLayout"
    price: float | None
    credit: float | None
    cuts: Cuts

    @property
    def net(self) -> float | None:
        """The price less the worth of the offcut."""
        return None if self.price is None or self.credit is None else self.price - self.credit


Share = tuple[float, SheetCost]
"""What a copy has of a sheet, and the sheet."""


@dataclass(frozen=True, slots=True)
class PartCost:
    """All copies of one part: their share of the sheets, of price and worth of the offcuts, and their cuts."""

    part: str
    copies: int
    sheets: float
    price: float | None
    credit: float | None
    net: float | None
    cuts: Cuts


@dataclass(frozen=True, slots=True)
class Costs:
    """The cost of a nest."""

    sheets: tuple[SheetCost, ...]
    parts: tuple[PartCost, ...]
    rates: Rates

    @property
    def price(self) -> float | None:
        """Of all sheets."""
        return whole(one.price for one in self.sheets)

    @property
    def credit(self) -> float | None:
        """Of all offcuts."""
        return whole(one.credit for one in self.sheets)

    @property
    def net(self) -> float | None:
        """Of all sheets less all offcuts."""
        return whole(one.net for one in self.sheets)

    @property
    def cuts(self) -> Cuts:
        """Of all sheets."""
        return Cuts(whole(one.cuts.length_mm for one in self.sheets), whole(one.cuts.pierces for one in self.sheets))


def job_costs(result: "JobResult") -> Costs | None:
    """Return the cost of a nested job; None where nothing was nested."""
    if result.nest.product is None:
        return None
    layouts, names = result.nest.product.layouts, file_names(result.parts, result.job)
    patterns = {run.part.name: run.pattern for run in result.parts if run.pattern is not None}
    written = cuts_of_sheets(result.write.report, layouts, names)
    return costs(layouts, patterns, written, result.job.rates, cuts_of_copies(result.write.report))


def costs(
    layouts: "Sequence[SheetLayout]",
    patterns: "Mapping[str, FlatPattern]",
    written: Sequence[Cuts],
    rates: Rates,
    helped: Mapping[str, Cuts] = NOBODY,
) -> Costs:
    """Return the cost of a nest.

    patterns: by their names; written: the cuts of each sheet's file; helped: of one copy of a part with helps.
    """
    sheets = tuple(
        SheetCost(layout, cost(layout, patterns), _credit(layout, rates), cuts)
        for layout, cuts in zip(layouts, written, strict=True)
    )
    return Costs(sheets, _parts(sheets, patterns, helped), rates)


def _credit(layout: "SheetLayout", rates: Rates) -> float | None:
    """Return what the offcut of a sheet is worth; 0 without an offcut."""
    if layout.offcut is None or rates.offcut_credit == 0.0:
        return 0.0
    price = _price_of_area(layout.sheet)
    area = layout.offcut.width_mm * layout.offcut.height_mm
    return None if price is None else rates.offcut_credit * price * area


def _price_of_area(sheet: "Sheet") -> float | None:
    """Return the price of a square mm of a rectangle or of a roll, edges included; None where it is not known."""
    if sheet.price is None:
        return None
    return sheet.price / (sheet.height_mm * (MM_PER_M if sheet.is_roll else sheet.width_mm))


def _parts(
    sheets: Sequence[SheetCost], patterns: "Mapping[str, FlatPattern]", helped: Mapping[str, Cuts]
) -> tuple[PartCost, ...]:
    """Return the cost of every part that lies on some sheet, in the order of the patterns."""
    areas = {name: _net_area(pattern) for name, pattern in patterns.items()}
    shares: defaultdict[str, list[Share]] = defaultdict(list)
    for sheet in sheets:
        names = [placed.part for placed in sheet.layout.placements]
        all_of_them = fsum(areas[name] for name in names)
        for name in names:
            shares[name].append((areas[name] / all_of_them, sheet))
    return tuple(_part(pattern, shares[name], helped.get(name)) for name, pattern in patterns.items() if shares[name])


def _net_area(pattern: "FlatPattern") -> float:
    """Return the area of a part without its holes, mm2: outer contours are positive, inner ones negative."""
    from stages.geometry.paths.arcpath import area

    return fsum(area(contour.path) for contour in (pattern.outer, *pattern.inner))


def _part(pattern: "FlatPattern", shares: Sequence[Share], helped: Cuts | None) -> PartCost:
    """Return the cost of as many copies of a part as there are shares."""
    count = len(shares)
    one = figures(pattern, 0.0)
    long, pierces = (one.cut_length_mm, one.pierces) if helped is None else (helped.length_mm, helped.pierces)
    cuts = Cuts(_of(count, long), None if pierces is None else round(count * pierces))
    return PartCost(
        pattern.part,
        count,
        fsum(share for share, _ in shares),
        whole(_of(share, sheet.price) for share, sheet in shares),
        whole(_of(share, sheet.credit) for share, sheet in shares),
        whole(_of(share, sheet.net) for share, sheet in shares),
        cuts,
    )


def _of(share: float, amount: float | None) -> float | None:
    """Return a share of an amount, or so many times it; None where it is not known."""
    return None if amount is None else share * amount


def costs_entry(made: Costs) -> Document:
    """Return the table as a report has it."""
    rates = made.rates
    return {
        "rates": {
            "speed_mm_min": rates.speed_mm_min,
            "pierce_time_s": rates.pierce_time_s,
            "offcut_credit": rates.offcut_credit,
        },
        "sheets": [
            {
                "stock": one.layout.sheet.id,
                "index": one.layout.index,
                "price": one.price,
                "offcut_credit": one.credit,
                "net": one.net,
                **_cuts_entry(one.cuts, rates),
            }
            for one in made.sheets
        ],
        "parts": [
            {
                "part": one.part,
                "copies": one.copies,
                "sheets": one.sheets,
                "price": one.price,
                "offcut_credit": one.credit,
                "net": one.net,
                **_cuts_entry(one.cuts, rates),
            }
            for one in made.parts
        ],
        "total": {
            "sheets": len(made.sheets),
            "price": made.price,
            "offcut_credit": made.credit,
            "net": made.net,
            **_cuts_entry(made.cuts, rates),
        },
    }


def _cuts_entry(cuts: Cuts, rates: Rates) -> Document:
    pierces = None if cuts.pierces is None else int(cuts.pierces)
    return {"cut_length_mm": cuts.length_mm, "pierces": pierces, "time_s": cuts.seconds(rates)}


def cost_lines(result: "JobResult") -> list[str]:
    """Return the line of a nested job, none of another."""
    made = job_costs(result)
    return [] if made is None else [cost_line(made)]


def cost_line(made: Costs) -> str:
    """Return the cost in one line for the terminal; what is not known, and how it could be, is said."""
    cuts = made.cuts
    words = [counted(len(made.sheets), "sheet")]
    if made.net is None or made.price is None:
        words.append(f"price{_priceless(made.sheets)} not known (price under [[stock]])")
    else:
        words.append(f"price {made.price:.2f}")
        words += [f"offcuts worth {made.credit:.2f}, net {made.net:.2f}"] if made.credit else []
    if cuts.length_mm is not None and cuts.pierces is not None:
        words.append(f"cut {cuts.length_mm / MM_PER_M:.3f} m, {counted(round(cuts.pierces), 'pierce')}")
    seconds = cuts.seconds(made.rates)
    unknown = "time not known (speed and pierce_time under [process])"
    words.append(unknown if seconds is None else f"time {_clock(seconds)}")
    return f"cost  {', '.join(words)}"


def _priceless(sheets: Sequence[SheetCost]) -> str:
    """Return of which stock no price is given, where there is one of other stock."""
    names = dict.fromkeys(f'"{one.layout.sheet.id}"' for one in sheets if one.price is None)
    return f" of {', '.join(names)}" if any(one.price is not None for one in sheets) else ""


def _clock(seconds: float) -> str:
    """Return a time in minutes and seconds."""
    minutes, rest = divmod(round(seconds), round(SECONDS_PER_MINUTE))
    return f"{minutes}:{rest:02d} min"
