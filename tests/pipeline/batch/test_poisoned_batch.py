"""One job in ten is poison: all good ones are made, every bad one is named, put aside, and not run again unasked."""

from pathlib import Path

import pytest

from pipeline.batch import commands
from pipeline.batch.executor import Local
from tests.pipeline.batch.calls import call
from tests.pipeline.batch.inprocess import InProcess, made
from tests.pipeline.batch.poisonedbatch import BAD, Hurried, by_text, check, jobs_file, kinds


def test_a_batch_with_poison_on_this_machine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    jobs, out = jobs_file(tmp_path / "in"), tmp_path / "out"
    monkeypatch.setattr(commands, "executor_of", lambda *_args: Hurried(Local(2, by_text)))
    assert call("batch", jobs, "-o", out, "--memory", 400) == 3
    check(jobs, out)
    stand_in = InProcess(job=made)
    monkeypatch.setattr(commands, "executor_of", lambda *_args: stand_in)
    assert call("batch", jobs, "-o", out, "--memory", 400) == 3
    assert stand_in.ran == [], "what was put aside is not run again"
    assert call("retry", out) == 0
    bad = [f"jobs-{line:07}" for line, kind in enumerate(kinds(), 1) if kind in BAD]
    assert stand_in.ran == bad
