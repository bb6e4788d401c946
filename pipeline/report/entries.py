"""What the formats of numbers read of a report, typed: metrics, findings, stages, parts and the nest.

Numbers stay as JSON has them, integers and floats apart.  Figures of flat patterns, surfaces, sheets and costs have
many keys that come and go; they stay mappings, of which every number is told by its path.  What the shop needs of them
by name is in `shopentries`; what both read of jobs, parts and sheets is their heads.
"""

from collections.abc import Mapping

import msgspec
from msgspec import Struct, field

Number = int | float
Value = bool | int | float | None
Figures = dict[str, object]


class MetricEntry(Struct, frozen=True):
    """One metric of a stage."""

    name: str
    value: Value
    unit: str
    evidence: str
    limit: Value
    passed: bool = field(name="pass")
    margin: Number | None = None


class FindingEntry(Struct, frozen=True):
    """One finding of a stage."""

    code: str
    message: str
    fatal: bool


class StageEntry(Struct, frozen=True):
    """One stage as it went; `stage` is empty for nest and write, whose place in the report says which they are."""

    status: str
    metrics: tuple[MetricEntry, ...]
    findings: tuple[FindingEntry, ...]
    stage: str = ""


class PartHead(Struct, frozen=True, kw_only=True):
    """What every reader needs of a part; `verdict` is null in what was nested from drawings alone."""

    name: str
    quantity: int
    verdict: str | None = field(name="class")
    mass_kg: Number | None
    cut_length_mm: Number | None
    pierces: int | None


class PartEntry(PartHead, frozen=True, kw_only=True):
    """One part."""

    flat: Figures | None
    surface: Figures | None
    stages: tuple[StageEntry, ...]


class SheetHead(Struct, frozen=True, kw_only=True):
    """What every reader needs of a nested sheet."""

    stock: str
    index: int
    utilisation: Number
    mass_kg: Number | None
    cut_length_mm: Number | None
    pierces: int | None
    used_length_mm: Number | None


class SheetEntry(SheetHead, frozen=True, kw_only=True):
    """One nested sheet."""

    offcut: Figures | None
    cost: Number | None


class CostEntry(Struct, frozen=True):
    """What cutting costs: each part, and all together."""

    parts: tuple[Figures, ...]
    total: Figures


class NestEntry(StageEntry, frozen=True, kw_only=True):
    """The nest of all parts."""

    sheets: tuple[SheetEntry, ...]
    cost: CostEntry | None = None


class FileEntry(Struct, frozen=True):
    """One drawing."""

    path: str
    sha256: str


class WriteEntry(StageEntry, frozen=True, kw_only=True):
    """The drawings."""

    files: tuple[FileEntry, ...]


class JobHead(Struct, frozen=True, kw_only=True):
    """What every reader needs of a job; digest: null where several were nested together; formats: of its report."""

    name: str
    digest: str | None = None
    formats: tuple[str, ...] | None = None


class ReportEntry(Struct, frozen=True):
    """A report, or a group of one of several jobs."""

    schema: str
    status: str
    job: JobHead
    parts: tuple[PartEntry, ...]
    nest: NestEntry
    write: WriteEntry


def entries(report: Mapping[str, object]) -> ReportEntry:
    """Return a report typed; `msgspec.ValidationError`, which names the place, for one that is broken."""
    return msgspec.convert(report, ReportEntry)
