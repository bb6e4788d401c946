"""Units: closed forms, exact, and what is refused."""

from decimal import Decimal
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pipeline.units import LARGEST, UnreadableError, describe, quantity
from stages.model.scalars import Angle, Curvature, Length, Number


@pytest.mark.parametrize(
    ("text", "unit", "wanted"),
    [
        ("1/8 in", "mm", Fraction(127, 40)),
        ("1 1/2 in", "mm", Fraction(381, 10)),
        ("-1 1/2 in", "mm", -Fraction(381, 10)),
        ('3"', "mm", Fraction(381, 5)),
        ("3.5mm", "in", Fraction(7, 2)),
        ("  3.5 mm ", "in", Fraction(7, 2)),
        ("1/3", "mm", Fraction(1, 3)),
        ("1/3", "in", Fraction(127, 15)),
        ("1e-3 m", "mm", Fraction(1)),
        (".5 ft", "mm", Fraction(762, 5)),
        ("12 um", "mm", Fraction(12, 1000)),
        (Decimal("0.1"), "mm", Fraction(1, 10)),
        (Decimal("0.1"), "m", Fraction(100)),
        (2, "cm", Fraction(20)),
        (0.1, "mm", Fraction(1, 10)),
    ],
)
def test_a_length_is_exact_in_mm(text: object, unit: str, wanted: Fraction) -> None:
    read = quantity(Length, text, unit)
    assert type(read) is Length
    assert read == wanted


@pytest.mark.parametrize(
    ("text", "unit", "wanted"),
    [
        (Decimal("0.02"), "mm", Fraction(1, 50)),
        (1, "in", Fraction(5, 127)),
        ("1/2 1/in", "mm", Fraction(5, 254)),
        ("2 /m", "mm", Fraction(1, 500)),
        ("0.02 1/mm", "in", Fraction(1, 50)),
    ],
)
def test_a_bare_curvature_is_scaled_by_the_inverse_unit(text: object, unit: str, wanted: Fraction) -> None:
    assert quantity(Curvature, text, unit) == wanted


def test_angles_are_degrees_and_radians_are_rounded_far_below_a_double() -> None:
    assert quantity(Angle, "12 deg") == 12
    assert quantity(Angle, 30, "in") == 30
    assert abs(quantity(Angle, "1 rad") - Fraction("57.29577951308232087679815481410517")) < Fraction(1, 10**30)


def test_plain_numbers_have_no_unit() -> None:
    assert quantity(Number, "1/3", "in") == Fraction(1, 3)


@pytest.mark.parametrize(
    ("sort", "value", "message"),
    [
        (Length, "nan", '"nan" is not a number with a unit'),
        (Length, Decimal("NaN"), "nan is not a finite number"),
        (Length, Decimal("-Infinity"), "-inf is not a finite number"),
        (Length, float("inf"), "inf is not a finite number"),
        (Length, Decimal("1e999999"), "1E+999999 has absurdly many digits or an absurd exponent"),
        (Length, "1e99999999999999999999", "1e99999999999999999999 has an absurd exponent"),
        (Length, Decimal("1e-999999"), "1E-999999 has absurdly many digits or an absurd exponent"),
        pytest.param(Length, 10**5000, "a whole number of very many digits is absurdly large", id="googol"),
        (Length, 10**9 + 1, "1000000001 is absurdly large"),
        (Length, "1000001 m", '"1000001 m" is absurdly large'),
        (Length, "3 deg", 'the unit "deg" is that of an angle in degrees'),
        (Length, "3 1/mm", 'the unit "1/mm" is that of a curvature'),
        (Length, "3 furlong", 'unknown unit "furlong"'),
        (Length, "12,5 mm", '"12,5 mm" has a comma in its number'),
        (Length, "1/0 in", '"1/0 in" divides by zero'),
        (Length, "twelve", '"twelve" is not a number with a unit'),
        (Length, "", '"" is not a number with a unit'),
        (Length, True, "true where a length belongs"),
        (Length, [1], "an array of 1 where a length belongs"),
        (Curvature, "3 mm", 'the unit "mm" is that of a length'),
        (Angle, "3 mm", 'the unit "mm" is that of a length'),
        (Number, "3 mm", 'the unit "mm" is that of a length'),
        (Number, None, "nothing (null) where a number without unit belongs"),
    ],
)
def test_what_is_no_such_quantity_is_refused_in_words(sort: type[Length], value: object, message: str) -> None:
    with pytest.raises(UnreadableError) as caught:
        quantity(sort, value)
    assert caught.value.message == message
    assert "such as" in caught.value.hint


@given(st.text(max_size=30) | st.decimals() | st.floats() | st.integers())
def test_no_value_at_all_breaks_the_reader(value: object) -> None:
    try:
        assert abs(quantity(Length, value)) <= LARGEST
    except UnreadableError as error:
        assert error.message.isprintable()


@given(st.floats(-1e8, 1e8, allow_subnormal=False).filter(lambda value: value == 0.0 or abs(value) >= 1e-20))
def test_a_double_comes_back_as_it_was(value: float) -> None:
    assert float(quantity(Length, Decimal(repr(value)))) == value


def test_long_texts_are_shortened_and_control_characters_masked() -> None:
    assert describe("a" * 100) == '"' + "a" * 56 + "..."
    assert describe("a\nb") == '"a?b"'
