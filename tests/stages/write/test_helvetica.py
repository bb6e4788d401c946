"""Texts in Helvetica: their widths by Adobe's own tables, their letters, their lines."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stages.write.helvetica import (
    BOLD,
    ENCODING,
    FIRST_CODE,
    MM_PER_POINT,
    REGULAR,
    THOUSANDTHS,
    Face,
    encoded,
    lost,
    width_mm,
    wrapped,
    written,
)
from tests.near import assert_near

ROUNDING = 1e-12
NAMES = {"A": "A", "i": "i", "m": "m", "0": "zero", "?": "question", "ä": "adieresis", "ß": "germandbls", "–": "endash",
         "€": "Euro", "×": "multiply", "²": "twosuperior", "°": "degree",
         "Ø": "Oslash", "'": "quotesingle"}  # fmt: skip


def adobe(face: Face) -> dict[str, int]:
    """Return widths by the names of the letters, from the tables that matplotlib brings along."""
    import matplotlib

    file = Path(matplotlib.get_data_path()) / "fonts/pdfcorefonts" / f"{face.name}.afm"
    rows = [line.split() for line in file.read_text("latin-1").splitlines() if line.startswith("C ")]
    return {row[7]: int(row[4]) for row in rows}


@pytest.mark.parametrize("face", [REGULAR, BOLD], ids=lambda face: face.name)
def test_letters_are_as_wide_as_adobe_says(face: Face) -> None:
    known = adobe(face)
    for letter, name in NAMES.items():
        assert face.widths[letter.encode(ENCODING)[0]] == known[name], letter


@pytest.mark.parametrize("face", [REGULAR, BOLD], ids=lambda face: face.name)
def test_every_letter_of_the_encoding_has_a_width_and_no_other(face: Face) -> None:
    for code in range(FIRST_CODE, 256):
        try:
            bytes([code]).decode(ENCODING)
        except UnicodeDecodeError:
            assert face.widths[code] == 0
        else:
            assert (face.widths[code] > 0) is (code != 127)


def test_a_text_is_as_wide_as_its_letters() -> None:
    thousandths = sum(REGULAR.widths[ord(letter)] for letter in "Blech")
    expected = thousandths / THOUSANDTHS * 10.0 * MM_PER_POINT
    assert_near(width_mm("Blech", 10.0), expected, bound=ROUNDING, why="the sum")


def test_umlauts_are_written_by_their_codes() -> None:
    assert encoded("Tür (3)") == r"(T\374r \(3\))"
    assert encoded("a\\b") == r"(a\\b)"


def test_an_umlaut_of_two_signs_is_one_letter() -> None:
    assert written("Tu\N{COMBINING DIAERESIS}r") == "Tür"


def test_letters_of_other_scripts_are_replaced_and_told() -> None:
    assert written("č Ж 日") == "c ? ?"
    assert lost("č Ж Ж 日 ü") == ["č", "Ж", "日"]
    assert lost("Tür – 3 × 4 m²") == []


def test_line_ends_and_control_signs_do_not_get_on_a_page() -> None:
    assert written("a\nb\tc") == "a b c"
    assert "\x07" not in written("a\x07b")


@given(st.text(max_size=60), st.floats(8.0, 80.0))
def test_no_line_is_wider_than_asked_for_and_no_letter_is_left_out(text: str, width: float) -> None:
    lines = wrapped(text, width, 9.0)
    assert all(width_mm(line, 9.0) <= width for line in lines)
    assert "".join(lines).replace(" ", "") == written(text).replace(" ", "")


def test_a_word_is_divided_only_where_it_is_wider_than_a_line() -> None:
    assert wrapped("left plate", width_mm("plate", 9.0) + 0.1, 9.0) == ["left", "plate"]
    assert len(wrapped("x" * 300, 50.0, 9.0)) > 1


@given(st.text(max_size=40))
def test_what_is_written_is_ascii_in_balanced_brackets(text: str) -> None:
    made = encoded(text)
    assert made.isascii()
    assert made.isprintable()
    assert made.startswith("(")
    assert made.endswith(")")
