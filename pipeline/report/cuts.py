"""The cuts of sheets and parts of a nest, as files were read back: how long, how many, how much time they take."""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import fsum
from typing import TYPE_CHECKING

from pipeline.files import FileNames
from pipeline.rates import Rates

if TYPE_CHECKING:
    from stages.model.report import StageReport
    from stages.model.sheet import SheetLayout

SECONDS_PER_MINUTE = 60.0


@dataclass(frozen=True, slots=True)
class Cuts:
    """Cuts of a sheet or of a part: length in mm, how many; None: not known."""

    length_mm: float | None
    pierces: float | None

    def seconds(self, rates: Rates) -> float | None:
        """Return the time that they take."""
        if self.length_mm is None or self.pierces is None or rates.speed_mm_min is None or rates.pierce_time_s is None:
            return None
        return self.length_mm / rates.speed_mm_min * SECONDS_PER_MINUTE + self.pierces * rates.pierce_time_s


UNKNOWN = Cuts(None, None)


def cuts_of_copies(report: "StageReport") -> dict[str, Cuts]:
    """Return the cuts of one copy of each part as files with helps were read back, the mean over all copies."""
    files = report.detail.get("parts")
    rows: defaultdict[str, list[Mapping[str, float]]] = defaultdict(list)
    for parts in files.values() if isinstance(files, dict) else ():
        for part, row in parts.items():
            rows[part].append(row)
    found = {}
    for part, some in rows.items():
        long, pierces, copies = (fsum(row[key] for row in some) for key in ("cut_length_mm", "pierces", "copies"))
        found[part] = Cuts(long / copies, pierces / copies)
    return found


def cuts_of_sheets(report: "StageReport", layouts: "Sequence[SheetLayout]", names: FileNames) -> list[Cuts]:
    """Return the cuts of sheets, as their files, or those of the parts on them, were read back."""
    sheets = report.detail.get("sheets")
    if isinstance(sheets, list):
        return [Cuts(one["cut_length_mm"], one["pierces"]) for one in sheets]
    if names.machine.file_per == "part":
        return [_together(cuts_of_files(report, names.part_drawings(layout))) for layout in layouts]
    return cuts_of_files(report, [names.drawing(layout) or "" for layout in layouts])


def cuts_of_files(report: "StageReport", paths: Iterable[str]) -> list[Cuts]:
    """Return the cuts of files as they were read back; not known for files that were not written."""
    files = report.detail.get("files")
    read = files if isinstance(files, dict) else {}
    return [Cuts(read[path]["cut_length_mm"], read[path]["pierces"]) if path in read else UNKNOWN for path in paths]


def _together(some: Sequence[Cuts]) -> Cuts:
    return Cuts(whole(one.length_mm for one in some), whole(one.pierces for one in some))


def whole(values: Iterable[float | None]) -> float | None:
    """Return the sum, None if one of the values is not known."""
    listed = list(values)
    known = [value for value in listed if value is not None]
    return fsum(known) if len(known) == len(listed) else None
