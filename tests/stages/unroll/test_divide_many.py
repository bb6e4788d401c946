"""Parts of many turns: where each blank ends is looked for near the end of the one before, and is where it was."""

from collections.abc import Callable
from math import ceil, log2

import pytest

from stages.geometry.flat.development import develop
from stages.geometry.paths.arcpath import ArcPath
from stages.model.tolerances import Tolerances
from stages.unroll import divide
from stages.unroll.divide import Strip, runs, strip_of
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


def arcs_looked_at(monkeypatch: pytest.MonkeyPatch, look: Callable[[], object]) -> list[int]:
    """Return of how many arcs each outline is that is looked at for overlaps."""
    seen: list[int] = []

    def counted(path: ArcPath) -> float:
        seen.append(path.bulges.size)
        return doubled(path)

    doubled = divide.doubled
    with monkeypatch.context() as patch:
        patch.setattr(divide, "doubled", counted)
        look()
    return seen


def test_of_many_turns_a_few_are_looked_at_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not more than an eighth of the whole, or than twice a run, a twelfth; where the whole comes first it is seen."""
    flat = strip(60.0, 12.0, 1)
    whole = divide.run_outline(flat, 0, divide.STEPS).bulges.size
    assert (
        max(arcs_looked_at(monkeypatch, lambda: runs(flat, allowed=ALLOWED_MM2)))
        <= whole * max(1.0 / 8.0, 2.0 / 12.0) + ENDS
    )
    monkeypatch.setattr(divide, "LOOKED", (1,))
    assert max(arcs_looked_at(monkeypatch, lambda: longest(flat))) == whole


ENDS = 4
"""Both ends of a run, and where they cut an arc."""


def test_a_run_like_the_one_before_takes_two_looks_and_one_when_it_is_evened_out(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Every run of a helix is like the first but for a step; the last one ends where the strip does."""
    flat = strip(60.0, 12.0, 1)
    found = arcs_looked_at(monkeypatch, lambda: runs(flat, allowed=ALLOWED_MM2))
    count = len(runs(flat, allowed=ALLOWED_MM2))
    first, evened = len(divide.LOOKED) + log2(divide.STEPS), len(divide.LOOKED) + count
    assert count == 12
    assert len(found) <= first + 3 * (count - 1) + evened


@pytest.mark.parametrize(("turns", "count"), [(4.0, 4), (7.9, 8), (12.0, 12), (30.0, 30)])
def test_the_runs_of_a_helix_are_as_even_as_steps_permit(turns: float, count: int) -> None:
    """So many times the ceiling of an even share, the last one what is left."""
    ends = runs(strip(60.0, turns, 1), allowed=ALLOWED_MM2)
    each = ceil(divide.STEPS / count)
    assert ends == [*(each * number for number in range(1, count)), divide.STEPS]
