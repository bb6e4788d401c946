"""Two finished jobs of the sewn bag nested together by the command: what is cut is every piece with all that it had."""

import json
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pipeline.cli import main
from pipeline.job import job_of
from pipeline.jobfile import read as read_job
from pipeline.outputs import outputs
from pipeline.run import run_job
from pipeline.store import write_files
from stages.geometry.curves import contours
from stages.geometry.paths.arcpath import area
from stages.model.pattern import FlatPattern
from stages.write.chains import Entity
from stages.write.readback import read
from tests.near import assert_near, assert_relative
from tests.samples import SAMPLES

JOBS = ("first", "second")
NAMES = {"first": "sewn bag", "second": "sewn bag-2"}
"""What the pool calls two jobs of one name."""
STOCK = """\
schema = 1
[nest]
gap = 3
time_limit = 0.1
[report]
formats = ["json"]
[[stock]]
id = "hide"
width = 2400
height = 1400
grain = 0
edge_gap = 10
"""


COARSE = (
    "part[0].stitch[0].pitch=16",
    *(f"part[0].stitch[{i}].{key}" for i in (1, 2) for key in ("pitch=16", "pitch_range=[14, 18]")),
    "part[1].stitch[0].pitch=16",
    "part[2].stitch[0].pitch=16",
)
"""A quarter of the stitches of the sample: what is asked of each is the same, and each takes its time."""


class Pooled:
    """What the command left: the report, the side file and the entities of the one sheet; and the parts as made."""

    def __init__(self, folder: Path, patterns: dict[str, FlatPattern]) -> None:
        """Read the output folder of the pool."""
        self.patterns = patterns
        self.report = json.loads((folder / "report.json").read_bytes())
        (self.group,) = self.report["groups"]
        (drawing,) = folder.glob("*/cut/*.dxf")
        self.side = json.loads(drawing.with_suffix(".json").read_bytes())
        self.entities: tuple[Entity, ...] = read(drawing.read_text("ascii")).entities

    def copies(self) -> Iterator[tuple[str, FlatPattern, int]]:
        """Yield every piece: its pooled name, its pattern and which copy it is."""
        for job in JOBS:
            for part, pattern in self.patterns.items():
                yield from ((f"{NAMES[job]}/{part}", pattern, copy + 1) for copy in range(pattern.quantity))

    def contours(self, part: str, copy: int) -> list[dict]:
        return [row for row in self.side["contours"] if (row["part"], row["copy"]) == (part, copy)]

    def on(self, layer: str) -> int:
        return sum(entity.layer == layer for entity in self.entities)


@pytest.fixture(scope="module")
def pooled(tmp_path_factory: pytest.TempPathFactory) -> Pooled:
    """Return what becomes of two finished jobs."""
    below = tmp_path_factory.mktemp("bags")
    job = replace(job_of(read_job(SAMPLES / "bag" / "sewn.toml", ["report.formats=['json']", *COARSE])), stock=())
    result = run_job(job)
    for name in JOBS:
        write_files(below / name, outputs(result)[1])
    (below / "stock.toml").write_text(STOCK, "utf-8")
    words = ["nest", *(str(below / name) for name in JOBS), "-o", str(below / "both")]
    with pytest.raises(SystemExit) as ended:
        main([*words, "--stock", str(below / "stock.toml"), "--quiet"])
    assert not ended.value.code
    return Pooled(below / "both", {run.part.name: run.pattern for run in result.parts if run.pattern is not None})


def test_every_piece_of_both_jobs_is_on_the_sheet_and_traced_to_its_order(pooled: Pooled) -> None:
    (sheet,) = pooled.group["nest"]["sheets"]
    orders = {(one["part"], one["copy"]): one["order"] for one in sheet["placements"]}
    wanted = {(name, copy): name for name, _, copy in pooled.copies()}
    assert orders.keys() == wanted.keys()
    for (name, copy), order in orders.items():
        job, _, part = name.partition("/")
        assert (order["job"], order["part"], order["copy"]) == (job, part, copy)
    assert [job["name"] for job in pooled.report["jobs"]] == [*NAMES.values()]
    assert [job["job"] for job in pooled.report["jobs"]] == ["sewn bag"] * len(JOBS)


def test_every_hole_of_every_piece_is_cut_for_its_purpose(pooled: Pooled) -> None:
    stitched = 0
    for name, pattern, copy in pooled.copies():
        rows = pooled.contours(name, copy)
        found = sorted((row["name"], row["purpose"]) for row in rows if row["layer"] == "CUT_INNER")
        assert found == sorted((hole.name, hole.purpose) for hole in pattern.inner), name
        for row in rows:
            if row["purpose"] == "stitch":
                stitched += 1
                assert_near(row["circle"][2], 1.0, bound=1e-9, why="the diameter of the job")
    holes = sum(hole.purpose == "stitch" for _, pattern, _ in pooled.copies() for hole in pattern.inner)
    assert stitched == holes >= 2 * 230, "rows on all sides of the seams of a bag"


def test_every_outline_is_cut_with_its_notches(pooled: Pooled) -> None:
    """A notch in the outline takes its own area from what the outline enclosed before."""
    for name, pattern, copy in pooled.copies():
        (outer,) = [row for row in pooled.contours(name, copy) if row["contour"] == 0]
        assert_relative(outer["area_mm2"], area(pattern.outer.path), bound=1e-9, why="decimals of two drawings")
        if pattern.boundary is not None:
            assert outer["area_mm2"] < area(pattern.boundary.path) - 1.0
    notched = [pattern for _, pattern, _ in pooled.copies() if any(one.in_outline for one in pattern.notches)]
    assert len(notched) >= 2 * (2 + 1), "bodies and base of each bag"


def test_marks_of_every_piece_are_drawn(pooled: Pooled) -> None:
    wanted = Counter(mark.layer for _, pattern, _ in pooled.copies() for mark in pattern.marks)
    assert wanted["SEW"] > 0
    assert {layer: pooled.on(layer) for layer in wanted} == dict(wanted)


def test_every_piece_says_whose_it_is(pooled: Pooled) -> None:
    said = Counter(entity.writing.text for entity in pooled.entities if entity.writing is not None)
    drawn = {(one["part"], one["drawn_as"]) for one in pooled.side["placements"]}
    assert said == Counter(dict(drawn)[name] for name, _, _ in pooled.copies())
    assert len({label for _, label in drawn}) == len(drawn), "no two parts go by one label"


def test_what_is_cut_is_where_the_report_says(pooled: Pooled) -> None:
    places = {(one["part"], one["copy"]): np.array(one["matrix"]) for one in pooled.side["placements"]}
    for name, pattern, copy in pooled.copies():
        matrix = places[name, copy]
        holes = {hole.name: hole for hole in pattern.inner}
        for row in pooled.contours(name, copy):
            if row["circle"] is not None:
                _, x, y = contours.area_and_centroid(holes[row["name"]].edges)
                there = matrix[:, :2] @ np.array([x, y]) + matrix[:, 2]
                assert_near(row["circle"][:2], there, bound=1e-7, why="placements and decimals")
