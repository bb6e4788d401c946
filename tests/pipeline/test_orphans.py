"""What a killed process has started ends with it: the search of the nest, and the reader of CAD files."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.pipeline.batch.processes import alive_after, below, lives

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the kernel's help is that of Linux")
PATIENCE_S = 120.0

SEARCH = """
from tests.stages.nest.test_child import request
from stages.nest.child import Told, solve
import threading, time
told = Told()
def say():
    while told.ready is None:
        time.sleep(0.01)
    print("begun", flush=True)
threading.Thread(target=say, daemon=True).start()
solve(request(300.0), told)
"""
READER = """
import sys
from pipeline.cad.files import read_guarded
child = "from pipeline.cad import child; import sys, time; child.read = lambda *_: time.sleep(300); child.main()"
print("begun", flush=True)
read_guarded((sys.executable, "-c", child, "file", "step"), 300.0)
"""


def started(program: str) -> "subprocess.Popen[bytes]":
    """Return a process that has begun what it is to do."""
    process = subprocess.Popen((sys.executable, "-c", program), stdout=subprocess.PIPE, cwd=Path.cwd())
    assert process.stdout is not None
    assert process.stdout.readline() == b"begun\n"
    return process


def with_child(process: "subprocess.Popen[bytes]") -> set[int]:
    """Return a process and the one that it has started, once there is one that has had time to begin."""
    end = time.monotonic() + PATIENCE_S
    while len(found := below(process.pid)) < 2:
        assert time.monotonic() < end
        time.sleep(0.05)
    time.sleep(1.0)
    return found


@pytest.mark.parametrize("program", [SEARCH, READER], ids=["search", "reader"])
def test_a_child_is_gone_soon_after_its_parent_is_killed(program: str) -> None:
    with started(program) as parent:
        family: Sequence[int] = sorted(with_child(parent))
        assert all(map(lives, family))
        os.kill(parent.pid, signal.SIGKILL)
        assert not alive_after({*family}, 5.0)


ORPHAN = """
import os, sys, time
from pipeline.orphans import die_with_parent
die_with_parent(os.getppid() + 1)
print("alive", flush=True)
"""


def test_one_whose_parent_is_gone_already_does_not_begin() -> None:
    ended = subprocess.run((sys.executable, "-c", ORPHAN), capture_output=True, check=False, cwd=Path.cwd())
    assert (ended.returncode, ended.stdout) == (1, b"")
