"""Webs of an outline with itself, refusals, contours that a beam does not fit into; holes are in `test_features`."""

from dataclasses import replace

import pytest

from stages.geometry.paths.arcpath import ArcPath
from stages.model.pattern import Contour
from stages.model.process import Process
from stages.unroll.webs import judged
from tests.near import assert_near
from tests.stages.geometry.paths.test_beside import notched
from tests.stages.geometry.paths.test_bridges import BONE, WAISTED
from tests.stages.write.patterns import contour, hole, polygon_edges


def outline(path: ArcPath) -> Contour:
    return replace(contour(polygon_edges(*map(tuple, path.vertices.tolist()))), path=path)


@pytest.mark.parametrize("path", [BONE, WAISTED], ids=["bone", "waisted"])
def test_a_neck_is_told_with_both_places_and_refused_if_asked(path: ArcPath) -> None:
    told = judged(outline(path), (), Process(min_web_mm=2.5))
    (found,) = told.findings
    assert found.code == "narrow-web"
    assert found.message == "2 mm between the outline and itself, the process wants 2.5 mm"
    assert found.where is not None
    assert_near(abs(float(found.where["to_y"]) - float(found.where["y"])), 2.0, bound=1e-12, why="across the neck")
    assert [
        finding.fatal for finding in judged(outline(path), (), Process(min_web_mm=2.5, refuses_narrow=True)).findings
    ] == [True]
    assert_near([float(metric.value or 0.0) for metric in told.metrics], [2.0], bound=1e-12, why="closed form")


def test_a_neck_as_wide_as_is_wanted_is_none() -> None:
    assert judged(outline(BONE), (), Process(min_web_mm=2.0)).findings == ()
    assert judged(outline(BONE), (), Process()).findings == ()


def test_the_narrowest_web_counts_whether_at_a_hole_or_not() -> None:
    holes = (hole(25.0, 5.0, 4.0),)
    told = judged(outline(BONE), holes, Process(min_web_mm=2.5))
    assert {metric.name: metric.value for metric in told.metrics}["min_web_mm"] == pytest.approx(1.0, abs=1e-12)
    assert len(told.findings) == 2


def test_a_slot_that_the_beam_cannot_enter_refuses_the_part_where_its_way_is_written() -> None:
    slot = outline(notched(0.15))
    offset = Process(kerf_mm=0.2, compensated=True)
    (found,) = judged(slot, (), offset).findings
    assert (found.code, found.fatal) == ("narrower-than-kerf", True)
    assert judged(slot, (), Process(kerf_mm=0.2)).findings == ()
    assert judged(outline(notched(0.25)), (), offset).findings == ()


def test_a_hole_smaller_than_the_kerf_refuses_the_part() -> None:
    (found,) = judged(outline(BONE), (hole(25.0, 5.0, 0.09),), Process(kerf_mm=0.2, compensated=True)).findings
    assert found.code == "narrower-than-kerf"
