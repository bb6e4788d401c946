"""Runs of tests in a copy: the copy is what is imported; what hangs or takes too long is ended with all it started."""

import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.mutants import running
from tests.mutants.running import clock, judged

ROOT = Path(__file__).parents[2]
PASSED = "tests/test_x.py::test_a[1 - 2] PASSED   [ 50%]\n"
TESTS = (
    "from stages.x import two\n\n\ndef test_a():\n    assert two() == 2\n\n\ndef test_b():\n    assert two() == {}\n"
)
BOTH = """
import sys
from pathlib import Path
from tests.mutants.running import run
for words in (["tests/test_x.py"], ["tests/test_x.py", "--deselect=tests/test_x.py::test_b"]):
    ended = run(Path(sys.argv[1]), words, 60.0)
    print(ended.how, ended.test or "-", ended.count)
"""


@pytest.mark.parametrize(
    ("log", "cut", "code", "how", "test"),
    [
        (PASSED, None, 0, "passed", ""),
        (PASSED + "tests/t.py::b FAILED [ 9%]\n\nFAILED tests/t.py::b - 1 - 2", None, 1, "failed", "tests/t.py::b"),
        ("ERROR tests/t.py - NameError", None, 2, "failed", "tests/t.py"),
        (PASSED + "tests/t.py::b Fatal Python error: Aborted", None, -6, "failed", "tests/t.py::b"),
        (PASSED + "tests/t.py::b ", "silent", -9, "silent", "tests/t.py::b"),
        (PASSED + "tests/t.py::b ", "spent", -9, "spent", "tests/t.py::b"),
    ],
)  # fmt: skip
def test_the_words_of_pytest_are_understood(log: str, cut: None, code: int, how: str, test: str) -> None:
    ended = judged(log, cut, code, 1.0)
    assert (ended.how, ended.test) == (how, test)
    assert ended.count == log.count("PASSED")


def test_what_ends_before_any_test_is_no_verdict() -> None:
    with pytest.raises(RuntimeError, match="before any test"):
        judged("pytest: error: unrecognized arguments", None, 4, 1.0)


def test_the_copy_is_what_is_tested(tmp_path: Path) -> None:
    """Its modules have the names of the project's, and its tests those of the tests that ask."""
    for name, text in {"stages/x.py": "def two():\n    return 2\n", "tests/test_x.py": TESTS.format(3)}.items():
        (tmp_path / name).parent.mkdir()
        (tmp_path / name).write_text(text)
        (tmp_path / name).with_name("__init__.py").write_text("")
    command = [sys.executable, "-c", BOTH, str(tmp_path)]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    assert ended.stdout.splitlines() == ["failed tests/test_x.py::test_b 1", "passed - 1"]


def forked(what: Callable[[], int]) -> int:
    """Start a process of its own that does something and ends."""
    child = os.fork()
    if child == 0:
        code = 1
        try:
            os.setsid()
            code = what()
        finally:
            os._exit(code)
    return child


def watched(log: Path, what: Callable[[], int], seconds: float, silent_s: float) -> tuple[str | None, int]:
    log.write_text("")
    child = forked(what)
    ended = running._watched(child, clock(child), log, seconds, silent_s)
    with pytest.raises(ChildProcessError):
        os.waitpid(child, 0)
    return ended


def test_silence_and_too_long_a_time_end_a_process(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    log = tmp_path / "log"

    def asleep() -> int:
        time.sleep(60.0)
        return 0

    def talks() -> int:
        while True:
            log.write_text(log.read_text() + "a word\n")
            time.sleep(0.01)

    monkeypatch.setattr(running, "BUSY", 1.0)
    assert watched(log, asleep, 60.0, 0.2)[0] == "silent"
    assert watched(log, talks, 0.3, 60.0)[0] == "spent"
    assert watched(log, lambda: 3, 60.0, 60.0) == (None, 3)


def test_a_process_that_waits_is_given_ten_times_as_long(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    monkeypatch.setattr(time, "clock_gettime", lambda _: 0.5)
    used = clock(1)
    now[0] += 4.0
    assert used() == 0.5
    now[0] += 16.0
    assert used() == 2.0
