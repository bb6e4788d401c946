"""The certifier on contours as read: in any order, either sense; what is missing, moved or too much is found."""

from collections.abc import Sequence

import numpy as np
import pytest

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, area, backwards, bounds, length, split, transform
from stages.model.pattern import Contour
from stages.model.report import Metric
from stages.model.sheet import NestOptions, Placement, Sheet, SheetLayout, Zone
from stages.nest.legal.certify import measured
from stages.nest.legal.files import ReadSheet, certify_contours
from stages.nest.legal.laid import lay, spread
from tests.stages.nest.shapes import angle_piece, box, contour, disc, pattern, rectangle, ring

ZONE = Zone(contour(box(50.0, 50.0, 240.0, 140.0)).path, 1)
SHEET = Sheet("s", 300.0, 200.0, 1, edge_gap_mm=10.0, zones=(ZONE,))
OPTIONS = NestOptions(gap_mm=5.0)
PARTS = (ring("r", 60.0, 40.0), disc("d", 30.0), rectangle("a", 60.0, 40.0, quantity=2))
PLACED = (
    Placement("r", 1, Rigid2(80.0, 80.0, 20.0)),
    Placement("d", 1, Rigid2(80.0, 82.0)),
    Placement("a", 1, Rigid2(150.0, 20.0)),
    Placement("a", 2, Rigid2(150.0, 70.0)),
)
LAYOUT = SheetLayout(SHEET, 1, PLACED, 0.0)


def drawn(moved: dict[int, Rigid2] | None = None) -> tuple[list[ArcPath], list[ArcPath]]:
    """Return the outer and inner contours as a file might hold them, some copies moved from their place."""
    by_name = {part.part: part for part in PARTS}
    regions = [lay(by_name[one.part], one).region for one in PLACED]
    paths = [
        [transform(path, (moved or {}).get(i, Rigid2())) for path in one.contours] for i, one in enumerate(regions)
    ]
    return [some[0] for some in paths], [path for some in paths for path in some[1:]]


def judged(outer: Sequence[ArcPath], inner: Sequence[ArcPath]) -> tuple[list[str], dict[str, Metric]]:
    metrics, findings = certify_contours([ReadSheet(LAYOUT, outer, inner)], PARTS, OPTIONS)
    assert all(finding.fatal for finding in findings)
    return [finding.code for finding in findings], {metric.name: metric for metric in metrics}


def test_contours_as_they_were_placed_give_the_figures_of_the_nest() -> None:
    codes, metrics = judged(*drawn())
    assert codes == []
    placed, _ = measured(
        [spread(LAYOUT, [lay(part, one) for one in PLACED for part in PARTS if part.part == one.part])], OPTIONS
    )
    assert {name: metric.value for name, metric in metrics.items()} == {metric.name: metric.value for metric in placed}
    assert set(metrics) == {"min_gap_mm", "min_edge_gap_mm", "overlap_mm2", "zone_overlap_mm2"}


def test_neither_the_order_nor_the_sense_nor_the_cutting_of_arcs_matters() -> None:
    outer, inner = drawn()
    assert judged([backwards(path) for path in outer[::-1]], [split(path, max_bulge=0.2) for path in inner])[0] == []


SQUARE = contour(box(60.0, 60.0, 50.0, 52.0)).path
"""It has the box of the disc."""

