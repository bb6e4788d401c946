"""Two runs side by side: every number that changed, parts and drawings that came and went, verdicts that turned.

Rows are those of `results.csv`, told apart by part, stage and metric; with them classes, statuses, findings, and all
that the job and its provenance say.  `run`, whose seconds never agree, is left out; so are details of stages and places
on sheets, which the digests of the drawings stand for.  A number that changed by a rounding is a change: nothing is
passed over.  A change is worse where a check fails that passed or was not there, where a class or a status comes later
in its order, or where a new part fails.  A stage that was skipped is no worse: what kept it from running is.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Literal

from pipeline.report.entries import ReportEntry, StageEntry, Value, entries
from pipeline.report.render import Made, Report, each
from pipeline.report.rows import Row, leaves, rows

SCHEMA = "planish-comparison/1"
Verdict = Literal["", "worse", "better"]
Said = Value | str
Key = tuple[str, str, str]
ORDERS = (
    ("exact", "fabrication", "metal", "leather", "inconclusive", "rejected"),
    ("made", "rejected", "no-solution"),
    ("pass", "fail"),
)
"""Classes of a part, what became of a job, how a stage went: the better first."""


@dataclass(frozen=True, slots=True)
class Change:
    """What changed of one metric.  a, b: its values; None also where a run has none.  difference: b - a of numbers."""

    part: str
    stage: str
    metric: str
    a: Said
    b: Said
    difference: float | None
    unit: str
    verdict: Verdict
    present: Literal["both", "a", "b"] = "both"
    limits: tuple[Value, Value] = (None, None)


@dataclass(frozen=True, slots=True)
class Comparison:
    """What changed from run A to run B.  files: paths of drawings, and whether they were added, removed or changed."""

    added: tuple[str, ...]
    removed: tuple[str, ...]
    changes: tuple[Change, ...]
    files: tuple[tuple[str, str], ...]
    spoilt: tuple[str, ...]
    """Parts of B that A had not, and of which a check fails."""

    @property
    def same(self) -> bool:
        """Whether nothing changed."""
        return not (self.added or self.removed or self.changes or self.files)

    @property
    def worse(self) -> bool:
        """Whether something that was good is not."""
        return bool(self.spoilt) or any(change.verdict == "worse" for change in self.changes)


def compare(a: Report, b: Report) -> Comparison:
    """Return what changed from one report to another, both as JSON has them."""
    one, two = list(_named(a)), list(_named(b))
    had, have = _parts(one), _parts(two)
    added = tuple(name for name in have if name not in had)
    removed = tuple(name for name in had if name not in have)
    before, after = _rows(one), _rows(two)
    spoilt = {key[0] for key, row in after.items() if key[0] in added and row.passed is False}
    shared = [key for key in _merged(before, after) if key[0] not in {*added, *removed}]
    said, says = {**dict(_settings(a)), **dict(_texts(one))}, {**dict(_settings(b)), **dict(_texts(two))}
    kept = [key for key in _merged(said, says) if key[0] not in {*added, *removed}]
    words = [_word(key, said, says) for key in kept if said.get(key) != says.get(key)]
    numbers = [change for key in shared for change in _changes(key, before.get(key), after.get(key))]
    return Comparison(added, removed, (*words, *numbers), tuple(_files(one, two)), tuple(sorted(spoilt)))


def _named(report: Report) -> Iterator[tuple[str, ReportEntry]]:
    """Yield a report, or the groups of one of several jobs, each with what goes before its names."""
    for prefix, made in each(Made(report, {})):
        yield prefix, entries(made.report)


def _settings(report: Report) -> Iterator[tuple[Key, Said]]:
    """Yield what a job was asked for, and with which limits, tables and program, by the paths in its report."""
    for table in ("job", "provenance"):
        for path, value in leaves("", report.get(table, {})):
            yield ("", table, path), value


def _parts(reports: Sequence[tuple[str, ReportEntry]]) -> list[str]:
    return [f"{prefix}{part.name}" for prefix, report in reports for part in report.parts]


def _rows(reports: Sequence[tuple[str, ReportEntry]]) -> dict[Key, Row]:
    return {(f"{prefix}{row.part}", row.stage, row.metric): row for prefix, report in reports for row in rows(report)}


def _merged(before: Mapping[Key, object], after: Mapping[Key, object]) -> list[Key]:
    """Return all keys in the order of the second run, those that are gone behind them."""
    return [*after, *(key for key in before if key not in after)]


def _texts(reports: Sequence[tuple[str, ReportEntry]]) -> Iterator[tuple[Key, Said]]:
    """Yield what became of jobs, parts and stages, and what was found."""
    for prefix, report in reports:
        yield (prefix, "job", "status"), report.status
        for part in report.parts:
            yield (f"{prefix}{part.name}", "part", "class"), part.verdict
            for stage in part.stages:
                yield from _stage(f"{prefix}{part.name}", stage.stage, stage)
        yield from _stage(prefix, "nest", report.nest)
        yield from _stage(prefix, "write", report.write)


def _stage(part: str, name: str, stage: StageEntry) -> Iterator[tuple[Key, Said]]:
    """Yield how a stage went, and its findings, those of one code together."""
    yield (part, name, "status"), stage.status
    for code in dict.fromkeys(finding.code for finding in stage.findings):
        same = [finding.message for finding in stage.findings if finding.code == code]
        yield (part, name, f"finding {code}"), "; ".join(same)


def _word(key: Key, said: Mapping[Key, Said], says: Mapping[Key, Said]) -> Change:
    """Return the change of a class, a status, a finding or a setting, which a run may have and not know (None)."""
    (part, stage, metric), a, b = key, said.get(key), says.get(key)
    ranks = [{name: rank for rank, name in enumerate(order)} for order in ORDERS if a in order and b in order]
    verdict: Verdict = ""
    if metric in ("class", "status") and ranks:
        verdict = "worse" if ranks[0][str(b)] > ranks[0][str(a)] else "better"
    present: Literal["both", "a", "b"] = "b" if key not in said else "a" if key not in says else "both"
    return Change(part, stage, metric, a, b, None, "", verdict, present)


def _changes(key: Key, a: Row | None, b: Row | None) -> Iterator[Change]:
    """Yield what changed of one row, at most one change."""
    part, stage, metric = key
    turn = _turn(a, b)
    if a is None and b is not None:
        yield Change(part, stage, metric, None, b.value, None, b.unit, turn, "b", (None, b.limit))
    elif b is None and a is not None:
        yield Change(part, stage, metric, a.value, None, None, a.unit, turn, "a", (a.limit, None))
    elif a is not None and b is not None and _content(a) != _content(b):
        limits = (a.limit, b.limit)
        yield Change(part, stage, metric, a.value, b.value, _difference(a, b), b.unit, turn, "both", limits)


def _content(row: Row) -> tuple[object, ...]:
    """Return what of a row may change; a truth is no number."""
    return (row.value, isinstance(row.value, bool), row.limit, row.passed, row.unit, row.evidence)


def _turn(a: Row | None, b: Row | None) -> Verdict:
    """Return whether a check that passed fails or the other way round; a failure that came or went is one too."""
    failed, fails = a is not None and a.passed is False, b is not None and b.passed is False
    if failed == fails:
        return ""
    return "worse" if fails else "better"


def _difference(a: Row, b: Row) -> float | None:
    """Return b - a; None unless both are numbers of the same unit."""
    if isinstance(a.value, bool) or isinstance(b.value, bool) or a.value is None or b.value is None:
        return None
    return float(b.value - a.value) if a.unit == b.unit else None


def _files(one: Sequence[tuple[str, ReportEntry]], two: Sequence[tuple[str, ReportEntry]]) -> Iterator[tuple[str, str]]:
    """Yield the drawings that are not the same, with what became of them."""
    had, have = _digests(one), _digests(two)
    for path in sorted({*had, *have}):
        if had.get(path) != have.get(path):
            yield path, "removed" if path not in have else "added" if path not in had else "changed"


def _digests(reports: Sequence[tuple[str, ReportEntry]]) -> dict[str, str]:
    return {f"{prefix}{file.path}": file.sha256 for prefix, report in reports for file in report.write.files}


def comparison_document(found: Comparison) -> dict[str, object]:
    """Return a comparison as a document."""
    return {
        "schema": SCHEMA,
        "same": found.same,
        "worse": found.worse,
        "parts": {"added": list(found.added), "removed": list(found.removed), "failing": list(found.spoilt)},
        "changes": [asdict(change) for change in found.changes],
        "files": [{"path": path, "change": change} for path, change in found.files],
    }
