"""Meshes of a job: found, in mm, doubted where their size is odd, in the digest, complained about with their place."""

import struct
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from pipeline.job import Job, job_of
from pipeline.jobfile import read
from pipeline.kinds import template
from pipeline.run import run_job
from stages.construct import construct
from stages.errors import BadInputError
from stages.geometry.mesh.mesh import Mesh
from stages.model.meshes import MeshFile
from tests.near import assert_near
from tests.pipeline.jobs import STOCK, write_job
from tests.pipeline.test_meshfiles import CORE, TRIANGLE, archive, binary_stl, text_stl
from tests.tubes import dome, flat, holed, moved, together, tube

JOB = """\
schema = 1
[report]
formats = ["json"]
[[part]]
name = "hood"
[part.surface]
kind = "mesh"
file = "hood.stl"
"""
SHEET = holed(9, [], dome)


def job(folder: Path, text: str = JOB, size: float = 50.0, mesh: Mesh = SHEET) -> Job:
    (folder / "hood.stl").write_bytes(binary_stl(Mesh(mesh.vertices * size, mesh.faces)))
    return job_of(read(write_job(folder, text)))


def complaint(folder: Path, text: str = JOB) -> str:
    with pytest.raises(BadInputError) as caught:
        read(write_job(folder, text))
    return str(caught.value).replace(f"{folder}/", "")


def extent(made: Job) -> float:
    body = made.parts[0].body
    assert isinstance(body, Mesh)
    return float(np.ptp(body.vertices[:, 0]))


def test_without_units_the_job_has_its_own_and_says_so(tmp_path: Path) -> None:
    width = float(np.ptp(SHEET.vertices[:, 0])) * 50.0
    here = job(tmp_path)
    assert_near(extent(here), width, bound=1e-5, why="float32")
    assert "hood.stl states no unit: taken as mm, the unit of the job" in here.notes
    inches = job(tmp_path, 'units = "in"\n' + JOB, size=2.0)
    assert_near(extent(inches), width / 25.0 * 25.4, bound=1e-5, why="float32")
    given = job(tmp_path, JOB + 'units = "cm"\n')
    assert_near(extent(given), 10.0 * width, bound=1e-4, why="float32")
    assert not any("states no unit" in note for note in given.notes)


def test_a_3mf_states_its_unit_and_does_not_take_another(tmp_path: Path) -> None:
    text = f'<model unit="inch" xmlns="{CORE}"><resources><object id="1">{TRIANGLE}</object></resources>'
    (tmp_path / "hood.3mf").write_bytes(archive(text + '<build><item objectid="1"/></build></model>'))
    named = JOB.replace("hood.stl", "hood.3mf")
    assert_near(extent(job(tmp_path, named)), 50.8, bound=1e-12, why="2 in")
    assert_near(extent(job(tmp_path, named + 'units = "in"\n')), 50.8, bound=1e-12, why="2 in")
    assert complaint(tmp_path, named + 'units = "mm"\n') == (
        'job.toml:9:9: part[0].surface.units: "mm", but hood.3mf says in (leave it out)'
    )


def doubted(made: Job) -> str:
    return " ".join(finding.message for finding in made.parts[0].remarks if finding.code == "mesh-units")


@pytest.mark.parametrize(
    ("size", "text", "words"),
    [
        (50.0, JOB, ""),
        (0.05, JOB, "less than 1 mm; as m it would be 126.2"),
        (50_000.0, JOB, "more than 10 m; as um it would be 126.2"),
        (50.0, JOB + 'units = "m"\n', "more than 10 m; as mm it would be 126.2"),
        (0.4, JOB + STOCK, "less than a hundredth of the sheet's 116.619 mm; as in it would be 25.6"),
        (20.0, JOB + STOCK, ""),
        (900.0, JOB + STOCK, "no sheet of the stock, 116.619 mm at most, holds it"),
        (900.0, JOB + 'units = "mm"\n' + STOCK, ""),
    ],
)
def test_an_odd_size_is_doubted_with_what_else_it_may_be(tmp_path: Path, size: float, text: str, words: str) -> None:
    said = doubted(job(tmp_path, text, size))
    assert words in said
    assert bool(words) == bool(said)


def test_the_doubt_is_a_finding_of_the_report(tmp_path: Path) -> None:
    made = job(tmp_path, JOB + "recognise = false\n", 0.05)
    outcome = construct(made.parts[0], made.tolerances)
    assert "mesh-units" in [finding.code for finding in outcome.report.findings]


def test_the_digest_is_of_the_triangles_and_the_inputs_name_the_file(tmp_path: Path) -> None:
    one = job(tmp_path)
    assert [name for name, _ in one.inputs] == ["job.toml", "hood.stl"]
    (tmp_path / "hood.stl").write_bytes(text_stl(one.parts[0].body))  # type: ignore[arg-type]
    same = job_of(read(tmp_path / "job.toml"))
    assert same.digest == one.digest
    assert same.inputs[1] != one.inputs[1]
    assert job(tmp_path, size=50.001).digest != one.digest


