"""The short form of the fuzzer, and that it sees what it looks for."""

import os
import subprocess
import sys
from pathlib import Path
from time import process_time

import pytest

from pipeline.cli import main
from tests.fuzz import trial
from tests.fuzz.grammar import Drawn
from tests.fuzz.lots import draw, run_one
from tests.fuzz.rendering import Raw, as_json, as_toml
from tests.fuzz.seeds import SEEDS

JOBS = 100
ROOT = Path(__file__).parent.parent.parent
GOOD = Drawn("job.toml", as_toml(SEEDS["flat"]).encode())


@pytest.fixture(autouse=True)
def _patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Here types are checked at every call, and libraries are loaded: the limit of time is not the one of a run."""
    monkeypatch.setattr(trial, "LIMIT_S", 30.0)


def test_no_drawn_job_breaks_anything(tmp_path: Path) -> None:
    command = [
        sys.executable,
        "-m",
        "tests.fuzz",
        "--jobs",
        str(JOBS),
        "--seed",
        "5",
        "--finds",
        str(tmp_path / "finds"),
    ]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, check=False, text=True)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    assert f"{JOBS} jobs in " in ended.stdout


def test_the_jobs_that_are_begun_with_run(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    for name in ("plate", "shell", "sewn", "turns"):
        (tmp_path / f"{name}.toml").write_text(as_toml(SEEDS[name]), "utf-8")
        (tmp_path / f"{name}.json").write_text(as_json(SEEDS[name]), "utf-8")
        for ending in ("toml", "json"):
            main_quietly(["check", str(tmp_path / f"{name}.{ending}")])
    assert "no errors" in capsys.readouterr().err


def main_quietly(arguments: list[str]) -> None:
    """Run a command that must not exit with an error."""
    try:
        main(arguments)
    except SystemExit as error:
        assert not error.code


def test_a_seed_draws_the_same_jobs_again() -> None:
    lists: list[list[Drawn]] = [[], []]
    for drawn in lists:
        draw(7, 20, drawn.append)
    assert lists[0] == lists[1]
    assert len({one.content for one in lists[0]}) > 10


def test_raw_text_stands_as_it_is() -> None:
    table: dict[str, object] = {"a b": [Raw("nan"), True, None, 'q"'], "x": {"y": 1.5}}
    assert as_toml(table) == '"a b" = [nan, true, "none", "q\\""]\nx = {y = 1.5}\n'
    assert as_json(table) == '{"a b": [nan, true, null, "q\\""], "x": {"y": 1.5}}'


def test_a_good_job_is_no_find(tmp_path: Path) -> None:
    assert run_one(GOOD, tmp_path / "root") is None


def test_a_traceback_is_found_with_its_place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trial, "run_job", lambda _: 1 / 0)
    fault = run_one(GOOD, tmp_path / "root")
    assert fault is not None
    assert (fault.sort, fault.where.partition(" ")[0]) == ("traceback", "ZeroDivisionError")


def test_computing_too_long_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def endless(_job: object) -> None:
        while True:
            process_time()

    monkeypatch.setattr(trial, "LIMIT_S", 0.1)
    monkeypatch.setattr(trial, "run_job", endless)
    fault = run_one(GOOD, tmp_path / "root")
    assert fault is not None
    assert fault.sort == "slow"


@pytest.mark.parametrize("way", ["open", "mkdir", "rename", "symlink"])
def test_writing_outside_of_the_root_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, way: str) -> None:
    outside = tmp_path / "outside"
    real = trial.run_job

    def leaky(job: object) -> object:
        ways = {
            "open": lambda: os.close(os.open(outside, os.O_CREAT | os.O_WRONLY)),
            "mkdir": outside.mkdir,
            "rename": lambda: (tmp_path / "root" / GOOD.name).rename(outside),
            "symlink": lambda: outside.symlink_to("/"),
        }
        ways[way]()
        return real(job)  # type: ignore[arg-type]

    monkeypatch.setattr(trial, "run_job", leaky)
    fault = run_one(GOOD, tmp_path / "root")
    assert fault is not None
    assert (fault.sort, str(outside) in fault.text) == ("outside", True)


def test_an_exit_code_that_says_nothing_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trial, "exit_code", lambda *_: 4)
    fault = run_one(GOOD, tmp_path / "root")
    assert fault is not None
    assert fault.sort == "code"
