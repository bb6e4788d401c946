"""Pictures of nested sheets: copies where they lie, holes white, many of them in time."""

import time
from dataclasses import replace

import pytest

from pipeline.report.pictures.part import sheet_picture
from pipeline.report.pictures.sheet import FILLS, FREE_FILL
from stages.geometry.curves.rigid import Rigid2
from stages.model.pattern import FlatPattern
from stages.model.sheet import Placement, Rectangle, Sheet, SheetLayout
from tests.pipeline.report.pictures.test_part import FRUSTUM, PLATE, count, made, pixels


def many(pattern: FlatPattern, copies: int) -> SheetLayout:
    motions = [Rigid2(400.0 * (i % 20), 500.0 * (i // 20), 7.0 * i, i % 3 == 0) for i in range(copies)]
    placed = tuple(Placement(pattern.part, i + 1, motion) for i, motion in enumerate(motions))
    return SheetLayout(Sheet("coil", 8200.0, 6000.0, edge_gap_mm=10.0), 1, placed, 0.4)


def test_two_hundred_copies_on_one_sheet_are_drawn_in_time_and_alike() -> None:
    _, pattern = made(PLATE)
    layout = many(pattern, 200)
    first = sheet_picture(layout, {"part": pattern})
    start = time.process_time()
    assert sheet_picture(layout, {"part": pattern}) == first
    assert time.process_time() - start < 10.0
    assert count(first, FILLS[0]) > 10_000


def test_a_moved_part_and_a_mirrored_one_are_seen_on_the_sheet() -> None:
    _, pattern = made(FRUSTUM)
    pictures = [
        sheet_picture(SheetLayout(Sheet("s", 400.0, 300.0), 1, (Placement("part", 1, motion),), 0.1), {"part": pattern})
        for motion in (Rigid2(150.0, 100.0), Rigid2(151.0, 100.0), Rigid2(150.0, 100.0, 0.0, mirrored=True))
    ]
    assert len(set(pictures)) == 3


def test_holes_stay_white_on_the_sheet() -> None:
    _, pattern = made(PLATE)
    layout = SheetLayout(Sheet("s", 320.0, 220.0), 1, (Placement("part", 1, Rigid2(10.0, 10.0)),), 0.8)
    whole = pattern.replace(inner=())
    with_hole, without = (count(sheet_picture(layout, {"part": one}), FILLS[0]) for one in (pattern, whole))
    assert with_hole < 0.95 * without


@pytest.mark.parametrize("size", [(1.0, 1.0), (10000.0, 100.0), (100.0, 10000.0)])
def test_a_sheet_of_any_size_is_drawn_even_without_parts(size: tuple[float, float]) -> None:
    layout = SheetLayout(Sheet("s", *size, edge_gap_mm=0.1), 1, (), 0.0)
    assert pixels(sheet_picture(layout, {})).shape[1] == 1320


def test_the_offcut_of_the_layout_is_shown() -> None:
    _, pattern = made(PLATE)
    layout = SheetLayout(Sheet("s", 1000.0, 250.0), 1, (Placement("part", 1, Rigid2(10.0, 20.0)),), 0.2)
    with_offcut = replace(layout, offcut=Rectangle(320.0, 0.0, 680.0, 250.0))
    shown, bare = (sheet_picture(one, {"part": pattern}) for one in (with_offcut, layout))
    assert count(shown, FREE_FILL) > 20_000
    assert count(bare, FREE_FILL) < 200, "letters have pixels of all greys"


def test_more_names_than_rows_are_counted_in_the_table() -> None:
    _, pattern = made(PLATE)
    names = [f"part-{i}" for i in range(20)]
    placed = tuple(Placement(name, 1, Rigid2(310.0 * i, 0.0)) for i, name in enumerate(names))
    shown = sheet_picture(SheetLayout(Sheet("s", 6200.0, 250.0), 1, placed, 0.7), dict.fromkeys(names, pattern))
    assert all(count(shown, fill) > 0 for fill in FILLS)
