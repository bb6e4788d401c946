"""Where a report comes from: digests that change with what they stand for, and a source for every limit."""

from hashlib import sha256
from importlib.resources import files
from pathlib import Path

import pytest

from pipeline import provenance
from pipeline.job import Job, job_of
from pipeline.jobfile import read
from pipeline.provenance import Limit, code_digest, tables
from pipeline.report.document import document
from pipeline.run import run_job
from tests.pipeline.jobs import PLATE, write_job

STEEL = '[material]\nname = "DC01"\nthickness = 2\n'


def job(folder: Path, text: str, *settings: str) -> Job:
    return job_of(read(write_job(folder, text), settings))


def limit(job: Job, name: str) -> Limit:
    (found,) = (limit for limit in job.limits if limit.name == name)
    return found


def test_a_limit_names_the_table_that_it_comes_from(tmp_path: Path) -> None:
    found = limit(job(tmp_path, PLATE + STEEL), "bend_radius_min")
    assert found.value == 2.0
    assert found.source.startswith("materials.toml, mild steel: 1 x thickness; ")
    assert limit(job(tmp_path, PLATE + STEEL), "outer_fibre_strain").source.startswith("materials.toml, mild steel: ")


def test_a_value_of_the_job_goes_before_the_table_and_says_so(tmp_path: Path) -> None:
    own = PLATE + STEEL + "bend_radius_min = 5\nmax_strain = 0.1\n"
    assert limit(job(tmp_path, own), "bend_radius_min") == Limit(
        "bend_radius_min", 5.0, "mm", "job file, material.bend_radius_min"
    )
    assert limit(job(tmp_path, own), "outer_fibre_strain").source == "job file, material.max_strain"


@pytest.mark.parametrize(
    ("setting", "name", "value"),
    [("tolerance.accept=leather", "max_warp_deg", 45.0), ("tolerance.chord=0.2", "chord", 0.2)],
)
def test_a_tolerance_is_that_of_planish_unless_the_job_says_otherwise(
    setting: str, name: str, value: float, tmp_path: Path
) -> None:
    assert limit(job(tmp_path, PLATE), name).source.endswith("default of planish")
    changed = limit(job(tmp_path, PLATE, setting), name)
    assert changed.value == value
    assert f"job file, {setting.split('=', maxsplit=1)[0]}" in changed.source


def test_a_tolerance_that_the_job_gives_is_its_own_even_where_it_is_the_default(tmp_path: Path) -> None:
    given = '[tolerance]\naccept = "fabrication"\nchord = 0.05\n'
    stated, left = job(tmp_path, PLATE + given, "tolerance.join=0.01"), job(tmp_path, PLATE)
    keys = {"chord": "chord", "join": "join", "max_warp_deg": "accept", "max_strain": "accept"}
    for name, key in keys.items():
        assert limit(stated, name).value == limit(left, name).value
        assert limit(stated, name).source.endswith(f"job file, tolerance.{key}")
        assert limit(left, name).source.endswith("default of planish")
    assert stated.digest == left.digest


def test_every_limit_that_a_metric_is_held_against_is_among_the_sources(tmp_path: Path) -> None:
    """Whatever limit a report shows stands in its list of limits, with the same value."""
    cylinder = '[[part]]\nname = "bow"\n[part.surface]\nkind = "cone"\nradius0 = 40\nradius1 = 40\nheight = 50\n'
    report = document(run_job(job(tmp_path, PLATE + STEEL + cylinder)), {})
    block, parts = report["provenance"], report["parts"]
    assert isinstance(block, dict)
    assert isinstance(parts, list)
    known = {row["value"] for row in block["limits"]}
    held = [
        (metric["name"], metric["limit"])
        for part in parts
        for stage in part["stages"]
        for metric in stage["metrics"]
        if isinstance(metric["limit"], float) and metric["name"] not in OWN
    ]
    assert {name for name, _ in held} >= {"max_warp_deg", "max_strain"}
    assert [item for item in held if item[1] not in known] == []


OWN = {"overlap_mm2"}
"""The square of the chord."""


def test_the_digest_of_the_input_is_that_of_its_values_and_the_files_are_told_in_the_run(tmp_path: Path) -> None:
    first, second = job(tmp_path, PLATE), job(tmp_path, "# a remark\n" + PLATE)
    assert first.digest == second.digest != job(tmp_path, PLATE, "nest.gap=1").digest
    assert second.inputs == (("job.toml", sha256(("# a remark\n" + PLATE).encode()).hexdigest()),)
    reports = [document(run_job(each), {}) for each in (first, second)]
    assert reports[0]["provenance"] == reports[1]["provenance"]
    assert [report.pop("run")["inputs"][0]["sha256"] for report in reports] == [  # type: ignore[index,union-attr]
        dict(each.inputs)["job.toml"] for each in (first, second)
    ]
    assert reports[0] == reports[1]


def test_a_drawing_is_an_input_with_a_digest_of_its_own(tmp_path: Path) -> None:
    import ezdxf

    drawing = ezdxf.new("R2000", units=4)
    drawing.modelspace().add_circle((0, 0), 30)
    drawing.saveas(tmp_path / "disc.dxf")
    text = '[part.surface]\nkind = "flat"\noutline = { file = "disc.dxf" }\n'
    found = job(tmp_path, PLATE.split("[part.surface]")[0] + text)
    assert found.inputs[1] == ("disc.dxf", sha256((tmp_path / "disc.dxf").read_bytes()).hexdigest())


def test_tables_and_code_have_digests_that_follow_their_text(monkeypatch: pytest.MonkeyPatch) -> None:
    materials = files("pipeline").joinpath("data", "materials.toml").read_bytes()
    assert dict(tables())["materials.toml"] == sha256(materials).hexdigest()
    honest = provenance._digest

    def changed(file: Path) -> str:
        return "0" * 64 if file.name == "certificate.py" else honest(file)

    before = code_digest()
    code_digest.cache_clear()
    assert code_digest() == before
    code_digest.cache_clear()
    monkeypatch.setattr(provenance, "_digest", changed)
    assert code_digest() != before
    code_digest.cache_clear()


def test_the_libraries_that_read_the_files_of_a_job_are_told_with_their_versions() -> None:
    always = provenance.environment(["job.toml", "rails.dxf", "hood.stl"])
    assert set(always) == {"python", *provenance.LIBRARIES}
    assert set(provenance.environment(["job.toml", "a/Bracket.STP"])) - set(always) == {"cadquery-ocp-novtk"}
    both = provenance.environment(["one.igs", "two.3dm"])
    assert set(both) - set(always) == {"cadquery-ocp-novtk", "rhino3dm"}
    assert "not installed" not in both.values()


def test_every_cad_file_that_is_read_has_its_library_told() -> None:
    from pipeline.cad.files import SORTS

    assert {end for ends in provenance.CAD_LIBRARIES.values() for end in ends} == set(SORTS)
