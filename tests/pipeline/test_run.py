"""The flow of a job: which stage runs when, and what becomes of the job when one fails; stages are stubs."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from pipeline.job import Job, job_of
from pipeline.jobfile import read
from pipeline.run import JobResult, Step, run_job
from stages.errors import NoSolutionError
from stages.model.cutfile import CutFile
from stages.model.material import Part
from stages.model.report import Finding, Metric, Outcome, StageReport
from tests.pipeline.jobs import CONE, PLATE, STOCK, write_job

Stub = Callable[..., Outcome[object]]


class Pattern:
    """Stands for a flat pattern: it has a name that can be replaced."""

    def __init__(self, part: str) -> None:
        self.part = part

    def replace(self, part: str) -> "Pattern":
        return Pattern(part)


class Made:
    """Stands for a surface and for its certificate: it knows its part."""

    def __init__(self, part: Part) -> None:
        self.part, self.name = part, part.name

    @property
    def surface(self) -> "Made":
        return self


class Nest:
    """Stands for a nest of no sheets."""

    layouts = ()


def stage(name: str, product: object, *findings: Finding, metrics: tuple[Metric, ...] = ()) -> Stub:
    return lambda *_: Outcome(product, StageReport(name, "x", metrics, findings))  # type: ignore[arg-type]


@pytest.fixture
def stages(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Put stubs in the place of stages; all of them pass until one is replaced."""
    monkeypatch.setattr("pipeline.files.FileNames.nesting", lambda _, nesting: nesting)

    def put(**stubs: Stub) -> None:
        for name, stub in stubs.items():
            monkeypatch.setattr(f"stages.{name}.{name}", stub)

    put(construct=lambda part, _: Outcome(Made(part), StageReport("construct", part.name)))
    put(verify=lambda surface, _: Outcome(surface, StageReport("verify", surface.name)))
    put(unroll=lambda surface, _: Outcome(Pattern(surface.name), StageReport("unroll", surface.name)))
    monkeypatch.setattr("stages.write.flavours.as_cut", lambda pattern, _: pattern)
    monkeypatch.setattr("stages.unroll.divide.blanks", lambda certificate, _: (certificate,))
    put(nest=stage("nest", Nest()), write=stage("write", (CutFile("flat/plate.dxf", "0"),)))
    return put


@pytest.fixture
def job(tmp_path: Path) -> Job:
    return job_of(read(write_job(tmp_path, PLATE + STOCK + CONE)))


def statuses(result: JobResult) -> list[list[str]]:
    steps = [*(run.steps for run in result.parts), (result.nest, result.write)]
    return [[str(step.status) for step in row] for row in steps]


def test_a_job_whose_stages_pass_is_made(stages: object, job: Job) -> None:
    result = run_job(job)
    assert (result.status, result.exit_code) == ("made", 0)
    assert statuses(result) == [["pass"] * 3, ["pass"] * 3, ["pass"] * 2]
    assert list(result.seconds) == ["construct", "verify", "unroll", "nest", "write"]


def test_a_listener_hears_of_every_stage_in_order(stages: object, job: Job) -> None:
    heard: list[Step[object]] = []
    run_job(job, heard.append)
    assert [step.report.stage for step in heard] == [*["construct", "verify", "unroll"] * 2, "nest", "write"]


@pytest.mark.parametrize(
    ("failing", "wanted"),
    [
        ("construct", ["fail", "skipped", "skipped"]),
        ("verify", ["pass", "fail", "skipped"]),
        ("unroll", ["pass", "pass", "fail"]),
    ],
)
def test_after_a_refusal_the_rest_is_skipped_and_the_job_rejected(
    stages: Callable[..., None], job: Job, failing: str, wanted: list[str]
) -> None:
    stages(**{failing: stage(failing, None, Finding("no", "no", fatal=True))})
    result = run_job(job)
    assert (result.status, result.exit_code) == ("rejected", 1)
    assert statuses(result) == [wanted, wanted, ["skipped", "skipped"]]


def test_a_product_does_not_count_if_a_metric_exceeds_its_limit(stages: Callable[..., None], job: Job) -> None:
    stages(verify=stage("verify", "a certificate", metrics=(Metric("max_warp_deg", 2.0, "deg", limit=1.0),)))
    result = run_job(job)
    assert result.exit_code == 1
    assert result.parts[0].pattern is None


def test_one_rejected_part_stops_the_nest_but_the_others_are_written_flat(
    stages: Callable[..., None], job: Job
) -> None:
    refused = Outcome(None, StageReport("verify", "cone"))
    passed = StageReport("verify", "plate")
    stages(verify=lambda part, _: refused if part.name == "cone" else Outcome(part, passed))
    written: list[list[str]] = []

    def write(patterns: list[Pattern], nesting: object, *_: object) -> Outcome[object]:
        assert nesting is None
        written.append([pattern.part for pattern in patterns])
        return Outcome((), StageReport("write", "x"))

    stages(write=write)
    result = run_job(job)
    assert (result.exit_code, written) == (1, [["plate"]])
    assert statuses(result)[2] == ["skipped", "pass"]


