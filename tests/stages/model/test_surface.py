"""The part's v and the patches: there and back, also where spans do not begin at 0 nor have length 1."""

from dataclasses import replace
from fractions import Fraction

import pytest

from stages.model.surface import RuledSurface
from tests.parts import RIGHT_FRUSTUM, passage

SPANS = ((Fraction(3), Fraction(7, 2)), (Fraction(7, 2), Fraction(5)))


@pytest.fixture
def surface() -> RuledSurface:
    made = passage(RIGHT_FRUSTUM).surface
    assert isinstance(made, RuledSurface)
    return replace(made, patches=made.patches * 2, spans=SPANS)


@pytest.mark.parametrize(
    ("v", "place"),
    [
        (3.0, (0, 0.0)),
        (3.125, (0, 0.25)),
        (3.5, (0, 1.0)),
        (3.875, (1, 0.25)),
        (5.0, (1, 1.0)),
        (2.9, (0, 0.0)),
        (6.0, (1, 1.0)),
    ],
)
def test_a_place_by_the_parts_v_lies_on_its_patch_and_within_it(
    surface: RuledSurface, v: float, place: tuple[int, float]
) -> None:
    assert surface.place_of(v) == place
    if 3.0 <= v <= 5.0:
        assert surface.v_of(*place) == v
