"""The commands of a batch, as a user calls them: exit codes, what is told, how a run is ended."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from pipeline.batch.identity import program
from pipeline.batch.work import Record, Work
from tests.pipeline.batch.calls import call, plain
from tests.pipeline.batch.inprocess import InProcess, made, made_as, tree
from tests.pipeline.batch.runs import go, lines_file


def test_a_batch_that_is_made_ends_with_0(
    tmp_path: Path, executor: InProcess, capsys: pytest.CaptureFixture[str]
) -> None:
    jobs = lines_file(tmp_path / "in", 3)
    assert call("batch", jobs, "-o", tmp_path / "out") == 0
    look = f"look at {tmp_path / 'out' / 'summary.html'}\n"
    assert capsys.readouterr().err == f"3 jobs: 3 made, 0 waiting\n{look}"
    assert call("batch", jobs, "-o", tmp_path / "out", "--quiet") == 0
    assert len(executor.ran) == 3
    assert capsys.readouterr() == ("", "")


def rejecting(work: Work) -> Record:
    return made_as(work, "rejected" if work.line == 2 else "made")


def test_a_batch_with_a_job_that_is_not_made_ends_with_3_and_names_it(
    tmp_path: Path, executor: InProcess, capsys: pytest.CaptureFixture[str]
) -> None:
    executor.job = rejecting
    jobs, out = lines_file(tmp_path / "in", 3), tmp_path / "out"
    assert call("batch", jobs, "-o", out) == 3
    told, look = "jobs-0000002: rejected: no\n3 jobs: 2 made, 1 rejected, 0 waiting\n", out / "summary.html"
    assert capsys.readouterr().err == f"{told}look at {look}\n"
    assert call("batch", jobs, "-o", out) == 3
    assert "  jobs-0000002: rejected: no\n" in capsys.readouterr().err
    plain("status", out)
    assert capsys.readouterr().out == "3 jobs: 2 made, 1 rejected, 0 waiting\n  jobs-0000002: rejected: no\n"


def test_events_and_status_as_json(tmp_path: Path, executor: InProcess, capsys: pytest.CaptureFixture[str]) -> None:
    executor.job = rejecting
    out = tmp_path / "out"
    call("batch", lines_file(tmp_path / "in", 2), "-o", out, "--json")
    events = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [(event["event"], event.get("job"), event.get("status")) for event in events] == [
        ("ended", "jobs-0000001", "made"),
        ("ended", "jobs-0000002", "rejected"),
        ("end", None, None),
    ]
    plain("status", out, "--json")
    document = json.loads(capsys.readouterr().out)
    assert document["schema"] == "planish-batch/1"
    assert (document["jobs"], document["made"], document["rejected"]) == (2, 1, 1)
    assert document["failed"] == [{"job": "jobs-0000002", "status": "rejected", "cause": "no"}]


def test_explain_gives_a_command_that_runs_a_line_by_itself(
    tmp_path: Path, executor: InProcess, capsys: pytest.CaptureFixture[str]
) -> None:
    jobs, out = lines_file(tmp_path / "with space", 3), tmp_path / "out"
    call("batch", jobs, "-o", out)
    plain("explain", out, "jobs-0000002")
    told = capsys.readouterr().out
    assert f"jobs-0000002: {jobs}:2" in told
    taken = next(line for line in told.splitlines() if "by itself: " in line).split("by itself: ")[1].split(" && ")[0]
    subprocess.run(taken, shell=True, check=True)
    assert (jobs.parent / "jobs-0000002.json").read_text() == '{"number": 1}\n'


def test_explain_gives_a_command_that_runs_a_row_by_itself(
    tmp_path: Path, executor: InProcess, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "blade.toml").write_text("schema = 1\n")
    (tmp_path / "rows.csv").write_text('id,job.name\none,"a b"\n')
    out = tmp_path / "out"
    assert call("batch", tmp_path / "blade.toml", "--table", tmp_path / "rows.csv", "-o", out) == 0
    capsys.readouterr()
    plain("explain", out, "one")
    assert f"by itself: planish run {tmp_path / 'blade.toml'} --set 'job.name=a b'" in capsys.readouterr().out


def test_a_folder_without_jobs_ends_with_2_and_what_was_left_out_is_told(
    tmp_path: Path, executor: InProcess, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "stock.json").write_text("{}")
    assert call("batch", tmp_path / "in", "-o", tmp_path / "out") == 2
    told = capsys.readouterr().err
    assert "note: " in told
    assert "1 *.json left out" in told
    assert "no jobs" in told
    assert executor.ran == []


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["batch", "none.toml"], "no such file or folder"),
        (["batch", "a.toml", "b.toml", "--table", "rows.csv"], "takes one job file as its template"),
        (["batch"], "Missing argument"),
        (["status", "nowhere"], "there is no journal"),
        (["explain", "nowhere", "job"], "there is no journal"),
        (["retry", "nowhere"], "there is no journal"),
        (["batch", "a.toml", "--workers", "0"], "--workers"),
    ],
)
def test_wrong_usage_ends_with_2(words: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(*words) == 2
    assert message in capsys.readouterr().err


def test_a_full_disk_ends_with_75_and_the_remedy_and_the_batch_goes_on(
    tmp_path: Path, executor: InProcess, capsys: pytest.CaptureFixture[str]
) -> None:
    jobs, out = lines_file(tmp_path / "in", 3), tmp_path / "out"
    full = Record("crashed", f"the files of the job could not be written: {os.strerror(28)}", 0.0, (), "", own=False)
    executor.job = lambda work: full if work.line == 2 else made(work)
    assert call("batch", jobs, "-o", out) == 75
    told = capsys.readouterr().err
    assert "No space left on device (make space there, and run the same command again)" in told
    assert f"go on with: planish batch {jobs} -o {out}\n" in told
    executor.job = made
    assert call("batch", jobs, "-o", out) == 0
    assert len(tree(out)) == 6


SLOW = """
import sys, time
from pipeline.batch import commands
from pipeline.cli import main
from tests.pipeline.batch.inprocess import InProcess, made

