"""Parts of many turns: where each blank ends is looked for near the end of the one before, and is where it was."""

from collections.abc import Callable

import pytest

from stages.geometry.flat.development import develop
from stages.geometry.paths.arcpath import ArcPath
from stages.model.tolerances import Tolerances
from stages.unroll import divide
from stages.unroll.divide import Strip, strip_of
from tests.stages.unroll.test_divide import helix_strip

ALLOWED_MM2 = Tolerances().chord_mm ** 2
ANY = 1000
"""More runs than there are."""


def by_bisection(good: Callable[[int], bool], _near: int, first: int, last: int) -> tuple[int, int]:
    """Look at all that is left first, as where nothing is known of how long a run may be."""
    return (last, last) if good(last) else (first, last)


def strip(pitch: float, turns: float, pieces: int) -> Strip:
    return strip_of(develop(helix_strip(100.0, pitch, turns, pieces=pieces).patches))


def longest(flat: Strip, count: int = ANY) -> list[int] | None:
    """Return the runs that are as long as can be, one after the other."""
    return divide._greedy(flat, float(flat.area[-1]), ALLOWED_MM2, count)


@pytest.mark.parametrize(("pitch", "turns", "pieces"), [(60.0, 2.2, 1), (300.0, 2.5, 2)])
def test_the_ends_are_those_that_bisection_of_the_whole_finds(
    monkeypatch: pytest.MonkeyPatch, pitch: float, turns: float, pieces: int
) -> None:
    flat = strip(pitch, turns, pieces)
    found = longest(flat)
    monkeypatch.setattr(divide, "_around", by_bisection)
    assert longest(flat) == found is not None
    assert len(found) > 2


def test_no_more_runs_are_looked_for_than_there_may_be() -> None:
    flat = strip(60.0, 1.5, 1)
    found = longest(flat)
    assert found is not None
    assert longest(flat, len(found)) == found
    assert longest(flat, len(found) - 1) is None


def test_what_is_left_is_looked_at_as_a_whole_but_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """By the arcs of all that is looked at: those of most of the whole once, by bisection for every other run too."""
    flat = strip(60.0, 4.0, 1)
    seen: list[int] = []

    def counted(path: ArcPath) -> float:
        seen.append(path.bulges.size)
        return doubled(path)

    def most_of_it() -> int:
        seen.clear()
        longest(flat)
        return sum(size > 0.6 * max(seen) for size in seen)

    doubled = divide.doubled
    monkeypatch.setattr(divide, "doubled", counted)
    assert most_of_it() == 1
    monkeypatch.setattr(divide, "_around", by_bisection)
    assert most_of_it() == 2
