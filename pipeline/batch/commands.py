"""`planish batch`, `status`, `retry`, `explain`: arguments -> one run of a batch, or one look into its journal.

Exit codes: 0 all made; 3 some were not; 2 wrong usage; 75 not at its end, and nothing is lost; 130 stopped at once.
"""

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from platform import system
from typing import TYPE_CHECKING

import click

from pipeline.batch.asked import asked
from pipeline.plaintext import plain, plain_lines

if TYPE_CHECKING:
    from types import FrameType

    from pipeline.batch.batch import Order, Ready
    from pipeline.batch.entries import Entries
    from pipeline.batch.executor import Executor
    from pipeline.batch.progress import Progress
    from pipeline.batch.runner import Loop, Stop

EXIT_SOME_FAILED, EXIT_RESUMABLE = 3, 75
TIMEOUT_S, MEMORY_MB = 600.0, 2048
MEGABYTE = 1 << 20

Out = click.argument("out", type=click.Path(path_type=Path), metavar="OUT")
AsJson = click.option("--json", "as_json", is_flag=True, help="Write JSON to stdout: events as lines, or one document.")
Quiet = click.option("--quiet", is_flag=True, help="No messages but errors.")
Workers = click.option(
    "--workers", type=click.IntRange(1, 4096), metavar="N", help="Children on this machine; one a core if absent."
)
Cluster = click.option("--cluster", metavar="ADDRESS", help="Address of a Dask scheduler that runs the jobs instead.")
Timeout = click.option("--timeout", type=click.FloatRange(min=0, min_open=True), metavar="S", help="For one job.")
Memory = click.option("--memory", type=click.IntRange(64), metavar="MB", help="For one job.")


@dataclass(frozen=True, slots=True)
class Means:
    """What runs the jobs, and what is told of it."""

    workers: int | None
    cluster: str | None
    as_json: bool
    quiet: bool


@click.command()
@click.argument("paths", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="PATH...")
@click.option("-o", "--out", type=click.Path(path_type=Path), default=Path("out/batch"), show_default=True)
@Workers
@Cluster
@click.option("--table", type=click.Path(path_type=Path), metavar="ROWS.csv", help="A job for each row of values.")
@click.option(
    "--allow", multiple=True, type=click.Path(path_type=Path, exists=True, file_okay=False), metavar="FOLDER",
    help="Jobs may name files in it, not only beside themselves.",
)  # fmt: skip
@Timeout
@Memory
@AsJson
@Quiet
def batch(
    paths: tuple[Path, ...],
    out: Path,
    *,
    workers: int | None,
    cluster: str | None,
    table: Path | None,
    allow: tuple[Path, ...],
    timeout: float | None,
    memory: int | None,
    as_json: bool,
    quiet: bool,
) -> None:
    """Run many jobs: folders, job files, globs, JSON Lines, or a template with a table; goes on where it was."""
    from pipeline.batch.batch import Order
    from pipeline.batch.entries import entries, silent
    from pipeline.batch.families import rows, table_of
    from pipeline.batch.work import Limits
    from stages.errors import BadInputError, Problem

    if table is not None and len(paths) != 1:
        raise BadInputError(Problem("--table takes one job file as its template", hint="one PATH"))
    tell = silent if quiet else note
    jobs = entries(paths, tell) if table is None else rows(table_of(table, paths[0]))
    limits = Limits(timeout or TIMEOUT_S, (memory or MEMORY_MB) * MEGABYTE)
    allowed = tuple(sorted(str(folder.resolve()) for folder in allow))
    order = Order(out, limits, allowed, asked(click.get_current_context()))
    _run(order, jobs, Means(workers, cluster, as_json, quiet))


@click.command()
@Out
@Workers
@Cluster
@Timeout
@Memory
@AsJson
@Quiet
def retry(
    out: Path,
    *,
    workers: int | None,
    cluster: str | None,
    timeout: float | None,
    memory: int | None,
    as_json: bool,
    quiet: bool,
) -> None:
    """Run the jobs of a batch again that were not made, and those that still wait."""
    from pipeline.batch.batch import Order
    from pipeline.batch.told import last_run
    from pipeline.batch.work import Limits

    before, allow = last_run(out)
    limits = Limits(timeout or before.wall_s, memory * MEGABYTE if memory else before.memory_bytes)
    _run(Order(out, limits, allow, asked(click.get_current_context())), None, Means(workers, cluster, as_json, quiet))


