"""Helps for the process from the job file to the report: keys, what is refused with a remedy, jobs that run."""

import json
from pathlib import Path

import msgspec
import pytest

from pipeline.finishedentries import DxfEntry
from pipeline.helps import helps_of, tab_width_mm
from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.processtables import ProcessTable
from pipeline.run import JobResult, run_job
from stages.errors import BadInputError
from stages.model.helps import Helps, Lead, Tabs
from stages.model.material import Material
from tests.near import assert_near
from tests.pipeline.jobs import PLATE, write_job

SHEET = """\
[nest]
gap = 5
rotations = [0]
[[stock]]
id = "sheet"
width = 300
height = 200
edge_gap = 5
"""
OFFSET = """\
[process]
kerf = 0.2
kerf_compensation = "offset"
"""
ALL = """\
[process]
kerf = 0.2
kerf_compensation = "offset"
kerf_corners = "mitre"
start = "left"
slat_pitch = 60
on_narrow = "refuse"
lead_in = { kind = "arc", radius = 1.5 }
lead_out = { kind = "line", length = 1, angle = 45 }
tabs = { count = 2, width = 0.4 }
"""
Report = dict[str, dict[str, list[dict[str, object]]]]


def made(folder: Path, text: str) -> JobResult:
    folder.mkdir(exist_ok=True)
    plates = PLATE.replace('name = "plate"', 'name = "plate"\nquantity = 3')
    return run_job(job_of(read(write_job(folder, plates + text), (), lambda _: None)))


def refused(folder: Path, text: str) -> list[tuple[str, str]]:
    """Return keys and hints of what is wrong with a job."""
    with pytest.raises(BadInputError) as caught:
        read(write_job(folder, PLATE + text), (), lambda _: None)
    return [(problem.path, problem.hint) for problem in caught.value.problems]


def codes(result: JobResult) -> set[str]:
    return {finding.code for finding in result.write.report.findings}


def test_what_the_tables_stand_for(tmp_path: Path) -> None:
    job = job_of(read(write_job(tmp_path, PLATE + SHEET + ALL), (), lambda _: None))
    lead = Lead("arc", 1.5, 90.0), Lead("line", 1.0, 45.0)
    assert job.machine.helps == Helps(0.2, True, True, "left", *lead, Tabs(0.4, count=2))
    assert (job.process.slat_pitch_mm, job.process.refuses_narrow, job.process.compensated) == (60.0, True, True)


def test_without_wishes_there_are_no_helps() -> None:
    assert not helps_of(ProcessTable(), 0.2, Material()).any


@pytest.mark.parametrize(
    ("material", "thickness", "width"),
    [("mild steel", 1.0, 0.2), ("mild steel", 2.0, 0.4), ("mild steel", 6.0, 0.5), ("stainless 304", None, 0.2),
     ("aluminium 5052-H32", 2.0, 0.6), ("aluminium 6061-T6", 5.0, 0.8), ("", None, 0.2)],
)  # fmt: skip
def test_tabs_are_as_wide_as_the_sheet_wants(material: str, thickness: float | None, width: float) -> None:
    assert_near(tab_width_mm(material, thickness), width, bound=1e-15, why="a product of two decimals")


@pytest.mark.parametrize("helps", ["", OFFSET, ALL], ids=["none", "offset", "all"])
@pytest.mark.parametrize("per", ["sheet", "part", "material"])
def test_jobs_run_with_them_and_their_files_are_certified(tmp_path: Path, helps: str, per: str) -> None:
    result = made(tmp_path, SHEET + helps + f'[dxf]\none_file_per = "{per}"\n')
    assert result.status == "made", result.write.report.findings
    names = {metric.name for metric in result.write.report.metrics}
    assert "min_gap_mm" in names
    assert ("kerf_offset_error_mm" in names) == bool(helps)
    assert {"kerf-compensated"} & codes(result) == ({"kerf-compensated"} if helps else set())


def test_the_gap_that_is_certified_is_what_the_cuts_leave(tmp_path: Path) -> None:
    found = [
        made(tmp_path / str(number), SHEET + helps).write.report.metric("min_gap_mm").value
        for number, helps in enumerate(["", OFFSET])
    ]
    assert_near(float(found[0] or 0) - float(found[1] or 0), 0.2, bound=1e-8, why="half a kerf on either side")


def test_common_lines_go_with_offset_contours(tmp_path: Path) -> None:
    result = made(tmp_path, SHEET.replace("gap = 5\n", "gap = 5\ncommon_line = true\n", 1) + OFFSET)
    assert result.status == "made", result.write.report.findings
    assert {"common-lines", "kerf-compensated"} <= codes(result)


