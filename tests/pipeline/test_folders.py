"""Folders by their handles: nothing is written outside, also while someone exchanges them for links."""

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from time import monotonic

import pytest

from pipeline import folders
from pipeline.store import replacement, write_files
from stages.errors import BadInputError

REPORT = b'{"schema": "planish-report/1"}'
ROUNDS_S = 1.0
FILES = {"report.json": REPORT, **{f"cut/{i}.dxf": REPORT for i in range(4)}}


@contextmanager
def racing(swap: Callable[[], None]) -> Iterator[None]:
    """Let a thread call `swap` again and again until the block ends."""
    over = threading.Event()
    thread = threading.Thread(target=_race, args=(over, swap))
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()


def _race(over: threading.Event, swap: Callable[[], None]) -> None:
    while not over.is_set():
        with suppress(OSError):
            swap()


def inside(folder: Path) -> list[str]:
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*"))


@pytest.mark.parametrize("path", ["../x", "/x", "a/../../x", "", "."])
def test_a_path_out_of_the_folder_is_a_defect_and_writes_nothing(tmp_path: Path, path: str) -> None:
    (tmp_path / "in").mkdir()
    with folders.opened(tmp_path / "in") as handle, pytest.raises(ValueError, match="no path below a folder"):
        folders.write(handle, path, b"x")
    assert inside(tmp_path) == ["in"]


def test_no_link_is_followed_on_the_way_down(tmp_path: Path) -> None:
    root, outside = tmp_path / "in", tmp_path / "outside"
    root.mkdir()
    outside.mkdir()
    (root / "cut").symlink_to(outside)
    (root / "a.txt").symlink_to(outside / "a.txt")
    with folders.opened(root) as handle:
        for path in ("cut/a.dxf", "a.txt"):
            with pytest.raises(OSError, match=r"\S"):
                folders.write(handle, path, b"x")
        with pytest.raises(OSError, match=r"\S"):
            folders.replace(handle, "cut/a.dxf", b"x")
        folders.replace(handle, "a.txt", b"x")
    assert inside(outside) == []
    assert not (root / "a.txt").is_symlink()
    with pytest.raises(OSError, match=r"\S"), folders.opened(root / "cut"):
        pass


def test_removing_a_link_leaves_what_it_leads_to(tmp_path: Path) -> None:
    (tmp_path / "kept").mkdir()
    (tmp_path / "kept" / "file").touch()
    (tmp_path / "link").symlink_to(tmp_path / "kept")
    with folders.opened(tmp_path) as handle:
        folders.remove("link", handle)
    assert inside(tmp_path) == ["kept", "kept/file"]


def test_nothing_is_written_outside_while_the_folders_of_a_draft_are_exchanged_for_links(tmp_path: Path) -> None:
    root, outside = tmp_path / "root", tmp_path / "outside"
    root.mkdir()
    outside.mkdir()

    def swap() -> None:
        """Put links in the places of the draft and of its folders, wherever they are just now."""
        for draft in root.glob(".out-*.part"):
            with suppress(OSError):
                (draft / "cut").rename(root / f"aside-{os.urandom(4).hex()}")
            with suppress(OSError):
                (draft / "cut").symlink_to(outside)
            with suppress(OSError):
                draft.rename(root / f"aside-{os.urandom(4).hex()}")
            with suppress(OSError):
                draft.symlink_to(outside)

    tried = 0
    end = monotonic() + ROUNDS_S
    with racing(swap):
        while monotonic() < end:
            tried += 1
            with suppress(BadInputError), replacement(root / "out") as draft:
                write_files(draft, FILES)
    assert tried > 1
    # the links that the other thread makes through its own link are its own
    assert not [path for path in outside.rglob("*") if not path.is_symlink()]


