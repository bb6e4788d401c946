"""What a cut file is held to, measured in the file itself, in every flavour and version.

Distances to the exact development by polygons (a second method beside the one whose figures are reported); arcs, smooth
joins, closed contours and extents from the entities as the library reads them.
"""

from dataclasses import replace
from functools import cache
from math import degrees

import numpy as np
import pytest
from ezdxf import bbox
from shapely import LineString, dwithin, points, prepare

from stages.geometry.arrays import Points2
from stages.geometry.curves.plane import PlaneCurve
from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, joint_turns, lengths, piece_count
from stages.geometry.paths.biarc import LEAST_PIECE_MM
from stages.model.cutfile import Side
from stages.model.pattern import FlatPattern
from stages.model.sheet import Nesting, Placement, Sheet, SheetLayout
from stages.write import write
from stages.write.chains import Entity
from stages.write.readback import read
from tests.near import assert_near
from tests.stages.geometry.plane_curves import CONE, ELLIPSE, stroked
from tests.stages.write.cases import Case, document, machine
from tests.stages.write.patterns import CHORD_MM, contour, drop, pattern, plate, polygon_edges, sector, strip

SMOOTH_DEG = 0.2
EXTENT_MM = 0.01
FEW: list[Case] = [
    ("polyline-arcs", "R2000"), ("lines-arcs", "R2000"), ("lines-arcs", "R12"), ("polylines", "R2000"), ("r12", "R12")
]  # fmt: skip
"""Each flavour once, lines and arcs as R12 too: other versions hold the same entities."""

ARCS = [case for case in FEW if case[0] != "polylines"]
SIDES: list[Side] = ["either", "outside"]


def ellipse() -> FlatPattern:
    return pattern("ellipse", contour([ELLIPSE]), (0.0, 0.0))


def cone() -> FlatPattern:
    ends = CONE.at(np.array([0.0, 1.0]))
    start, end = tuple(ends[0].tolist()), tuple(ends[1].tolist())
    return pattern("cone", contour([CONE, *polygon_edges(end, (0.0, 0.0), start)[:2]]), (100.0, 100.0))


def parts(case: Case) -> list[FlatPattern]:
    """Return the parts that are written, fewer where they take hundreds of chords."""
    some = [plate(), sector(), strip()]
    return some if case[0] == "polylines" else [*some, drop(), ellipse(), cone()]


@cache
def texts(case: Case, side: Side) -> dict[str, str]:
    """Return the text of the file of each part."""
    outcome = write(parts(case), None, replace(machine(case), side=side))
    assert outcome.report.passed, outcome.report.findings
    return {part.part: file.text for part, file in zip(parts(case), outcome.product, strict=True)}


@cache
def written(case: Case, side: Side) -> dict[str, tuple[Entity, ...]]:
    """Return the paths of the file of each part."""
    return {name: read(text).entities for name, text in texts(case, side).items()}


def outline(case: Case, part: FlatPattern, side: Side = "either") -> ArcPath:
    path = next(one.path for one in written(case, side)[part.part] if one.layer == "CUT_OUTER")
    assert path is not None
    return path


@pytest.mark.parametrize("case", ARCS)
@pytest.mark.parametrize(("part", "lines", "goal"), [(strip(), 3, 26), (ellipse(), 0, 38), (cone(), 2, 24)])
def test_developments_take_few_arcs_at_two_hundredths(case: Case, part: FlatPattern, lines: int, goal: int) -> None:
    path = outline(case, part)
    assert np.count_nonzero(path.bulges == 0.0) == lines
    assert piece_count(path) - lines <= goal


@pytest.mark.parametrize("case", ARCS)
@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize(("part", "corners"), [(strip(), 4), (ellipse(), 0), (cone(), 3), (drop(), 0), (sector(), 4)])
def test_arcs_of_one_curve_join_smoothly(case: Case, side: Side, part: FlatPattern, corners: int) -> None:
    turns = np.sort(np.abs(joint_turns(outline(case, part, side))))
    assert np.count_nonzero(turns > np.radians(20.0)) == corners
    assert degrees(turns[: turns.size - corners].max(initial=0.0)) <= SMOOTH_DEG


