"""A real scheduler and real workers, each in a process of its own, on this machine."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

PATIENCE_S = 120.0
DASK = (sys.executable, "-m", "dask")


@dataclass(slots=True)
class Dask:
    """A scheduler, its address, and its workers."""

    folder: Path
    address: str
    processes: list["subprocess.Popen[bytes]"] = field(default_factory=list)

    def worker(self, *options: str, daemon: bool = False) -> "subprocess.Popen[bytes]":
        """Start a worker of one thread."""
        words = ("worker", self.address, "--nthreads", "1", "--no-dashboard", *options)
        setting = {"DASK_DISTRIBUTED__WORKER__DAEMON": str(daemon)}
        started = _started(words, self.folder, setting)
        self.processes.append(started)
        return started


def _started(words: Sequence[str], folder: Path, setting: dict[str, str]) -> "subprocess.Popen[bytes]":
    surroundings = os.environ | setting | {"PYTHONPATH": os.pathsep.join(map(os.path.abspath, sys.path))}
    with (folder / "dask.log").open("ab") as log:
        return subprocess.Popen(
            (*DASK, *words), cwd=folder, env=surroundings, stdout=log, stderr=log, start_new_session=True
        )


@contextmanager
def dask(folder: Path) -> Iterator[Dask]:
    """Run a scheduler for the block; it and its workers are killed at the end."""
    said = folder / "scheduler.json"
    words = ("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(said))
    scheduler = _started(words, folder, {})
    running = Dask(folder, "", [scheduler])
    try:
        end = time.monotonic() + PATIENCE_S
        while not running.address:
            assert time.monotonic() < end, (folder / "dask.log").read_text()
            time.sleep(0.05)
            if said.exists() and said.stat().st_size:
                running.address = json.loads(said.read_text())["address"]
        yield running
    finally:
        for process in running.processes:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
