"""Whole numbers in messages: as they were typed, up to where nobody would read them."""

import pytest

from pipeline.units import LARGEST, describe

WORDS = "a whole number of very many digits"


@pytest.mark.parametrize("sign", [1, -1])
def test_a_whole_number_is_shown_up_to_the_square_of_the_largest_length(sign: int) -> None:
    assert describe(sign * LARGEST) == str(sign * LARGEST)
    assert describe(sign * LARGEST**2) == str(sign * LARGEST**2)
    assert describe(sign * (LARGEST**2 + 1)) == WORDS
