"""Job files that once broke something, kept small: each ends as its name says, in time, and writes nowhere else.

The number that a name begins with is the exit code.  What went wrong once is said in the first line of the file.
"""

from pathlib import Path

import pytest

from tests.fuzz import trial
from tests.fuzz.grammar import Drawn
from tests.fuzz.lots import run_one
from tests.fuzz.trial import exit_code

CORPUS = Path(__file__).with_name("corpus")
FILES = sorted(file.name for file in CORPUS.iterdir() if file.suffix in {".toml", ".json"})


@pytest.fixture(autouse=True)
def _patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Here types are checked at every call: the limit of time is not the one of a run, but what hung still does."""
    monkeypatch.setattr(trial, "LIMIT_S", 10.0)


def test_the_corpus_is_there() -> None:
    assert FILES


@pytest.mark.parametrize("name", FILES)
def test_what_once_broke_something_ends_as_it_should(tmp_path: Path, name: str) -> None:
    drawn = Drawn(f"job{Path(name).suffix}", (CORPUS / name).read_bytes())
    assert run_one(drawn, tmp_path / "root") is None
    (tmp_path / "again").mkdir()
    assert exit_code(CORPUS / name, tmp_path / "again") == int(name.partition("-")[0])
