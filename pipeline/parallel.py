"""The parts of one job run by several processes at a time; what comes of it is what one process would have made.

A part goes through its stages without the others, so each may go through them anywhere.  The processes get the whole
job once and then numbers of parts.  Results come in the order of the parts, and the steps of each are told when its
turn has come, so that reports and messages are the same as from one process; only seconds differ.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from pebble import ProcessExpired, ProcessPool

from pipeline.batch import children
from pipeline.job import Job
from pipeline.run import PartRun, Runner, Spread, Step, one_after_the_other, run_set


@dataclass(frozen=True, slots=True)
class Ran:
    """What became of a part: its blanks, the steps in the order in which they went, the seconds of each stage."""

    runs: tuple[PartRun, ...]
    steps: tuple[Step[object], ...]
    seconds: dict[str, float]


_job: list[Job] = []


def begin(job: Job) -> None:
    """Make this process one that runs parts of a job."""
    children.harmless()
    _job[:] = [job]


def run_number(number: int) -> Ran:
    """Return what becomes of one part of the job; runs in a child."""
    steps: list[Step[object]] = []
    runner = Runner(steps.append)
    runs = run_set(runner, _job[0].parts[number], _job[0])
    return Ran(runs, tuple(steps), runner.seconds)


def spread_over(workers: int) -> Spread:
    """Return the way to run the parts of a job in so many processes."""

    def spread(runner: Runner, job: Job) -> Iterator[tuple[PartRun, ...]]:
        if len(job.parts) == 1:
            yield from one_after_the_other(runner, job)
            return
        pool = ProcessPool(min(workers, len(job.parts)), 0, begin, (job,), children.context())
        try:
            asked = [pool.schedule(run_number, (number,)) for number in range(len(job.parts))]
            for part, future in zip(job.parts, asked, strict=True):
                try:
                    yield _told(runner, future.result())
                except ProcessExpired as end:
                    said, _ = children.end_of(end.exitcode, server=0)
                    raise RuntimeError(f"the process that ran part '{part.name}' has ended: {said}") from end
        finally:
            children.end(pool)

    return spread


def _told(runner: Runner, ran: Ran) -> tuple[PartRun, ...]:
    """Return the blanks of a part after telling its steps and adding its seconds."""
    for step in ran.steps:
        runner.listener(step)
    for stage, seconds in ran.seconds.items():
        runner.seconds[stage] = runner.seconds.get(stage, 0.0) + seconds
    return ran.runs
