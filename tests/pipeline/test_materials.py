"""The table of materials: complete, sourced, overridden by the job."""

from pathlib import Path

import pytest

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.materials import VALUES, MaterialRow, are_same, listing, look_up, table
from stages.errors import BadInputError
from stages.model.kfactor import KFactor
from stages.model.material import Material
from tests.pipeline.jobs import CONE, PLATE, write_job


def material(folder: Path, *lines: str) -> tuple[Material, tuple[str, ...]]:
    job = job_of(read(write_job(folder, PLATE + "[material]\n" + "\n".join(lines))))
    return job.parts[0].material, job.notes


@pytest.mark.parametrize("row", table(), ids=lambda row: row.name)
def test_every_value_has_a_source_in_words(row: MaterialRow) -> None:
    for key in VALUES:
        sourced = getattr(row, key)
        if sourced is None:
            assert "leather" in row.name, "what is not elastic has no yield strength and no modulus"
            continue
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
    elastic = {"yield_strength_mpa": 230.0, "youngs_modulus_gpa": 193.0}
    assert plain == Material("stainless 304", 2.0, 7900.0, 2.0, 0.3, **elastic)
    own, _ = material(tmp_path, 'name = "304"', 'thickness = "1/8 in"', "density = 8000", "bend_radius_min = 5")
    assert own == Material("304", 3.175, 8000.0, 5.0, 0.3, **elastic)


def test_springback_needs_both_values_and_takes_those_of_the_job(tmp_path: Path) -> None:
    own, _ = material(tmp_path, 'name = "mild steel"', "yield_strength = 355", "youngs_modulus = 205")
    assert (own.yield_strength_mpa, own.youngs_modulus_gpa) == (355.0, 205.0)
    leather, _ = material(tmp_path, 'name = "veg-tan leather"')
    assert (leather.yield_strength_mpa, leather.youngs_modulus_gpa) == (None, None)


@pytest.mark.parametrize(
    ("line", "rule"),
    [
        ("k_factor = 0.42", 0.42),
        ('k_factor = "din6935"', "din6935"),
        ("k_factor = [[0.5, 0.33], [1, 0.38], [5, 0.5]]", ((0.5, 0.33), (1.0, 0.38), (5.0, 0.5))),
    ],
)
def test_k_is_a_value_a_rule_or_a_table(tmp_path: Path, line: str, rule: object) -> None:
    assert material(tmp_path, line)[0].k_factor == KFactor(rule, given=True)


def test_without_k_the_sheet_is_rolled(tmp_path: Path) -> None:
    k = material(tmp_path, "thickness = 2")[0].k_factor
    assert (k.rule, k.given) == (0.5, False)


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ("k_factor = 0.65", "material.k_factor: K = 0.65 (from 0 to 0.5; the k of DIN 6935 is twice this K)"),
        ('k_factor = "din"', 'material.k_factor: "din" is not allowed (did you mean "din6935"?)'),
        ("k_factor = [[1, 0.3], [1, 0.4]]", "material.k_factor[1][0]: r/t = 1 (from 0 on, each above the one before)"),
        ("k_factor = [[-1, 0.3]]", "material.k_factor[0][0]: r/t = -1 (from 0 on, each above the one before)"),
        (
            "k_factor = [[1, 0.8]]",
            "material.k_factor[0][1]: K = 0.8 (from 0 to 0.5; the k of DIN 6935 is twice this K)",
        ),
        ("yield_strength = 0", "material.yield_strength: 0 (must be above 0)"),
    ],
)
def test_a_k_that_no_sheet_has_is_refused(tmp_path: Path, line: str, complaint: str) -> None:
    with pytest.raises(BadInputError) as caught:
        material(tmp_path, line)
    assert complaint in str(caught.value)


def test_a_face_needs_a_thickness(tmp_path: Path) -> None:
    text = PLATE + CONE.replace('name = "cone"', 'name = "cone"\nface = "inner"')
    with pytest.raises(BadInputError) as caught:
        read(write_job(tmp_path, text))
    assert "part[1].face" in str(caught.value)
    assert "material.thickness" in str(caught.value)
    read(write_job(tmp_path, text + "[material]\nthickness = 2\n"))


def test_the_radius_of_a_named_material_needs_a_thickness(tmp_path: Path) -> None:
    assert material(tmp_path, 'name = "brass"')[0].bend_radius_min_mm is None


def test_an_unknown_name_stands_for_the_values_given_and_says_so(tmp_path: Path) -> None:
    own, notes = material(tmp_path, 'name = "stainles 304"', "thickness = 1")
    assert own == Material("stainles 304", 1.0)
    assert notes == (
        'material "stainles 304" is not in the table: only the values given count; did you mean "stainless 304"?',
    )


def test_names_of_one_row_mean_one_material() -> None:
    assert are_same("mild steel", "DC01")
    assert are_same("Brass", "brass")
    assert not are_same("mild steel", "brass")
    assert not are_same("unobtainium", "adamantium")
    assert are_same("un-obtainium", "Un obtainium"), "not in the table, and alike"
