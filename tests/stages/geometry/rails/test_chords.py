"""Chords of arcs of F = 0: whether rails meet at an end."""

import numpy as np
import pytest

from stages.geometry.rails.chords import shares_an_end
from tests.stages.geometry.rails.test_bound import chained

LOW = [[0.0, 0.0, 0.0], [50.0, 0.0, 0.0], [100.0, 30.0, 0.0]]


@pytest.mark.parametrize(
    ("first", "last", "shared"),
    [
        ([0.0, 0.0, 40.0], [100.0, 30.0, 40.0], False),
        ([0.0, 0.0, 0.0], [100.0, 30.0, 40.0], True),
        ([0.0, 0.0, 40.0], [100.0, 30.0, 0.0], True),
    ],
)
def test_rails_of_several_curves_share_an_end_where_they_begin_or_end(
    first: list[float], last: list[float], shared: bool
) -> None:
    """The joint in the middle is no end: there the rails are 40 mm apart, or meet, without a change."""
    for middle in ([50.0, 0.0, 40.0], [50.0, 0.0, 0.0]):
        assert shares_an_end(chained(np.array(LOW)), chained(np.array([first, middle, last]))) is shared
