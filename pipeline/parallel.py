"""The parts of one job run by several processes at a time; what comes of it is what one process would have made.

A part goes through its stages without the others, so each may go through them anywhere (`forked`).  Results come in
the order of the parts, and the steps of each are told when its turn has come, so that reports and messages are the same
as from one process; only seconds differ.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from pipeline.eager import load_parts
from pipeline.forked import EndedError, forked, forks
from pipeline.job import Job
from pipeline.run import PartRun, Runner, Spread, Step, one_after_the_other, run_set


@dataclass(frozen=True, slots=True)
class Ran:
    """What became of a part: its blanks, the steps in the order in which they went, the seconds of each stage."""

    runs: tuple[PartRun, ...]
    steps: tuple[Step[object], ...]
    seconds: dict[str, float]


def run_number(job: Job, number: int) -> Ran:
    """Return what becomes of one part of the job; runs in a child."""
    steps: list[Step[object]] = []
    runner = Runner(steps.append)
    return Ran(run_set(runner, job.parts[number], job), tuple(steps), runner.seconds)


def spread_over(workers: int) -> Spread:
    """Return the way to run the parts of a job in so many processes."""

    def spread(runner: Runner, job: Job) -> Iterator[tuple[PartRun, ...]]:
        if min(workers, len(job.parts)) == 1 or not forks():
            yield from one_after_the_other(runner, job)
            return
        load_parts()
        try:
            for ran in forked(lambda number: run_number(job, number), len(job.parts), workers):
                yield _told(runner, ran)
        except EndedError as error:
            name = job.parts[error.number].name
            raise RuntimeError(f"the process that ran part '{name}' has ended: {error.said}") from None

    return spread


def _told(runner: Runner, ran: Ran) -> tuple[PartRun, ...]:
    """Return the blanks of a part after telling its steps and adding its seconds."""
    for step in ran.steps:
        runner.listener(step)
    for stage, seconds in ran.seconds.items():
        runner.seconds[stage] = runner.seconds.get(stage, 0.0) + seconds
    return ran.runs
