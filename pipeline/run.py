"""`run_job`: one job through all stages, as far as each part gets, with a report all the way.

A stage is imported when its turn comes, so that commands that need none of them do not wait for numpy and scipy.  A
stage that raises `NoSolutionError` has fallen short, which is its report's fatal finding; seconds are kept apart from
the reports, which are functions of the job alone.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from time import perf_counter
from typing import TYPE_CHECKING, Generic, Literal, ParamSpec, TypeVar

from pipeline.files import file_names
from pipeline.inturn import Each, in_turn
from pipeline.job import Job
from stages.errors import NoSolutionError
from stages.model.report import Finding, Outcome, Stage, StageReport

if TYPE_CHECKING:
    from stages.model.cutfile import CutFile
    from stages.model.material import Part
    from stages.model.pattern import FlatPattern
    from stages.model.sheet import Nesting
    from stages.model.surface import Certificate, Surface

P = ParamSpec("P")
T = TypeVar("T")
T_co = TypeVar("T_co", covariant=True)
Status = Literal["made", "rejected", "no-solution"]
StepStatus = Literal["pass", "fail", "skipped"]

EXIT_CODES: dict[Status, int] = {"made": 0, "rejected": 1, "no-solution": 3}
EXIT_INTERRUPTED = 130


@dataclass(frozen=True, slots=True)
class Step(Generic[T_co]):
    """One stage as it went: its report, and its product if it passed; `short` if it fell short of its task."""

    status: StepStatus
    report: StageReport
    product: T_co | None = None
    short: bool = False


@dataclass(frozen=True, slots=True)
class PartRun:
    """One part through its stages, or one blank of a divided part: then `part` and `surface` are the blank's."""

    part: "Part"
    steps: tuple[Step[object], ...]
    surface: "Surface | None"
    pattern: "FlatPattern | None"


@dataclass(frozen=True, slots=True)
class JobResult:
    """What became of a job."""

    job: Job
    parts: tuple[PartRun, ...]
    nest: "Step[Nesting]"
    write: "Step[tuple[CutFile, ...]]"
    seconds: dict[str, float]

    @property
    def status(self) -> Status:
        """Return made, rejected (geometry says no), or no-solution (a method fell short, or it fits no sheet)."""
        steps = [step for run in self.parts for step in run.steps]
        if any(step.short for step in steps) or "fail" in (self.nest.status, self.write.status):
            return "no-solution"
        return "rejected" if any(step.status == "fail" for step in steps) else "made"

    @property
    def interrupted(self) -> bool:
        """Return whether someone stopped the search of the nest, and waits."""
        return any(finding.code == "interrupted" for finding in self.nest.report.findings)

    @property
    def exit_code(self) -> int:
        """Return the exit code of the command line; that of an interruption where the search was interrupted."""
        return EXIT_INTERRUPTED if self.interrupted and self.status == "made" else EXIT_CODES[self.status]


Listener = Callable[[Step[object]], None]


def silent(_step: Step[object]) -> None:
    """Tell no one."""


@dataclass(frozen=True, slots=True)
class Runner:
    """Runs stages: keeps the seconds of each and tells a listener how it went."""

    listener: Listener = silent
    seconds: dict[str, float] = field(default_factory=dict)

    def step(
        self, stage: Stage, subject: str, call: Callable[P, Outcome[T | None]], *args: P.args, **kw: P.kwargs
    ) -> Step[T]:
        """Return the step that a call makes; a stage that raises `NoSolutionError` has failed."""
        try:
            outcome = self.timed(stage, subject, call, *args, **kw)
            passed = outcome.product is not None and outcome.report.passed
            step: Step[T] = Step("pass", outcome.report, outcome.product) if passed else Step("fail", outcome.report)
        except NoSolutionError as error:
            step = Step("fail", fell_short(stage, subject, error), short=True)
        self.listener(step)
        return step

    def timed(self, stage: Stage, subject: str, call: Callable[P, T], *args: P.args, **kw: P.kwargs) -> T:
        """Return what a call returns, its seconds counted; an error but `NoSolutionError` names part and stage."""
        start = perf_counter()
        try:
            return call(*args, **kw)
        except NoSolutionError:
            raise
        except BaseException as error:
            error.add_note(f"part '{subject}', stage {stage}")
            raise
        finally:
            self.seconds[stage] = self.seconds.get(stage, 0.0) + perf_counter() - start


def fell_short(stage: Stage, subject: str, error: NoSolutionError) -> StageReport:
    """Return the report of a stage whose method fell short."""
    where: dict[str, float | int | str] = {"reached": error.reached, "wanted": error.wanted, "unit": error.unit}
    return StageReport(stage, subject, findings=(Finding("no-solution", str(error), fatal=True, where=where),))


def skipped(stage: Stage, subject: str) -> Step[T]:
    """Return the step of a stage that was not run."""
    return Step("skipped", StageReport(stage, subject))


Spread = Callable[[Runner, Job], Iterable[tuple[PartRun, ...]]]
"""How the parts of a job are run: yields the blanks of each, in the order of the parts."""


