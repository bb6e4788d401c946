"""Trimmed parts: an outline in u and v through the flat map, with areas and lengths known in closed form."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from stages.geometry.arrays import Array, Points2, Values
from stages.geometry.curves.plane import CircularArc, Segment, stretch
from stages.geometry.flat.development import develop
from stages.model.material import Material
from stages.model.pattern import FlatPattern
from stages.model.report import StageReport
from stages.model.surface import RuledSurface, Trim
from stages.unroll import unroll
from stages.unroll.divide import blanks
from stages.unroll.thickness import neutral
from stages.unroll.trimmed import trimmed
from stages.verify import verify
from tests.near import assert_near, assert_relative
from tests.parts import DEFAULT, RIGHT_FRUSTUM, Table, construct, part

RADII, SWEEP = (300.0, 150.0), 2.0
FRUSTUM: Table = RIGHT_FRUSTUM | {"radius0": 300, "radius1": 150, "height": 400, "sweep": SWEEP * 180.0 / np.pi}
SLANT = float(np.hypot(150.0, 400.0))
MIDDLE = np.array([0.5, 0.5])
ROUNDING = 1e-11
"""Of quadratures and of differentiated positions, as a share of the part."""


def ring(radius: float, turn: float = 2.0 * np.pi) -> CircularArc:
    """Return a circle in the plane of u and v."""
    return CircularArc(MIDDLE, radius, 0.3, turn)


def frustum(trim: Trim | None, material: Material | None = None, **keys: object) -> RuledSurface:
    """Return the cone with this trim."""
    surface = construct(part(FRUSTUM, material or Material(), **keys), DEFAULT).product
    assert isinstance(surface, RuledSurface)
    return replace(surface, trim=trim)


def laid(surface: RuledSurface) -> tuple[FlatPattern | None, StageReport]:
    """Return what unroll makes of a surface."""
    certificate = verify(surface, DEFAULT).product
    assert certificate is not None
    outcome = unroll(certificate, DEFAULT)
    return outcome.product, outcome.report


def side(report: StageReport, name: str) -> dict[str, float]:
    """Return the figures of one side."""
    figures = report.detail[name]
    assert isinstance(figures, dict)
    return figures


def ring_area(radius: float) -> float:
    """Return the area of a circle of u and v on the cone: the area element is linear in u, so it counts at u = 1/2."""
    return np.pi * radius**2 * SLANT * SWEEP * (RADII[0] + RADII[1]) / 2.0


def test_areas_of_both_sides_are_those_of_the_closed_form() -> None:
    pattern, report = laid(frustum(Trim((ring(0.45),), ((ring(0.1),),))))
    exact = ring_area(0.45) - ring_area(0.1)
    for name in ("surface", "flat"):
        assert_relative(side(report, name)["area"], exact, bound=ROUNDING, why="quadratures to rounding")
    assert pattern is not None
    assert len(pattern.inner) == 1
    assert report.metric("area_error").value is not None
    assert float(report.metric("length_error").value or 0.0) <= ROUNDING
    assert side(report, "surface")["edges"] is None


def test_the_whole_patch_as_its_own_trim_is_the_patch() -> None:
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    square = tuple(Segment(a, b) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True))
    _, with_trim = laid(frustum(Trim(square)))
    _, without = laid(frustum(None))
    for name in ("area", "outline_length", "width", "height"):
        assert_relative(side(with_trim, "flat")[name], side(without, "flat")[name], bound=ROUNDING, why="same outline")


@pytest.mark.parametrize("cuts", [(), (0.3, 0.8)])
def test_the_way_round_and_the_pieces_of_a_loop_do_not_count(cuts: tuple[float, ...]) -> None:
    backwards = ring(0.4, -2.0 * np.pi)
    ends = [0.0, *cuts, 1.0]
    pieces = tuple(stretch(backwards, low, high) for low, high in pairwise(ends))
    _, report = laid(frustum(Trim(pieces)))
    assert_relative(side(report, "flat")["area"], ring_area(0.4), bound=ROUNDING, why="quadratures to rounding")


def test_the_neutral_surface_is_trimmed_and_the_given_one_reported() -> None:
    sheet = Material(thickness_mm=2.0)
    _, report = laid(frustum(Trim((ring(0.45),)), sheet, face="inner"))
    given, flat = side(report, "given")["area"], side(report, "flat")["area"]
    assert_relative(given, ring_area(0.45), bound=ROUNDING, why="quadratures to rounding")
    # parallel cones: the radius grows by the offset times the cosine of the half angle
    offset = float(report.metric("neutral_offset_mm").value or 0.0) * 400.0 / SLANT
    mean = (RADII[0] + RADII[1]) / 2.0
    assert abs(offset) > 0.1
    assert_relative(flat / given, (mean + abs(offset)) / mean, bound=1e-9, why="both linear in the radius")


def test_a_map_that_is_no_isometry_is_caught() -> None:
    surface = frustum(Trim((ring(0.45),)))
    sheet = neutral(surface, DEFAULT)
    (piece,) = develop(surface.patches).pieces

    class Stretched:
        patch, breaks = piece.patch, piece.breaks

        def positions(self, u: Values, v: Values) -> Points2:
            return piece.positions(u, v) * np.array([1.001, 1.0])

        def chords(self, u0: Values, v0: Values, u: Values, v: Values) -> Points2:
            return piece.chords(u0, v0, u, v) * np.array([1.001, 1.0])

        def velocities(self, u: Values, v: Values) -> Points2:
            return piece.velocities(u, v) * np.array([1.001, 1.0])

    development = develop(surface.patches)
    assert surface.trim is not None
    planted = trimmed(sheet, replace(development, pieces=(Stretched(),)), surface.trim, DEFAULT.chord_mm)
    error = next(metric.value for metric in planted.metrics if metric.name == "area_error")
    assert_near(float(error or 0.0), 1e-3, bound=1e-9, why="x stretched by a thousandth")


def test_marks_and_features_end_at_the_outline() -> None:
    keys = {
        "mark": [{"kind": "rulings", "count": 5, "name": "r"}],
        "notch": [{"edge": "outline", "distance": 30, "kind": "slit"}],
    }
    surface = frustum(Trim((ring(0.45),), ((ring(0.1),),)), **keys)
    pattern, _ = laid(surface)
    assert pattern is not None
    rulings = [mark for mark in pattern.marks if mark.name.startswith("r-")]
    # the middle one is cut in two by the hole
    assert len(rulings) == 6
    for mark in rulings:
        assert not outside(mark.path.vertices, pattern.outer.path.vertices.mean(axis=0), pattern)


def outside(points: Array, middle: Array, pattern: FlatPattern) -> bool:
    """Return whether points reach beyond the box of the outline about its middle."""
    reach = np.abs(pattern.corners - middle).max(axis=0) + DEFAULT.chord_mm
    return bool((np.abs(points - middle) > reach).any())


def test_a_trimmed_part_has_no_edges_with_names() -> None:
    surface = frustum(Trim((ring(0.45),)), notch=[{"edge": "c0", "at": 0.5}])
    placed = construct(part(FRUSTUM, notch=[{"edge": "c0", "at": 0.5}]), DEFAULT).product
    assert isinstance(placed, RuledSurface)
    pattern, report = laid(replace(surface, features=placed.features))
    assert pattern is None
    assert [finding.code for finding in report.findings if finding.fatal] == ["no-such-edge"]


def test_a_trimmed_part_is_not_divided() -> None:
    surface = frustum(Trim((ring(0.45),)), cut="auto")
    certificate = verify(surface, DEFAULT).product
    assert certificate is not None
    assert blanks(certificate, DEFAULT) == (certificate,)