def test_what_does_not_fit_the_stock_is_no_solution(stages: Callable[..., None], job: Job) -> None:
    stages(nest=stage("nest", None, Finding("does-not-fit", "too large", fatal=True)))
    result = run_job(job)
    assert (result.status, result.exit_code) == ("no-solution", 3)
    assert statuses(result)[2] == ["fail", "pass"]


@pytest.mark.parametrize("failing", ["construct", "verify", "unroll", "nest", "write"])
def test_a_method_that_falls_short_is_no_solution_with_both_numbers(
    stages: Callable[..., None], job: Job, failing: str
) -> None:
    def fall_short(*_: object) -> Outcome[object]:
        raise NoSolutionError("rulings", reached=2e-3, wanted=1e-3, unit="rad")

    stages(**{failing: fall_short})
    result = run_job(job)
    assert (result.status, result.exit_code) == ("no-solution", 3)
    steps = [*(step for run in result.parts for step in run.steps), result.nest, result.write]
    (finding,) = next(step for step in steps if step.short).report.findings
    assert finding.fatal
    assert finding.where == {"reached": 2e-3, "wanted": 1e-3, "unit": "rad"}


def test_contours_that_a_flavour_cannot_hold_are_no_solution(
    stages: object, job: Job, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fall_short(*_: object) -> None:
        raise NoSolutionError("a path outside of a sharp corner", reached=1.0, wanted=0.05, unit="mm")

    monkeypatch.setattr("stages.write.flavours.as_cut", fall_short)
    result = run_job(job)
    assert (result.status, result.exit_code) == ("no-solution", 3)
    assert statuses(result)[2] == ["skipped", "fail"]


def test_without_stock_nothing_is_nested(stages: object, tmp_path: Path) -> None:
    result = run_job(job_of(read(write_job(tmp_path, PLATE))))
    assert (result.exit_code, statuses(result)[1]) == (0, ["skipped", "pass"])


def test_an_interrupted_search_is_told_by_the_exit_code(stages: Callable[..., None], job: Job) -> None:
    stages(nest=stage("nest", Nest(), Finding("interrupted", "stopped")))
    result = run_job(job)
    assert (result.status, result.exit_code) == ("made", 130)


def test_a_defect_names_part_and_stage(stages: Callable[..., None], job: Job) -> None:
    def broken(*_: object) -> Outcome[object]:
        raise ZeroDivisionError

    stages(verify=broken)
    with pytest.raises(ZeroDivisionError) as caught:
        run_job(job)
    assert caught.value.__notes__ == ["part 'plate', stage verify"]


def blank_of(certificate: Made, number: int) -> Made:
    return Made(replace(certificate.part, spec=certificate.part.spec.blank(number)))


def test_a_divided_part_has_a_run_for_each_blank_and_shares_the_steps_before(
    stages: Callable[..., None], job: Job, monkeypatch: pytest.MonkeyPatch
) -> None:
    def halves(certificate: Made, _: object) -> tuple[Made, ...]:
        return (blank_of(certificate, 1), blank_of(certificate, 2)) if certificate.name == "cone" else (certificate,)

    monkeypatch.setattr("stages.unroll.divide.blanks", halves)
    heard: list[Step[object]] = []
    result = run_job(job, heard.append)
    assert [run.part.name for run in result.parts] == ["plate", "cone.1", "cone.2"]
    assert [run.pattern.part for run in result.parts if run.pattern] == ["plate", "cone.1", "cone.2"]
    first, second = result.parts[1:]
    assert first.steps[:2] == second.steps[:2]
    assert [step.report.subject for step in heard[3:7]] == ["cone", "cone", "cone.1", "cone.2"]
    assert result.status == "made"


def test_a_blank_that_cannot_be_unrolled_rejects_the_job_and_not_the_other_blank(
    stages: Callable[..., None], job: Job, monkeypatch: pytest.MonkeyPatch
) -> None:
    def unroll(certificate: Made, _: object) -> Outcome[object]:
        found = (Finding("strain", "too much", fatal=True),) if certificate.name == "cone.2" else ()
        pattern = None if found else Pattern(certificate.name)
        return Outcome(pattern, StageReport("unroll", certificate.name, (), found))

    monkeypatch.setattr(
        "stages.unroll.divide.blanks", lambda certificate, _: tuple(blank_of(certificate, n) for n in (1, 2))
    )
    stages(unroll=unroll)
    result = run_job(job)
    assert [run.pattern is not None for run in result.parts] == [True, True, True, False]
    assert (result.status, result.nest.status) == ("rejected", "skipped")