def one_after_the_other(runner: Runner, job: Job) -> Iterator[tuple[PartRun, ...]]:
    """Run the parts of a job in this process."""
    for part in job.parts:
        yield run_set(runner, part, job)


@dataclass(frozen=True, slots=True)
class Way:
    """How a job is run: its parts, and whatever else is one call for each of many things."""

    parts: Spread = one_after_the_other
    each: Each = in_turn


ALONE = Way()
"""All of it in this process."""


def spread(workers: int) -> Way:
    """Return the way to run a job in so many processes; in this one alone if that is enough."""
    if workers == 1:
        return ALONE
    from pipeline.forked import each_by
    from pipeline.parallel import spread_over

    return Way(spread_over(workers), each_by(workers))


def run_job(job: Job, listener: Listener = silent, by: Way = ALONE) -> JobResult:
    """Return what becomes of a job: each part constructed, verified, unrolled; all patterns nested and written.

    Nothing is nested unless every part passed; patterns of parts that passed are written flat in any case.
    """
    runner = Runner(listener)
    from pipeline.sewing import sewn_runs

    runs = [run for blanks in by.parts(runner, job) for run in blanks]
    return finish(runner, job, sewn_runs(runner, runs, job.tolerances), by.each)


def finish(runner: Runner, job: Job, parts: tuple[PartRun, ...], each: Each = in_turn) -> JobResult:
    """Return what becomes of a job whose parts have got as far as they get: nested and written."""
    nest: Step[Nesting] = skipped("nest", job.name)
    try:
        patterns = cut_patterns(parts, job)
    except NoSolutionError as error:
        fell: Step[tuple[CutFile, ...]] = Step("fail", fell_short("write", job.name, error), short=True)
        runner.listener(fell)
        return JobResult(job, parts, nest, fell, runner.seconds)
    if job.stock and len(patterns) == len(parts):
        nest = with_findings(nested(runner, patterns, job), job.repairs)
    write: Step[tuple[CutFile, ...]] = skipped("write", job.name)
    if patterns:
        from pipeline.certified import written

        names = file_names(parts, job)
        named = names.patterns(patterns)
        nesting = names.nesting(nest.product)
        write = runner.step("write", job.name, written, named, nesting, names.machine, job.options, each)
    return JobResult(job, parts, nest, write, runner.seconds)


def cut_patterns(parts: Sequence[PartRun], job: Job) -> "list[FlatPattern]":
    """Return the patterns of all parts that passed, with the contours that the flavour of the drawings can hold.

    Raises NoSolutionError where there are none such: nothing lies outside of a needle.
    """
    patterns = [run.pattern for run in parts if run.pattern is not None]
    if not patterns:
        return []
    from stages.write.flavours import as_cut

    return [as_cut(pattern, job.machine) for pattern in patterns]


def with_findings(step: Step[T], findings: Sequence[Finding]) -> Step[T]:
    """Return a step with what was found out before it."""
    report = replace(step.report, findings=(*findings, *step.report.findings))
    return replace(step, report=report) if findings else step


def nested(runner: Runner, patterns: "Sequence[FlatPattern]", job: Job) -> "Step[Nesting]":
    """Return the nest of all patterns, around the copies that a stored layout holds."""
    from stages.nest import nest

    if job.layout is None:
        return runner.step("nest", job.name, nest, patterns, job.stock, job.options, job.tolerances)
    from pipeline.layouts import placed

    there = placed(job.layout, job.stock, patterns)
    return runner.step("nest", job.name, nest, patterns, job.stock, job.options, job.tolerances, fixed=there)


def run_set(runner: Runner, part: "Part", job: Job) -> "tuple[PartRun, ...]":
    """Return the blanks of one part as far as they get, the seams between them compared; what differs is told."""
    from pipeline.sets import with_seams
    from stages.construct.sets import parts_of, seams_of

    alone = [run for piece in parts_of(part) for run in run_part(runner, piece, job)]
    seams = seams_of(part)
    runs = with_seams(alone, seams, job.tolerances) if seams else tuple(alone)
    for before, run in zip(alone, runs, strict=True):
        if run.steps[-1].report.findings != before.steps[-1].report.findings:
            runner.listener(run.steps[-1])
    return runs


def run_part(runner: Runner, part: "Part", job: Job) -> "tuple[PartRun, ...]":
    """Return one part as far as it gets: one run, or one for each blank that it is divided into."""
    from stages.construct import construct
    from stages.unroll import unroll
    from stages.unroll.divide import blanks
    from stages.verify import verify

    name, tol = part.name, job.tolerances
    made: Step[Surface] = runner.step("construct", name, construct, part, tol)
    proved: Step[Certificate] = skipped("verify", name)
    if made.product is not None:
        proved = runner.step("verify", name, verify, made.product, tol)
    if proved.product is None:
        return (PartRun(part, (made, proved, skipped("unroll", name)), made.product, None),)
    runs = []
    for blank in runner.timed("unroll", name, blanks, proved.product, tol):
        piece = blank.surface.part
        flat: Step[FlatPattern] = runner.step("unroll", piece.name, unroll, blank, tol)
        runs.append(PartRun(piece, (made, proved, flat), blank.surface, flat.product))
    return tuple(runs)
