"""Rails as a part among others: divided, joined, moved, folded; rails that meet, rails moved along, frames."""

from math import acos, degrees, sqrt

import mpmath as mp
import numpy as np
import pytest

from stages.construct.curves import chain
from stages.construct.railkind import rail_strip
from stages.geometry.rails import folds
from stages.geometry.rails.strip import closed_bounds
from stages.model.rails import Rails
from stages.model.surface import RuledSurface
from stages.model.tolerances import Tolerances
from stages.unroll import unroll
from stages.unroll.divide import blanks
from tests.near import assert_near, assert_relative
from tests.parts import Passage, Table, passage, read
from tests.stages.geometry.rails.test_folds import SLIDING, random_rails

HELICES: tuple[Table, Table] = (
    {"helix": {"radius": 100, "pitch": 60, "turns": 1.5}},
    {"helix": {"radius": 160, "pitch": 60, "turns": 1.5}},
)
CURVED = [[0, 0, 0], [40, 80, 0], [120, -40, 20], [160, 20, 12]]


def rails(a: Table, b: Table, **keys: object) -> Table:
    return {"kind": "rails", "rail_a": a, "rail_b": b} | keys


def curves(a: list[list[float]], b: list[list[float]], **keys: object) -> Table:
    return rails({"bezier": a}, {"bezier": b}, **keys)


def moved(points: list[list[float]], by: tuple[float, float, float]) -> list[list[float]]:
    return [[x + d for x, d in zip(point, by, strict=True)] for point in points]


def area(made: Passage) -> float:
    value = made.side("surface")["area"]
    assert isinstance(value, float)
    return value


def kinds(made: Passage) -> list[str]:
    found = made.reports["construct"].detail["pieces"]
    assert isinstance(found, list)
    return [row["kind"] for row in found]


def frame(half: float, z: float) -> Table:
    corners = [[half, -half, z], [half, half, z], [-half, half, z], [-half, -half, z]]
    return {"polyline": [*corners, corners[0]]}


def test_a_strip_that_would_overlap_itself_is_divided_into_blanks() -> None:
    whole = passage(rails(*HELICES), cut="auto")
    assert whole.codes("unroll", fatal=True) == ["flat-overlap"]
    assert whole.certificate is not None
    assert isinstance(whole.surface, RuledSurface)
    made = [unroll(blank, Tolerances()) for blank in blanks(whole.certificate, Tolerances())]
    assert len(made) > 1
    assert all(outcome.product is not None for outcome in made)
    sides = [outcome.report.detail["surface"] for outcome in made]
    areas = [side["area"] for side in sides if isinstance(side, dict)]
    assert_relative([sum(areas)], [area(whole)], bound=1e-12, why="the blanks are the part")
    assert max(float(outcome.report.metric("metric_error").value or 0.0) for outcome in made) < 1e-11


def test_rails_join_to_a_cylinder_as_pieces_of_a_strip() -> None:
    """A quarter pipe from two quarter circles, and a plane that goes on from its last ruling."""
    arc: Table = {"arc": {"center": [0, 0, 0], "radius": 50, "normal": [0, 0, 1], "start": 0, "end": 90}}
    over: Table = {"arc": {"center": [0, 0, 80], "radius": 50, "normal": [0, 0, 1], "start": 0, "end": 90}}
    plane = {"kind": "ruled", "c0": {"line": [[-60, 50, 0], [0, 50, 0]]}, "c1": {"line": [[-60, 50, 80], [0, 50, 80]]}}
    made = passage({"kind": "strip", "pieces": [rails(arc, over), plane]})
    assert made.refused_by is None
    assert made.value("construct", "join_normal_deg") < 1e-12
    assert_relative([area(made)], [80.0 * (25.0 * np.pi + 60.0)], bound=1e-13, why="closed form")


