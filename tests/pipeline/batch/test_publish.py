"""Drafts and their places: what was begun is brought to its end, what is torn is not, and no link is followed."""

import os
import shutil
from pathlib import Path

import pytest

from pipeline.batch import batch, draft, publish
from pipeline.batch.entries import entries
from pipeline.batch.journal import Journal
from pipeline.batch.runner import Stop
from pipeline.batch.stopped import StoppedError
from pipeline.batch.work import Record, Work
from stages.errors import BadInputError
from tests.pipeline.batch.inprocess import InProcess, made, tree
from tests.pipeline.batch.runs import LIMITS, PROGRAM, go, lines_file


class EndError(Exception):
    """Stands for the end of the runner."""


def cut_off(jobs: Path, out: Path, monkeypatch: pytest.MonkeyPatch, of: object, name: str, *, after: bool) -> None:
    """Run a batch that ends just before or after a call."""
    call = getattr(of, name)

    def ending(*args: object, **kw: object) -> None:
        if after:
            call(*args, **kw)
        raise EndError

    with batch.ready(batch.Order(out, LIMITS), PROGRAM) as at, monkeypatch.context() as patch:
        patch.setattr(of, name, ending)
        with pytest.raises(EndError):
            batch.run(at, entries([jobs]), InProcess(), Stop(), lambda _loop, _event: None)


def test_a_draft_that_was_renamed_but_not_committed_is_adopted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    jobs, out = lines_file(tmp_path / "in", 3), tmp_path / "out"
    cut_off(jobs, out, monkeypatch, Journal, "settle", after=False)
    assert (out / "jobs-0000001").is_dir()
    assert go(out, jobs) == []


def test_a_draft_that_was_to_be_renamed_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    jobs, out = lines_file(tmp_path / "in", 3), tmp_path / "out"
    cut_off(jobs, out, monkeypatch, Journal, "intend", after=True)
    assert not (out / "jobs-0000001").exists()
    assert go(out, jobs) == []
    assert len(tree(out)) == 6


@pytest.mark.parametrize("of", ["place", "draft"])
def test_what_is_torn_is_not_adopted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, of: str) -> None:
    jobs, out = lines_file(tmp_path / "in", 3), tmp_path / "out"
    go(tmp_path / "undisturbed", jobs)
    name = "settle" if of == "place" else "intend"
    cut_off(jobs, out, monkeypatch, Journal, name, after=of == "draft")
    torn = out / "jobs-0000002" if of == "place" else out / ".drafts" / "1-2"
    (torn / "report.json").write_text("{")
    assert go(out, jobs) == ["jobs-0000002"]
    assert tree(out) == tree(tmp_path / "undisturbed")


def test_nothing_stays_among_the_drafts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    jobs, out = lines_file(tmp_path / "in", 3), tmp_path / "out"
    cut_off(jobs, out, monkeypatch, publish, "synced", after=False)
    assert list((out / ".drafts").iterdir()) != []
    go(out, jobs)
    assert list((out / ".drafts").iterdir()) == []


def test_a_link_in_the_place_of_a_job_is_replaced_and_its_target_left_alone(tmp_path: Path) -> None:
    jobs, out = lines_file(tmp_path / "in", 2), tmp_path / "out"
    go(out, jobs)
    mine = tmp_path / "mine"
    shutil.move(out / "jobs-0000001", mine)
    (out / "jobs-0000001").symlink_to(mine)
    assert go(out, jobs) == ["jobs-0000001"]
    assert not (out / "jobs-0000001").is_symlink()
    assert (mine / "report.json").exists()


