"""Each check of `planish doctor` finds its fault, says the remedy, and is content where there is none."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest
from click.testing import CliRunner

from pipeline.batch import cluster, doctor
from pipeline.batch.doctoring import EXIT_NOT_FIT
from pipeline.batch.doctoring import doctor as command
from tests.pipeline.batch.poison import ends

Patch = pytest.MonkeyPatch


def refuse(*_words: object) -> None:
    raise OSError(18, os.strerror(18))


FAULTS: dict[str, tuple[Callable[[Patch], None], str]] = {
    "journal": (lambda patch: patch.setattr(doctor, "file_system", lambda _: "nfs4"), "works on nfs4; put the output"),
    "drafts": (lambda patch: patch.setattr(Path, "rename", refuse), "Invalid cross-device link; choose another"),
    "disk": (lambda patch: patch.setattr(doctor, "SLOW_SYNC_S", 0.0), "ms to make sure of a file; a batch does it"),
    "space": (
        lambda patch: patch.setattr(shutil, "disk_usage", lambda _: SimpleNamespace(free=1 << 30)),
        "1.0 GB free; a job takes",
    ),
    "files": (
        lambda patch: patch.setattr(
            os,
            "statvfs",
            lambda _: SimpleNamespace(
                f_files=9, f_favail=7, f_bavail=1 << 30, f_blocks=1 << 31, f_bfree=1 << 30, f_frsize=4096
            ),
        ),
        "7 more; ask for fewer formats",
    ),
}


@pytest.mark.parametrize("what", FAULTS)
def test_a_planted_fault_is_found_with_its_remedy_and_nothing_else(
    tmp_path: Path, monkeypatch: Patch, what: str
) -> None:
    monkeypatch.setattr(doctor, "child", doctor.threads)
    assert all(found.good for found in doctor.examine(tmp_path / "out", None))
    plant, said = FAULTS[what]
    with monkeypatch.context() as patch:
        plant(patch)
        (found,) = (found for found in doctor.examine(tmp_path / "out", None) if not found.good)
    assert found.what == what
    assert said in found.line()
    assert found.line().startswith("NOT OK  ")
    assert not list(tmp_path.iterdir())


def test_a_child_starts_and_one_that_does_not_is_told(monkeypatch: Patch) -> None:
    good = doctor.child()
    assert good.good
    assert " MB, most of it shared" in good.said
    monkeypatch.setattr(doctor, "resident", ends)
    bad = doctor.child()
    assert not bad.good
    assert "SIGABRT" in bad.line()
    assert doctor.WARM in bad.remedy


def test_a_child_that_cannot_be_reached_is_told_with_what_the_system_says(tmp_path: Path) -> None:
    """The path of a socket has at most 107 bytes (unix(7)), and children are started over one below TMPDIR."""
    deep = tmp_path / ("d" * 100)
    deep.mkdir()
    words = (sys.executable, "-c", "from pipeline.batch.doctor import child; print(child().line())")
    ended = subprocess.run(words, env={**os.environ, "TMPDIR": str(deep)}, capture_output=True, text=True, check=True)
    assert ended.stdout.startswith("NOT OK  child")
    assert "AF_UNIX path too long" in ended.stdout
    assert "TMPDIR" in ended.stdout


def test_files_systems_that_count_no_files_are_not_blamed(monkeypatch: Patch) -> None:
    monkeypatch.setattr(os, "statvfs", lambda _: SimpleNamespace(f_files=0, f_favail=0))
    assert doctor.files_left(Path()) == doctor.Found(
        "files", good=True, said="not limited", remedy=doctor.files_left(Path()).remedy
    )


def test_the_file_system_is_that_of_the_longest_mount_point(monkeypatch: Patch, tmp_path: Path) -> None:
    mounts = f"/dev/a / ext4 rw\nb {tmp_path} nfs rw\nc {tmp_path}/other xfs rw\nproc /proc proc rw\n"
    monkeypatch.setattr(Path, "read_text", lambda *_: mounts)
    assert doctor.file_system(tmp_path / "out") == "nfs"
    assert doctor.file_system(Path("/")) == "ext4"
    mounts = mounts.replace(" nfs rw", "\\040x autofs rw") + f"s:/ {tmp_path}\\040x nfs4 rw\n"
    assert doctor.file_system(tmp_path.with_name(f"{tmp_path.name} x")) == "nfs4", "a blank in its name, mounted over"
    monkeypatch.setattr(Path, "read_text", refuse)
    assert doctor.file_system(Path("/")) == "an unknown file system"


def test_the_exit_code_and_the_document_say_what_the_lines_say(tmp_path: Path, monkeypatch: Patch) -> None:
    monkeypatch.setattr(doctor, "child", doctor.threads)
    good = CliRunner().invoke(command, [str(tmp_path)])
    assert good.exit_code == 0
    assert all(line.startswith("ok      ") for line in good.output.splitlines())
    monkeypatch.setattr(cluster, "CONNECT_S", 0.2)
    bad = CliRunner().invoke(command, [str(tmp_path), "--json", "--cluster", "tcp://127.0.0.1:9"])
    assert bad.exit_code == EXIT_NOT_FIT
    checks = json.loads(bad.stdout)["checks"]
    assert [check["what"] for check in checks if not check["good"]] == ["cluster"]
    assert "dask scheduler" in checks[-1]["remedy"]
