"""Ribbons whose job file points at a mesh for their normals: read, in mm, part of the digest, and told when missing."""

from pathlib import Path

import numpy as np
import pytest

from pipeline.job import Job, job_of
from pipeline.jobfile import read
from stages.construct import construct
from stages.errors import BadInputError
from stages.geometry.mesh.mesh import Mesh
from tests.meshes import jittered

JOB = """schema = 1
units = "cm"
[[part]]
name = "band"
[part.surface]
kind = "ribbon"
curve = {{ helix = {{ radius = 10, pitch = 40, turns = 0.125 }} }}
normals = {{ file = "{file}"{units} }}
width = 2
"""


def pipe() -> Mesh:
    """Return 1.2 rad of a pipe of 100 mm."""
    v, u, faces = jittered(1, 50, 50)
    turn = 1.2 * v - 0.2
    return Mesh(np.column_stack([100.0 * np.cos(turn), 100.0 * np.sin(turn), 80.0 * u - 10.0]), faces[:, ::-1])


def written(folder: Path, *, scale: float = 1.0) -> None:
    """Write the pipe as OFF, which has no unit."""
    mesh = pipe()
    rows = [f"OFF\n{len(mesh.vertices)} {len(mesh.faces)} 0"]
    rows += [" ".join(repr(float(x)) for x in row) for row in mesh.vertices * scale]
    rows += [f"3 {a} {b} {c}" for a, b, c in mesh.faces]
    (folder / "last.off").write_text("\n".join(rows) + "\n", "ascii")


def job(folder: Path, units: str = ', units = "mm"', file: str = "last.off") -> Job:
    place = folder / "job.toml"
    place.write_text(JOB.format(file=file, units=units), "utf-8")
    return job_of(read(place))


def test_the_mesh_is_read_in_its_own_unit(tmp_path: Path) -> None:
    written(tmp_path)
    found = job(tmp_path)
    (mesh,) = found.parts[0].meshes.values()
    assert np.array_equal(mesh.vertices, pipe().vertices)
    assert [name for name, _ in found.inputs] == ["job.toml", "last.off"]
    made = construct(found.parts[0], found.tolerances)
    assert made.report.passed, made.report.findings
    assert float(made.report.metric("mesh_distance_mm").value or 0.0) < 1e-3


def test_a_mesh_without_a_unit_has_that_of_the_job_and_does_not_fit(tmp_path: Path) -> None:
    written(tmp_path)
    found = job(tmp_path, units="")
    assert any("states no unit" in note for note in found.notes)
    made = construct(found.parts[0], found.tolerances)
    (finding,) = (finding for finding in made.report.findings if finding.fatal)
    assert finding.code == "curve-off-mesh" and "0.1 times" in finding.message


def test_another_mesh_is_another_job(tmp_path: Path) -> None:
    written(tmp_path)
    one = job(tmp_path).digest
    assert job(tmp_path).digest == one
    written(tmp_path, scale=1.0 + 1e-12)
    assert job(tmp_path).digest != one


def test_a_mesh_of_doubtful_size_is_told(tmp_path: Path) -> None:
    written(tmp_path)
    found = job(tmp_path, units=', units = "m"')
    assert [remark.code for remark in found.parts[0].remarks] == ["mesh-units"]
    assert "mesh-units" in [f.code for f in construct(found.parts[0], found.tolerances).report.findings]


def test_a_missing_file_is_told_with_its_place(tmp_path: Path) -> None:
    with pytest.raises(BadInputError) as caught:
        job(tmp_path, file="none.off")
    (problem,) = caught.value.problems
    assert (problem.path, problem.line) == ("part[0].surface.normals.file", 8)
    assert "none.off" in problem.message
