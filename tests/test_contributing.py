"""What CONTRIBUTING.md and stages/DESIGN.md send people to is there."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
TEXT = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
FOLDERS = "pipeline/|stages/|tests/|samples/|\\.ci/"
CODE = "pipeline", "stages", "tests", "samples"
NAMED = sorted(set(re.findall(rf"`((?:{FOLDERS})[\w./-]*)`", TEXT)))
DESIGN = (ROOT / "stages/DESIGN.md").read_text("utf-8")
MODULES = sorted(set(re.findall(r"[\w/]+\.py\b", DESIGN)))


@pytest.mark.parametrize("name", NAMED)
def test_every_place_that_is_named_is_there(name: str) -> None:
    assert (ROOT / name).exists()


def test_there_are_places_named() -> None:
    assert {"pipeline/units.py", "stages/model", "samples/gallery.py", "tests/corpus"} <= set(NAMED)


def test_it_is_one_page() -> None:
    assert len(TEXT.splitlines()) <= 80


@pytest.mark.parametrize("name", MODULES)
def test_every_module_that_the_design_page_names_is_there(name: str) -> None:
    files = [ROOT / "dev.py", *(file for folder in CODE for file in (ROOT / folder).rglob("*.py"))]
    assert any(file.as_posix().endswith(f"/{name}") for file in files)


def test_the_design_page_names_modules() -> None:
    assert {"write/test_compare.py", "dev.py"} <= set(MODULES)
