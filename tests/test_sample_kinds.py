"""Every kind of surface is in a sample, and no sample is without one."""

import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

from pipeline.job import job_of
from pipeline.jobfile import read
from samples.gallery import shown
from stages.model.part import KINDS
from tests.samples import SAMPLES

MADE = sorted(path for path in SAMPLES.glob("*/*.toml") if path.name == "job.toml")
ALL = sorted(SAMPLES.glob("*/*.toml"))


def kinds_in(value: object) -> Iterator[str]:
    """Yield every `kind` of a surface or of a piece of one."""
    if isinstance(value, dict):
        if isinstance(value.get("kind"), str):
            yield value["kind"]
        for key in ("surface", "pieces", "first"):
            yield from kinds_in(value.get(key))
    elif isinstance(value, list):
        for entry in value:
            yield from kinds_in(entry)


def test_every_kind_of_surface_is_in_a_sample_that_is_made() -> None:
    wanted = {str(kind.__struct_config__.tag) for kind in KINDS}
    shown = {
        kind for path in MADE for part in tomllib.loads(path.read_text("utf-8"))["part"] for kind in kinds_in(part)
    }
    assert shown == wanted


@pytest.mark.parametrize("path", ALL, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_every_sample_is_a_job_that_says_what_it_is(path: Path) -> None:
    assert path.read_text("utf-8").startswith("# ")
    assert job_of(read(path, [])).parts


@pytest.mark.parametrize("path", MADE, ids=lambda path: path.parent.name)
def test_every_sample_that_is_made_has_its_pictures_beside_it(path: Path) -> None:
    assert {picture.stem for picture in path.parent.glob("*.png")} == set(shown(path.parent.name))
