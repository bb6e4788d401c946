"""The panels of samples/upper: the files are those of the formulas, and the flat figures those of closed forms."""

import numpy as np
import pytest

from pipeline.run import JobResult
from samples.upper.panels import HALF_ANGLE, RADIUS, files
from stages.model.cutfile import Flavour, Machine, Version
from stages.write import write
from stages.write.flavours import as_cut
from tests.bench.written import apart
from tests.near import assert_near
from tests.samples import SAMPLES, SHORT_SEARCH, figure, result_of, run, stage, told


@pytest.fixture(scope="module")
def made() -> JobResult:
    return result_of("upper/job.toml", SHORT_SEARCH)


@pytest.fixture(scope="module")
def upper(made: JobResult) -> dict[str, dict]:
    report, code, written = told(made)
    assert (code, report["status"]) == (0, "made"), report
    assert any(file.startswith("cut/") for file in written)
    return {part["name"]: part for part in report["parts"]}


@pytest.mark.parametrize("name", ["toe.stl", "seat.stl"])
def test_the_meshes_are_those_of_the_formulas(name: str) -> None:
    """The order of the triangles is that of whichever Delaunay triangulation is installed."""
    made, kept = (content[84:] for content in (files()[name], _kept(name)))
    corners = (np.unique(np.frombuffer(rows, dtype=ROW)["corners"].reshape(-1, 3), axis=0) for rows in (made, kept))
    one, other = corners
    assert_near(one.astype(float), other.astype(float), bound=1e-4, why="float32 of 300 mm")


ROW = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])


def _kept(name: str) -> bytes:
    return (SAMPLES / "upper" / name).read_bytes()


def test_the_rim_of_the_toe_keeps_its_length_and_the_dart_closes(upper: dict[str, dict]) -> None:
    toe = upper["toe"]
    assert figure(toe, "unroll", "kept_length_error")["value"] <= 1e-12
    rim = 2.0 * np.pi * RADIUS * np.sin(HALF_ANGLE)
    kept = figure(toe, "construct", "kept_mm")["value"]
    assert_near(kept, rim, bound=rim * (2.0 * np.pi / 132.0) ** 2 / 24.0 * 1.1, why="132 chords of a circle")
    legs = toe["flat"]["outline_length"] - rim
    assert_near(legs / 2.0, RADIUS * HALF_ANGLE, bound=0.03 * RADIUS * HALF_ANGLE, why="within the strain of leather")
    assert figure(toe, "unroll", "seam_difference_mm")["value"] <= 0.05


def test_leather_takes_both_and_the_report_says_where_it_is_stretched(upper: dict[str, dict]) -> None:
    for part in upper.values():
        assert part["class"] == "leather"
        strain = figure(part, "verify", "max_strain")
        assert strain["value"] <= strain["limit"] == 0.03
        field = stage(part, "unroll")["detail"]["strain_field"]
        assert 100 <= len(field["x"]) <= 2000
        assert {len(column) for column in field.values()} == {len(field["x"])}


def test_the_seat_is_square_and_strained_alike_in_both_halves(upper: dict[str, dict]) -> None:
    """z = (x^2 - y^2) / 1000: what exchanges x and y turns it over, and nothing of lengths changes."""
    flat = upper["seat"]["flat"]
    assert_near(flat["width"], flat["height"], bound=0.05, why="irregular triangles of 9 mm")
    side = np.linspace(-150.0, 150.0, 2001)
    x, y = np.meshgrid(side, side)
    element = np.sqrt(1.0 + (2.0 * x / 1000.0) ** 2 + (2.0 * y / 1000.0) ** 2)
    area = float(np.trapezoid(np.trapezoid(element, side, axis=1), side))
    assert_near(upper["seat"]["surface"]["area"], area, bound=1e-5 * area, why="edges on the fitted surface")


@pytest.mark.parametrize("flavour", ["polyline-arcs", "lines-arcs", "polylines", "r12"])
def test_outlines_that_may_not_lie_inside_are_near_the_exact_ones_in_every_flavour(
    made: JobResult, flavour: Flavour
) -> None:
    """The rim of the toe is refitted through a mesh's vertices: its corners at the dart are sharp."""
    version: Version = "R12" if flavour == "r12" else "R2000"
    machine = Machine(flavour=flavour, version=version, side="outside")
    patterns = [as_cut(run.pattern, machine) for run in made.parts if run.pattern is not None]
    outcome = write(patterns, None, machine)
    assert outcome.report.passed, outcome.report.findings
    found = {metric.name: metric for metric in outcome.report.metrics}
    assert found["inside_mm"].passed
    assert found["max_deviation_mm"].passed
    for pattern, file in zip(patterns, outcome.product, strict=True):
        distance = apart(file.text, machine.layers, pattern)
        assert distance.distance_mm <= distance.tolerance_mm, distance


def test_sheet_metal_is_refused(upper: dict[str, dict]) -> None:
    assert upper
    report, code, _ = run("upper/job.toml", "tolerance.accept='metal'")
    assert (code, report["status"]) == (1, "rejected")
