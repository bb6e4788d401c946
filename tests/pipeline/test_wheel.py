"""What an installed planish has of its own: every file of `pipeline/data`, in a wheel made of this source."""

import re
import sys
import tomllib
import zipfile
from pathlib import Path
from subprocess import run

import pytest

from pipeline.report.html import LIBRARY, SCRIPTS, STYLES
from pipeline.report.pages import ASSETS

ROOT = Path(__file__).parents[2]
MADE = re.compile(r"(^|/)(__pycache__|node_modules)/")
"""Made here by programs, and no part of the source."""


@pytest.fixture(scope="module")
def held(tmp_path_factory: pytest.TempPathFactory) -> set[str]:
    """Return the names in a wheel, built without a network by the build program that the project names."""
    pytest.importorskip("hatchling")
    folder = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    run(build, cwd=ROOT, check=True, capture_output=True)
    (wheel,) = folder.glob("*.whl")
    with zipfile.ZipFile(wheel) as opened:
        return {name for name in opened.namelist() if not name.endswith("/")}


def sources(folder: Path) -> set[str]:
    """Return the files below a folder that are not made, by their paths below the root."""
    found = (file.relative_to(ROOT).as_posix() for file in folder.rglob("*") if file.is_file())
    return {name for name in found if not MADE.search(name)}


def test_every_file_of_the_data_is_in_the_wheel(held: set[str]) -> None:
    data = sources(ROOT / "pipeline" / "data")
    assert {"pipeline/data/report/page.html", "pipeline/data/report-schema.json"} <= data
    assert data - held == set()


def test_every_module_is_in_the_wheel(held: set[str]) -> None:
    modules = {name for folder in ("pipeline", "stages") for name in sources(ROOT / folder) if name.endswith(".py")}
    assert modules - held == set()


def test_type_checkers_are_told_that_there_are_types(held: set[str]) -> None:
    assert {"pipeline/py.typed", "stages/py.typed"} <= held


def test_nothing_is_in_the_wheel_that_is_no_source(held: set[str]) -> None:
    licence = {name for name in held if name.startswith("planish-")}
    assert any(name.endswith("LICENSE") for name in licence)
    assert held - licence - sources(ROOT / "pipeline") - sources(ROOT / "stages") == set()


def test_what_the_pages_are_made_of_is_there_and_nothing_else() -> None:
    assert all((ASSETS / name).is_file() for name in (LIBRARY, *STYLES, *SCRIPTS))
    code = "".join(file.read_text("utf-8") for file in (ROOT / "pipeline" / "report").glob("*.py"))
    unnamed = [file.name for file in ASSETS.iterdir() if file.is_file() and f'"{file.name}"' not in code]
    assert unnamed == ["three.LICENSE.txt"]


def test_the_wheel_is_of_both_packages() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    assert project["tool"]["hatch"]["build"]["targets"]["wheel"]["packages"] == ["pipeline", "stages"]
