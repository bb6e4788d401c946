"""`junit.xml`: a suite for each part, a case for each metric of each stage, for systems that show results of tests.

Elements stand in the order that the schemas of Jenkins and Ant ask for: properties, cases, output.  A metric past its
limit is a failure, and so is every finding for which a part or a job cannot be made, by its code; other findings are
the output of their suite.  A stage that was not reached is one skipped case.  Nest and write are the cases of a last
suite, that of the job.  Seconds, host and date are not told: they differ from run to run, and no schema of Jenkins asks
for them (that of Ant does).  XML 1.0 has no place for control characters: each becomes U+FFFD, and the output of the
first suite says which they were.
"""

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from xml.etree import ElementTree

from pipeline.report.entries import FindingEntry, MetricEntry, PartEntry, ReportEntry, StageEntry, entries
from pipeline.report.results import number
from pipeline.report.rows import fatal

FORBIDDEN = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""What is no character of XML 1.0 (fifth edition, production 2)."""
REPLACEMENT = "\ufffd"


@dataclass(frozen=True, slots=True)
class Case:
    """One test case; failure: its sort and what it says."""

    stage: str
    name: str
    output: str = ""
    failure: tuple[str, str] | None = None
    skipped: bool = False


@dataclass(frozen=True, slots=True)
class Suite:
    """One test suite."""

    name: str
    properties: tuple[tuple[str, str], ...]
    cases: tuple[Case, ...]
    output: tuple[str, ...]


def junit_xml(report: Mapping[str, object]) -> bytes:
    """Return the checks of a report as JSON has it."""
    read = entries(report)
    told = list(suites(read))
    lost = sorted({character for suite in told for text in _texts(suite) for character in FORBIDDEN.findall(text)})
    tree = _tree(read.job.name, told, [_lost(character) for character in lost])
    ElementTree.indent(tree, " ")
    text: bytes = ElementTree.tostring(tree, "utf-8", xml_declaration=True)
    return text + b"\n"


def suites(report: ReportEntry) -> Iterator[Suite]:
    """Yield a suite for each part, and that of the job."""
    for part in report.parts:
        yield _suite(part.name, _properties(part), [(stage.stage, stage) for stage in part.stages])
    whole = (("status", report.status), *((("digest", report.job.digest),) if report.job.digest else ()))
    yield _suite(report.job.name, whole, [("nest", report.nest), ("write", report.write)])


def _properties(part: PartEntry) -> tuple[tuple[str, str], ...]:
    return (("class", part.verdict),) if part.verdict is not None else ()


def _suite(name: str, properties: tuple[tuple[str, str], ...], stages: Sequence[tuple[str, StageEntry]]) -> Suite:
    cases = tuple(case for called, stage in stages for case in _cases(called, stage))
    output = tuple(
        f"{called}: {finding.code}: {finding.message}"
        for called, stage in stages
        for finding in stage.findings
        if not finding.fatal
    )
    return Suite(name, properties, cases, output)


def _cases(stage: str, entry: StageEntry) -> Iterator[Case]:
    """Yield the cases of a stage; one that failed has a case that says so even where no number does."""
    if entry.status == "skipped" and not entry.metrics and not fatal(entry.findings):
        yield Case(stage, "status", skipped=True)
        return
    names = numbered(metric.name for metric in entry.metrics)
    cases = [_measured(stage, name, metric) for name, metric in zip(names, entry.metrics, strict=True)]
    by_code: dict[str, list[FindingEntry]] = {}
    for finding in fatal(entry.findings):
        by_code.setdefault(finding.code, []).append(finding)
    cases += [
        Case(stage, code, failure=(code, "\n".join(one.message for one in same))) for code, same in by_code.items()
    ]
    if entry.status == "fail" and all(case.failure is None for case in cases):
        cases.append(Case(stage, "status", failure=("status", f"{stage} failed")))
    yield from cases


def _measured(stage: str, name: str, metric: MetricEntry) -> Case:
    """Return the case of a metric."""
    unit = f" {metric.unit}" if metric.unit else ""
    value = "not defined" if metric.value is None else f"{number(metric.value)}{unit}"
    limit = "no limit" if metric.limit is None else f"limit {number(metric.limit)}{unit}"
    said = f"{metric.name}: {value}, {limit}, {metric.evidence}"
    return Case(stage, name, said, None if metric.passed else ("limit", said))


def numbered(names: Iterable[str]) -> list[str]:
    """Return names, the second of a name with a 2 behind it."""
    seen: Counter[str] = Counter()
    told = []
    for name in names:
        seen[name] += 1
        told.append(name if seen[name] == 1 else f"{name} ({seen[name]})")
    return told


def _tree(name: str, told: Sequence[Suite], remarks: Sequence[str]) -> ElementTree.Element:
    """Return the document.  remarks: go to the output of the first suite."""
    root = ElementTree.Element("testsuites", {"name": _clean(name), **_counts([c for one in told for c in one.cases])})
    for place, suite in enumerate(told):
        _add_suite(root, place, suite, remarks if place == 0 else ())
    return root


def _add_suite(root: ElementTree.Element, place: int, suite: Suite, remarks: Sequence[str]) -> None:
    """Add a suite: properties, cases, output."""
    counts = {**_counts(suite.cases), "skipped": str(sum(case.skipped for case in suite.cases)), "id": str(place)}
    element = ElementTree.SubElement(root, "testsuite", {"name": _clean(suite.name), **counts})
    if suite.properties:
        properties = ElementTree.SubElement(element, "properties")
        for key, value in suite.properties:
            ElementTree.SubElement(properties, "property", {"name": key, "value": _clean(value)})
    for case in suite.cases:
        _add_case(element, suite.name, case)
    if suite.output or remarks:
        ElementTree.SubElement(element, "system-out").text = _clean("\n".join((*remarks, *suite.output)))


def _add_case(suite: ElementTree.Element, part: str, case: Case) -> None:
    names = {"name": _clean(case.name), "classname": _clean(f"{part}.{case.stage}")}
    element = ElementTree.SubElement(suite, "testcase", names)
    if case.skipped:
        ElementTree.SubElement(element, "skipped")
    if case.failure is not None:
        sort, said = case.failure
        message = {"message": _clean(said.split("\n")[0]), "type": _clean(sort)}
        ElementTree.SubElement(element, "failure", message).text = _clean(said)
    if case.output:
        ElementTree.SubElement(element, "system-out").text = _clean(case.output)


def _counts(cases: Sequence[Case]) -> dict[str, str]:
    """Return how many cases there are and how many failed; none ended in an error: then there is no report."""
    failures = sum(case.failure is not None for case in cases)
    return {"tests": str(len(cases)), "failures": str(failures), "errors": "0"}


def _clean(text: str) -> str:
    return FORBIDDEN.sub(REPLACEMENT, text)


def _lost(character: str) -> str:
    return f"U+{ord(character):04X} is no character of XML and was replaced by U+{ord(REPLACEMENT):04X}"


def _texts(suite: Suite) -> Iterator[str]:
    """Yield every text of a suite."""
    yield from (suite.name, *suite.output)
    for case in suite.cases:
        yield from (case.name, case.output, *(case.failure or ()))
    for pair in suite.properties:
        yield from pair
