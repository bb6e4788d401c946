"""Points within contours of lines and arcs, above all those on chords, of which the parities must not disagree."""

import numpy as np
import pytest

from stages.geometry.arrays import Mask
from stages.geometry.paths.arcpath import ArcPath, backwards
from stages.geometry.paths.clearance import pieces
from stages.geometry.paths.enclosed import inside, inside_own

SHARES = (0.25, 0.5, 0.75)


def on_chords(path: ArcPath) -> Mask:
    """Return whether points on the chords of a path count as within it, asked in both ways; those must agree."""
    some = pieces(path)
    points = np.concatenate([some.start + share * (some.end - some.start) for share in SHARES])
    found = inside(points, some)
    owner = np.zeros(some.bulge.size, dtype=np.int64)
    assert inside_own(points, np.zeros(points.shape[0], dtype=np.int64), some, owner).tolist() == found.tolist()
    return found


def ring(count: int, bulge: float, turn: float) -> ArcPath:
    """Return a closed path on the corners of a regular polygon, level and upright ones to the digit."""
    angle = turn + np.arange(count) * 2.0 * np.pi / count
    corners = np.round(4.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1), 12)
    return ArcPath(corners, np.full(count, bulge), closed=True)


@pytest.mark.parametrize("turn", [0.0, np.pi / 4.0, 0.3])
@pytest.mark.parametrize("count", [2, 4, 8])
def test_a_point_on_the_chord_of_a_circle_is_within_it(count: int, turn: float) -> None:
    circle = ring(count, float(np.tan(np.pi / count / 2.0)), turn)
    for path in (circle, backwards(circle)):
        assert on_chords(path).all()


@pytest.mark.parametrize("turn", [0.0, np.pi / 4.0, 0.3])
def test_a_point_on_the_chord_of_a_hollow_arc_is_not(turn: float) -> None:
    hollow = ring(4, -0.2, turn)
    for path in (hollow, backwards(hollow)):
        assert not on_chords(path).any()
