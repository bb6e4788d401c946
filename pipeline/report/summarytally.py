"""What many jobs come to, counted in one pass that keeps no job: statuses, causes, trends, the worst.

Trends are over the jobs in the order in which they come, in at most `BINS` groups of equal size: when they are full,
two neighbours become one and the size doubles.  Of parts and jobs the worst `LISTED` are kept.  Of causes the first
`CAUSES` kinds are told apart, later kinds are counted as others.
"""

from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from pipeline.report.document import Document
from pipeline.report.summaryrows import CLASS_ORDER, MADE, STATUSES, Held, JobRow, held_document

SCHEMA = "planish-summary/1"
BINS = 128
LISTED = 500
CAUSES = 1000
OTHERS = "other causes"
SHOWN_CAUSES = 50

T = TypeVar("T")


@dataclass(slots=True)
class Worst(Generic[T]):
    """The worst of what was offered, ties in the order of their coming."""

    gravity: Callable[[T], tuple[object, ...]]
    kept: list[T] = field(default_factory=list)

    def offer(self, one: T) -> None:
        """Take one in; now and then drop what cannot be listed any more."""
        self.kept.append(one)
        if len(self.kept) >= 2 * LISTED:
            self.kept = self.sorted()

    def sorted(self) -> list[T]:
        """Return the worst, the very worst first."""
        return sorted(self.kept, key=self.gravity, reverse=True)[:LISTED]


@dataclass(slots=True)
class Bin:
    """Jobs that follow each other."""

    first: str
    last: str
    jobs: int = 0
    made: int = 0
    seconds: float = 0.0
    longest: float = 0.0
    used: float = 0.0
    nested: int = 0
    load: float | None = None

    def add(self, row: JobRow) -> None:
        """Count a job."""
        self.last = row.job
        self.jobs += 1
        self.made += row.status == MADE
        self.seconds += row.seconds
        self.longest = max(self.longest, row.seconds)
        if row.utilisation is not None:
            self.used, self.nested = self.used + row.utilisation, self.nested + 1
        self.load = _larger(self.load, None if row.worst is None else row.worst.load)

    def joined(self, other: "Bin") -> "Bin":
        """Return this bin and the next as one."""
        return Bin(
            self.first, other.last, self.jobs + other.jobs, self.made + other.made, self.seconds + other.seconds,
            max(self.longest, other.longest), self.used + other.used, self.nested + other.nested,
            _larger(self.load, other.load),
        )  # fmt: skip

    def document(self) -> Document:
        """Return the bin as the summary has it."""
        return {
            "first": self.first, "last": self.last, "jobs": self.jobs, "made": self.made,
            "share_made": self.made / self.jobs, "mean_seconds": self.seconds / self.jobs,
            "largest_seconds": self.longest, "mean_utilisation": self.used / self.nested if self.nested else None,
            "largest_load": self.load,
        }  # fmt: skip


def _larger(a: float | None, b: float | None) -> float | None:
    known = [one for one in (a, b) if one is not None]
    return max(known, default=None)


@dataclass(slots=True)
class Trend:
    """Bins of equal size over all jobs so far."""

    size: int = 1
    bins: list[Bin] = field(default_factory=list)

    def add(self, row: JobRow) -> None:
        """Count a job in the last bin, or in a new one."""
        if self.bins and self.bins[-1].jobs < self.size:
            self.bins[-1].add(row)
            return
        if len(self.bins) == BINS:
            self.bins = [a.joined(b) for a, b in zip(self.bins[::2], self.bins[1::2], strict=True)]
            self.size *= 2
        self.bins.append(Bin(row.job, row.job))
        self.bins[-1].add(row)


def tally(rows: Iterable[JobRow]) -> Document:
    """Return the summary of jobs, read once: the document of `summary.json`."""
    statuses, classes, causes, examples = Counter[str](), Counter[str](), Counter[str](), dict[str, str]()
    parts = failed = 0
    seconds = 0.0
    trend = Trend()
    worst_parts = Worst[tuple[JobRow, Held]](lambda one: one[1].gravity)
    worst_jobs = Worst[JobRow](lambda row: row.gravity)
    for row in rows:
        statuses[row.status] += 1
        parts, failed, seconds = parts + row.parts, failed + row.failed, seconds + row.seconds
        if row.reached is not None:
            classes[row.reached] += 1
        if row.group:
            group = row.group if row.group in causes or len(causes) < CAUSES else OTHERS
            causes[group] += 1
            examples.setdefault(group, row.job)
        trend.add(row)
        worst_jobs.offer(row)
        for held in row.held:
            worst_parts.offer((row, held))
    jobs = statuses.total()
    return {
        "schema": SCHEMA,
        "jobs": jobs,
        "parts": parts,
        "parts_failed": failed,
        "seconds": seconds,
        "statuses": _counted(statuses, jobs, "status", (*reversed(STATUSES),)),
        "classes": _counted(classes, classes.total(), "class", (*reversed(CLASS_ORDER),)),
        "causes": pareto(causes, examples),
        "trend": [one.document() for one in trend.bins],
        "worst_parts": [
            {"job": row.job, "report": row.report, **held_document(held)} for row, held in worst_parts.sorted()
        ],
        "worst_jobs": [job_document(row) for row in worst_jobs.sorted()],
    }


def _counted(counts: Counter[str], of: int, name: str, order: tuple[str, ...]) -> list[Document]:
    """Return counts in an order; names that it lacks come last."""
    names = [*(one for one in order if one in counts), *sorted(set(counts) - set(order))]
    return [{name: one, "jobs": counts[one], "share": counts[one] / of} for one in names]


def pareto(causes: Counter[str], examples: dict[str, str]) -> list[Document]:
    """Return causes from the most frequent on, each with its share and that of all before it and itself."""
    total, before, found = causes.total(), 0, list[Document]()
    ordered = sorted(causes.items(), key=lambda item: (-item[1], item[0]))
    shown = ordered[:SHOWN_CAUSES]
    if rest := ordered[SHOWN_CAUSES:]:
        shown.append((OTHERS, sum(count for _, count in rest)))
        examples = {**examples, OTHERS: examples[rest[0][0]]}
    for name, count in shown:
        before += count
        shares = {"share": count / total, "cumulative": before / total}
        found.append({"cause": name, "jobs": count, **shares, "example": examples[name]})
    return found


def job_document(row: JobRow) -> Document:
    """Return a job as the summary lists it."""
    worst = row.worst
    return {
        "job": row.job, "status": row.status, "cause": row.cause, "class": row.reached, "parts": row.parts,
        "parts_failed": row.failed, "utilisation": row.utilisation, "seconds": row.seconds,
        "report": row.report, "worst": None if worst is None else held_document(worst),
    }  # fmt: skip