def test_a_job_without_stock_says_that_they_do_nothing(tmp_path: Path) -> None:
    result = made(tmp_path, ALL)
    assert result.status == "made"
    assert any("[[stock]]" in note for note in result.job.notes)


@pytest.mark.parametrize("helps", ['lead_in = { kind = "arc", radius = 1.5 }', "tabs = { count = 2, width = 0.4 }"])
def test_a_width_of_the_cut_that_is_not_known_is_told_where_it_counts(tmp_path: Path, helps: str) -> None:
    told = [
        [note for note in job_of(read(path, (), lambda _: None)).notes if "width of the cut" in note]
        for path in (
            write_job(tmp_path, f"{PLATE}{SHEET}[process]\n{known}{text}\n")
            for known, text in (("", helps), ("kerf = 0.2\n", helps), ('type = "laser"\n', helps), ("", "start = 0.5"))
        )
    ]
    assert [len(notes) for notes in told] == [1, 0, 0, 0]


def test_the_report_tells_them_and_reads_back(tmp_path: Path) -> None:
    result = made(tmp_path, SHEET + ALL)
    report = json.loads(outputs(result)[1]["report.json"])
    assert report["job"]["process"]["kerf_compensation"] == "offset"
    entry = msgspec.convert(report["job"]["dxf"], DxfEntry)
    assert entry.machine().helps == result.job.machine.helps


def test_a_slot_narrower_than_the_kerf_rejects_the_job(tmp_path: Path) -> None:
    slot = "[0, 0], [40, 0], [40, 30], [20.1, 30], [20.1, 9], [20, 9], [20, 30], [0, 30], [0, 0]"
    text = PLATE.replace("[0, 0], [40, 0], [40, 30], [0, 30], [0, 0]", slot) + SHEET + OFFSET
    result = run_job(job_of(read(write_job(tmp_path, text), (), lambda _: None)))
    assert (result.status, result.exit_code) == ("rejected", 1)
    found = [finding for step in result.parts[0].steps for finding in step.report.findings if finding.fatal]
    assert [finding.code for finding in found] == ["narrower-than-kerf"]


def test_small_parts_are_warned_of(tmp_path: Path) -> None:
    result = made(tmp_path, SHEET + "[process]\nslat_pitch = 60\n")
    found = [finding.code for step in result.parts[0].steps for finding in step.report.findings]
    assert (result.status, found) == ("made", ["tip-up"])


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ('[process]\nkerf_compensation = "offset"\n', "process.kerf_compensation"),
        ('[process]\nkerf = 0\nkerf_compensation = "offset"\n', "process.kerf_compensation"),
        ('[process]\nkerf_compensation = "ofset"\n', "process.kerf_compensation"),
        ("[process]\nstart = 1.5\n", "process.start"),
        ('[process]\nstart = "corners"\n', "process.start"),
        ('[process]\nlead_in = { kind = "line", radius = 2 }\n', "process.lead_in.length"),
        ('[process]\nlead_in = { kind = "arc", radius = 2, angle = 200 }\n', "process.lead_in.angle"),
        ('[process]\nlead_out = { kind = "line", length = 2, angel = 45 }\n', "process.lead_out.angel"),
        ("[process]\ntabs = { count = 2, spacing = 50 }\n", "process.tabs.spacing"),
        ("[process]\ntabs = { width = 0 }\n", "process.tabs.width"),
        ("[process]\ntab = { width = 1 }\n", "process.tab"),
        ("[process]\nslat_pitch = 0\n", "process.slat_pitch"),
        (OFFSET + SHEET.replace("gap = 5\n", "gap = 0.1\n", 1), "nest.gap"),
        (OFFSET + SHEET.replace("edge_gap = 5", "edge_gap = 0.05"), "stock[0].edge_gap"),
        (ALL + '[dxf]\nflavour = "aama"\n', "dxf.flavour"),
        (OFFSET + '[dxf]\nlayers = { MARK = { name = "CUT_OUTER_OFFSET" } }\n', "dxf.layers.CUT_OUTER.name"),
        (
            OFFSET + '[dxf]\nflavour = "r12"\nlayers = { CUT_INNER = { name = "AN_INNER_CONTOUR_OF_MANY_LETT" } }\n',
            "dxf.layers.CUT_INNER.name",
        ),
    ],
)
def test_what_cannot_be_is_refused_with_a_remedy(tmp_path: Path, text: str, key: str) -> None:
    found = dict(refused(tmp_path, text))
    assert key in found
    assert found[key]
