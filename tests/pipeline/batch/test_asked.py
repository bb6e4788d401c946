"""The command that a run was asked for with, and what status says of how to go on."""

import json
import os
import shlex
import signal
from pathlib import Path

import pytest

from pipeline.batch import commands, journal, told
from pipeline.batch.asked import Asked
from pipeline.batch.batch import Order
from pipeline.batch.lock import held, holder
from pipeline.batch.work import Record, Work
from pipeline.cli import main
from stages.errors import BadInputError
from tests.pipeline.batch.calls import call, plain
from tests.pipeline.batch.inprocess import InProcess, made
from tests.pipeline.batch.runs import go, lines_file

Capture = pytest.CaptureFixture[str]


def given(monkeypatch: pytest.MonkeyPatch, *words: object) -> Asked:
    """Return what the command that is called with these words says that it was asked for."""
    orders: list[Order] = []
    monkeypatch.setattr(commands, "_run", lambda order, *_rest: orders.append(order))
    main([str(word) for word in words])
    return orders[0].asked


@pytest.mark.parametrize(
    "words",
    [
        "batch in/jobs.jsonl",
        "batch in in/jobs.jsonl -o 'with space' --workers 2 --cluster tcp://a:1 --allow . --allow in --timeout 5.0",
        "batch in --memory 100 --json --quiet",
        "batch in/a.toml --table in/rows.csv",
        "batch -o out -- -x.toml",
        "retry done --workers 3 --json",
    ],
)
def test_the_command_is_what_was_given_whatever_the_process_was_started_with(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: str
) -> None:
    monkeypatch.chdir(tmp_path)
    lines_file(tmp_path / "in", 1)
    for name in ("-x.toml", "in/a.toml"):
        (tmp_path / name).write_text("schema = 1\n")
    (tmp_path / "in" / "rows.csv").write_text("job.name\nx\n")
    go(tmp_path / "done", tmp_path / "in" / "jobs.jsonl")
    monkeypatch.setattr("sys.argv", ["another program", "-x"])
    found = given(monkeypatch, *shlex.split(words))
    assert found == Asked(f"planish {words}", str(tmp_path))


def test_an_option_before_the_jobs_asks_for_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    jobs = lines_file(tmp_path / "in", 1)
    assert given(monkeypatch, "batch", "--quiet", "--out=x", jobs).command == f"planish batch {jobs} -o x --quiet"


def test_a_command_is_told_with_its_folder_where_that_is_another(tmp_path: Path) -> None:
    assert Asked("planish batch in", os.getcwd()).line() == "planish batch in"  # noqa: PTH109
    assert Asked("planish batch in", "/a b").line() == "cd '/a b' && planish batch in"
    assert Asked("planish batch in").line() == "planish batch in"


def interrupting(at_line: int) -> InProcess:
    """An executor in whose job of a line the user asks for an end."""

    def job(work: Work) -> Record:
        if work.line == at_line:
            os.kill(os.getpid(), signal.SIGINT)
        return made(work)

    return InProcess(job=job, slots=1)


