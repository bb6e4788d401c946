"""Batches run again: what stands is not run, what does not is, and the journal knows why."""

import json
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path

import pytest

from pipeline.batch import journal, told
from pipeline.batch.entries import entries
from pipeline.batch.identity import Program
from pipeline.batch.stopped import StoppedError
from pipeline.batch.work import Limits, Record, Status, Work
from pipeline.parse import LARGEST_FILE
from stages.errors import BadInputError
from tests.pipeline.batch.inprocess import InProcess, made, made_as, tree
from tests.pipeline.batch.runs import PROGRAM, go, lines_file


def why(out: Path, job: str) -> str:
    """Return what explain says of why a job ran."""
    lines = told.explain(journal.reading(out), job, out)
    return next(line.strip() for line in lines if " ran in run" in line)


def test_a_second_run_of_the_same_runs_nothing(tmp_path: Path) -> None:
    jobs, out = lines_file(tmp_path / "in", 20), tmp_path / "out"
    assert len(go(out, jobs)) == 20
    before = tree(out)
    assert go(out, jobs) == []
    assert tree(out) == before
    assert json.loads(before["jobs-0000007/report.json"])["text"] == '{"number": 6}'


def test_a_changed_job_is_run_again_and_no_other(tmp_path: Path) -> None:
    jobs, out = lines_file(tmp_path / "in", 5), tmp_path / "out"
    go(out, jobs)
    jobs.write_text(jobs.read_text().replace("3}", "33}"))
    assert go(out, jobs) == ["jobs-0000004"]
    assert b"33}" in tree(out)["jobs-0000004/report.json"]
    assert why(out, "jobs-0000004") == "ran in run 2: the job itself has changed"
    assert why(out, "jobs-0000003") == "ran in run 1, as it had not run before"


def test_a_job_whose_bytes_move_in_their_file_is_read_where_they_are_now(tmp_path: Path) -> None:
    out = tmp_path / "out"
    jobs = lines_file(tmp_path / "in", 3)
    stopped = InProcess(job=lambda work: made_as(work, "rejected"))
    go(out, jobs, stopped)
    jobs.write_text("\n" + jobs.read_text())
    assert go(out, jobs) == ["jobs-0000002", "jobs-0000003", "jobs-0000004"]
    assert json.loads(tree(out)["jobs-0000002/report.json"])["text"] == '{"number": 0}'


@pytest.mark.parametrize(
    ("program", "reason"),
    [
        (Program("other", "tables", "libraries 1"), "the code of planish changed"),
        (Program("code", "other", "libraries 1"), "the tables of materials and processes changed"),
        (Program("code", "tables", "libraries 2"), "the libraries (libraries 1 then) changed"),
    ],
)
def test_another_program_makes_everything_again(tmp_path: Path, program: Program, reason: str) -> None:
    jobs, out = lines_file(tmp_path / "in", 3), tmp_path / "out"
    go(out, jobs)
    assert len(go(out, jobs, by=program)) == 3
    assert why(out, "jobs-0000001") == f"ran in run 2: {reason}"
    assert go(out, jobs, by=program) == []


def naming(drawing: Path) -> InProcess:
    """An executor whose second job names a drawing."""

    def job(work: Work) -> Record:
        named = drawing.read_bytes() if drawing.exists() else None
        inputs = ((str(drawing), "" if named is None else sha256(named).hexdigest()),)
        return made_as(work, "made" if named else "bad-input", inputs if work.line == 2 else ())

    return InProcess(job=job)


def test_a_job_is_run_again_when_a_file_that_it_names_changes(tmp_path: Path) -> None:
    jobs, out, drawing = lines_file(tmp_path / "in", 3), tmp_path / "out", tmp_path / "rail.dxf"
    drawing.write_text("one")
    go(out, jobs, naming(drawing))
    assert go(out, jobs, naming(drawing)) == []
    drawing.write_text("two")
    assert go(out, jobs, naming(drawing)) == ["jobs-0000002"]
    assert why(out, "jobs-0000002") == f"ran in run 2: {drawing} has changed".replace("run 2", "run 3")
    assert go(out, jobs, naming(drawing)) == []


