"""Every kind of surface is in a sample that is made, with a picture of it, and the page of the samples shows them."""

import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest
from PIL import Image

from pipeline.job import job_of
from pipeline.jobfile import read
from samples.gallery import PICTURES, made_small, place, shown
from samples.listing import PAGE, REFUSED, WHOLE, page, pictures_of_kinds, words
from stages.model.part import KINDS
from tests.samples import SAMPLES

ALL = sorted(SAMPLES.glob("*/*.toml"))
MADE = sorted(SAMPLES / job for job in PICTURES)
LARGEST_PICTURE = 150_000
"""Bytes: all pictures together are loaded with one page."""


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


WANTED = {str(kind.__struct_config__.tag) for kind in KINDS}


def test_every_kind_of_surface_is_in_a_sample_that_is_made() -> None:
    found = {
        kind for path in MADE for part in tomllib.loads(path.read_text("utf-8"))["part"] for kind in kinds_in(part)
    }
    assert found == WANTED


def test_every_kind_of_surface_has_a_picture_of_a_part_of_it() -> None:
    found = pictures_of_kinds()
    assert set(found) == WANTED
    assert len(set(found.values())) == len(WANTED), "no picture stands for two kinds"
    assert all(place(job, name).exists() for job, name in found.values())


@pytest.mark.parametrize("path", ALL, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_every_sample_is_a_job_that_says_what_it_is(path: Path) -> None:
    job = path.relative_to(SAMPLES).as_posix()
    assert len(words(job)) > 60
    assert job_of(read(path, [])).parts
    assert (job in PICTURES) != (job in REFUSED)


@pytest.mark.parametrize("folder", sorted({path.parent for path in ALL}), ids=lambda folder: folder.name)
def test_every_sample_that_is_made_has_its_pictures_beside_it_and_no_others(folder: Path) -> None:
    jobs = [job for job in PICTURES if (SAMPLES / job).parent == folder]
    assert {picture.stem for picture in folder.glob("*.png")} == {name for job in jobs for name in shown(job)}
    assert all(picture.stat().st_size < LARGEST_PICTURE for picture in folder.glob("*.png"))


def test_the_page_of_the_samples_is_what_the_gallery_writes() -> None:
    assert PAGE.read_text("utf-8") == page()


def test_the_page_names_every_job_and_shows_every_picture() -> None:
    text = page()
    for job in (*PICTURES, *REFUSED):
        assert f"| [{job}]({job}) |" in text
    for job, names in WHOLE.items():
        assert set(names) <= set(shown(job))
    for kind in WANTED:
        assert f"| `{kind}` |" in text


def test_a_small_picture_shows_the_same_and_is_left_alone_the_next_time(tmp_path: Path) -> None:
    picture = tmp_path / "a.png"
    image = Image.linear_gradient("L").convert("RGB")
    image.save(picture)
    made_small(picture)
    once = picture.read_bytes()
    made_small(picture)
    assert picture.read_bytes() == once
    with Image.open(picture) as small:
        assert small.mode == "P"
        assert small.convert("RGB").tobytes() == image.tobytes(), "no more colours than there are"