def slow(work):
    time.sleep(0.2)
    return made(work)

commands.executor_of = lambda *_args: InProcess(job=slow, slots=1)
main(sys.argv[1:])
"""


def started(*words: object) -> "subprocess.Popen[str]":
    """Start a batch of slow jobs in a process of its own."""
    command = [sys.executable, "-c", SLOW, *map(str, words)]
    return subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)


def when_begun(out: Path) -> None:
    """Wait until the first job is published."""
    end = time.monotonic() + 60
    while not (out / "jobs-0000001").exists() and time.monotonic() < end:
        time.sleep(0.02)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_finishes_what_runs_and_tells_how_to_go_on(tmp_path: Path, number: signal.Signals) -> None:
    jobs, out = lines_file(tmp_path / "in", 200), tmp_path / "out"
    with started("batch", jobs, "-o", out) as batch:
        when_begun(out)
        batch.send_signal(number)
        _, told = batch.communicate(timeout=60)
    assert batch.returncode == 75
    assert f"go on with: planish batch {jobs} -o {out}" in told
    made_so_far = [path for path in out.iterdir() if path.is_dir() and path.name != ".drafts"]
    assert 0 < len(made_so_far) < 200
    assert all((path / "report.json").exists() for path in made_so_far)


def test_an_end_asked_for_while_jobs_are_taken_in_is_no_end_of_the_batch(
    tmp_path: Path, executor: InProcess, capsys: pytest.CaptureFixture[str]
) -> None:
    def job(work: Work) -> Record:
        if work.line == 1:
            os.kill(os.getpid(), signal.SIGINT)
        return made(work)

    executor.job, executor.slots = job, 1000
    jobs, out = lines_file(tmp_path / "in", 300), tmp_path / "out"
    assert call("batch", jobs, "-o", out) == 75
    assert "256 jobs: 256 made, 0 waiting\ngo on with: planish batch " in capsys.readouterr().err
    executor.job = made
    assert call("batch", jobs, "-o", out) == 0
    assert len(executor.ran) == 300


def test_a_second_signal_stops_at_once_and_nothing_is_lost(tmp_path: Path, executor: InProcess) -> None:
    def job(work: Work) -> Record:
        for number in (signal.SIGINT, signal.SIGTERM) if work.line == 5 else ():
            os.kill(os.getpid(), number)
        return made(work)

    executor.job, executor.slots = job, 1
    jobs, out = lines_file(tmp_path / "in", 20), tmp_path / "out"
    assert call("batch", jobs, "-o", out) == 130
    assert executor.ran[-1] == "jobs-0000005"
    assert len(go(out, jobs, by=program())) >= 15
    assert len(tree(out)) == 40
