"""Texts as strokes that reach over a contour are cut off there, and told of, instead of failing the job."""

import numpy as np
import pytest
from shapely import LineString, Polygon

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, length, polygon
from stages.model.cutfile import Machine
from stages.model.pattern import FlatPattern, Text
from stages.model.sheet import Nesting, Placement, Sheet, SheetLayout
from stages.write import write
from stages.write.onpart import POLYGON_MM, on_part, region_of
from stages.write.readback import read
from tests.near import assert_near
from tests.stages.write.cases import CASES
from tests.stages.write.patterns import contour, pattern, plate, polygon_edges

STROKES = Machine(text="strokes")


def lettered(x: float, y: float, text: str = "TOP 7", angle_deg: float = 0.0) -> FlatPattern:
    """Return the plate, 100 x 60 with holes of radius 10 about (50, 40) and 4 about (80, 20), with a text."""
    return plate().replace(texts=(Text("mark-1", text, np.array([x, y]), 8.0, angle_deg),))


def square(low: float, high: float) -> ArcPath:
    corners = np.array([[low, low], [high, low], [high, high], [low, high]])
    return ArcPath(corners, np.zeros(4), closed=True)


def line(*points: tuple[float, float], closed: bool = False) -> ArcPath:
    return ArcPath(np.array(points), np.zeros(len(points)), closed)


def test_strokes_are_cut_at_the_outline_and_at_holes() -> None:
    region = region_of([square(0.0, 10.0), square(4.0, 6.0)])
    (kept,) = on_part([line((1.0, 1.0), (9.0, 1.0))], region)
    assert_near(kept.vertices, [[1.0, 1.0], [9.0, 1.0]], bound=0.0, why="it lies on the part")
    parts = on_part([line((1.0, 5.0), (13.0, 5.0))], region)
    found = sorted(part.vertices[:, 0].tolist() for part in parts)
    assert_near(np.array(found), [[1.0, 4.0], [6.0, 10.0]], bound=1e-12, why="closed form")
    assert on_part([line((11.0, 5.0), (13.0, 5.0))], region) == []
    assert on_part([line((9.98, 5.0), (13.0, 5.0))], region) == []


def test_a_closed_stroke_that_is_cut_is_open() -> None:
    ring = line((8.0, 8.0), (12.0, 8.0), (12.0, 9.0), (8.0, 9.0), closed=True)
    parts = on_part([ring], region_of([square(0.0, 10.0)]))
    assert not any(part.closed for part in parts)
    assert_near(sum(map(length, parts)), 5.0, bound=1e-12, why="two sides of 2, one of 1")


def test_a_text_on_the_part_is_neither_cut_nor_told_of() -> None:
    outcome = write([lettered(45.0, 12.0)], None, STROKES)
    assert outcome.report.passed
    assert outcome.report.findings == ()


@pytest.mark.parametrize(
    ("x", "y", "words"),
    [
        (95.0, 30.0, "cut off"),
        (50.0, 52.0, "cut off"),
        (20.0, 59.0, "cut off"),
        (150.0, 30.0, "does not lie on the part"),
    ],
)
def test_a_text_over_a_contour_is_told_of_with_place_and_remedy_and_stops_nothing(
    x: float, y: float, words: str
) -> None:
    outcome = write([lettered(x, y)], None, STROKES)
    assert outcome.report.passed, outcome.report.findings
    (finding,) = outcome.report.findings
    assert (finding.code, finding.fatal) == ("text-clipped", False)
    assert (finding.where["part"], finding.where["feature"], finding.where["x"], finding.where["y"]) == (
        "plate", "mark-1", x, y
    )  # fmt: skip
    assert words in finding.message
    assert "smaller height" in finding.message


@pytest.mark.parametrize("case", CASES)
def test_what_is_engraved_lies_on_the_part_in_every_flavour(case) -> None:
    how = Machine(flavour=case[0], version=case[1], text="strokes")
    outcome = write([lettered(50.0, 52.0, angle_deg=30.0)], None, how)
    assert outcome.report.passed, outcome.report.findings
    entities = read(outcome.product[0].text).entities
    holes = [Polygon(polygon(one.path, accuracy=1e-3)) for one in entities if one.layer == "CUT_INNER" and one.path]
    for one in entities:
        if one.layer == "ENGRAVE" and one.path is not None:
            drawn = LineString(one.path.vertices)
            # both are polygons of the hole
            assert all(drawn.intersection(hole).length <= 2.0 * (2.0 * 10.0 * POLYGON_MM) ** 0.5 for hole in holes)
            assert drawn.within(Polygon([(0, 0), (100, 0), (100, 60), (0, 60)]).buffer(1e-9))


def test_a_mirrored_copy_may_lose_letters_that_the_part_as_drawn_keeps() -> None:
    """A J leaves room for a leaning edge; on a mirrored copy the last letter is there, and a T is wide above."""
    leaning = contour(polygon_edges((6.0, 0.0), (100.0, 0.0), (100.0, 60.0), (24.0, 60.0)))
    part = pattern("plate", leaning, (60.0, 30.0)).replace(texts=lettered(13.5, 5.0, "JT").texts)
    placed = (Placement("plate", 1, Rigid2(300.0, 100.0, mirrored=True)),)
    flat = write([part], None, STROKES).report
    nest = write([part], Nesting((SheetLayout(Sheet("s", 600.0, 400.0), 1, placed, 0.1),)), STROKES).report
    assert flat.passed
    assert flat.findings == ()
    assert nest.passed
    assert [finding.code for finding in nest.findings] == ["text-clipped"]
