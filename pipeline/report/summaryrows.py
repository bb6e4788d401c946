"""One row for every job of a batch: what became of it, what it was refused for, and its worst number beside the limit.

A row is made from the report of the job where there is one, and from what the runner knows where there is none.  How
far a number is to its limit is its *load*, value over limit: 1 is the limit itself.  Where the limit is 0 a load is not
defined beyond it; what failed comes before what passed whatever its load.

Causes are grouped by the code of the first finding that was fatal, else by the metric that failed, else by the text of
the runner with its file, numbers and quoted names taken out.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass

import msgspec

from pipeline.report.document import Document
from pipeline.report.entries import Number, PartEntry, ReportEntry, StageEntry
from pipeline.report.html import PAGE
from pipeline.store import REPORT
from stages.model.tolerances import CLASSES

MADE = "made"
STATUSES = ("internal", "crashed", "out-of-memory", "timed-out", "bad-input", "no-solution", "rejected", MADE)
"""From the gravest to the best; one that is not among them counts as the gravest."""
REPORTED = frozenset({MADE, "rejected", "no-solution"})
"""Statuses that leave a report."""
CLASS_ORDER = ("rejected", "inconclusive", *reversed(CLASSES))
"""From the worst to the best."""
LONGEST = 120
"""Characters of a cause that is a text."""


@dataclass(frozen=True, slots=True)
class Held:
    """A number of a part that is held against a limit."""

    part: str
    stage: str
    metric: str
    value: Number
    limit: Number
    unit: str
    evidence: str
    passed: bool

    @property
    def load(self) -> float | None:
        """Return the value over the limit; None beyond a limit of 0."""
        if self.limit > 0:
            return self.value / self.limit
        return 0.0 if self.value <= self.limit else None

    @property
    def gravity(self) -> tuple[bool, float]:
        """Return what orders numbers: failed ones first, then by load."""
        load = self.load
        return not self.passed, float("inf") if load is None else load


@dataclass(frozen=True, slots=True)
class JobRow:
    """A job of a batch; `parts` and `failed` count its parts, `held` has the worst number of each part.

    report: the file in its folder that tells more, the page where it has one; None where it left no report.
    """

    job: str
    status: str
    cause: str
    group: str
    reached: str | None
    parts: int
    failed: int
    utilisation: float | None
    seconds: float
    held: tuple[Held, ...]
    report: str | None = None

    @property
    def worst(self) -> Held | None:
        """Return the worst number of all its parts."""
        return max(self.held, key=lambda held: held.gravity, default=None)

    @property
    def gravity(self) -> tuple[int, tuple[bool, float]]:
        """Return what orders jobs: the worst has the largest."""
        known = STATUSES.index(self.status) if self.status in STATUSES else -1
        worst = self.worst
        return len(STATUSES) - known, (False, -1.0) if worst is None else worst.gravity


def job_row(job: str, status: str, cause: str, seconds: float, report: bytes | None) -> JobRow:
    """Return the row of a job; report: its `report.json`, None where it left none.

    Raises `msgspec.ValidationError` or `msgspec.DecodeError` for bytes that are no report.
    """
    if report is None:
        group = "" if status == MADE else f"{status}: {grouped(cause)}".removesuffix(": ")
        return JobRow(job, status, cause, group, None, 0, 0, None, seconds, ())
    found = msgspec.json.decode(report, type=ReportEntry)
    held = (max(_held(part), key=lambda one: one.gravity, default=None) for part in found.parts)
    classes = [part.verdict for part in found.parts if part.verdict is not None]
    return JobRow(
        job, status, cause, "" if status == MADE else _group(found) or f"{status}: {grouped(cause)}".removesuffix(": "),
        min(classes, key=_rank, default=None), len(found.parts), sum(_failed(part) for part in found.parts),
        _utilisation(found), seconds, tuple(one for one in held if one is not None), _told_in(found),
    )  # fmt: skip


def _told_in(found: ReportEntry) -> str:
    """Return the file in which a job is told of best."""
    return PAGE if found.job.formats is None or "html" in found.job.formats else REPORT


def _rank(reached: str) -> int:
    return CLASS_ORDER.index(reached) if reached in CLASS_ORDER else -1


def _failed(part: PartEntry) -> bool:
    return any(stage.status == "fail" for stage in part.stages)


def _held(part: PartEntry) -> Iterator[Held]:
    """Yield the numbers of a part that have a limit."""
    for stage in part.stages:
        for metric in stage.metrics:
            value, limit = metric.value, metric.limit
            if not (value is None or limit is None or isinstance(value, bool) or isinstance(limit, bool)):
                yield Held(
                    part.name, stage.stage, metric.name, value, limit, metric.unit, metric.evidence, metric.passed
                )


def _group(found: ReportEntry) -> str:
    """Return the group of what a job was refused for; empty where its report does not say."""
    stages = [*(stage for part in found.parts for stage in part.stages), found.nest, found.write]
    fatal = (finding.code for stage in stages for finding in stage.findings if finding.fatal)
    return next(fatal, "") or next(_failing(stages), "")


def _failing(stages: list[StageEntry]) -> Iterator[str]:
    return (metric.name for stage in stages for metric in stage.metrics if not metric.passed)


def _utilisation(found: ReportEntry) -> float | None:
    """Return the mean utilisation of the sheets."""
    used = [float(sheet.utilisation) for sheet in found.nest.sheets]
    return sum(used) / len(used) if used else None


def grouped(cause: str) -> str:
    """Return a cause without file, numbers and quoted names, so that like ones are counted together."""
    text = PATH.sub("\u2026", QUOTED.sub("\u2026", PLACE.sub("", cause)))
    text = ": ".join(_numberless(piece) for piece in text.split(": "))
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}\u2026"


def _numberless(text: str) -> str:
    """Return a text with # for its numbers; of a key such as `part[0].surface.k0` only for places in arrays."""
    return INDEX.sub("[#]", text) if KEY.fullmatch(text) else NUMBER.sub("#", text)


PLACE = re.compile(r"^/.*?: ")
"""The file that a cause begins with, line and column with it: `/jobs/a.toml:23:11: `."""
PATH = re.compile(r"(?<![\w/])/(?:[^\s/]+/)+[^\s/:,)]*")
QUOTED = re.compile(r"'[^']*'|\"[^\"]*\"")
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
INDEX = re.compile(r"\[\d+\]")
KEY = re.compile(r"[a-z]\w*(?:\[\d+\])*(?:\.[a-z]\w*(?:\[\d+\])*)*")


def held_document(held: Held) -> Document:
    """Return a number beside its limit as the summary has it."""
    return {
        "part": held.part, "stage": held.stage, "metric": held.metric, "value": held.value, "limit": held.limit,
        "unit": held.unit, "evidence": held.evidence, "pass": held.passed, "load": held.load,
    }  # fmt: skip
