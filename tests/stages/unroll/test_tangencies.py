"""Bend lines between flat and bent faces: where curvature jumps, to the side that bends."""

import numpy as np
import pytest

from stages.geometry.curves.curves import Circular, bezier, exactly
from stages.geometry.flat.development import develop
from stages.geometry.ruled.ruled import RuledPatch, between
from stages.model.surface import RuledSurface, whole_spans
from stages.unroll.tangencies import tangency_marks
from tests.near import assert_near
from tests.parts import OBLIQUE_CONE, part

UP = np.array([0.0, 0.0, 30.0])


def flat(start: list[float], end: list[float]) -> RuledPatch:
    low = [np.array([*start, 0.0]), np.array([*end, 0.0])]
    c0, c1 = (bezier([exactly(point + step) for point in low]) for step in (0 * UP, UP))
    return between(c0, c1)


def bend(centre: list[float], start: float, sweep: float) -> RuledPatch:
    x, y, none = np.array([10.0, 0, 0]), np.array([0, 10.0, 0]), np.zeros(3)
    c0, c1 = (Circular(np.array([*centre, 0.0]) + step, x, y, none, start, sweep) for step in (0 * UP, UP))
    return between(c0, c1)


def strip(*patches: RuledPatch) -> RuledSurface:
    inner = tuple(float(i) for i in range(1, len(patches)))
    return RuledSurface(part(OBLIQUE_CONE), patches, 80.0, whole_spans(len(patches)), tangencies=inner)


@pytest.mark.parametrize(("centre", "start", "sweep"), [([40, 10], -np.pi / 2, 1.0), ([40, -10], np.pi / 2, -1.0)])
def test_the_line_lies_at_the_end_of_the_flat_face(centre: list[float], start: float, sweep: float) -> None:
    surface = strip(flat([0, 0], [40, 0]), bend(centre, start, sweep))
    (line,) = tangency_marks(surface, develop(surface.patches))
    # the rulings run along +z, so N = p x c0' points to +y, the way the first of the two bends
    assert line.layer == ("BEND_UP" if sweep > 0 else "BEND_DOWN")
    heights = np.abs(line.path.vertices[:, 1])
    assert_near(heights, [40.0, 40.0], bound=1e-12, why="the length of the flat face")
    assert_near(sorted(line.path.vertices[:, 0]), [0.0, 30.0], bound=1e-12, why="the whole ruling")


def test_flat_faces_side_by_side_have_no_bend_line_between_them() -> None:
    surface = strip(flat([0, 0], [40, 0]), flat([40, 0], [70, 0]))
    assert tangency_marks(surface, develop(surface.patches)) == ()
