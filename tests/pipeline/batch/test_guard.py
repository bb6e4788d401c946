"""A job in its child: what its record says, and what lies in its draft."""

import json
from collections.abc import Sequence
from hashlib import sha256
from pathlib import Path

import pytest

from pipeline.batch import digest, guard
from pipeline.batch.work import LONGEST_CAUSE, Limits, Record, Work, one_line
from pipeline.job import Job
from pipeline.run import JobResult
from tests.pipeline.jobs import PLATE, TWISTED

DRAWN = '[[part]]\nname = "drawn"\nsurface = {kind = "flat", outline = {file = "lost.dxf"}}\n'


def work(folder: Path, text: str | None, settings: Sequence[str] = (), line: int | None = None) -> Work:
    file = folder / ("jobs.jsonl" if line else "job.toml")
    if text is not None and line is None:
        file.write_text(text)
    content = text.encode() if text is not None and line else None
    return Work("id-7", str(file), line, content, tuple(settings), (), str(folder / "draft"), Limits(60.0, 1 << 30))


def names(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


def test_a_job_is_made_and_its_digest_is_that_of_its_files(tmp_path: Path) -> None:
    record = guard.run(work(tmp_path, PLATE))
    assert (record.status, record.cause, record.inputs, record.own) == ("made", "", (), True)
    assert record.seconds > 0.0
    assert record.digest == digest.folder(tmp_path / "draft")
    assert names(tmp_path / "draft") == ["flat/plate.dxf", "flat/plate.json", "report.json"]


def test_the_same_job_has_the_same_bytes_wherever_it_runs(tmp_path: Path) -> None:
    digests = []
    for place in ("here", "there"):
        (tmp_path / place).mkdir()
        digests.append(guard.run(work(tmp_path / place, PLATE)).digest)
    assert digests[0] == digests[1] != ""


def test_a_rejected_job_has_its_report_and_says_why(tmp_path: Path) -> None:
    record = guard.run(work(tmp_path, PLATE + TWISTED))
    assert record.status == "rejected"
    assert record.cause.startswith("twisted: not developable enough")
    assert json.loads((tmp_path / "draft" / "report.json").read_bytes())["status"] == "rejected"


def test_a_wrong_job_leaves_all_its_problems_and_no_report(tmp_path: Path) -> None:
    record = guard.run(work(tmp_path, "schema = 2\nunits = 'ell'\n"))
    assert (record.status, record.own) == ("bad-input", True)
    assert record.cause.startswith(f"{tmp_path}/job.toml:1:1: part: missing")
    assert names(tmp_path / "draft") == [guard.ERRORS]
    found = json.loads((tmp_path / "draft" / guard.ERRORS).read_bytes())["errors"]
    assert {problem["path"] for problem in found} == {"part", "schema", "units"}


def test_a_wrong_line_is_named_by_its_number_and_column(tmp_path: Path) -> None:
    record = guard.run(work(tmp_path, '{"schema": 2, "part": []}', line=17))
    assert record.cause.startswith(f"{tmp_path}/jobs.jsonl:17:12: schema: ")
    record = guard.run(work(tmp_path, '{"schema": 1,', line=18))
    assert record.cause.startswith(f"{tmp_path}/jobs.jsonl:18:14: JSON: ")


def test_a_line_without_a_name_is_named_as_its_job(tmp_path: Path) -> None:
    cone = {"kind": "cone", "radius0": 30, "radius1": 20, "height": 9}
    text = json.dumps({"schema": 1, "part": [{"name": "a", "surface": cone}]})
    record = guard.run(work(tmp_path, text, ('report.formats=["json"]',), line=3))
    assert record.status == "made", record.cause
    assert json.loads((tmp_path / "draft" / "report.json").read_bytes())["job"]["name"] == "id-7"


def test_settings_of_a_row_are_set(tmp_path: Path) -> None:
    assert guard.run(work(tmp_path, PLATE, ["part[0].thick=1"])).cause.startswith("--set: part[0].thick: ")
    assert guard.run(work(tmp_path, PLATE, ["part[0].name=blade"])).status == "made"
    assert "flat/blade.dxf" in names(tmp_path / "draft")


def test_files_that_a_job_names_are_noted_also_those_that_are_not_there(tmp_path: Path) -> None:
    drawing = tmp_path / "lost.dxf"
    record = guard.run(work(tmp_path, "schema = 1\n" + DRAWN))
    assert record.inputs == ((str(drawing), ""),)
    drawing.write_text("no drawing")
    record = guard.run(work(tmp_path, "schema = 1\n" + DRAWN))
    assert record.status == "bad-input"
    assert record.inputs == ((str(drawing), sha256(b"no drawing").hexdigest()),)


def test_files_that_come_with_planish_are_no_inputs(tmp_path: Path) -> None:
    text = 'schema = 1\n[[part]]\nname = "m"\nsurface = {kind = "mesh", file = "sample:none.stl"}\n'
    record = guard.run(work(tmp_path, text))
    assert (record.status, record.inputs) == ("bad-input", ())


def failing(error: BaseException) -> object:
    def run_job(_job: Job) -> JobResult:
        raise error

    return run_job


def test_a_defect_leaves_its_traceback(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    error = ZeroDivisionError("no\nway")
    error.add_note("part 'a', stage verify")
    monkeypatch.setattr(guard, "run_job", failing(error))
    record = guard.run(work(tmp_path, PLATE))
    assert (record.status, record.cause) == ("internal", "ZeroDivisionError: no way (part 'a', stage verify)")
    assert names(tmp_path / "draft") == [guard.TRACEBACK]
    assert "in run_job" in (tmp_path / "draft" / guard.TRACEBACK).read_text()


def caused(outer: Exception, cause: BaseException) -> Exception:
    outer.__cause__ = cause
    return outer


@pytest.mark.parametrize(
    "error", [MemoryError(), RuntimeError("std::bad_alloc"), caused(ValueError("no"), MemoryError())], ids=repr
)
def test_memory_that_is_not_to_be_had_is_told_from_a_defect(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    monkeypatch.setattr(guard, "run_job", failing(error))
    record = guard.run(work(tmp_path, PLATE))
    assert (record.status, record.cause) == ("out-of-memory", "needs more than 1024 MB of memory")
    assert not (tmp_path / "draft").exists()


def test_the_limit_of_memory_is_that_of_the_job_and_gone_after_it() -> None:
    with pytest.raises(MemoryError), guard.memory(100 << 20):
        bytearray(200 << 20)
    with guard.memory(400 << 20):
        assert len(bytearray(200 << 20)) == 200 << 20
    assert len(bytearray(500 << 20)) == 500 << 20


def test_a_system_that_does_not_tell_what_is_mapped_sets_no_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guard, "MAPPED", Path("/none"))
    with guard.memory(0):
        assert len(bytearray(200 << 20)) == 200 << 20


def test_a_folder_that_takes_no_files_is_no_failure_of_the_job(tmp_path: Path) -> None:
    good = work(tmp_path, PLATE)
    lost = Work(*(str(tmp_path / "none" / "d") if name == "draft" else getattr(good, name) for name in Work.__slots__))
    record: Record = guard.run(lost)
    assert (record.status, record.own, record.digest) == ("crashed", False, "")
    assert record.cause == "the files of the job could not be written: No such file or directory"


def test_a_cause_is_one_line_of_some_length() -> None:
    assert one_line("a\r\n b\tc \x1b[31m\udcff") == "a b c ?[31m?"
    assert len(one_line("x" * 10_000)) == LONGEST_CAUSE
