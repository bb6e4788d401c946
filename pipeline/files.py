"""Where the drawings of a job lie below its output folder, and what they call its parts and stock.

A part goes by its own name in the report.  In drawings and file names it goes by a name that every system takes
(`store.safe_names`), so that what is etched on a part is also the name of its file.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from pipeline.job import Job
from pipeline.store import safe_name, safe_names
from stages.model.cutfile import Machine, filled

if TYPE_CHECKING:
    from pipeline.run import JobResult, PartRun
    from stages.model.pattern import FlatPattern
    from stages.model.sheet import Nesting, SheetLayout

LONGEST_VALUE = 30
"""Letters of a value in a file name: all fields together stay below what file systems take."""


@dataclass(frozen=True, slots=True)
class FileNames:
    """The names in drawings and files of parts and stock, by their names in the job.

    machine: that of the job, with its values in the fields of file names.
    """

    parts: dict[str, str]
    stock: dict[str, str]
    machine: Machine = field(default_factory=Machine)

    def drawing(self, layout: "SheetLayout") -> str | None:
        """Return the path of the drawing of a nested sheet; None where each part has a drawing of its own."""
        if self.machine.file_per == "part":
            return None
        return self.machine.path(self.stock[layout.sheet.id], layout.index)

    def picture(self, layout: "SheetLayout") -> str:
        """Return the path of the picture of a nested sheet."""
        return f"preview/{self.stock[layout.sheet.id]}-{layout.index}.png"

    def part_drawings(self, layout: "SheetLayout") -> list[str]:
        """Return the paths of the drawings of all copies on a sheet, where each part has one of its own."""
        return [self.machine.part_path(self.parts[placed.part]) for placed in layout.placements]

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
    return FileNames(
        safe_names(run.part.name for run in parts), safe_names(sheet.id for sheet in job.stock), _named(job)
    )


def _named(job: Job) -> Machine:
    """Return what the drawings of a job are like, the fields of their names filled as far as they are the job's."""
    thickness = job.material.thickness_mm
    values = {
        "job": job.name,
        "customer": job.customer,
        "revision": job.revision,
        "material": job.material.name,
        "thickness": None if thickness is None else f"{thickness:g}",
    }
    safe = {key: safe_name(value or f"no-{key}")[:LONGEST_VALUE].rstrip(".-") for key, value in values.items()}
    material = safe_name(job.material.name)[:LONGEST_VALUE] if job.material.name else ""
    style = replace(job.machine.style, name=safe["job"], material=material)
    return replace(job.machine, file_name=filled(job.machine.file_name, safe), style=style)


def drawings(result: "JobResult") -> dict[str, bytes]:
    """Return the drawings of a job by their paths; of nothing but flat patterns unless the job is made."""
    files = {file.path: file.text.encode() for file in result.write.product or ()}
    return {path: text for path, text in files.items() if result.status == "made" or path.startswith("flat/")}