def dense(edges: tuple[PlaneCurve, ...]) -> Points2:
    return np.concatenate([edge.at(np.linspace(0.0, 1.0, 1501))[:-1] for edge in edges])


def line(corners: Points2) -> LineString:
    made = LineString(np.vstack([corners, corners[:1]]))
    prepare(made)
    return made


@pytest.mark.parametrize("case", FEW)
@pytest.mark.parametrize("side", SIDES)
def test_every_contour_is_within_the_tolerance_both_ways(case: Case, side: Side) -> None:
    for part in parts(case)[2:]:
        path = outline(case, part, side)
        drawn = stroked(path, 40) if path.bulges.any() else path.vertices
        exact = dense(part.outer.edges)
        # an arc of 30 mm about 100 mm in 40 chords is 7e-4 mm off them, and so is what is exact off its points
        assert dwithin(points(drawn), line(exact), CHORD_MM + 1e-3).all()
        assert dwithin(points(exact), line(drawn), CHORD_MM + 1e-3).all()


@pytest.mark.parametrize("case", FEW)
@pytest.mark.parametrize("side", SIDES)
def test_contours_are_closed_once_without_a_short_piece_or_a_wide_arc(case: Case, side: Side) -> None:
    for entities in written(case, side).values():
        cut = [one for one in entities if one.layer.startswith("CUT_")]
        assert all(one.closed for one in cut)
        for one in cut:
            assert one.path is not None
            assert lengths(one.path).min() >= LEAST_PIECE_MM
            assert np.abs(one.path.bulges).max() <= 1.0


@pytest.mark.parametrize("case", [case for case in FEW if case[0] != "lines-arcs"])
def test_a_contour_is_one_entity(case: Case) -> None:
    for part in parts(case):
        outer = [one for one in written(case, "either")[part.part] if one.layer == "CUT_OUTER"]
        assert [one.count for one in outer] == [1]


@pytest.mark.parametrize("case", FEW)
@pytest.mark.parametrize("side", SIDES)
def test_extents_are_the_box_that_the_library_finds_by_itself(case: Case, side: Side) -> None:
    for text in texts(case, side).values():
        drawing = document(text)
        assert drawing.audit().errors == []
        box = bbox.extents([one for one in drawing.modelspace() if one.dxftype() != "TEXT"], fast=False)
        for name, corner in (("$EXTMIN", box.extmin), ("$EXTMAX", box.extmax)):
            found = np.array(drawing.header[name])[:2]
            assert_near(found, [corner.x, corner.y], bound=EXTENT_MM, why="the library flattens arcs within 0.01")


@pytest.mark.parametrize("case", FEW)
@pytest.mark.parametrize("mirrored", [False, True])
def test_a_nested_copy_has_the_pieces_of_the_part_and_all_that_is_on_it(case: Case, mirrored: bool) -> None:
    placed = (Placement("plate", 1, Rigid2(200.0, 150.0, 77.0, mirrored)), Placement("sector", 1, Rigid2(700.0, 300.0)))
    nest = Nesting((SheetLayout(Sheet("stock", 1000.0, 600.0), 1, placed, 0.1),))
    *flat, sheet = write([plate(), sector()], nest, machine(case)).product
    alone = [one for file in flat for one in read(file.text).entities]
    together = [one for one in read(sheet.text).entities if one.layer != "SHEET"]
    assert sorted(map(_kind, together)) == sorted(map(_kind, alone))


def _kind(one: Entity) -> tuple[str, str, int, int]:
    """Return what does not change with the place: layer, kind, how many pieces, how many of them arcs."""
    if one.path is None:
        return one.layer, one.kind, 0, 0
    return one.layer, one.kind, piece_count(one.path), int(np.count_nonzero(one.path.bulges))


@pytest.mark.parametrize("case", FEW)
@pytest.mark.parametrize("side", SIDES)
def test_lines_and_arcs_are_the_edges_one_to_one(case: Case, side: Side) -> None:
    if case[0] == "polylines":
        assert piece_count(outline(case, plate(), side)) == 4
        return
    for part, pieces in ((plate(), 4), (sector(), 6)):
        # the outer arcs of the sector turn by 120 degrees: two pieces of at most 90 each
        assert piece_count(outline(case, part, side)) == pieces