def test_a_job_is_run_again_when_a_file_that_it_missed_appears(tmp_path: Path) -> None:
    jobs, out, drawing = lines_file(tmp_path / "in", 2), tmp_path / "out", tmp_path / "rail.dxf"
    go(out, jobs, naming(drawing))
    assert go(out, jobs, naming(drawing)) == []
    drawing.write_text("one")
    assert go(out, jobs, naming(drawing)) == ["jobs-0000002"]


def test_an_output_folder_that_is_gone_is_made_again(tmp_path: Path) -> None:
    jobs, out = lines_file(tmp_path / "in", 3), tmp_path / "out"
    go(out, jobs)
    before = tree(out)
    (out / "jobs-0000002").rename(tmp_path / "elsewhere")
    assert go(out, jobs) == ["jobs-0000002"]
    assert tree(out) == before


def failing(status: Status) -> InProcess:
    return InProcess(job=lambda work: Record(status, "why", 0.0, (), "", own=True))


@pytest.mark.parametrize("status", ["rejected", "no-solution", "bad-input", "internal"])
def test_a_failure_that_running_again_would_not_change_is_final_at_once(tmp_path: Path, status: Status) -> None:
    jobs, out = lines_file(tmp_path / "in", 2), tmp_path / "out"
    assert go(out, jobs, failing(status)) == ["jobs-0000001", "jobs-0000002"]
    assert go(out, jobs, failing(status)) == []
    assert json.loads(tree(out)["jobs-0000001/failure.json"])["status"] == status


@pytest.mark.parametrize("status", ["crashed", "timed-out", "out-of-memory"])
def test_a_job_that_fails_three_times_by_itself_is_put_aside(tmp_path: Path, status: Status) -> None:
    jobs, out = lines_file(tmp_path / "in", 1), tmp_path / "out"
    assert len(go(out, jobs, failing(status))) == 3
    assert go(out, jobs, failing(status)) == []
    assert "put aside after 3 failures" in "\n".join(told.explain(journal.reading(out), "jobs-0000001", out))


def test_a_job_that_crashes_twice_and_then_does_not_is_made(tmp_path: Path) -> None:
    tries: list[str] = []

    def job(work: Work) -> Record:
        tries.append(work.job)
        return made(work) if len(tries) == 3 else Record("crashed", "SIGSEGV", 0.0, (), "", own=True)

    out = tmp_path / "out"
    go(out, lines_file(tmp_path / "in", 1), InProcess(job=job))
    assert told.tally(journal.reading(out), 9).all_made


def test_a_failure_that_is_not_its_own_is_never_charged_to_a_job(tmp_path: Path) -> None:
    tries: list[str] = []

    def job(work: Work) -> Record:
        tries.append(work.job)
        lost = Record("crashed", "killed from outside (SIGKILL)", 0.0, (), "", own=False)
        return made(work) if len(tries) > 30 else lost

    out = tmp_path / "out"
    go(out, lines_file(tmp_path / "in", 1), InProcess(job=job))
    assert told.tally(journal.reading(out), 9).all_made


def test_what_an_executor_loses_is_run_again(tmp_path: Path) -> None:
    tries: list[str] = []

    def job(work: Work) -> Record:
        tries.append(work.job)
        if len(tries) < 3:
            raise ConnectionError("the node is gone")
        return made(work)

    assert len(go(tmp_path / "out", lines_file(tmp_path / "in", 1), InProcess(job=job))) == 3


def test_higher_limits_and_allowed_folders_give_failures_another_chance(tmp_path: Path) -> None:
    jobs, out = lines_file(tmp_path / "in", 1), tmp_path / "out"
    for status, changed in (
        ("timed-out", {"limits": Limits(61.0, 1 << 30)}),
        ("out-of-memory", {"limits": Limits(60.0, 1 << 31)}),
        ("bad-input", {"allow": ("/drawings",)}),
    ):
        place = out / status
        assert go(place, jobs, failing(status)) != []
        assert go(place, jobs, limits=Limits(59.0, 1 << 29)) == []
        assert go(place, jobs, **changed) == ["jobs-0000001"], status


def test_a_failed_job_leaves_nothing_of_what_was_made_before(tmp_path: Path) -> None:
    jobs, out = lines_file(tmp_path / "in", 1), tmp_path / "out"
    go(out, jobs)
    go(out, jobs, failing("bad-input"), by=Program("new", "", ""))
    assert list(tree(out)) == ["jobs-0000001/failure.json"]


