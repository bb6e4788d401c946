"""The same guarded child on a real Dask scheduler with real workers, and what keeps a worker from being used."""

import signal
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from math import inf
from pathlib import Path

import pytest

from pipeline.batch import cluster, commands, digest
from pipeline.batch.cluster import Cluster, troubles
from pipeline.batch.identity import program
from pipeline.batch.remote import Host
from pipeline.cli import main
from stages.errors import BadInputError
from tests.pipeline.batch.daskprocesses import Dask, dask
from tests.pipeline.batch.poison import GOOD, ONCE, poisoned, work
from tests.pipeline.batch.poisonedbatch import Hurried, by_text, check, jobs_file
from tests.pipeline.batch.processes import alive_after, below

pytest.importorskip("distributed")
WAIT_S = 300.0
LINUX = pytest.mark.skipif(sys.platform != "linux", reason="the kernel's help is that of Linux")


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Dask]:
    with dask(tmp_path_factory.mktemp("dask")) as started:
        started.worker()
        yield started


@pytest.fixture
def workers(running: Dask, tmp_path: Path) -> Iterator[Cluster]:
    executor = Cluster(running.address, tmp_path, poisoned, WAIT_S)
    yield executor
    executor.close(now=True)


def test_good_jobs_among_poisonous_ones_are_all_made_on_a_cluster(tmp_path: Path, workers: Cluster) -> None:
    kinds = [GOOD] * 30
    kinds[3::10] = ["segfault", "exit 0", "hog"]
    futures = [workers.submit(work(tmp_path, number, kind)) for number, kind in enumerate(kinds)]
    records = [future.result(WAIT_S) for future in futures]
    assert [record.status == "made" for record in records] == [kind == GOOD for kind in kinds]
    assert [record.cause for record in records if record.status != "made"] == [
        "SIGSEGV",
        "the process ended by itself, exit code 0",
        "needs more than 400 MB of memory",
    ]
    made = [number for number, kind in enumerate(kinds) if kind == GOOD]
    assert all(records[number].digest == digest.folder(tmp_path / str(number)) for number in made)
    assert not list(tmp_path.glob(f"{cluster.PROBE}*"))


def test_a_whole_batch_with_poison_on_a_cluster(tmp_path: Path, running: Dask, monkeypatch: pytest.MonkeyPatch) -> None:
    jobs, out = jobs_file(tmp_path / "in"), tmp_path / "out"
    monkeypatch.setattr(commands, "executor_of", lambda _means, at: Hurried(Cluster(running.address, at, by_text)))
    with pytest.raises(SystemExit) as ended:
        main(["batch", str(jobs), "-o", str(out), "--memory", "400"])
    assert ended.value.code == commands.EXIT_SOME_FAILED
    check(jobs, out)


@pytest.mark.parametrize(("threads", "counted"), [({"one": 4, "other": 3}, 7), ({}, 1)])
def test_slots_follow_the_threads(
    threads: dict[str, int], counted: int, workers: Cluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where no worker is left there is still one slot: the next job waits for one that comes."""
    assert workers.slots == cluster.AHEAD
    with monkeypatch.context() as patched:
        patched.setattr(workers.client, "nthreads", lambda: threads)
        patched.setattr(workers, "counted", -inf)
        assert workers.slots == cluster.AHEAD * counted
    workers.counted = -inf


def test_a_job_on_another_planish_comes_back_unrun_and_unblamed(tmp_path: Path, workers: Cluster) -> None:
    workers.by = replace(workers.by, code="0" * 64)
    record = workers.submit(work(tmp_path, 0)).result(WAIT_S)
    assert not record.own
    assert "the code of planish" in record.cause


@LINUX
def test_a_worker_that_is_killed_takes_its_child_along_and_no_job_is_blamed(tmp_path: Path) -> None:
    with dask(tmp_path) as running:
        first = running.worker("--no-nanny")
        executor = Cluster(running.address, tmp_path, poisoned, WAIT_S)
        assert executor.submit(work(tmp_path, 0)).result(WAIT_S).status == "made"
        lost = executor.submit(work(tmp_path, 1, ONCE, 600.0))
        good = [executor.submit(work(tmp_path, number)) for number in range(2, 6)]
        while not (tmp_path / "1.begun").exists():
            time.sleep(0.05)
        started = below(first.pid)
        first.send_signal(signal.SIGKILL)
        assert not alive_after(started, 5.0)
        running.worker("--no-nanny")
        assert [future.result(WAIT_S).status for future in good] == ["made"] * 4
        assert lost.result(WAIT_S).status == "made"
        executor.close(now=True)


def test_a_worker_that_may_have_no_children_is_refused_with_the_cure(tmp_path: Path) -> None:
    with dask(tmp_path) as running:
        running.worker(daemon=True)
        with pytest.raises(BadInputError) as caught:
            Cluster(running.address, tmp_path, poisoned, WAIT_S)
        (problem,) = caught.value.problems
        assert "is a daemon" in problem.message
        assert "DASK_DISTRIBUTED__WORKER__DAEMON=False dask worker tcp://" in problem.hint
        with pytest.raises(BadInputError, match="has no workers"):
            running.processes.pop().send_signal(signal.SIGKILL)
            time.sleep(1.0)
            Cluster(running.address, tmp_path, poisoned, 0.1)


def test_no_scheduler_is_said_with_the_cure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "CONNECT_S", 0.5)
    with pytest.raises(BadInputError, match=r"no Dask scheduler answers at tcp://127\.0\.0\.1:9.*dask scheduler"):
        Cluster("tcp://127.0.0.1:9", tmp_path)


FIT = Host("node:1", program(), daemon=False, found="probe", answered=True)
UNFIT = {
    "is not what runs here: the code of planish": replace(FIT, program=replace(FIT.program, code="")),
    "is a daemon": replace(FIT, daemon=True),
    "does not see": replace(FIT, found="", answered=False),
    "cannot write to": replace(FIT, answered=False),
    "cannot run planish: ModuleNotFoundError: No module named 'pipeline'": ModuleNotFoundError(
        "No module named 'pipeline'"
    ),
}


@pytest.mark.parametrize("said", UNFIT)
def test_what_is_wrong_with_a_worker_is_said_and_nothing_else(tmp_path: Path, said: str) -> None:
    assert not list(troubles({"tcp://a": FIT}, FIT.program, "tcp://s", tmp_path))
    (problem,) = troubles({"tcp://a": FIT, "tcp://b": UNFIT[said]}, FIT.program, "tcp://s", tmp_path)
    assert problem.message.startswith(f"worker tcp://b {said}")
    assert problem.hint