def test_nothing_is_written_outside_while_the_output_folder_is_exchanged_for_a_link(tmp_path: Path) -> None:
    root, outside = tmp_path / "root", tmp_path / "outside"
    root.mkdir()
    outside.mkdir()

    def swap() -> None:
        (root / "out").rename(root / f"aside-{os.urandom(4).hex()}")
        (root / "out").symlink_to(outside)

    end = monotonic() + ROUNDS_S
    while monotonic() < end:
        with suppress(BadInputError), replacement(root / "out") as draft, racing(swap):
            write_files(draft, FILES)
        assert inside(outside) == []
        if (root / "out").is_symlink():
            (root / "out").unlink()


def test_a_draft_that_became_another_folder_is_told(tmp_path: Path) -> None:
    told = pytest.raises(BadInputError, match="another program changed the output folder")
    with told, replacement(tmp_path / "out") as draft:
        write_files(draft, FILES)
        (tmp_path / draft.name).rename(tmp_path / "aside")
        (tmp_path / draft.name).mkdir()
    assert (tmp_path / "aside" / "report.json").read_bytes() == REPORT


def test_a_file_is_replaced_as_a_whole_or_not_at_all(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"old")
    with folders.opened(tmp_path) as handle:
        with pytest.raises(TypeError):
            folders.replace(handle, "a", None)  # type: ignore[arg-type]
        assert (inside(tmp_path), (tmp_path / "a").read_bytes()) == (["a"], b"old")
        folders.replace(handle, "a", b"new")
        folders.replace(handle, "deep/er/b", b"new")
    assert inside(tmp_path) == ["a", "deep", "deep/er", "deep/er/b"]
    assert (tmp_path / "a").read_bytes() == b"new"


def laid_out(root: Path, place: str) -> None:
    """Make a new folder, and in its place another one, a file, a link, an empty folder, or nothing."""
    (root / "new").mkdir()
    (root / "new" / "b").touch()
    (root / "else").mkdir()
    (root / "else" / "kept").touch()
    if place in {"full", "empty"}:
        (root / "place").mkdir()
    if place == "full":
        (root / "place" / "a").touch()
    if place == "file":
        (root / "place").touch()
    if place == "link":
        (root / "place").symlink_to(root / "else")


@pytest.mark.parametrize(("place", "moved"), [("none", 0), ("empty", 0), ("full", 1), ("file", 1), ("link", 1)])
def test_a_folder_takes_its_place_and_what_lay_there_goes_aside(tmp_path: Path, place: str, moved: int) -> None:
    laid_out(tmp_path, place)
    with folders.opened(tmp_path) as handle:
        assert folders.put("new", handle, "place", handle, "aside") == bool(moved)
        folders.remove("aside", handle)
    assert inside(tmp_path) == ["else", "else/kept", "place", "place/b"]


@pytest.mark.parametrize("place", ["full", "file", "link"])
def test_what_lay_there_is_back_where_a_folder_cannot_take_its_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, place: str
) -> None:
    laid_out(tmp_path, place)
    before, rename = inside(tmp_path), os.rename

    def failing(source: str, target: str, **keys: int) -> None:
        if source == "new" and not os.path.lexists(tmp_path / target):
            raise PermissionError(13, "no")
        rename(source, target, **keys)

    monkeypatch.setattr(os, "rename", failing)
    with folders.opened(tmp_path) as handle, pytest.raises(PermissionError):
        folders.put("new", handle, "place", handle, "aside")
    assert inside(tmp_path) == before


def test_a_new_folder_is_gone_unless_it_took_a_place(tmp_path: Path) -> None:
    with folders.opened(tmp_path) as handle:
        with pytest.raises(OSError, match="name"), folders.grown("part", handle) as part:
            folders.create(part, "a/b", b"1")
            folders.create(part, "n" * 300, b"2")
        assert inside(tmp_path) == []
        with folders.grown("part", handle) as part:
            folders.create(part, "a/b", b"1")
            folders.put("part", handle, "whole", handle, "aside")
        with pytest.raises(FileExistsError), folders.grown("whole", handle):
            pass
    assert (tmp_path / "whole" / "a" / "b").read_bytes() == b"1"
