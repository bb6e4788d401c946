"""Modules that heads and comments name in backticks are there, wherever they have moved."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
FOLDERS = tuple(folder.name for folder in (ROOT / "stages").iterdir() if folder.is_dir())
NAME = re.compile(rf"`((?:stages|pipeline|{'|'.join(FOLDERS)})(?:\.\w+)+)`")
FILES = sorted(file for top in ("stages", "pipeline") for file in (ROOT / top).rglob("*.py"))
NAMED = [(file, name) for file in FILES for name in NAME.findall(file.read_text("utf-8"))]


def is_there(name: str) -> bool:
    """Return whether a dotted name is a module, a package, or something that a module holds."""
    for top in (ROOT, ROOT / "stages"):
        place = top / name.replace(".", "/")
        if place.is_dir() or place.with_suffix(".py").exists():
            return True
        for holder in (place.parent.with_suffix(".py"), place.parent / "__init__.py"):
            if holder.exists() and re.search(rf"\b{place.name}\b", holder.read_text("utf-8")):
                return True
    return False


@pytest.mark.parametrize(("file", "name"), NAMED, ids=lambda one: one if isinstance(one, str) else one.stem)
def test_a_module_that_is_named_is_there(file: Path, name: str) -> None:
    assert is_there(name), f"{file.relative_to(ROOT)} names {name}"


def test_there_are_names_and_a_wrong_one_is_seen() -> None:
    assert len(NAMED) > 20
    assert not is_there("geometry.meshprofile")