def test_a_file_of_many_jobs_that_changes_while_it_runs_stops_the_batch_and_loses_nothing(tmp_path: Path) -> None:
    jobs, out = lines_file(tmp_path / "in", 700), tmp_path / "out"

    def job(work: Work) -> Record:
        if work.line == 2:
            jobs.write_text(jobs.read_text().replace("698}", "6988}"))
        return made(work)

    with pytest.raises(StoppedError, match=r"jobs\.jsonl has changed while the batch ran \(run the same command again"):
        go(out, jobs, InProcess(job=job, slots=1))
    ran = go(out, jobs)
    assert 1 < len(ran) < 700
    assert b"6988}" in tree(out)["jobs-0000699/report.json"]
    assert len(tree(out)) == 1400


def test_a_job_file_that_changes_before_it_is_run_is_run_and_recorded_as_it_is_then(tmp_path: Path) -> None:
    for name in ("a.toml", "b.toml"):
        (tmp_path / "in").mkdir(exist_ok=True)
        (tmp_path / "in" / name).write_text("# old")

    def job(work: Work) -> Record:
        (tmp_path / "in" / "b.toml").write_text("# new")
        return made(work)

    out = tmp_path / "out"
    assert go(out, tmp_path / "in", InProcess(job=job, slots=1)) == ["a", "b"]
    assert b"# new" in tree(out)["b/report.json"]
    assert go(out, tmp_path / "in") == []
    (tmp_path / "in" / "b.toml").write_text("# old")
    assert go(out, tmp_path / "in") == ["b"], "what was taken in at first was never run"


@pytest.mark.parametrize(
    ("spoil", "cause"),
    [
        (lambda file: file.unlink(), "cannot be read: there is no plain file"),
        (lambda file: file.write_bytes(b"#" * (LARGEST_FILE + 1)), "larger than 20 MB"),
    ],
)
def test_a_job_file_that_cannot_be_read_when_its_turn_comes_is_a_bad_job(
    tmp_path: Path, spoil: Callable[[Path], object], cause: str
) -> None:
    file = tmp_path / "job.toml"
    file.write_text("# good")
    taken = list(entries([file]))
    spoil(file)
    assert go(tmp_path / "out", iter(taken)) == [], "no child is asked"
    found = json.loads(tree(tmp_path / "out")["job/failure.json"])
    assert (found["status"], found["cause"]) == ("bad-input", f"{file}: {cause}")
    file.write_text("# good")
    assert go(tmp_path / "out", entries([file])) == ["job"]


def test_ids_that_are_asked_for_twice_are_told_apart_and_stay_so(tmp_path: Path) -> None:
    for name in ("a/job.toml", "b/JOB.toml", "c/job-2.toml", "d/job.toml"):
        (tmp_path / name).parent.mkdir()
        (tmp_path / name).write_text(f"# {name}")
    paths = sorted(tmp_path.glob("?/*"))
    first = go(tmp_path / "out", entries(paths))
    assert first == ["job", "JOB-2", "job-2-2", "job-3"]
    assert len({name.casefold() for name in first}) == 4
    assert go(tmp_path / "out", entries(paths)) == []


def test_jobs_of_an_earlier_batch_stay_as_they_are(tmp_path: Path) -> None:
    out = tmp_path / "out"
    go(out, lines_file(tmp_path / "in", 2, "one.jsonl"))
    assert go(out, lines_file(tmp_path / "in", 2, "two.jsonl"), by=PROGRAM) == ["two-0000001", "two-0000002"]
    assert told.tally(journal.reading(out), 9).jobs == 4


def test_a_folder_that_is_no_batch_is_not_touched(tmp_path: Path) -> None:
    jobs = lines_file(tmp_path / "in", 1)
    with pytest.raises(BadInputError, match="no journal of a batch"):
        go(tmp_path, jobs)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["in"]


def test_a_journal_of_another_version_is_not_touched(tmp_path: Path) -> None:
    jobs, out = lines_file(tmp_path / "in", 1), tmp_path / "out"
    go(out, jobs)
    base = journal.opened(out).base
    base.execute("PRAGMA user_version = 99")
    base.close()
    with pytest.raises(BadInputError, match="version 99"):
        go(out, jobs)