def test_a_folder_of_drafts_that_is_swapped_for_a_link_while_it_runs_leads_nowhere(tmp_path: Path) -> None:
    jobs, out, victim = lines_file(tmp_path / "in", 3), tmp_path / "out", tmp_path / "victim"
    victim.mkdir()
    (victim / "1-1").write_text("keep")

    def job(work: Work) -> Record:
        if work.line == 2:
            (out / ".drafts").rename(tmp_path / "moved")
            (out / ".drafts").symlink_to(victim)
            return Record("rejected", "", 0.0, (), "", own=True)
        try:
            return Record("made", "", 0.0, (), draft.write(Path(work.draft), {"report.json": b"{}"}), own=True)
        except OSError as error:
            return Record("crashed", str(error), 0.0, (), "", own=False)

    with pytest.raises(StoppedError, match=r"Not a directory.*\.drafts"):
        go(out, jobs, InProcess(job=job, slots=1))
    assert {path.name: path.read_text() for path in victim.iterdir()} == {"1-1": "keep"}


def test_a_link_in_the_place_of_the_drafts_or_of_the_journal_is_refused(tmp_path: Path) -> None:
    jobs, out = lines_file(tmp_path / "in", 1), tmp_path / "out"
    go(out, jobs)
    (out / ".drafts").rmdir()
    (out / ".drafts").symlink_to(tmp_path)
    with pytest.raises(BadInputError, match=r"out/\.drafts: a link or a file where .*remove it"):
        go(out, jobs)
    (out / ".drafts").unlink()
    for name in ("journal.sqlite", "journal.sqlite-wal"):
        (out / name).touch()
        (out / name).rename(tmp_path / name)
        (out / name).symlink_to(tmp_path / name)
        with pytest.raises(BadInputError, match=f"{name}: the journal is a link"):
            go(out, jobs)
        (out / name).unlink()
        (tmp_path / name).rename(out / name)


def test_a_link_or_a_folder_in_the_place_of_the_lock_is_refused(tmp_path: Path) -> None:
    jobs, out = lines_file(tmp_path / "in", 1), tmp_path / "out"
    go(out, jobs)
    (out / ".lock").unlink()
    (out / ".lock").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(BadInputError, match=r"where the lock \.lock belongs"):
        go(out, jobs)
    (out / ".lock").unlink()
    (out / ".lock").mkdir()
    with pytest.raises(BadInputError, match=r"where the lock \.lock belongs"):
        go(out, jobs)
    assert not (tmp_path / "elsewhere").exists()


def test_an_output_folder_that_cannot_be_made_is_a_mistake_of_the_user(tmp_path: Path) -> None:
    jobs = lines_file(tmp_path / "in", 1)
    with pytest.raises(BadInputError, match="choose another folder with -o"):
        go(jobs / "out", jobs)


def test_a_draft_that_is_not_there_is_no_failure_of_its_job(tmp_path: Path) -> None:
    tries: list[str] = []

    def job(work: Work) -> Record:
        tries.append(work.job)
        return made(work) if len(tries) > 1 else Record("made", "", 0.0, (), "0" * 64, own=True)

    out = tmp_path / "out"
    assert len(go(out, lines_file(tmp_path / "in", 1), InProcess(job=job))) == 2


def test_only_one_runner_has_a_folder_and_the_other_is_told_which(tmp_path: Path) -> None:
    jobs, out = lines_file(tmp_path / "in", 1), tmp_path / "out"
    order = batch.Order(out, LIMITS)
    with batch.ready(order, PROGRAM), pytest.raises(BadInputError, match=f"process {os.getpid()} on .* is at work"):
        go(out, jobs)
    assert go(out, jobs) == ["jobs-0000001"]


def test_the_drafts_of_a_group_are_synced_before_the_journal_knows_and_renamed_after(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    order: list[str] = []
    for of, name in ((publish, "synced"), (Journal, "intend"), (publish, "put"), (Journal, "settle")):
        call = getattr(of, name)

        def told(*args: object, call: object = call, name: str = name) -> object:
            order.append(name)
            return call(*args)  # type: ignore[operator]

        monkeypatch.setattr(of, name, told)
    with batch.ready(batch.Order(tmp_path / "out", LIMITS), PROGRAM) as at:
        order.clear()
        batch.run(at, iter(()), InProcess(), Stop(), lambda _loop, _event: None)
        assert order == []
    go(tmp_path / "out", lines_file(tmp_path / "in", 1))
    assert order[-4:] == ["synced", "intend", "put", "settle"]
