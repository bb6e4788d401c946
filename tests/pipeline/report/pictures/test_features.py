"""What is drawn on formed surfaces and beside them: holes, marks, bend lines, names; and from where it is seen."""

import numpy as np
import pytest

from pipeline.report.pictures import canvas as page
from pipeline.report.pictures.edges import hole_text, rulings, side_length, sides
from pipeline.report.pictures.features import drawn_on, sampled
from pipeline.report.pictures.flat_names import Name, first_free
from pipeline.report.pictures.marks import marks_legend
from pipeline.report.pictures.names import Label, best_place, clearances
from pipeline.report.pictures.net import net, view_direction
from pipeline.report.pictures.part import part_picture, sheet_picture
from pipeline.report.pictures.surface import paintings
from stages.geometry.curves.rigid import Rigid2
from stages.model.sheet import Placement, Sheet, SheetLayout
from stages.model.surface import RuledSurface
from tests.near import assert_near
from tests.pipeline.report.pictures.test_part import count, made, pixels

RADIUS = 300.0
HALF_PIPE = {
    "kind": "cylinder",
    "directrix": {"arc": {"center": [0, 0, 0], "radius": 300, "normal": [1, 0, 0], "start": 0, "end": 180}},
    "direction": [1, 0, 0],
    "length": 800,
}
DRILLED = {"name": "fix", "kind": "drill", "at": [0.5, 0.25], "diameter": 80}
BENT = [{"max_angle": 15}]
QUADS = 120
SAGITTA = RADIUS * (1.0 - np.cos(np.pi / QUADS / 2.0))
"""Of one quad of the net: how far its middle is inside the pipe."""


def test_a_drilled_hole_lies_on_the_pipe_where_it_was_asked_for() -> None:
    surface, pattern = made(HALF_PIPE, hole=[DRILLED])
    assert isinstance(surface, RuledSurface)
    (hole,) = drawn_on(net(surface), pattern)
    assert hole.closed
    assert_near(np.hypot(*hole.points[:, 1:].T), np.full(len(hole.points), RADIUS), bound=SAGITTA + 1e-9, why="sagitta")
    centre = surface.patches[0].c0.jet(np.array([0.25]), 0)[0][0] + [400.0, 0.0, 0.0]
    reach = np.linalg.norm(hole.points - centre, axis=1)
    assert_near(
        reach,
        np.full(len(reach), 40.0),
        bound=40.0**2 / (8.0 * RADIUS),
        why="a drill of 40 mm is 40^2 / (8 R) off its tangent plane",
    )


def test_a_bend_line_that_a_hole_cuts_into_pieces_counts_once() -> None:
    _, pattern = made(HALF_PIPE, bend=BENT, hole=[DRILLED | {"diameter": 120}])
    assert len(pattern.marks) > 12
    assert marks_legend(pattern) == ["dash-dotted: 12 bend lines"], "180 deg in hits of 15"


def test_bend_lines_lie_along_rulings_and_take_the_place_of_those() -> None:
    surface, pattern = made(HALF_PIPE, bend=BENT)
    assert isinstance(surface, RuledSurface)
    lines = drawn_on(net(surface), pattern)
    assert len(lines) == 12, "180 deg in hits of 15"
    for line in lines:
        assert np.ptp(line.points[:, 1:], axis=0).max() < 1e-6, "parallel to x"
        assert np.ptp(line.points[:, 0]) == pytest.approx(800.0, abs=1e-3)
    plain, _ = paintings(net(surface), view_direction(net(surface)))
    bent, _ = paintings(net(surface), view_direction(net(surface)), lines)
    assert (len(plain[1].depth) > 0, len(bent[1].depth)) == (True, 0), "rulings"
    image = part_picture(surface, pattern, [])
    assert count(image, page.PURPLE) > count(part_picture(*made(HALF_PIPE), []), page.PURPLE)


def test_bend_lines_of_a_fan_of_cones_are_straight_in_space_up_to_their_ends() -> None:
    """Also where the last point lies on an arc, outside the chord between two rulings of the net."""
    duct = {"kind": "transition", "rectangle": [500, 300], "round": 315, "height": 400, "offset": [60, 0]}
    surface, pattern = made(duct, bend=[{"max_angle": 10}])
    assert isinstance(surface, RuledSurface)
    for line in drawn_on(net(surface), pattern):
        way = line.points[-1] - line.points[0]
        off = np.linalg.norm(np.cross(line.points - line.points[0], way), axis=1) / np.linalg.norm(way)
        assert off.max() < 0.5, "one quad across a corner spans 90 deg / 15 of 157.5 mm: a sagitta of 0.2 mm"


