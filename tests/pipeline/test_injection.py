"""Names that would be code elsewhere stay text in every file that a job makes: HTML, CSV, XML, DXF, SVG, PDF, JSON."""

import csv
import json
import os
import re
from html.parser import HTMLParser
from io import StringIO
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from lxml import etree

from pipeline.cli import main
from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.plaintext import plain, plain_lines
from pipeline.run import run_job
from stages.errors import BadInputError
from stages.write.drawing import Label
from tests.pipeline.jobs import write_job

NAMES = (
    "</script><script>alert(1)</script>",
    "<!--<img src=x onerror=alert(1)>",
    "\"quotes\" & 'more' `${x}`",
    "=cmd()|'/C calc'!A0",
    "+1+1",
    "@SUM(A1)",
    "-2+3;DROP",
    "]]> &amp; <x/>",
    "../../../x",
    "CON",
    "{job}{0.__class__}%s%n$(id)`id`",
    "(unbalanced \\) /JS <</S>> endobj",
    "%%c\\U+0000\\P\\n  0 SECTION",
    "ü漢字é",
    "x" * 80,
)
PAYLOAD = re.compile(rb"<script>alert|<img src=x")
CONTROLS = ("a\n  0\nSECTION\n", "a\r\nb", "a\0b", "a\x1b[31m", "a\u2028b", "a\u202eb", "a\x85b", "a\x7fb", "a\ud800b")
WAYS: tuple[tuple[str | int, ...], ...] = (
    ("job", "name"),
    ("job", "customer"),
    ("material", "name"),
    ("stock", 0, "id"),
    ("part", 0, "name"),
    ("part", 0, "mark", 0, "text"),
)
FORMATS = ["json", "csv", "junit", "html", "traveller"]


def job(name: str, flavour: str) -> dict[str, object]:
    """Return a job that is called so wherever it may be called anything."""
    text = name if name.isascii() else "A"
    outline = {"polyline": [[0, 0], [60, 0], [60, 40], [0, 40], [0, 0]]}
    return {
        "schema": 1,
        "job": {"name": name, "customer": name, "revision": name},
        "material": {"name": name, "thickness": 1},
        "stock": [{"id": name, "width": 200, "height": 100, "quantity": 1}],
        "nest": {"time_limit": 0.05, "gap": 3},
        "dxf": {"flavour": flavour, "also": [] if flavour == "aama" else ["svg", "pdf"]},
        "report": {"formats": FORMATS},
        "part": [{
            "name": name,
            "hole": [{"name": name, "kind": "circle", "at": [20, 20], "diameter": 5}],
            "mark": [{"name": name, "kind": "text", "at": [30, 10], "text": text, "height": 2}],
            "notch": [{"name": name, "edge": "outline", "distance": 10, "kind": "v"}],
            "surface": {"kind": "flat", "outline": outline},
        }],
    }  # fmt: skip


@pytest.fixture(
    scope="module", params=[(name, "lines-arcs") for name in NAMES] + [(NAMES[0], "r12"), (NAMES[12], "aama")]
)
def made(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, dict[str, bytes]]:
    """The name, and all files of the job that has it."""
    name, flavour = request.param
    file = write_job(tmp_path_factory.mktemp("job"), json.dumps(job(name, flavour)), "job.json")
    _, files = outputs(run_job(job_of(read(file))))
    return name, files


