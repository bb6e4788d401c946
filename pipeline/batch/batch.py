"""One run of a batch from its begin to its end: whatever a run before it left is brought to its end first."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.batch import journal as journals
from pipeline.batch import publish
from pipeline.batch.asked import Asked
from pipeline.batch.entries import JOURNAL, Entries
from pipeline.batch.identity import Program
from pipeline.batch.journal import Journal
from pipeline.batch.lock import LOCK, held
from pipeline.batch.places import Places
from pipeline.batch.publish import DRAFTS, Tree
from pipeline.batch.runner import Listener, Loop, Stop
from pipeline.batch.stale import outdate
from pipeline.batch.stopped import full_disk_stops
from pipeline.batch.work import Limits
from stages.errors import BadInputError, Problem

if TYPE_CHECKING:
    from pipeline.batch.executor import Executor


NO_ONE = Asked()


@dataclass(frozen=True, slots=True)
class Order:
    """What is asked of a run: where to, under which limits, with which folders allowed, with which command."""

    out: Path
    limits: Limits
    allow: tuple[str, ...] = ()
    asked: Asked = NO_ONE


@dataclass(frozen=True, slots=True)
class Ready:
    """An output folder that this run has to itself, and its journal."""

    order: Order
    tree: Tree
    journal: Journal


@contextmanager
def ready(order: Order, by: Program) -> Iterator[Ready]:
    """Take an output folder for the block: what was being published is settled, what is out of date waits again."""
    refuse_foreign(order.out)
    with full_disk_stops(order.out), ExitStack() as open_:
        tree = publish.opened(order.out.absolute())
        open_.callback(tree.close)
        open_.enter_context(held(tree.out, str(order.out)))
        journal = journals.opened(order.out)
        open_.callback(journal.base.close)
        publish.settle(tree, journal)
        outdate(journal, by, order.allow, order.limits, tree.out)
        journal.begin(by, order.allow, order.limits, order.asked)
        yield Ready(order, tree, journal)


def run(at: Ready, entries: Entries, executor: "Executor", stop: Stop, tell: Listener) -> Loop:
    """Run jobs until none waits or the end is asked for, and return how it went; `StoppedError`."""
    places = Places(at.order.allow, at.order.limits)
    loop = Loop(at.journal, at.tree, executor, places, stop, tell)
    try:
        loop.run(entries)
    finally:
        places.close()
    return loop


def refuse_foreign(out: Path) -> None:
    """Raise `BadInputError` if a folder is neither free nor the output of a batch."""
    if out.is_symlink() or (out.exists() and not out.is_dir()):
        raise BadInputError(Problem("the output folder is a link or a file", hint="choose another", file=str(out)))
    if not out.exists() or (out / JOURNAL).exists():
        return
    strangers = {entry.name for entry in out.iterdir()} - {LOCK, DRAFTS}
    if strangers:
        what = f"holds {min(strangers)}, and no journal of a batch"
        raise BadInputError(Problem(what, hint="choose a new folder with -o", file=str(out)))