WAVES = (
    [[0, -11.7545566, -63.3723241], [200, 13.5632179, 7.8375543], [400, -9.3465472, -125.8379855],
     [600, -26.9346448, -2.4250473]],
    [[1.6996348, -40.441862, 303.0449312], [177.0479635, -40.3767338, 248.3739148],
     [392.8337009, 44.2194934, 220.8199784], [585.3222138, -5.5850975, 255.5232072]],
)  # fmt: skip
"""Two rails whose strip has three cones and a ruled piece."""


def test_moving_and_turning_the_rails_moves_the_strip() -> None:
    """Turned by 3-4-5 triangles about two axes, and run from the other end."""
    turn = np.array([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
    turn = turn @ np.array([[1.0, 0.0, 0.0], [0.0, 0.28, -0.96], [0.0, 0.96, 0.28]])
    ends = [np.round(np.array(points) @ turn.T + [500, -200, 30], 9)[::-1].tolist() for points in WAVES]
    still, other = passage(curves(*WAVES)), passage(curves(*ends))
    assert sorted(kinds(still)) == ["cone", "cone", "cone", "ruled"]
    assert kinds(other)[::-1] == kinds(still)
    assert_relative([area(other)], [area(still)], bound=1e-10, why="points rounded to 1e-9 mm")


@pytest.mark.parametrize("by", [(12, 0, 80), (0, 5, 60)])
def test_a_rail_moved_along_bounds_a_cylinder_through_its_inflections(by: tuple[float, float, float]) -> None:
    """Another arc of F = 0 crosses at each inflection.  Area: |by| times the width of the curve seen along it."""
    made = passage(curves(CURVED, moved(CURVED, by)))
    assert set(kinds(made)) == {"ruled"}
    assert_near(made.value("verify", "max_warp_deg"), 0.0, bound=1e-9, why="parallel rulings")
    x, d = [mp.matrix(point) for point in CURVED], mp.matrix(by)

    def width(t: mp.mpf) -> mp.mpf:
        r1 = 3 * ((x[1] - x[0]) * (1 - t) ** 2 + 2 * (x[2] - x[1]) * t * (1 - t) + (x[3] - x[2]) * t**2)
        along = (r1.T * d)[0] ** 2
        return mp.sqrt((r1.T * r1)[0] * (d.T * d)[0] - along)

    assert_relative([area(made)], [float(mp.quad(width, [0, 0.25, 0.5, 0.75, 1]))], bound=1e-12, why="mpmath")


def test_a_curve_and_its_larger_image_bound_one_cone() -> None:
    made = passage(curves(CURVED, moved([[2 * x, 2 * y, 2 * z] for x, y, z in CURVED], (40, 0, 80))))
    assert set(kinds(made)) == {"ruled"}
    assert made.value("verify", "max_warp_deg") < 1e-9


def test_rails_that_share_both_end_points_bound_a_lens() -> None:
    """Two parabolas over one chord in planes at right angles: parallel rulings, t = s; area by mpmath."""
    made = passage(curves([[0, 0, 0], [2, 2, 0], [4, 0, 0]], [[0, 0, 0], [2, 0, 2], [4, 0, 0]]))
    assert kinds(made) == ["ruled"]
    lens = mp.quad(lambda t: mp.sqrt(2) * 4 * t * (1 - t) * mp.sqrt(16 + (4 - 8 * t) ** 2 / 2), [0, 0.5, 1])
    assert_relative([area(made)], [float(lens)], bound=1e-13, why="quadrature")


@pytest.mark.parametrize("backwards", [False, True])
def test_rails_that_share_one_end_point_have_a_strip_from_cones_there(backwards: bool) -> None:
    a, b = [[0, 0, 0], [1, 2, 0], [3, -1, 0.5], [4, 0.5, 2]], [[0, 0, 0], [1, 1, 2], [2.5, -1, 1.5], [4, 0.5, 3]]
    step = -1 if backwards else 1
    made = passage(curves(moved(a, (70, 30, -10))[::step], moved(b, (70, 30, -10))[::step]))
    assert made.refused_by is None
    assert made.value("verify", "max_warp_deg") < 1e-9
    assert made.value("construct", "join_normal_deg") < 1e-6


@pytest.mark.parametrize("seed", [3, 26, 35])
def test_an_arc_that_turns_at_a_shared_end_point_is_unrolled(seed: int) -> None:
    """The corner of no length there leaves none of its rounding: a ruling of 1e-14 would look anywhere."""
    rng = np.random.default_rng(seed)
    a, b = (_from_origin(rng, aside) for aside in (0.0, 1.6))
    made = passage(curves(a, b))
    assert made.refused_by is None
    rows = made.reports["construct"].detail["pieces"]
    assert isinstance(rows, list)
    assert (rows[0]["kind"], rows[0]["a"][0], rows[0]["b"][0]) == ("ruled", 0.0, 0.0)
    assert made.value("verify", "max_warp_deg") < 1e-9
    assert made.value("construct", "join_normal_deg") < 1e-6
    assert made.value("unroll", "area_error") < 1e-12


def _from_origin(rng: np.random.Generator, aside: float) -> list[list[float]]:
    """Return the control points of a cubic that begins in the origin, its other end some way aside."""
    away = [[x, aside * x / 6.0 + rng.normal(0.0, 0.5), rng.normal(0.0, 0.5)] for x in (2.0, 4.0, 6.0)]
    return [[0.0, 0.0, 0.0], *np.round(away, 6).tolist()]


def test_two_frames_fold_at_their_corners_alone_and_the_folds_are_bend_lines() -> None:
    """A pyramid's stump: normals (3, 0, 1) / sqrt 10 turn by acos(1/10) at each corner; the fourth is the seam."""
    made = passage(rails(frame(2, 0), frame(1, 3), folds="allow"))
    assert_relative([area(made)], [4 * 3 * sqrt(10)], bound=1e-14, why="four trapezia")
    assert made.pattern is not None
    rows = made.reports["unroll"].detail["bends"]
    assert isinstance(rows, list)
    assert_near([row["angle_deg"] for row in rows], [degrees(acos(0.1))] * 3, bound=1e-12, why="closed form")
    assert [row["fold"] for row in rows] == [True] * 3
    bends = [mark for mark in made.pattern.marks if mark.layer in {"BEND_UP", "BEND_DOWN"}]
    assert len({mark.layer for mark in bends}) == 1
    lengths = [float(np.hypot(*(mark.path.vertices[1] - mark.path.vertices[0]))) for mark in bends]
    assert_near(lengths, [sqrt(11)] * 3, bound=1e-13, why="from corner (2, 2, 0) to corner (1, 1, 3)")


def test_frames_are_refused_without_folds() -> None:
    made = passage(rails(frame(2, 0), frame(1, 3)))
    assert made.codes("construct", fatal=True) == ["no-smooth-strip"]
    (finding,) = made.reports["construct"].findings
    assert "every strip folds by at least 79.89" in finding.message
    assert "3 folds, the largest 84.2608 deg, and 84.2608 deg at its seam" in finding.message
    assert "round the corners of rail a, as at a = 1, b = 1.49" in finding.message
    assert finding.where is not None
    assert finding.where["a"] == 1.0


TURNS = ((1, 0), (0, 1), (-1, 0), (0, -1), (1, 0), (0, 1))


def rounded_frame() -> Table:
    """Return straight sides of 2 between quarter circles of radius 1, the corners of a square of side 4."""
    made: list[Table] = []
    for k, (x, y) in enumerate([(1, 1), (-1, 1), (-1, -1), (1, -1)]):
        (out, up), (dx, dy) = TURNS[k + 1 : k + 3]
        start = [x + out, y + up, 0]
        arc = {"center": [x, y, 0], "radius": 1, "normal": [0, 0, 1], "start": 90 * k, "end": 90 * k + 90}
        made += [{"arc": arc}, {"line": [start, [start[0] + 2 * dx, start[1] + 2 * dy, 0]]}]
    return {"chain": made}


def test_a_frame_over_a_frame_that_is_rounded_at_its_corners_has_a_strip() -> None:
    """What the refusal asks for, done."""
    made = passage(rails(rounded_frame(), frame(1, 3)))
    assert made.refused_by is None
    assert made.value("construct", "join_normal_deg") < 1e-9


def slot(half_width: float) -> Table:
    return {"ellipse": {"center": [0, 0, 150], "major": [0, 120, 0], "minor": [half_width, 0, 0]}}


@pytest.mark.parametrize("half_width", [6e-5, -1e-9])
def test_a_rail_without_width_is_refused_and_told_to_be_a_polyline(half_width: float) -> None:
    round_ = {"ellipse": {"center": [0, 0, 0], "major": [120, 0, 0], "minor": [0, 60, 0]}}
    for a, b, name in ((round_, slot(half_width), "b"), (slot(half_width), round_, "a")):
        made = passage(rails(a, b))
        assert made.codes("construct", fatal=True) == ["rail-doubled"]
        (finding,) = made.reports["construct"].findings
        assert finding.where == {name: 0.5}
        assert f"within {abs(half_width):.3g} mm of a straight line of 240 mm" in finding.message
        assert "polyline" in finding.message


def test_a_polyline_there_and_back_is_a_rail() -> None:
    """Two cones from its ends over the ellipse, and two planes along it: the ends of pressed tube."""
    line = {"polyline": [[120, 0, 0], [-120, 0, 0], [120, 0, 0]]}
    across = {"ellipse": {"center": [0, 0, 150], "major": [0, 120, 0], "minor": [60, 0, 0]}}
    made = passage(rails(line, across, folds="forbid"))
    assert not made.codes("construct", fatal=True)
    assert sorted(kinds(made)) == ["cone", "cone", "triangle", "triangle"]


def test_folds_that_have_not_settled_are_told_of(monkeypatch: pytest.MonkeyPatch) -> None:
    a, b = ([[float(x) for x in point] for point in rail.exact] for rail in random_rails(SLIDING[0]))
    table = curves(a, b, folds="allow")
    assert "folds-unsettled" not in passage(table).codes("construct")
    monkeypatch.setattr(folds, "ROUNDS", 1)
    assert "folds-unsettled" in passage(table).codes("construct")


def test_closed_rails_with_a_strip_have_no_lower_bound() -> None:
    spec = read(rails(frame(1.5, 0), {"circle": {"center": [0, 0, 2], "radius": 1, "normal": [0, 0, 1]}})).surface
    assert isinstance(spec, Rails)
    assert [bound.fold_rad for bound in closed_bounds(chain(spec.rail_a).curves, chain(spec.rail_b).curves)] == [0, 0]


def test_a_least_radius_takes_a_strip_without_cones_where_there_is_one() -> None:
    """The best way between the moved rails has no cone; between others every way has one, and that is refused."""
    straight = read(curves(CURVED, moved(CURVED, (12, 0, 80)), min_radius=1)).surface
    assert isinstance(straight, Rails)
    built = rail_strip(straight, Tolerances())
    assert [finding.code for finding in built.findings] == []
    coned = with_radius(rails(frame(1.5, 0), {"circle": {"center": [0, 0, 2], "radius": 1, "normal": [0, 0, 1]}}))
    assert coned == ["apex-on-rail", "min-radius"]


def with_radius(surface: Table) -> list[str]:
    """Return the findings on a surface with a least radius of 1 mm."""
    spec = read(surface | {"min_radius": 1}).surface
    assert isinstance(spec, Rails)
    return [finding.code for finding in rail_strip(spec, Tolerances()).findings]
