"""Stock: what counts as a plain rectangle."""

from dataclasses import replace

import numpy as np
import pytest

from stages.geometry.paths.arcpath import ArcPath
from stages.model.sheet import Sheet, Zone

PLATE = Sheet("plate", 200.0, 100.0)
CORNER = ArcPath(np.array([[0.0, 0.0], [20.0, 0.0], [0.0, 20.0]]), np.zeros(3), closed=True)


def test_a_sheet_is_a_rectangle() -> None:
    assert PLATE.is_rectangle
    assert replace(PLATE, kind="remnant", quantity=1, edge_gap_mm=5.0).is_rectangle


@pytest.mark.parametrize(
    "change",
    [{"kind": "roll"}, {"outline": CORNER}, {"defects": (CORNER,)}, {"zones": (Zone(CORNER, 2),)}],
)
def test_what_is_open_or_has_an_outline_defects_or_zones_is_none(change: dict[str, object]) -> None:
    assert not replace(PLATE, **change).is_rectangle
