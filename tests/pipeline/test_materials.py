"""The table of materials: complete, sourced, overridden by the job."""

from pathlib import Path

import pytest

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.materials import VALUES, listing, look_up, table
from stages.model.material import Material
from tests.pipeline.jobs import PLATE, write_job


def material(folder: Path, *lines: str) -> tuple[Material, tuple[str, ...]]:
    job = job_of(read(write_job(folder, PLATE + "[material]\n" + "\n".join(lines))))
    return job.parts[0].material, job.notes


@pytest.mark.parametrize("row", table(), ids=lambda row: row.name)
def test_every_value_has_a_source_in_words(row: object) -> None:
    for key in VALUES:
        sourced = getattr(row, key)
        assert sourced.value >= 0
        assert len(sourced.source.split()) >= 4
        assert sourced.source in listing()


def test_names_are_found_however_they_are_written() -> None:
    for name in ("mild steel", "Mild  Steel", "MILD-STEEL", "s235"):
        row, notes = look_up(name)
        assert row is not None
        assert (row.name, notes) == ("mild steel", ())
    assert look_up("Aluminum 5052-H32")[0] is look_up("5052")[0]


def test_the_job_goes_before_the_table(tmp_path: Path) -> None:
    plain, _ = material(tmp_path, 'name = "stainless 304"', "thickness = 2")
    assert plain == Material("stainless 304", 2.0, 7900.0, 2.0, 0.3)
    own, _ = material(tmp_path, 'name = "304"', 'thickness = "1/8 in"', "density = 8000", "bend_radius_min = 5")
    assert own == Material("304", 3.175, 8000.0, 5.0, 0.3)


def test_the_radius_of_a_named_material_needs_a_thickness(tmp_path: Path) -> None:
    assert material(tmp_path, 'name = "brass"')[0].bend_radius_min_mm is None


def test_an_unknown_name_stands_for_the_values_given_and_says_so(tmp_path: Path) -> None:
    own, notes = material(tmp_path, 'name = "stainles 304"', "thickness = 1")
    assert own == Material("stainles 304", 1.0)
    assert notes == (
        'material "stainles 304" is not in the table: only the values given count; did you mean "stainless 304"?',
    )
