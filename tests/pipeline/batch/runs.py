"""Runs of a batch for tests: with the executor of the test's own process, and a program that never changes."""

from dataclasses import dataclass, field
from pathlib import Path

from pipeline.batch import batch
from pipeline.batch.asked import Asked
from pipeline.batch.entries import Entries, entries
from pipeline.batch.executor import Executor
from pipeline.batch.identity import Program
from pipeline.batch.runner import Event, Loop, Stop
from pipeline.batch.work import Limits
from tests.pipeline.batch.inprocess import InProcess

PROGRAM = Program("code", "tables", "libraries 1")
LIMITS = Limits(60.0, 1 << 30)


@dataclass(slots=True)
class Heard:
    """Collects events."""

    events: list[Event] = field(default_factory=list)

    def __call__(self, _loop: Loop, event: Event | None) -> None:
        if event is not None:
            self.events.append(event)


def go(
    out: Path,
    jobs: Path | Entries,
    executor: InProcess | None = None,
    *,
    by: Program = PROGRAM,
    allow: tuple[str, ...] = (),
    limits: Limits = LIMITS,
    heard: Heard | None = None,
) -> list[str]:
    """Run a batch to its end and return the ids of the jobs that were run for it, in order."""
    executor = executor or InProcess()
    with batch.ready(batch.Order(out, limits, allow, Asked("planish batch")), by) as at:
        batch.run(at, entries([jobs]) if isinstance(jobs, Path) else jobs, executor, Stop(), heard or Heard())
    return executor.ran


def go_through(executor: Executor, out: Path, jobs: Path) -> None:
    """Run a batch to its end through an executor that has children."""
    with batch.ready(batch.Order(out, LIMITS), PROGRAM) as at:
        batch.run(at, entries([jobs]), executor, Stop(), Heard())


def lines_file(folder: Path, count: int, name: str = "jobs.jsonl", first: int = 0) -> Path:
    """Write a file of JSON Lines and return it."""
    folder.mkdir(exist_ok=True)
    file = folder / name
    file.write_text("".join(f'{{"number": {number}}}\n' for number in range(first, first + count)))
    return file
