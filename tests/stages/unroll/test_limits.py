"""What refuses a pattern: area covered twice, told from what fitted arcs cover."""

from math import pi, tan

import numpy as np
import pytest

from stages.geometry.paths.arcpath import ArcPath
from stages.geometry.paths.edges import edges_of
from stages.model.pattern import Contour
from stages.unroll import limits
from stages.unroll.limits import overlap
from tests.near import assert_relative

CHORD = 0.05
THREE_TURNS = np.linspace(0.0, 6.0 * pi, 25)


def wound() -> Contour:
    """Return an annulus of 10 and 20 mm that goes round three times."""
    around = np.stack([np.cos(THREE_TURNS), np.sin(THREE_TURNS)], axis=1)
    bulges = np.full(24, tan(pi / 16.0))
    vertices = np.vstack([20.0 * around, 10.0 * around[::-1]])
    path = ArcPath(vertices, np.concatenate([bulges, [0.0], -bulges, [0.0]]), closed=True)
    return Contour(edges_of(path), path, CHORD)


def test_a_pattern_that_lies_on_itself_is_measured_once(monkeypatch: pytest.MonkeyPatch) -> None:
    def again(*_: object) -> Contour:
        raise AssertionError("no arcs but those that are cut have to be looked at")

    monkeypatch.setattr(limits.outline, "contour", again)
    found = overlap(wound())
    assert_relative(float(found.value or 0.0), 2.0 * pi * (20.0**2 - 10.0**2), bound=1e-9, why="two turns too many")
    assert not found.passed


def test_an_overlap_that_arcs_might_make_is_looked_at_on_finer_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[float] = []

    def finer(_edges: object, chord_mm: float) -> Contour:
        asked.append(chord_mm)
        return wound()

    monkeypatch.setattr(limits.outline, "contour", finer)
    monkeypatch.setattr(limits, "doubled", lambda _: 2.0 * CHORD**2)
    assert overlap(wound()).value == 2.0 * CHORD**2
    assert asked == [CHORD / 4.0, CHORD / 16.0]
