"""One comparison of numbers for all tests: bound and reason are part of the call, a failure shows both sides."""

from collections.abc import Iterable

import numpy as np

Numbers = float | Iterable[object]


def assert_near(actual: Numbers, expected: Numbers, *, bound: float, why: str) -> None:
    """Fail unless every |actual - expected| is at most `bound`, which `why` derives."""
    left, right = np.asarray(actual, dtype=float), np.asarray(expected, dtype=float)
    assert left.shape == right.shape, f"shapes differ: {left.shape} against {right.shape}"
    away = np.abs(left - right)
    if left.size and not (away <= bound).all():
        place = np.unravel_index(int(np.nanargmax(np.where(np.isnan(away), np.inf, away))), away.shape)
        raise AssertionError(
            f"{left[place]!r} is not within {bound:g} ({why}) of {right[place]!r}: "
            f"off by {away[place]:g} at {tuple(map(int, place))}"
        )


def assert_relative(actual: Numbers, expected: Numbers, *, bound: float, why: str) -> None:
    """Fail unless every |actual / expected - 1| is at most `bound`, which `why` derives."""
    right = np.asarray(expected, dtype=float)
    ratio = np.asarray(actual, dtype=float) / right
    try:
        assert_near(ratio, np.ones_like(right), bound=bound, why=why)
    except AssertionError as error:
        error.add_note(f"{np.asarray(actual, dtype=float)} against {right}")
        raise