FAULTS = {
    "an outline that is not there": lambda outer, inner: (outer[:-1], inner),
    "a hole that is not there": lambda outer, _: (outer, []),
    "one outline too many": lambda outer, inner: ([*outer, outer[0]], inner),
    "one hole too many": lambda outer, inner: (outer, [*inner, *inner]),
    "a copy twice and another not": lambda outer, inner: ([*outer[:3], outer[2]], inner),
    "an outline elsewhere": lambda *_: drawn({2: Rigid2(1.0, 0.0)}),
    "an outline of the same box": lambda outer, inner: (
        [outer[0], contour(box(60.0, 60.0, 50.0, 52.0)).path, *outer[2:]],
        inner,
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_file_that_does_not_hold_the_copies_is_found(name: str) -> None:
    codes, metrics = judged(*FAULTS[name](*drawn()))
    assert set(codes) == {"file-copies"}
    assert metrics == {}


def test_what_is_off_by_less_than_a_copy_is_told_by_is_measured_all_the_same() -> None:
    """The disc touches the limits of its gap in the ring: 9.99 um are not looked over."""
    layout = SheetLayout(SHEET, 1, (PLACED[2], Placement("a", 2, Rigid2(150.0, 65.0))), 0.0)
    part = PARTS[2]
    paths = [lay(part, one).region.contours[0] for one in layout.placements]
    shifted = [paths[0], transform(paths[1], Rigid2(0.0, -9e-6))]
    for outer, wanted in ((paths, []), (shifted, ["gap"])):
        _, findings = certify_contours([ReadSheet(layout, outer, [])], [part], OPTIONS)
        assert [finding.code for finding in findings] == wanted


def test_the_rules_of_the_sheet_hold_for_contours_read() -> None:
    far = SheetLayout(SHEET, 1, (Placement("d", 1, Rigid2(240.0, 150.0)),), 0.0)
    path = transform(PARTS[1].outer.path, Rigid2(240.0, 150.0))
    _, findings = certify_contours([ReadSheet(far, [path], [])], [PARTS[1]], OPTIONS)
    assert [finding.code for finding in findings] == ["zone"]
    near = SheetLayout(SHEET, 1, (Placement("d", 1, Rigid2(39.0, 150.0)),), 0.0)
    path = transform(PARTS[1].outer.path, Rigid2(39.0, 150.0))
    _, findings = certify_contours([ReadSheet(near, [path], [])], [PARTS[1]], OPTIONS)
    assert [finding.code for finding in findings] == ["edge-gap"]
    assert certify_contours([], PARTS, OPTIONS)[1] == ()


STEPPED = pattern("z", contour([(0, 0), (40, 0), (40, 20), (60, 20), (60, 40), (20, 40), (20, 20), (0, 20)]))
"""Its mirror image has the same box, area and middle."""
HOLLOW = pattern("c", contour(box(60.0, 40.0), [0.0, -0.3, 0.0, 0.0]))
"""Turned by half a turn it has the same corners too: only its arc lies on the other side."""
HALF = pattern("h", contour([(0.0, 0.0), (60.0, 0.0), (0.0, 40.0)]), quantity=2)
OTHER_WAYS = {
    "mirrored": (STEPPED, Rigid2(60.0, mirrored=True)),
    "turned": (angle_piece("l", 60.0, 20.0), Rigid2(60.0, 60.0, 180.0)),
    "turned about the same corners": (HOLLOW, Rigid2(60.0, 40.0, 180.0)),
}


@pytest.mark.parametrize("name", OTHER_WAYS)
def test_a_part_that_lies_another_way_in_its_box_is_found(name: str) -> None:
    part, way = OTHER_WAYS[name]
    placed = Placement(part.part, 1, Rigid2(100.0, 50.0, 90.0))
    layout = SheetLayout(SHEET.replace(zones=()), 1, (placed,), 0.0)
    right = transform(part.outer.path, placed.motion)
    wrong = transform(transform(part.outer.path, way), placed.motion)
    assert bounds(wrong) == pytest.approx(bounds(right), abs=1e-9)
    assert area(wrong) == pytest.approx(area(right), abs=1e-9)
    for path, wanted in ((right, []), (wrong, ["file-copies"])):
        _, findings = certify_contours([ReadSheet(layout, [path], [])], [part], OPTIONS)
        assert [finding.code for finding in findings] == wanted


def test_two_parts_that_share_a_box_are_told_apart() -> None:
    placed = (Placement("h", 1, Rigid2(100.0, 50.0)), Placement("h", 2, Rigid2(160.0, 90.0, 180.0)))
    layout = SheetLayout(Sheet("s", 300.0, 200.0, 1), 1, placed, 0.0)
    paths = [transform(HALF.outer.path, one.motion) for one in placed]
    assert bounds(paths[0]) == pytest.approx(bounds(paths[1]), abs=1e-9)
    for outer in (paths, paths[::-1]):
        metrics, findings = certify_contours([ReadSheet(layout, outer, [])], [HALF], NestOptions())
        assert findings == ()
        assert metrics[0].value == pytest.approx(0.0, abs=1e-12)
    _, findings = certify_contours([ReadSheet(layout, [paths[0]] * 2, [])], [HALF], NestOptions())
    assert {finding.code for finding in findings} == {"file-copies"}


def test_a_contour_of_many_vertices_that_were_all_moved_on_is_known_again() -> None:
    """No vertex of the one lies at one of the other, so that every one is measured."""
    count = 1000
    angle = 2.0 * np.pi * np.arange(count) / count
    bulge = np.full(count, np.tan(np.pi / 2.0 / count))
    paths = [
        ArcPath(150.0 + 40.0 * np.stack([np.cos(angle + by), np.sin(angle + by)], axis=1), bulge, closed=True)
        for by in (0.0, 0.25 * angle[1])
    ]
    part = pattern("disc", Contour((), paths[0], 0.0))
    layout = SheetLayout(Sheet("s", 300.0, 300.0, 1), 1, (Placement("disc", 1, Rigid2()),), 0.0)
    assert certify_contours([ReadSheet(layout, [paths[1]], [])], [part], NestOptions())[1] == ()
    flat = np.isin(np.arange(count), np.arange(120, 129))
    dented = ArcPath(paths[1].vertices, np.where(flat, 0.0, bulge), closed=True)
    assert bounds(dented) == pytest.approx(bounds(paths[0]), abs=1e-6)
    assert abs(area(dented) - area(paths[0])) < 1e-5 * length(paths[0]), "their areas agree"
    assert certify_contours([ReadSheet(layout, [dented], [])], [part], NestOptions())[1] != ()
