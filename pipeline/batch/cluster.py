"""Jobs on the workers of a Dask scheduler: the only place that knows `distributed`.

Dask spreads the jobs and hands those of a lost worker to another; what a job may do to its process is met by the child
that each thread of a worker keeps (`remote`).  Scheduler and workers are trusted: whoever reaches them can run code.
Before the first job every worker is asked whether it is fit; the answers of those that are not become one error that
says the cure.
"""

import secrets
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Future, wait
from contextlib import suppress
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from time import monotonic
from typing import Protocol

from pipeline import __version__
from pipeline.batch import children, remote
from pipeline.batch.children import Run
from pipeline.batch.identity import Program, program
from pipeline.batch.remote import Host
from pipeline.batch.work import Record, Work
from stages.errors import BadInputError, Problem

CONNECT_S = 15.0
WORKERS_S = 60.0
"""How long to wait for the first worker: a queue of a cluster may take its time, a user should hear of it."""
AHEAD = 2
"""Jobs to keep submitted for each thread, so that the next is there when one ends; all count as begun."""
COUNTED_S = 5.0
"""How long a count of threads is good for."""
PROBE = ".planish-probe"
START = "DASK_DISTRIBUTED__WORKER__DAEMON=False dask worker {address} --nworkers auto --nthreads 1"


class Task(Protocol):
    """What `distributed` calls a future."""

    def result(self) -> Record:
        """Return what the call returned, or raise what it raised."""

    def cancel(self) -> None:
        """Have the scheduler forget it."""

    def add_done_callback(self, called: "Callable[[Task], None]") -> None:
        """Have it told when it is done, in a thread."""


class Client(Protocol):
    """What is used of the connection to a scheduler."""

    def submit(self, call: Callable[..., Record], *words: object, pure: bool) -> Task:
        """Have a call made by some worker."""

    def run(self, call: Callable[..., Host], *words: object, on_error: str) -> "Mapping[str, Host | BaseException]":
        """Have a call made by every worker; its errors are returned."""

    def nthreads(self) -> Mapping[str, int]:
        """Return the threads of each worker."""

    def wait_for_workers(self, n_workers: int, timeout: float) -> None:
        """Wait until there are so many workers."""

    def close(self) -> None:
        """Leave."""


class Cluster:
    """Jobs on the workers of the scheduler at an address; out: the folder that all of them must see."""

    def __init__(self, address: str, out: Path, run: Run = children.guarded, workers_s: float = WORKERS_S) -> None:
        self.call, self.by = run, program()
        self.client = connected(address)
        self.threads, self.counted = 0, 0.0
        self.flying: dict[Future[Record], Task] = {}
        try:
            unfit = list(troubles(hosts(self.client, address, out, workers_s), self.by, address, out))
        except BaseException:
            self.client.close()
            raise
        if unfit:
            self.client.close()
            raise BadInputError(*unfit)

    @property
    def slots(self) -> int:
        """Return how many jobs to keep submitted: it follows the workers that come and go."""
        if monotonic() - self.counted > COUNTED_S:
            with suppress(Exception):
                self.threads = sum(self.client.nthreads().values())
            self.counted = monotonic()
        return AHEAD * max(self.threads, 1)

    def submit(self, work: Work) -> "Future[Record]":
        """Return what will become of a job; one that no scheduler takes comes back at once."""
        future: Future[Record] = Future()
        future.set_running_or_notify_cancel()
        try:
            task = self.client.submit(remote.run, self.call, self.by, work, pure=False)
        except Exception as error:
            future.set_result(lost(f"the scheduler cannot be reached: {error}"))
            return future
        self.flying[future] = task
        task.add_done_callback(lambda ended: self._landed(future, ended))
        return future

    def _landed(self, future: "Future[Record]", task: Task) -> None:
        """Pass on what a task returned, or why it did not."""
        try:
            record = task.result()
        except BaseException as error:
            record = lost(f"{type(error).__name__}: {error}")
        self.flying.pop(future, None)
        future.set_result(record)

    def close(self, *, now: bool) -> None:
        """Leave the cluster: once what is submitted has been run, or now.

        Then the scheduler forgets what waits; a job that a child has begun is run to its end, and no one asks for it.
        """
        if not now:
            wait(list(self.flying))
        for task in list(self.flying.values()):
            with suppress(Exception):
                task.cancel()
        self.client.close()


def lost(why: str) -> Record:
    """Return the record of a job that the cluster lost."""
    return Record("crashed", " ".join(why.split()), 0.0, (), "", own=False)


def connected(address: str) -> Client:
    """Return the connection to a scheduler; `BadInputError` where there is none."""
    try:
        make: Callable[..., Client] = import_module("distributed").Client
    except ImportError:
        problem = Problem("the library for clusters is not installed", hint="pip install planish[cluster]")
        raise BadInputError(problem) from None
    try:
        return make(address, timeout=CONNECT_S, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        said = f"no Dask scheduler answers at {address}: {error}"
        hint = "start one with `dask scheduler`, and give the address that it prints"
        raise BadInputError(Problem(said, hint=hint)) from None


def hosts(client: Client, address: str, out: Path, workers_s: float) -> Mapping[str, Host | BaseException]:
    """Return every worker as it sees itself, by its address; `BadInputError` where there is none."""
    try:
        client.wait_for_workers(1, timeout=workers_s)
    except TimeoutError:
        said = f"the scheduler at {address} has no workers after {workers_s:g} s"
        raise BadInputError(Problem(said, hint=START.format(address=address))) from None
    probe = out.absolute() / f"{PROBE}-{secrets.token_hex(8)}"
    out.mkdir(parents=True, exist_ok=True)
    probe.write_text(probe.name, "ascii")
    try:
        answers = client.run(remote.look, str(probe), on_error="return")
        return {name: _seen(answer, probe) for name, answer in answers.items()}
    finally:
        for file in out.glob(f"{probe.name}*"):
            file.unlink(missing_ok=True)


def _seen(answer: Host | BaseException, probe: Path) -> Host | BaseException:
    """Return an answer; one that says it wrote beside the probe where nothing came has written somewhere else."""
    if not isinstance(answer, Host):
        return answer
    there = probe.with_name(f"{probe.name}.{answer.name.replace(':', '-')}").exists()
    return answer if there else replace(answer, answered=False)


def troubles(found: Mapping[str, Host | BaseException], by: Program, address: str, out: Path) -> Iterator[Problem]:
    """Yield what keeps workers from running jobs, with the cure."""
    for name, host in sorted(found.items()):
        if not isinstance(host, Host):
            said = f"worker {name} cannot run planish: {type(host).__name__}: {host}"
            yield Problem(said, hint=f"install planish {__version__} in its environment")
            continue
        changes = host.program.changes(by)
        if changes:
            said = f"worker {name} is not what runs here: {'; '.join(changes)}"
            yield Problem(said, hint="use one environment, or one container image, for the runner and all workers")
        if host.daemon:
            said = f"worker {name} is a daemon, which may have no children"
            yield Problem(said, hint=f"start it with {START.format(address=address)}")
        if not host.answered:
            said = f"worker {name} {'cannot write to' if host.found else 'does not see'} {out.absolute()}"
            yield Problem(said, hint="give an output folder on a file system that all machines share")
