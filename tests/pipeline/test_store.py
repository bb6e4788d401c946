"""Files: safe names, and an output folder that is replaced as a whole or not at all."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pipeline.store import LONGEST_NAME, RESERVED, replacement, safe_name, safe_names, write_files
from stages.errors import BadInputError

REPORT = b'{"schema": "planish-report/1"}'


@pytest.mark.parametrize(
    ("name", "file"),
    [
        ("plate-3", "plate-3"),
        ("Trichter groß", "Trichter-gro"),
        ("Stück 1", "Stuck-1"),
        ("../../etc/passwd", "etc-passwd"),
        ("C:\\x", "C-x"),
        (".hidden", "hidden"),
        ("con", "_con"),
        ("nul.txt", "_nul.txt"),
        ("漢字", "unnamed"),
        ("a" * 99, "a" * LONGEST_NAME),
    ],
)
def test_a_name_becomes_a_file_name(name: str, file: str) -> None:
    assert safe_name(name) == file


@given(st.lists(st.text(min_size=1), unique=True))
def test_file_names_are_plain_and_all_different(names: list[str]) -> None:
    chosen = safe_names(names)
    assert list(chosen) == names
    assert len({name.casefold() for name in chosen.values()}) == len(names)
    for name in chosen.values():
        assert name.isascii()
        assert name == Path(name).name
        assert not name.startswith((".", "-"))
        assert name.casefold() not in RESERVED


def files(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


def test_an_old_output_folder_is_replaced_as_a_whole(tmp_path: Path) -> None:
    out = tmp_path / "deep" / "out"
    for names in (["report.json", "cut/a.dxf", "flat/b.dxf"], ["report.json", "flat/c.dxf"]):
        with replacement(out) as draft:
            write_files(draft, dict.fromkeys(names, REPORT))
        assert files(tmp_path / "deep") == [f"out/{name}" for name in sorted(names)]


def test_a_failure_leaves_the_old_folder_and_nothing_else(tmp_path: Path) -> None:
    out = tmp_path / "out"
    with replacement(out) as draft:
        write_files(draft, {"report.json": REPORT})
    with pytest.raises(KeyboardInterrupt), replacement(out) as draft:
        write_files(draft, {"report.json": b"half"})
        raise KeyboardInterrupt
    assert files(tmp_path) == ["out/report.json"]
    assert (out / "report.json").read_bytes() == REPORT


def test_a_failure_takes_the_folders_it_made_away_again(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError), replacement(tmp_path / "a" / "b" / "out"):
        raise RuntimeError
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "names", [["thesis.doc"], ["report.json", "notes.txt"], ["cut/a.dxf"], ["report.json/x"]], ids=str
)
def test_a_folder_with_other_files_is_never_replaced(tmp_path: Path, names: list[str]) -> None:
    out = tmp_path / "out"
    write_files(out, dict.fromkeys(names, REPORT))
    with pytest.raises(BadInputError, match="planish"), replacement(out):
        pytest.fail("the work must not begin")
    assert files(out) == sorted(names)


POOL = b'{"schema": "planish-pool/1", "groups": [{"name": "steel-2mm"}, 3]}'


def test_the_folder_of_pooled_jobs_holds_its_groups_and_nothing_else(tmp_path: Path) -> None:
    out = tmp_path / "out"
    for _ in range(2):
        with replacement(out) as draft:
            write_files(draft, {"report.json": POOL, "steel-2mm/cut/a.dxf": b"0"})
    (out / "brass-1mm").mkdir()
    with pytest.raises(BadInputError, match="holds brass-1mm, which planish did not write"), replacement(out):
        pass
    assert files(tmp_path) == ["out/report.json", "out/steel-2mm/cut/a.dxf"]


def test_a_pool_without_a_list_of_groups_is_not_ours(tmp_path: Path) -> None:
    write_files(tmp_path / "out", {"report.json": b'{"schema": "planish-pool/1"}'})
    with pytest.raises(BadInputError, match="is no output folder of planish"), replacement(tmp_path / "out"):
        pass


def test_a_foreign_report_does_not_make_a_folder_ours(tmp_path: Path) -> None:
    write_files(tmp_path / "out", {"report.json": b'{"tests": 3}'})
    with pytest.raises(BadInputError, match="no output folder of planish"), replacement(tmp_path / "out"):
        pytest.fail("the work must not begin")


def test_an_empty_folder_is_free(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    with replacement(tmp_path / "out") as draft:
        write_files(draft, {"report.json": REPORT})
    assert files(tmp_path) == ["out/report.json"]


def test_the_job_file_and_the_working_folder_are_not_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    job = tmp_path / "job.toml"
    job.touch()
    with pytest.raises(BadInputError, match="would replace"), replacement(tmp_path, keep=[job]):
        pytest.fail("the work must not begin")
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    with pytest.raises(BadInputError, match="would replace"), replacement(Path()):
        pytest.fail("the work must not begin")


@pytest.mark.parametrize("below", ["file", "file/out", "file/deep/out"])
def test_an_output_folder_that_cannot_be_written_is_refused_before_any_work(tmp_path: Path, below: str) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(BadInputError, match="output folder"), replacement(tmp_path / below):
        pytest.fail("the work must not begin")
    assert files(tmp_path) == ["file"]


def test_a_link_to_an_output_folder_stays_a_link(tmp_path: Path) -> None:
    real, link = tmp_path / "real", tmp_path / "link"
    real.mkdir()
    link.symlink_to(real)
    with replacement(link) as draft:
        write_files(draft, {"report.json": REPORT})
    assert link.is_symlink()
    assert files(real) == ["report.json"]