def test_status_says_how_to_go_on_until_there_is_nothing_to_go_on_with(
    tmp_path: Path, executor: InProcess, capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    lines_file(tmp_path / "in", 9)
    executor.job, executor.slots = interrupting(4).job, 1
    assert call("batch", "in", "-o", "out", "--memory", 512) == 75
    command = "planish batch in -o out --memory 512"
    assert f"go on with: {command}\n" in capsys.readouterr().err
    plain("status", "out")
    assert capsys.readouterr().out.endswith(f" waiting\ngo on with: {command}\n")
    monkeypatch.chdir(tmp_path / "in")
    plain("status", tmp_path / "out", "--json")
    document = json.loads(capsys.readouterr().out)
    assert (document["at_work"], document["go_on"]) == ("", [f"cd {tmp_path} && {command}"])
    executor.job = made
    monkeypatch.chdir(tmp_path)
    assert call(*shlex.split(command)[1:]) == 0
    capsys.readouterr()
    plain("status", "out")
    assert capsys.readouterr().out == "9 jobs: 9 made, 0 waiting\n"
    assert sorted(executor.ran) == [f"jobs-000000{line}" for line in range(1, 10)]


def test_jobs_that_were_not_taken_in_are_not_forgotten_where_none_waits(
    tmp_path: Path, executor: InProcess, capsys: Capture
) -> None:
    executor.job, executor.slots = interrupting(1).job, 1000
    jobs, out = lines_file(tmp_path / "in", 300), tmp_path / "out"
    assert call("batch", jobs, "-o", out) == 75
    capsys.readouterr()
    plain("status", out)
    told_so = f"256 jobs: 256 made, 0 waiting\ngo on with: planish batch {jobs} -o {out}\n"
    assert capsys.readouterr().out == told_so
    assert call("retry", out) == 0
    capsys.readouterr()
    plain("status", out)
    assert capsys.readouterr().out == told_so, "retry takes no jobs in"
    executor.job = made
    assert call("batch", jobs, "-o", out) == 0
    capsys.readouterr()
    plain("status", out)
    assert capsys.readouterr().out == "300 jobs: 300 made, 0 waiting\n"


def test_two_batches_in_one_folder_are_each_told_how_to_go_on_with(tmp_path: Path, executor: InProcess) -> None:
    out = tmp_path / "out"
    executor.slots = 1
    files = [lines_file(tmp_path / "in", 5, name) for name in ("one.jsonl", "two.jsonl")]
    for file in files:
        executor.job = interrupting(3).job
        assert call("batch", file, "-o", out) == 75
    assert told.onward(journal.reading(out), out)["go_on"] == [f"planish batch {file} -o {out}" for file in files]


def test_while_someone_is_at_work_status_says_who(tmp_path: Path, capsys: Capture) -> None:
    out = tmp_path / "out"
    seen: list[str] = []

    def job(work: Work) -> Record:
        plain("status", out)
        seen.append(capsys.readouterr().out)
        return made(work)

    assert holder(out) == ""
    go(out, lines_file(tmp_path / "in", 2), InProcess(job=job, slots=1))
    assert f"\nat work: process {os.getpid()} on " in seen[0]
    assert "go on" not in seen[0]
    assert holder(out) == ""


def test_who_looks_who_is_at_work_keeps_no_one_from_it(tmp_path: Path) -> None:
    (tmp_path / ".lock").touch()
    folder = os.open(tmp_path, os.O_RDONLY)
    try:
        with held(folder, "out"):
            for _ in range(3):
                assert holder(tmp_path)
            with pytest.raises(BadInputError, match="is at work here"), held(folder, "out"):
                pass
        with held(folder, "out"):
            pass
    finally:
        os.close(folder)


def test_a_journal_without_tables_is_no_batch(tmp_path: Path) -> None:
    (tmp_path / "journal.sqlite").touch()
    with pytest.raises(BadInputError, match="there is no journal"):
        journal.reading(tmp_path)


OLD_RUN = """
CREATE TABLE run(id INTEGER PRIMARY KEY, program INTEGER, allow TEXT, wall_s REAL, memory_bytes INTEGER,
                 command TEXT, accepted INTEGER NOT NULL DEFAULT 0);
"""


def test_a_journal_of_version_1_is_read_and_gone_on_with(tmp_path: Path) -> None:
    jobs, out = lines_file(tmp_path / "in", 5), tmp_path / "out"
    go(out, jobs)
    base = journal.opened(out).base
    base.executescript(f"DROP TABLE run; {OLD_RUN} INSERT INTO run(program) VALUES(1); PRAGMA user_version = 1;")
    base.execute("UPDATE job SET state = 0 WHERE id = 2")
    base.close()
    assert told.onward(journal.reading(out), out) == {"at_work": "", "go_on": []}
    assert go(out, jobs) == ["jobs-0000002"]
    assert journal.version_of(journal.reading(out)) == 2