@click.command()
@Out
@AsJson
def status(out: Path, as_json: bool) -> None:
    """Say how far a batch is, and how to go on with one that was stopped."""
    import json

    from pipeline.batch.journal import reading
    from pipeline.batch.told import LISTED, LISTED_IN_DOCUMENT, onward, onward_lines, tally

    base = reading(out)
    if as_json:
        click.echo(json.dumps(tally(base, LISTED_IN_DOCUMENT).document() | onward(base, out), indent=1))
    else:
        show(*tally(base, LISTED).lines(), *onward_lines(base, out))


@click.command()
@Out
@click.argument("job")
def explain(out: Path, job: str) -> None:
    """Say what is known of a job of a batch, why it ran the last time, and how to run it by itself."""
    from pipeline.batch.journal import reading
    from pipeline.batch.told import explain as told

    show(*told(reading(out), job, out))


def show(*lines: str) -> None:
    """Write to stdout, for people, what may hold names of files and their contents."""
    click.echo("\n".join(map(plain, lines)))


def say(text: str) -> None:
    """Write lines to stderr."""
    click.echo(plain_lines(text), err=True)


def note(text: str) -> None:
    """Say what was assumed."""
    say(f"note: {text}")


def _run(order: "Order", jobs: "Entries | None", means: Means) -> None:
    """Run a batch, or the failed jobs of one, and exit."""
    if system() != "Linux":
        raise click.UsageError("batches run on Linux alone: their guards and locks are those of its kernel")
    from pipeline.batch.batch import ready
    from pipeline.batch.identity import program
    from pipeline.batch.progress import Progress
    from pipeline.batch.runner import Stop
    from pipeline.batch.stopped import StoppedError
    from pipeline.batch.told import tally_of_run

    stop, terminal = Stop(), sys.stderr.isatty()
    progress = Progress(
        lambda text: click.echo(text, err=True, nl=not terminal),
        click.echo if means.as_json else None,
        terminal,
        means.quiet,
    )
    try:
        with ready(order, program()) as at, heard(stop):
            loop = _through(at, jobs, means, stop, progress)
            counts = tally_of_run(at.journal.base, at.journal.run)
    except StoppedError as error:
        progress.clear()
        say(f"stopped: {error}\ngo on with: {order.asked.line()}")
        sys.exit(EXIT_RESUMABLE)
    progress.clear()
    progress.end(counts)
    if counts.waiting or loop.left is None:
        say(f"go on with: {order.asked.line()}")
        sys.exit(EXIT_RESUMABLE)
    said = _summarised(order.out, counts.jobs) if loop.drafts else ""
    if said and not means.quiet:
        say(said)
    sys.exit(0 if counts.all_made else EXIT_SOME_FAILED)


def _summarised(out: Path, jobs: int) -> str:
    """Summarise a batch if that takes seconds, and return where the summary lies, or how to have one."""
    from pipeline.batch.summarised import FEW, summarise
    from stages.errors import BadInputError

    if jobs > FEW:
        return f"summary: planish report {out}"
    try:
        return f"look at {out / summarise(out)[0]}"
    except BadInputError as error:
        return str(error.problems[0])


def _through(at: "Ready", jobs: "Entries | None", means: Means, stop: "Stop", progress: "Progress") -> "Loop":
    """Run the jobs through an executor that is ended in any case, and return how it went."""
    from pipeline.batch.batch import run
    from stages.errors import BadInputError, Problem

    if jobs is None:
        at.journal.retry()
    executor = executor_of(means, at.tree.path)
    clean = False
    try:
        loop = run(at, iter(()) if jobs is None else jobs, executor, stop, progress)
        clean = True
    finally:
        executor.close(now=not clean)
    if jobs is not None and not (loop.accepted or stop.asked):
        message = "no jobs: the folders hold no *.toml and *.jsonl, these are empty, or the table has but its first row"
        raise BadInputError(Problem(message))
    return loop


def executor_of(means: Means, out: Path) -> "Executor":
    """Return who runs the jobs that are written below `out`."""
    if means.cluster is not None:
        from pipeline.batch.cluster import Cluster

        return Cluster(means.cluster, out)
    from pipeline.batch.executor import Local

    return Local(means.workers or len(os.sched_getaffinity(0)))


@contextmanager
def heard(stop: "Stop") -> Iterator[None]:
    """Take Ctrl-C and SIGTERM for the block as a wish to end: what runs is finished; a second one ends at once."""

    def asked(_number: int, _frame: "FrameType | None") -> None:
        stop.asked += 1
        if stop.asked == 1:
            os.write(2, b"\nfinishing what runs; once more: stopping at once\n")

    before = {number: signal.signal(number, asked) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
