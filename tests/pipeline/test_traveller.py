"""The traveller: its pages, their figures, letters of all sorts, and the same bytes in every process."""

import json
import re
import subprocess
import sys
import zlib
from base64 import a85decode
from collections.abc import Mapping
from pathlib import Path

import pytest

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.report.render import Made
from pipeline.report.traveller import traveller_pdf
from pipeline.report.traveller_numbers import millimetres
from pipeline.run import run_job
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
SCRIPT = """
import sys
from pathlib import Path
from tests.pipeline.test_traveller import produced
sys.stdout.buffer.write(produced(Path(sys.argv[1]), Path(sys.argv[2]).read_text("utf-8"))["traveller.pdf"])
"""


def produced(folder: Path, text: str) -> dict[str, bytes]:
    """Return everything that a job makes."""
    return outputs(run_job(job_of(read(write_job(folder, text)))))[1]


def contents(pdf: bytes) -> list[str]:
    """Return what is drawn on each page, in operators."""
    found = re.findall(rb"/Contents (\d+) 0 R", pdf)
    return [drawn(pdf, int(number)) for number in found]


def drawn(pdf: bytes, number: int) -> str:
    match = re.search(rb"\n%d 0 obj\n<< [^\n]*stream\n(.*?)~>" % number, pdf.replace(b">>\nstream", b">> stream"), re.S)
    assert match is not None
    return zlib.decompress(a85decode(match[1])).decode("ascii")


def texts(page: str) -> list[str]:
    """Return the texts of a page."""
    found = re.findall(r"\((.*?)(?<!\\)\) Tj", page)
    return [re.sub(r"\\(\d{3})", lambda m: bytes([int(m[1], 8)]).decode("cp1252"), one) for one in found]


def all_texts(files: Mapping[str, bytes]) -> list[str]:
    return [one for page in contents(files["traveller.pdf"]) for one in texts(page)]


@pytest.fixture(scope="module")
def job(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    return produced(tmp_path_factory.mktemp("job"), PLATE + CONE + STOCK)


def test_every_part_and_every_sheet_has_a_page(job: dict[str, bytes]) -> None:
    pages = [texts(page) for page in contents(job["traveller.pdf"])]
    report = json.loads(job["report.json"])
    digest = report["job"]["digest"][:8]
    ids = [one for page in pages for one in page if one.startswith(digest)]
    assert sorted(set(ids)) == [f"{digest}-P001", f"{digest}-P002", f"{digest}-S001"]
    assert len(ids) == len(pages)


def test_every_page_has_the_check_line(job: dict[str, bytes]) -> None:
    for page in contents(job["traveller.pdf"]):
        assert "12 9 m 112 9 l S" in page
        assert "100 mm on paper" in texts(page)


def test_edges_and_diagonals_are_those_of_the_report(job: dict[str, bytes]) -> None:
    cone = json.loads(job["report.json"])["parts"][1]
    found = all_texts(job)
    for length in cone["flat"]["edges"].values():
        assert millimetres(length) in found
    (a, _, c, _) = cone["flat"]["corners"]
    assert millimetres(((a[0] - c[0]) ** 2 + (a[1] - c[1]) ** 2) ** 0.5) in found


def test_a_plate_is_measured_by_its_own_corners(job: dict[str, bytes]) -> None:
    found = texts(contents(job["traveller.pdf"])[0])
    assert {"30.00", "40.00", "50.00", "A \N{EN DASH} C", "diagonal"} <= {*found}


def test_a_pattern_is_at_true_scale_where_it_fits(job: dict[str, bytes]) -> None:
    assert "1 : 1" in " ".join(all_texts(job))


def test_a_large_pattern_is_at_a_scale_that_is_said(tmp_path: Path) -> None:
    said = " ".join(all_texts(produced(tmp_path, PLATE.replace("polyline", "polyline") + LARGE)))
    assert re.search(r"Flat pattern 1 : [2-9]\d", said)


def test_a_rejected_part_says_so_and_shows_no_pattern(tmp_path: Path) -> None:
    files = produced(tmp_path, PLATE + TWISTED)
    said = texts(contents(files["traveller.pdf"])[-1])
    assert "REJECTED" in said
    assert "FAIL" in said
    assert not any(one.startswith("Flat pattern") for one in said)


def test_umlauts_stay_and_letters_of_other_scripts_are_told(tmp_path: Path) -> None:
    files = produced(tmp_path, PLATE.replace('name = "plate"', 'name = "Größe Ж"'))
    said = all_texts(files)
    assert "Größe ?" in said
    assert any("U+0416" in one for one in said)


@pytest.mark.parametrize("name", ["<script>alert(1)</script>", "=cmd()", 'say "x" \\\\ (y', "x" * 80])
def test_names_stay_text(tmp_path: Path, name: str) -> None:
    quoted = name.replace('"', '\\"') if '"' in name else name
    files = produced(tmp_path, PLATE.replace('name = "plate"', f'name = "{quoted}"'))
    name = json.loads(files["report.json"])["parts"][0]["name"]
    first = texts(contents(files["traveller.pdf"])[0])
    head = "".join(re.sub(r"\\(.)", r"\1", one) for one in first[:8] if one != "EXACT")
    assert name.replace(" ", "") in head.replace(" ", "")


def test_the_same_job_gives_the_same_bytes_in_another_process(tmp_path: Path, job: dict[str, bytes]) -> None:
    text = tmp_path / "text.toml"
    text.write_text(PLATE + CONE + STOCK, "utf-8")
    command = [sys.executable, "-c", SCRIPT, str(tmp_path), str(text)]
    run = subprocess.run(command, check=True, capture_output=True, timeout=600)
    assert run.stdout == job["traveller.pdf"]


def test_another_length_gives_other_pages(job: dict[str, bytes]) -> None:
    """What is written comes from the report."""
    report = json.loads(job["report.json"])
    report["parts"][1]["flat"]["edges"]["c0"] += 1.0
    changed = traveller_pdf(Made(report, job))
    before = {*all_texts(job)}
    assert {*all_texts({"traveller.pdf": changed})} - before == {millimetres(report["parts"][1]["flat"]["edges"]["c0"])}


def test_without_side_files_and_views_the_pages_are_made(job: dict[str, bytes]) -> None:
    bare = {path: content for path, content in job.items() if path.startswith("flat/") and path.endswith(".dxf")}
    found = all_texts({"traveller.pdf": traveller_pdf(Made(json.loads(job["report.json"]), bare))})
    assert "Pieces" in found
    assert "Order of cutting" in all_texts(job)


def test_a_finding_of_a_thousand_letters_goes_on_below(job: dict[str, bytes]) -> None:
    report = json.loads(job["report.json"])
    words = [f"word{number}" for number in range(2000)]
    finding = {"code": "long", "message": " ".join(words), "fatal": False, "where": {}}
    report["parts"][0]["stages"][0]["findings"].append(finding)
    said = " ".join(all_texts({"traveller.pdf": traveller_pdf(Made(report, job))})).split()
    assert [one for one in said if one.startswith("word")] == words