class Scripts(HTMLParser):
    """The elements of a page, and what lies in its scripts."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        assert not [key for key, _ in attrs if key.startswith("on")], "no attribute is a script"


def test_names_are_names_in_every_file(made: tuple[str, dict[str, bytes]]) -> None:
    name, files = made
    assert all(re.fullmatch(r"[A-Za-z0-9._/-]+", path) and ".." not in path for path in files)
    assert "report.html" in files
    for path, content in files.items():
        if path.endswith(".html"):
            check_html(content)
        elif path.endswith(".csv"):
            check_csv(content)
        elif path.endswith((".xml", ".svg")):
            check_xml(content, name, path)
        elif path.endswith(".dxf"):
            check_dxf(content)
        elif path.endswith(".pdf"):
            check_pdf(content)
    assert json.loads(files["report.json"])["parts"][0]["name"] == name


def check_html(content: bytes) -> None:
    """Hold a page against one that no name is in: the same elements, but for rows and cells."""
    assert not PAYLOAD.search(content)
    page = Scripts()
    page.feed(content.decode())
    assert "img" not in page.tags
    assert page.tags.count("script") == content.count(b"<script") == content.count(b"</script")


def check_csv(content: bytes) -> None:
    """Every row has as many cells as the head; no cell is a formula."""
    rows = list(csv.reader(StringIO(content.decode("utf-8-sig"))))
    assert len({len(row) for row in rows}) == 1
    for cell in (cell for row in rows for cell in row):
        if cell[:1] and cell[0] in "=+-@\t\r":
            float(cell)


def check_xml(content: bytes, name: str, path: str) -> None:
    """The file is XML without entities of its own and without scripts."""
    root = etree.fromstring(content, etree.XMLParser(resolve_entities=False, no_network=True))
    assert root.getroottree().docinfo.doctype == ""
    assert not [one for one in root.iter() if etree.QName(one).localname in {"script", "x", "img", "foreignObject"}]
    if path == "junit.xml":
        assert name in {suite.get("name") for suite in root.iter("testsuite")}


KINDS = {"LINE", "ARC", "CIRCLE", "LWPOLYLINE", "POLYLINE", "VERTEX", "SEQEND", "TEXT", "INSERT", "POINT"}


def check_dxf(content: bytes) -> None:
    """Every second line is a group code, and there is nothing in the file but what is drawn."""
    lines = content.decode("ascii").split("\n")
    assert all(re.fullmatch(r" *\d+\r?", code) for code in lines[:-1:2])
    document = ezdxf.read(StringIO(content.decode("ascii")))
    spaces = [document.modelspace(), *(block for block in document.blocks if not block.name.startswith("*"))]
    assert {entity.dxftype() for space in spaces for entity in space} <= KINDS
    assert [line.strip() for line in lines[1::2]].count("EOF") == 1


def check_pdf(content: bytes) -> None:
    """No action, no script, no file inside."""
    assert content.startswith(b"%PDF-")
    assert not re.search(rb"/(JS|JavaScript|Launch|OpenAction|AA|EmbeddedFile|URI|SubmitForm)\b(?! <</S>>)", content)


@pytest.mark.parametrize("text", CONTROLS)
@pytest.mark.parametrize("way", WAYS, ids=str)
def test_what_would_end_a_line_or_move_a_terminal_is_refused(
    tmp_path: Path, text: str, way: tuple[str | int, ...]
) -> None:
    table: object = job("plain", "r12")
    inner = table
    for step in way[:-1]:
        inner = inner[step]  # type: ignore[index]
    inner[way[-1]] = text  # type: ignore[index]
    with pytest.raises(BadInputError, match="holds a control character"):
        read(write_job(tmp_path, json.dumps(table), "job.json"))


@pytest.mark.parametrize("text", CONTROLS)
def test_no_label_of_a_drawing_holds_more_than_one_line(text: str) -> None:
    with pytest.raises(ValueError, match="printable ASCII"):
        Label("MARK", text, np.zeros(2), 1.0, 0.0)


@pytest.mark.parametrize("name", [b"a\n  0\nEOF", b"\xff\xfe", b"\x1b[31m", "\u202e".encode()])
def test_a_job_file_called_so_gives_its_job_a_plain_name(tmp_path: Path, name: bytes) -> None:
    file = tmp_path / os.fsdecode(name + b".json")
    file.write_text(json.dumps(job("x", "r12") | {"job": {}, "report": {"formats": ["json", "csv"]}}), "utf-8")
    made = job_of(read(file))
    assert made.name.isprintable()
    assert all(said.isprintable() for said, _ in made.inputs)
    outputs(run_job(made))


def test_messages_do_not_move_the_terminal(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["check", str(write_job(tmp_path, '{"\\u001b[31m": 1, "schema": "\\u001b[2J"}', "\x1b[1m.json"))])
    assert "\x1b" not in capsys.readouterr().err
    assert (plain("a\x1b\u202eb"), plain_lines("a\nb\r")) == ("a??b", "a\nb?")


def test_names_of_pieces_in_other_files_are_held_to_the_same(tmp_path: Path) -> None:
    square = {"type": "simple_polygon", "data": [[0, 0], [90, 0], [90, 90], [0, 90]]}
    for name in ("a\n  0\nEOF", "x" * 300, "\ud800"):
        (tmp_path / "s.json").write_text(json.dumps({"bins": [{"id": name, "shape": square}]}), "utf-8")
        table = job("x", "r12") | {"stock": [{"file": "s.json"}]}
        with pytest.raises(BadInputError, match="is no name of a piece"):
            read(write_job(tmp_path, json.dumps(table), "job.json"))
