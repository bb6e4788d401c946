"""Splines near many values: polynomials are kept, smooth values followed, noise smoothed, circles closed."""

import numpy as np
import pytest

from stages.geometry.numeric.smoothing import DEGREE, followed
from tests.near import assert_near

AT = np.linspace(0.0, 1.0, 161)


def bezier(pieces: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return the values of the pieces by de Casteljau."""
    spans = len(pieces)
    piece = np.minimum((at * spans).astype(int), spans - 1)
    t = (at * spans - piece)[:, None, None]
    rows = pieces[piece]
    for _ in range(DEGREE):
        rows = (1.0 - t) * rows[:, :-1] + t * rows[:, 1:]
    return np.asarray(rows[:, 0])


def test_a_quintic_is_one_span_and_itself() -> None:
    values = np.stack([AT**5 - AT, 1.0 + AT**2], axis=1)
    found = followed(AT, values, 16, independent=100.0, closed=False, settled=1e-12)
    assert len(found.pieces) == 1
    assert_near(bezier(found.pieces, AT), values, bound=1e-12, why="within the space of the spline")


def test_smooth_values_are_followed_until_settled_and_the_pieces_are_the_spline() -> None:
    values = np.stack([np.cos(9.0 * AT), np.sin(9.0 * AT), AT], axis=1)
    found = followed(AT, values, 32, independent=150.0, closed=False, settled=1e-7)
    assert found.rms < 2e-7
    assert_near(bezier(found.pieces, AT), found.near, bound=1e-12, why="one spline in two bases")
    fine = np.linspace(0.0, 1.0, 997)
    wanted = np.stack([np.cos(9.0 * fine), np.sin(9.0 * fine), fine], axis=1)
    assert_near(bezier(found.pieces, fine), wanted, bound=1e-5, why="some times the rms, between the places too")


def test_a_closed_curve_is_smooth_where_it_closes() -> None:
    turn = 2.0 * np.pi * AT
    found = followed(
        AT, np.stack([np.cos(turn), np.sin(turn)], axis=1), 16, independent=60.0, closed=True, settled=1e-6
    )
    first, last = found.pieces[0], found.pieces[-1]
    assert_near(first[0], last[-1], bound=1e-12, why="periodic")
    assert_near(first[1] - first[0], last[-1] - last[-2], bound=1e-12, why="and so is its slope, equal spans")


@pytest.mark.parametrize("seed", range(5))
def test_noise_is_not_followed(seed: int) -> None:
    smooth = np.stack([np.cos(3.0 * AT), AT], axis=1)
    noise = 0.01 * np.random.default_rng(seed).standard_normal(smooth.shape)
    found = followed(AT, smooth + noise, 32, independent=161.0, closed=False, settled=1e-9)
    assert len(found.pieces) <= 4
    away = float(np.sqrt(((found.near - smooth) ** 2).sum(axis=1).mean()))
    assert away < 0.5 * 0.01 * np.sqrt(2.0), "nearer to the curve than the values are"