def test_the_same_file_twice_is_one_input(tmp_path: Path) -> None:
    twice = JOB + JOB[JOB.index("[[part]]") :].replace('"hood"', '"other"')
    made = job(tmp_path, twice)
    assert len(made.inputs) == 2
    assert [part.name for part in made.parts] == ["hood", "other"]


MISSING = {
    "a missing file": ("hood.stl", "there is no file hood.stl"),
    "a folder": (".", ". is a folder"),
    "a folder with an ending": ("dir.stl", "dir.stl is a folder"),
    "no sample": ("sample:nothing.stl", 'no mesh "sample:nothing.stl" comes with planish (there are: frustum.stl)'),
    "a way out of the samples": ("sample:../../cli.py", "comes with planish"),
    "a null": ("a\\u0000.stl", "control character"),
}


@pytest.mark.parametrize("case", MISSING)
def test_a_file_that_is_not_there_is_complained_about_with_its_place(tmp_path: Path, case: str) -> None:
    name, words = MISSING[case]
    (tmp_path / "dir.stl").mkdir()
    text = complaint(tmp_path, JOB.replace("hood.stl", name))
    assert text.startswith("job.toml:8:8: part[0].surface.file: ")
    assert words in text


def test_a_damaged_file_is_complained_about_with_its_place(tmp_path: Path) -> None:
    (tmp_path / "hood.stl").write_bytes(b"\0" * 80 + struct.pack("<I", 7) + b"\0" * 100)
    assert complaint(tmp_path) == (
        "job.toml:8:8: part[0].surface.file: hood.stl announces 7 triangles and holds 2: it is cut off, or no STL "
        "(copy or export it again)"
    )


def test_names_with_spaces_and_umlauts_are_found(tmp_path: Path) -> None:
    (tmp_path / "Haube größer 2.STL").write_bytes(binary_stl(SHEET))
    made = job_of(read(write_job(tmp_path, JOB.replace("hood.stl", "Haube größer 2.STL"))))
    assert made.inputs[1][0] == "Haube größer 2.STL"


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("seam = [[1, 2, 3], [1, 2, 3]]\n", "all its points coincide"),
        ("seam = [[1, 2, 3]]\n", "seam"),
        ('units = "yd"\n', '"yd" is not allowed'),
        ("[[part.hole]]\nkind = 'circle'\nname = 'h'\nat = [0.5, 0.5]\ndiameter = 3\n", "a mesh has no u and v"),
        ("[[part]]\nname = 'hood.1'\nsurface = {kind = 'mesh', file = 'hood.stl'}\n", 'may be a blank of "hood"'),
    ],
)
def test_keys_that_do_not_go_with_a_mesh_are_refused(tmp_path: Path, line: str, words: str) -> None:
    (tmp_path / "hood.stl").write_bytes(binary_stl(SHEET))
    assert words in complaint(tmp_path, JOB + line)


def test_large_files_are_told_of_before_they_are_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pipeline.reach.TOLD", 1000)
    (tmp_path / "hood.stl").write_bytes(binary_stl(SHEET))
    told: list[str] = []
    read(write_job(tmp_path, JOB), (), told.append)
    assert told == ["reading hood.stl, 0 MB"]


def test_pieces_run_as_blanks_of_their_own(tmp_path: Path) -> None:
    sheet = holed(9, [], flat)
    whole = together(sheet, moved(sheet, np.eye(3), np.array([4.0, 0.0, 0.0])))
    result = run_job(job(tmp_path, JOB, 30.0, whole))
    assert [run.part.name for run in result.parts] == ["hood.1", "hood.2"]
    assert result.status == "made"


def test_the_template_reads_the_mesh_that_comes_with_it(tmp_path: Path) -> None:
    made = job_of(read(write_job(tmp_path, template("mesh"))))
    spec = made.parts[0].spec.surface
    assert isinstance(spec, MeshFile)
    assert_near(extent(made), 120.0, bound=1e-5, why="a frustum of radius 60, float32")


def test_a_tube_of_a_file_becomes_the_frustum_that_it_was_made_from(tmp_path: Path) -> None:
    result = run_job(job(tmp_path, JOB, 10.0, tube(48, 10, (5.0, 3.0), 8.0)))
    assert result.status == "made"
    flat_area = result.parts[0].steps[2].report.detail["flat"]
    assert isinstance(flat_area, dict)
    slant = float(np.hypot(20.0, 80.0))
    assert_near(float(flat_area["area"]), np.pi * 80.0 * slant, bound=1e-6 * 2e4, why="pi (r0 + r1) s, float32")


def test_seams_are_in_the_units_of_the_job(tmp_path: Path) -> None:
    made = job(tmp_path, 'units = "cm"\n' + JOB + "seam = [[1, 2, 3], [4, 5, 6]]\n")
    spec = made.parts[0].spec.surface
    assert isinstance(spec, MeshFile)
    assert spec.seam is not None
    assert spec.seam[0][0] == Fraction(10)
