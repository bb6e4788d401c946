"""A draft is there as a whole or not at all, and nothing is written through a link."""

from pathlib import Path

import pytest

from pipeline.batch import digest, draft

FILES = {"report.json": b"{}", "flat/a.dxf": b"0\nEOF\n", "flat/deep/b": b"", "\udcff": b"any name"}


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_a_draft_holds_the_files_and_its_digest_is_that_of_the_folder(tmp_path: Path) -> None:
    whole = draft.write(tmp_path / "d", FILES)
    found = {str(path.relative_to(tmp_path / "d")): path.read_bytes() for path in (tmp_path / "d").rglob("*.*")}
    assert found == {name: content for name, content in FILES.items() if "." in name}
    assert whole == digest.files(FILES) == digest.folder(tmp_path / "d")
    assert names(tmp_path) == ["d"]


@pytest.mark.parametrize("name", FILES)
def test_one_byte_or_one_name_changes_the_digest(name: str) -> None:
    assert digest.files({**FILES, name: FILES[name] + b"."}) != digest.files(FILES)
    renamed = {(f"{key}2" if key == name else key): content for key, content in FILES.items()}
    assert digest.files(renamed) != digest.files(FILES)


def test_a_draft_of_an_earlier_attempt_makes_way(tmp_path: Path) -> None:
    draft.write(tmp_path / "d", {"old": b"1", "more": b"2"})
    draft.write(tmp_path / "d", {"new": b"3"})
    assert [path.name for path in (tmp_path / "d").iterdir()] == ["new"]
    assert names(tmp_path) == ["d"]


def test_nothing_is_left_of_files_that_could_not_be_written(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="name"):
        draft.write(tmp_path / "d", {"good": b"1", "n" * 300: b"2"})
    assert names(tmp_path) == []


def test_a_link_in_the_place_of_the_folder_of_drafts_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "drafts").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(OSError, match="director"):
        draft.write(tmp_path / "drafts" / "d", FILES)
    draft.clear(tmp_path / "drafts" / "d")
    assert names(tmp_path / "elsewhere") == []


def test_a_link_in_the_place_of_a_draft_is_replaced_and_not_followed(tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "d").symlink_to(tmp_path / "elsewhere")
    draft.write(tmp_path / "d", {"new": b"3"})
    assert not (tmp_path / "d").is_symlink()
    assert names(tmp_path / "elsewhere") == []


def test_what_a_killed_job_left_is_cleared_and_no_other_draft(tmp_path: Path) -> None:
    for name in ("7", f"7{draft.PART}ab", "70", f"70{draft.PART}ab"):
        draft.write(tmp_path / name, FILES)
    draft.clear(tmp_path / "7")
    assert names(tmp_path) == ["70", f"70{draft.PART}ab"]
