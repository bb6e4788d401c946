"""Where the drawings of a job lie below its output folder, and what they call its parts and stock.

A part goes by its own name in the report.  In drawings and file names it goes by a name that every system takes
(`store.safe_names`), so that what is etched on a part is also the name of its file.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from pipeline.job import Job
from pipeline.store import safe_names

if TYPE_CHECKING:
    from pipeline.run import JobResult, PartRun
    from stages.model.pattern import FlatPattern
    from stages.model.sheet import Nesting, SheetLayout


@dataclass(frozen=True, slots=True)
class FileNames:
    """The names in drawings and files of parts and stock, by their names in the job."""

    parts: dict[str, str]
    stock: dict[str, str]

    def drawing(self, layout: "SheetLayout") -> str:
        """Return the path of a nested sheet."""
        return f"cut/{self.stock[layout.sheet.id]}-{layout.index}.dxf"

    def patterns(self, patterns: "Sequence[FlatPattern]") -> "list[FlatPattern]":
        """Return the patterns as drawings call them."""
        return [pattern.replace(part=self.parts[pattern.part]) for pattern in patterns]

    def nesting(self, nesting: "Nesting | None") -> "Nesting | None":
        """Return the nest as drawings call its sheets and parts."""
        return None if nesting is None else replace(nesting, layouts=tuple(map(self._layout, nesting.layouts)))

    def _layout(self, layout: "SheetLayout") -> "SheetLayout":
        placements = tuple(replace(placed, part=self.parts[placed.part]) for placed in layout.placements)
        return replace(layout, sheet=replace(layout.sheet, id=self.stock[layout.sheet.id]), placements=placements)


def file_names(parts: "Sequence[PartRun]", job: Job) -> FileNames:
    """Return the names of a job's parts, the blanks of divided ones each by itself, and stock in drawings and files."""
    return FileNames(safe_names(run.part.name for run in parts), safe_names(sheet.id for sheet in job.stock))


def drawings(result: "JobResult") -> dict[str, bytes]:
    """Return the drawings of a job by their paths; nothing under `cut/` unless the job is made."""
    files = {file.path: file.text.encode() for file in result.write.product or ()}
    return {path: text for path, text in files.items() if result.status == "made" or not path.startswith("cut/")}
