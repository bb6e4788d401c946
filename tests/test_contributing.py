"""What CONTRIBUTING.md sends people to is there."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
TEXT = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
FOLDERS = "pipeline/|stages/|tests/|samples/|\\.ci/"
NAMED = sorted(set(re.findall(rf"`((?:{FOLDERS})[\w./-]*)`", TEXT)))


@pytest.mark.parametrize("name", NAMED)
def test_every_place_that_is_named_is_there(name: str) -> None:
    assert (ROOT / name).exists()


def test_there_are_places_named() -> None:
    assert {"pipeline/units.py", "stages/model", "samples/gallery.py", "tests/corpus"} <= set(NAMED)


def test_it_is_one_page() -> None:
    assert len(TEXT.splitlines()) <= 80
