"""A value at its limit passes and the next double fails: for every metric that has a limit, up to the report."""

from collections.abc import Iterator
from dataclasses import replace
from math import inf, nextafter

import pytest

from pipeline.outputs import outputs
from pipeline.report.entries import MetricEntry, entries
from pipeline.report.render import as_json_has_it
from pipeline.run import JobResult, Runner, Step
from stages.model.report import Metric, Outcome, StageReport
from tests.pipeline.reports import ran


@pytest.fixture(scope="module")
def result() -> JobResult:
    return ran("nested")


def limited(result: JobResult) -> Iterator[tuple[int, int, Metric]]:
    """Yield every metric of the parts that has a limit, with the numbers of its part and stage."""
    for part, run in enumerate(result.parts):
        for stage, step in enumerate(run.steps):
            yield from ((part, stage, metric) for metric in step.report.metrics if metric.limit is not None)


def judged(report: StageReport, metric: Metric, value: float | bool) -> Step[object]:
    """Return the step of a stage of which one metric has that value, as the stages are judged when they run."""
    metrics = tuple(replace(one, value=value) if one == metric else one for one in report.metrics)
    outcome: Outcome[object | None] = Outcome(object(), replace(report, metrics=metrics))
    return Runner().step(report.stage, report.subject, lambda: outcome)


def beyond(limit: float | bool) -> float | bool:
    """Return the least value that must not pass."""
    return not limit if isinstance(limit, bool) else nextafter(limit, inf)


def entry(result: JobResult, part: int, stage: int, step: Step[object], name: str) -> tuple[MetricEntry, str]:
    """Return what report.json says of a metric, and of its stage, if a stage went like this."""
    run = result.parts[part]
    steps = (*run.steps[:stage], step, *run.steps[stage + 1 :])
    parts = (*result.parts[:part], replace(run, steps=steps), *result.parts[part + 1 :])
    _, files = outputs(replace(result, parts=parts))
    said = entries(as_json_has_it(files["report.json"])).parts[part].stages[stage]
    (found,) = (one for one in said.metrics if one.name == name)
    return found, said.status


def test_a_value_at_its_limit_passes_and_the_next_double_fails(result: JobResult) -> None:
    names = set()
    for part, stage, metric in limited(result):
        assert metric.limit is not None
        names.add(metric.name)
        report = result.parts[part].steps[stage].report
        for value, passes in ((metric.limit, True), (beyond(metric.limit), False)):
            step = judged(report, metric, value)
            assert step.status == ("pass" if passes else "fail"), metric.name
    assert {"max_warp_deg", "max_strain"} <= names


def test_the_report_says_what_was_decided(result: JobResult) -> None:
    part, stage, metric = next(found for found in limited(result) if found[2].name == "max_warp_deg")
    assert metric.limit is not None
    for value, passes in ((metric.limit, True), (beyond(metric.limit), False)):
        step = judged(result.parts[part].steps[stage].report, metric, value)
        found, status = entry(result, part, stage, step, metric.name)
        assert (found.value, found.passed, status) == (value, passes, "pass" if passes else "fail")


def test_nest_and_write_are_judged_alike(result: JobResult) -> None:
    names = set()
    for step in (result.nest, result.write):
        for metric in (one for one in step.report.metrics if one.limit is not None):
            assert metric.limit is not None
            names.add(metric.name)
            assert judged(step.report, metric, metric.limit).status == "pass", metric.name
            assert judged(step.report, metric, beyond(metric.limit)).status == "fail", metric.name
    assert {"overlap_mm2", "max_deviation_mm"} <= names


def test_what_is_not_defined_passes_and_no_truth_is_a_number() -> None:
    assert Metric("m", None, limit=0.0).passed
    assert Metric("m", True, limit=True).passed
    assert not Metric("m", False, limit=True).passed
