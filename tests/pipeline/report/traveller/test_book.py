"""The traveller: its pages, their figures, letters of all sorts, and the same bytes in every process."""

import json
import re
from pathlib import Path

import pytest

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.report.render import Made
from pipeline.report.traveller.book import traveller_pdf
from pipeline.report.traveller.numbers import millimetres
from pipeline.run import run_job
from tests.pdfs import all_texts, page_operators, texts
from tests.pipeline.jobs import CONE, STOCK, TWISTED, write_job

PLATE = """\
schema = 1
[job]
name = "Tür"
[report]
formats = ["json", "traveller"]
[material]
name = "mild steel"
thickness = 2
[[part]]
name = "plate"
[part.surface]
kind = "flat"
outline = { polyline = [[0, 0], [40, 0], [40, 30], [0, 30], [0, 0]] }
"""
LARGE = """\
[[part]]
name = "large"
[part.surface]
kind = "cone"
radius0 = 900
radius1 = 500
height = 800
"""


def produced(folder: Path, text: str) -> dict[str, bytes]:
    """Return everything that a job makes."""
    return outputs(run_job(job_of(read(write_job(folder, text)))))[1]


@pytest.fixture(scope="module")
def job(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    return produced(tmp_path_factory.mktemp("job"), PLATE + CONE + STOCK)


def test_every_part_and_every_sheet_has_a_page(job: dict[str, bytes]) -> None:
    pages = [texts(page) for page in page_operators(job["traveller.pdf"])]
    report = json.loads(job["report.json"])
    digest = report["job"]["digest"][:8]
    ids = [one for page in pages for one in page if one.startswith(digest)]
    assert sorted(set(ids)) == [f"{digest}-P001", f"{digest}-P002", f"{digest}-S001"]
    assert len(ids) == len(pages)


def test_every_page_has_the_check_line(job: dict[str, bytes]) -> None:
    for page in page_operators(job["traveller.pdf"]):
        assert "12 9 m 112 9 l S" in page
        assert "100 mm on paper" in texts(page)


def test_edges_and_diagonals_are_those_of_the_report(job: dict[str, bytes]) -> None:
    cone = json.loads(job["report.json"])["parts"][1]
    found = all_texts(job["traveller.pdf"])
    for length in cone["flat"]["edges"].values():
        assert millimetres(length) in found
    (a, _, c, _) = cone["flat"]["corners"]
    assert millimetres(((a[0] - c[0]) ** 2 + (a[1] - c[1]) ** 2) ** 0.5) in found


def test_a_plate_is_measured_by_its_own_corners(job: dict[str, bytes]) -> None:
    found = texts(page_operators(job["traveller.pdf"])[0])
    assert {"30.00", "40.00", "50.00", "A \N{EN DASH} C", "diagonal"} <= {*found}


def test_a_pattern_is_at_true_scale_where_it_fits(job: dict[str, bytes]) -> None:
    assert "1 : 1" in " ".join(all_texts(job["traveller.pdf"]))


def test_a_large_pattern_is_at_a_scale_that_is_said(tmp_path: Path) -> None:
    said = " ".join(all_texts(produced(tmp_path, PLATE + LARGE)["traveller.pdf"]))
    assert re.search(r"Flat pattern 1 : [2-9]\d", said)


def test_a_rejected_part_says_so_and_shows_no_pattern(tmp_path: Path) -> None:
    files = produced(tmp_path, PLATE + TWISTED)
    said = texts(page_operators(files["traveller.pdf"])[-1])
    assert "REJECTED" in said
    assert "FAIL" in said
    assert not any(one.startswith("Flat pattern") for one in said)


def test_umlauts_stay_and_letters_of_other_scripts_are_told(tmp_path: Path) -> None:
    files = produced(tmp_path, PLATE.replace('name = "plate"', 'name = "Größe Ж"'))
    said = all_texts(files["traveller.pdf"])
    assert "Größe ?" in said
    assert any("U+0416" in one for one in said)


@pytest.mark.parametrize("name", ["<script>alert(1)</script>", "=cmd()", 'say "x" \\\\ (y', "x" * 80])
def test_names_stay_text(tmp_path: Path, name: str) -> None:
    quoted = name.replace('"', '\\"') if '"' in name else name
    files = produced(tmp_path, PLATE.replace('name = "plate"', f'name = "{quoted}"'))
    name = json.loads(files["report.json"])["parts"][0]["name"]
    first = texts(page_operators(files["traveller.pdf"])[0])
    head = "".join(one for one in first[:8] if one != "EXACT")
    assert name.replace(" ", "") in head.replace(" ", "")


def test_what_failed_without_a_value_is_told_first(job: dict[str, bytes]) -> None:
    """A number that is none became null on its way into the report."""
    report = json.loads(job["report.json"])
    lost = {"name": "lost", "value": None, "unit": "mm", "evidence": "sampled", "limit": 1.0, "pass": False}
    report["parts"][0]["stages"][1]["metrics"].append({**lost, "margin": None, "where": None})
    said = " ".join(texts(page_operators(traveller_pdf(Made(report, job)))[0]))
    assert "FAIL" in said
    assert "lost not defined, limit 1 mm" in said


def test_what_is_not_counted_is_not_none(job: dict[str, bytes]) -> None:
    report = json.loads(job["report.json"])
    report["nest"]["sheets"][0] |= {"pierces": None, "cut_length_mm": None}
    assert "pierces not known" in " ".join(all_texts(traveller_pdf(Made(report, job))))


def test_another_length_gives_other_pages(job: dict[str, bytes]) -> None:
    """What is written comes from the report."""
    report = json.loads(job["report.json"])
    (span,) = (one for one in report["parts"][1]["tape"]["spans"] if one["what"] == "c0")
    span["along_mm"] += 1.0
    changed = traveller_pdf(Made(report, job))
    before = {*all_texts(job["traveller.pdf"])}
    assert {*all_texts(changed)} - before == {millimetres(span["along_mm"])}


def test_without_side_files_the_order_of_cutting_is_not_said(job: dict[str, bytes]) -> None:
    bare = {"view.json": job["view.json"]}
    found = all_texts(traveller_pdf(Made(json.loads(job["report.json"]), bare)))
    assert "Pieces" in found
    assert "Order of cutting" in all_texts(job["traveller.pdf"])


def test_a_finding_of_a_thousand_letters_goes_on_below(job: dict[str, bytes]) -> None:
    report = json.loads(job["report.json"])
    words = [f"word{number}" for number in range(2000)]
    finding = {"code": "long", "message": " ".join(words), "fatal": False, "where": {}}
    report["parts"][0]["stages"][0]["findings"].append(finding)
    said = " ".join(all_texts(traveller_pdf(Made(report, job)))).split()
    assert [one for one in said if one.startswith("word")] == words


def test_a_part_with_a_seam_shows_the_size_of_what_is_cut(tmp_path: Path) -> None:
    files = produced(tmp_path, PLATE + '[[part.seam]]\nedge = "outline"\nallowance = 5\n')
    told = " ".join(texts(page_operators(files["traveller.pdf"])[0]))
    assert "50.00 × 40.00 mm" in told, "40 by 30 mm and 5 mm more on every side"
    assert "40.00 × 30.00 mm" not in told