def test_a_hole_is_painted_after_everything_that_it_pierces() -> None:
    surface, pattern = made(HALF_PIPE, hole=[DRILLED | {"diameter": 300}])
    assert isinstance(surface, RuledSurface)
    shape = net(surface)
    frame = view_direction(shape)
    faces, edges = paintings(shape, frame, drawn_on(shape, pattern))
    quads, _, hole, *_ = faces
    inside = quads.corners.mean(axis=1)
    low, high = hole.corners[0].min(axis=0), hole.corners[0].max(axis=0)
    pierced = ((inside > low) & (inside < high)).all(axis=1)
    assert pierced.sum() > 4
    assert hole.depth[0] >= quads.depth[pierced].max()
    assert len(edges) == 4


def test_a_part_without_features_has_none_and_a_closed_path_returns_to_its_start() -> None:
    surface, pattern = made(HALF_PIPE)
    assert isinstance(surface, RuledSurface)
    assert drawn_on(net(surface), pattern) == []
    points = sampled(pattern.outer.path, 50.0)
    assert points[0] == pytest.approx(points[-1])
    assert np.linalg.norm(np.diff(points, axis=0), axis=1).max() <= 50.0


def test_a_notch_takes_no_edge_its_name() -> None:
    notch = [{"edge": "c0", "at": 0.5, "kind": "v"}]
    whole, notched = (sides(made(HALF_PIPE, notch=one)[1]) for one in ([], notch))
    assert {name: side_length(edges) for name, edges in notched.items()} == pytest.approx(
        {name: side_length(edges) for name, edges in whole.items()}, rel=1e-12
    )
    assert len(rulings(made(HALF_PIPE, notch=notch)[1], [0.0, 0.5, 1.0])) == 3


def test_a_hole_drilled_through_bent_sheet_is_named_by_its_diameter() -> None:
    _, pattern = made(HALF_PIPE, hole=[DRILLED | {"diameter": 9}])
    assert hole_text(pattern.inner[0].path).startswith("⌀9.00")
    _, wide = made(HALF_PIPE, hole=[DRILLED | {"diameter": 400}])
    assert "×" in hole_text(wide.inner[0].path), "no circle any more: 427 mm round the pipe"


def test_bend_lines_are_seen_on_the_sheet() -> None:
    layout = SheetLayout(Sheet("s", 1500.0, 1200.0), 1, (Placement("part", 1, Rigid2(100.0, 100.0)),), 0.5)
    plain, bent = (sheet_picture(layout, {"part": made(HALF_PIPE, bend=one)[1]}) for one in ([], BENT))
    changed = (pixels(plain) != pixels(bent)).any(axis=2)
    assert changed.sum() > 1000


def test_a_name_goes_where_it_hides_no_line_and_near_the_viewer() -> None:
    points, up = np.array([[0.0, 0.0], [2.0, 0.0], [4.0, 0.0]]), np.tile([0.0, 1.0], (3, 1))
    label = Label("c0", page.BLUE, points, up, np.array([0.0, 1.0, 0.5]))
    nothing = np.array([[9.0, 9.0]])
    at, half, clear = best_place(label, nothing)
    assert (at[0], clear) == (2.0, True), "the nearest to the viewer"
    at, _, clear = best_place(label, np.array([[2.0, 0.15]]))
    assert (at[0], clear) == (4.0, True), "the next one"
    blocked = np.stack([points[:, 0], np.full(3, 0.15)], axis=1)
    assert not best_place(label, blocked)[2]
    assert clearances(np.zeros((1, 2)), half, np.array([[half[0] + 0.3, half[1] + 0.4]])) == pytest.approx([0.5])


def test_the_name_of_an_edge_gives_way_to_one_that_is_there() -> None:
    level = np.array([1.0, 0.0])
    first, second = Name("start  9 mm", np.zeros(2), level), Name("start  9 mm", np.array([0.0, 1.0]), level)
    assert first_free([first, second], []) is first
    assert first_free([first, second], [first.points]) is second
    assert first_free([first], [first.points]) is first, "better there than not at all"


@pytest.mark.parametrize("turned_deg", range(0, 180, 20))
def test_a_slender_part_is_seen_at_nearly_its_full_length(turned_deg: int) -> None:
    a = np.radians(turned_deg)
    along, across = np.array([np.cos(a), np.sin(a), 0.0]), np.array([-np.sin(a), np.cos(a), 0.0])
    ends = [(1000.0 * along).tolist(), (1000.0 * along + 60.0 * across).tolist(), (60.0 * across).tolist()]
    panel = {"kind": "ruled", "c0": {"line": [[0, 0, 0], ends[0]]}, "c1": {"line": [ends[2], ends[1]]}}
    surface, _ = made(panel)
    assert isinstance(surface, RuledSurface)
    frame = view_direction(net(surface))
    assert np.linalg.norm(frame[:2] @ along) > 0.85
