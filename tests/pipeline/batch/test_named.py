"""What a job was made from is what it is recorded under, also where files change while it reads them."""

from collections.abc import Callable, Sequence
from hashlib import sha256
from pathlib import Path

import pytest

from pipeline import reach
from pipeline.batch import guard, journal, told
from pipeline.batch.entries import entries
from pipeline.batch.named import Named
from pipeline.batch.work import Limits, Record, Work
from tests.pipeline.batch.inprocess import InProcess
from tests.pipeline.batch.runs import go
from tests.pipeline.jobs import PLATE

FLAT = b"v 0 0 0\nv 90 0 0\nv 90 50 0\nv 0 50 0\nf 1 2 3\nf 1 3 4\n"
WIDER = FLAT.replace(b"90", b"95")
BROKEN = b"no mesh"
MESH = '[[part]]\nname = "{}"\nsurface = {{ kind = "mesh", file = "sheet.obj", units = "mm" }}\n'
ONE, TWO = PLATE + MESH.format("a"), PLATE + MESH.format("a") + MESH.format("b")


def digest(content: bytes) -> str:
    return sha256(content).hexdigest()


def ran(folder: Path, text: str) -> Record:
    """Return what becomes of a job of that text."""
    limits = Limits(60.0, 1 << 31)
    draft = str(folder / "draft")
    return guard.run(Work("id", str(folder / "job.toml"), None, text.encode(), (), (), draft, limits))


@pytest.fixture
def mesh(tmp_path: Path) -> Path:
    file = tmp_path / "sheet.obj"
    file.write_bytes(FLAT)
    return file


def once(act: Callable[[], object]) -> Callable[[], None]:
    """Return a call that does something the first time that it is made."""
    left = [act]
    return lambda: [each() for each in left[:]] and left.clear()


def after_reading(monkeypatch: pytest.MonkeyPatch, act: Callable[[], object]) -> None:
    """Do something just after the first named file was read, before anything is made of it."""
    read, then = reach.limited, once(act)

    def reading(handle: int, largest: int) -> bytes:
        content = read(handle, largest)
        then()
        return content

    monkeypatch.setattr(reach, "limited", reading)


def test_a_file_counts_with_the_bytes_that_were_read(
    tmp_path: Path, mesh: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    after_reading(monkeypatch, lambda: mesh.write_bytes(WIDER))
    record = ran(tmp_path, ONE)
    assert (record.status, record.inputs) == ("made", ((str(mesh), digest(FLAT)),))


def test_a_broken_file_that_is_mended_meanwhile_is_recorded_as_it_was_met(
    tmp_path: Path, mesh: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mesh.write_bytes(BROKEN)
    after_reading(monkeypatch, lambda: mesh.write_bytes(FLAT))
    record = ran(tmp_path, ONE)
    assert (record.status, record.inputs) == ("bad-input", ((str(mesh), digest(BROKEN)),))


def test_a_file_read_twice_with_other_bytes_makes_no_result(
    tmp_path: Path, mesh: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert ran(tmp_path, TWO).status == "made"
    (tmp_path / "draft").rename(tmp_path / "before")
    after_reading(monkeypatch, lambda: mesh.write_bytes(WIDER))
    record = ran(tmp_path, TWO)
    assert (record.status, record.cause) == ("crashed", f"{mesh} has changed while the job read it")
    assert not (tmp_path / "draft").exists()


def test_a_file_that_appears_once_it_was_missed_makes_no_verdict(
    tmp_path: Path, mesh: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mesh.unlink()
    assert (ran(tmp_path, ONE).status, ran(tmp_path, ONE).inputs) == ("bad-input", ((str(mesh), ""),))
    opened = reach.opened

    def missing(root: Path, steps: Sequence[str]) -> int:
        try:
            return opened(root, steps)
        except FileNotFoundError:
            mesh.write_bytes(FLAT)
            raise

    monkeypatch.setattr(reach, "opened", missing)
    assert ran(tmp_path, ONE).cause == f"{mesh} has changed while the job read it"
    assert ran(tmp_path, ONE).status == "made"


def test_a_file_too_large_to_be_read_counts_with_what_it_holds(tmp_path: Path, mesh: Path) -> None:
    named = Named()
    named.seen(mesh, "")
    assert named.inputs() == ((str(mesh), digest(FLAT)),)
    assert not named.changed
    mesh.write_bytes(WIDER)
    named.inputs()
    assert named.changed == str(mesh)


def test_a_batch_runs_such_a_job_again_and_records_what_its_result_is_made_from(
    tmp_path: Path, mesh: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "two.toml").write_text(TWO)
    after_reading(monkeypatch, lambda: mesh.write_bytes(WIDER))
    out = tmp_path / "out"

    def again() -> list[str]:
        return go(out, entries([tmp_path / "two.toml"]), InProcess(job=guard.run))

    assert again() == ["two", "two"]
    assert told.tally(journal.reading(out), 9).all_made
    assert f"{mesh} sha256 {digest(WIDER)}" in "\n".join(told.explain(journal.reading(out), "two", out))
    assert again() == []
    mesh.write_bytes(FLAT)
    assert again() == ["two"]
