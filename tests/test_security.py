"""The page on security: every promise names a test that is there, and holds tests."""

import re
from pathlib import Path

ROOT = Path(__file__).parent.parent
PAGE = ROOT.joinpath("SECURITY.md").read_text("utf-8")
ROWS = [line.strip("|").split(" | ") for line in PAGE.splitlines() if line.startswith("| ")][1:]
LEAST_ROWS = 10


def named(cell: str) -> list[str]:
    """Return the files that a cell names."""
    return re.findall(r"`((?:tests|stages|pipeline)/[\w/]+\.py)`", cell)


def test_every_promise_names_the_tests_that_hold_it() -> None:
    assert len(ROWS) >= LEAST_ROWS
    for promise, _, held_by in ROWS:
        tests = [ROOT / name for name in named(held_by) if Path(name).name.startswith("test_")]
        assert tests, promise
        assert all("\ndef test_" in file.read_text("utf-8") for file in tests), promise


def test_every_file_that_the_page_names_is_there() -> None:
    assert [name for name in named(PAGE) if not (ROOT / name).is_file()] == []
