"""Whether a rail is closed, as far as its data alone say so."""

import pytest

from stages.model.curves import ArcSpec, CurveSpec
from stages.model.rails import closes
from stages.model.scalars import Angle, Length, Number


def arc(start: int, end: int) -> CurveSpec:
    centre, normal = (Length(0), Length(0), Length(0)), (Number(0), Number(0), Number(1))
    return CurveSpec(arc=ArcSpec(center=centre, radius=Length(5), normal=normal, start=Angle(start), end=Angle(end)))


@pytest.mark.parametrize(
    ("start", "end", "closed"),
    [(0, 360, True), (90, 450, True), (-180, 180, True), (100, -260, True), (90, 270, False), (0, 359, False)],
)
def test_an_arc_closes_after_a_full_turn_wherever_it_starts(start: int, end: int, closed: bool) -> None:
    assert closes(arc(start, end)) is closed
