"""Many ways beside their contours, measured together: what measuring one by one says, whatever is wrong with them."""

import numpy as np
import pytest

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths import manyfits
from stages.geometry.paths.arcpath import ArcPath, transform
from stages.geometry.paths.beside import Corners
from stages.geometry.paths.compensation import Fit, compensated, fit
from tests.near import assert_near
from tests.stages.write.patterns import drop, plate, sector, strip

HALF_MM = 0.1
PARTS = [plate(), sector(), strip(), drop()]
CONTOURS = [one.path for part in PARTS for one in (part.outer, *part.inner)]


def way(contour: ArcPath) -> ArcPath:
    made = compensated(contour, HALF_MM, Corners(mitred=False, least_mm=0.05))
    assert isinstance(made, ArcPath)
    return made


WAYS = [way(contour) for contour in CONTOURS]


def assert_same(found: list[Fit], contours: list[ArcPath], ways: list[ArcPath]) -> None:
    wanted = [fit(contour, one, HALF_MM) for contour, one in zip(contours, ways, strict=True)]
    for name in ("off_mm", "left_mm"):
        pairs = [[getattr(one, name) for one in some] for some in (found, wanted)]
        assert_near(*map(np.array, pairs), bound=1e-12, why="the same distances")


@pytest.mark.parametrize("few", [0, 40, 2048])
@pytest.mark.parametrize("block", [1, 100, 10_000])
def test_together_they_are_as_one_by_one(monkeypatch: pytest.MonkeyPatch, few: int, block: int) -> None:
    monkeypatch.setattr(manyfits, "FEW_PAIRS", few)
    monkeypatch.setattr(manyfits, "BLOCK", block)
    turned = [Rigid2(7.0 * number, -3.0, 20.0 * number) for number in range(len(CONTOURS))]
    contours, ways = ([transform(one, by) for one, by in zip(some, turned, strict=True)] for some in (CONTOURS, WAYS))
    assert_same(manyfits.fits(contours, ways, HALF_MM), contours, ways)


def test_one_way_that_is_moved_is_that_much_off_and_no_other() -> None:
    moved = [*WAYS]
    moved[1] = transform(WAYS[1], Rigid2(0.003, 0.0))
    found = manyfits.fits(CONTOURS, moved, HALF_MM)
    assert [number for number, one in enumerate(found) if one.off_mm > 1e-9] == [1]
    assert_near(found[1].off_mm, 0.003, bound=1e-4, why="amid a quarter of the hole, along the motion")


def test_a_way_that_is_far_from_its_contour_is_infinitely_off() -> None:
    found = manyfits.fits(CONTOURS[:1], [transform(WAYS[0], Rigid2(500.0, 0.0))], HALF_MM)
    assert found == [Fit(np.inf, np.inf)]


def test_no_contours_have_no_fits() -> None:
    assert manyfits.fits([], [], HALF_MM) == []
