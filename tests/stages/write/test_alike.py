"""Whether paths are alike vertex by vertex: many pairs at once, each judged by itself."""

import numpy as np
import pytest

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, transform
from stages.write.alike import SHARE, are_alike
from tests.stages.write.patterns import plate, sector, strip

NEAR_MM = 1e-6
PATHS = [one.path for part in (plate(), sector(), strip()) for one in (part.outer, *part.inner)]


def judged(found: list[ArcPath]) -> list[bool]:
    verdict: list[bool] = are_alike(list(zip(found, PATHS, strict=True)), np.full(len(PATHS), NEAR_MM)).tolist()
    return verdict


def with_bulge(path: ArcPath, more: float) -> ArcPath:
    return path.replace(bulges=path.bulges + more * (np.arange(path.bulges.size) == 1))


@pytest.mark.parametrize("number", range(len(PATHS)))
def test_one_that_is_moved_is_seen_and_no_other(number: int) -> None:
    for by, alike in ((0.9 * SHARE * NEAR_MM, True), (1.1 * SHARE * NEAR_MM, False)):
        found = [*PATHS]
        found[number] = transform(PATHS[number], Rigid2(0.0, by))
        assert judged(found) == [alike or other != number for other in range(len(PATHS))]


def test_a_bulge_counts_by_how_far_it_moves_an_arc() -> None:
    wide = float(np.ptp(PATHS[0].vertices, axis=0).sum())
    for by, alike in ((0.9 * SHARE * NEAR_MM / wide, True), (1.1 * SHARE * NEAR_MM / wide, False)):
        assert judged([with_bulge(PATHS[0], by), *PATHS[1:]])[0] is alike


def test_paths_of_other_counts_are_never_alike_and_deep_arcs_are_not_judged_so() -> None:
    assert not any(judged([*PATHS[1:], PATHS[0]])[:2])
    deep = PATHS[0].replace(bulges=np.full(4, 1.1))
    assert are_alike([(deep, deep)], np.array([NEAR_MM])).tolist() == [False]


def test_no_pairs_have_no_verdict() -> None:
    assert are_alike([], np.zeros(0)).shape == (0,)
