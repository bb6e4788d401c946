"""Texts in Helvetica and Helvetica Bold: how wide they are, in lines of what width, as PDF writes them.

Both are among the typefaces that every reader of PDF has, or replaces by one of the same widths.  Their letters are
those of the encoding WinAnsi (Windows code page 1252): Western Europe.  A letter that it does not have is replaced, by
the letter below its accent if that is known and by a question mark if not, and `lost` tells which letters that are.

Widths in thousandths of the size: Adobe's metrics of the typefaces (Core 14 AFM files, version 002.000 of 1989 to
1997), codes 32 to 255; 0 where the encoding has no letter.
"""

import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

ENCODING = "cp1252"
FIRST_CODE = 32
THOUSANDTHS = 1000.0
MM_PER_POINT = 25.4 / 72.0
CAPITALS = 0.718
DESCENT = 0.207
"""Height of a capital and depth of the letters that go below the line, over the size."""

ELSEWHERE = "?"
KEPT = 4096
"""Texts of which the letters and the width are kept: a cell is measured, placed and written, and many come again."""


@dataclass(frozen=True, slots=True, eq=False)
class Face:
    """A typeface: what pages call it, its name in PDF, and the width of each letter."""

    key: str
    name: str
    widths: tuple[int, ...]


def _face(key: str, name: str, widths: str) -> Face:
    return Face(key, name, (0,) * FIRST_CODE + tuple(int(width) for width in widths.split()))


REGULAR = _face(
    "R",
    "Helvetica",
    """
278 278 355 556 556 889 667 191 333 333 389 584 278 333 278 278 556 556 556 556 556 556 556 556 556 556 278 278
584 584 584 556 1015 667 667 722 722 667 611 778 722 278 500 667 556 833 722 778 667 778 722 667 611 722 667 944
667 667 611 278 278 278 469 556 333 556 556 500 556 556 278 556 556 222 222 500 222 833 556 556 556 556 333 500
278 556 500 722 500 500 500 334 260 334 584 0 556 0 222 556 333 1000 556 556 333 1000 667 333 1000 0 611 0 0 222
222 333 333 350 556 1000 333 1000 500 333 944 0 500 667 278 333 556 556 556 556 260 556 333 737 370 556 584 333
737 333 400 584 333 333 333 556 537 278 333 333 365 556 834 834 834 611 667 667 667 667 667 667 1000 722 667 667
667 667 278 278 278 278 722 722 778 778 778 778 778 584 778 722 722 722 722 667 667 611 556 556 556 556 556 556
889 500 556 556 556 556 278 278 278 278 556 556 556 556 556 556 556 584 611 556 556 556 556 500 556 500
""",
)
BOLD = _face(
    "B",
    "Helvetica-Bold",
    """
278 333 474 556 556 889 722 238 333 333 389 584 278 333 278 278 556 556 556 556 556 556 556 556 556 556 333 333
584 584 584 611 975 722 722 722 722 667 611 778 722 278 556 722 611 833 722 778 667 778 722 667 611 722 667 944
667 667 611 333 278 333 584 556 333 556 611 556 611 556 333 611 611 278 278 556 278 889 611 611 611 611 389 556
333 611 556 778 556 556 500 389 280 389 584 0 556 0 278 556 500 1000 556 556 333 1000 667 333 1000 0 611 0 0 278
278 500 500 350 556 1000 333 1000 556 333 944 0 500 667 278 333 556 556 556 556 280 556 333 737 370 556 584 333
737 333 400 584 333 333 333 611 556 278 333 333 365 556 834 834 834 611 722 722 722 722 722 722 1000 722 667 667
667 667 278 278 278 278 722 722 778 778 778 778 778 584 778 722 722 722 722 667 667 611 556 556 556 556 556 556
889 556 556 556 556 556 278 278 278 278 611 611 611 611 611 611 611 584 611 611 611 611 611 556 611 556
""",
)


@lru_cache(maxsize=KEPT)
def written(text: str) -> str:
    """Return a text in letters that the typefaces have: line ends and tabs as spaces, others replaced."""
    plain = _plain(text)
    return plain if _is_known(plain) else "".join(map(_letter, plain))


def lost(text: str) -> list[str]:
    """Return the letters of a text that are replaced, each once, in its order."""
    return [letter for letter in dict.fromkeys(_plain(text)) if _letter(letter) != letter]


def _plain(text: str) -> str:
    """Return a text with its accents on their letters, in one line."""
    return " ".join((text if text.isascii() else unicodedata.normalize("NFC", text)).split())


def _letter(letter: str) -> str:
    """Return a letter, or what stands for it."""
    known = (candidate for candidate in (letter, unicodedata.normalize("NFD", letter)[0]) if _is_known(candidate))
    return next(known, ELSEWHERE)


def _is_known(text: str) -> bool:
    """Return whether the typefaces have all letters of a text."""
    if not text.isprintable() or text.isascii():
        return text.isprintable()
    try:
        text.encode(ENCODING)
    except UnicodeEncodeError:
        return False
    return True


def width_mm(text: str, size_pt: float, face: Face = REGULAR) -> float:
    """Return how wide a text is, in mm; kerning is not applied, as readers of PDF do not."""
    return _thousandths(text, face) / THOUSANDTHS * size_pt * MM_PER_POINT


@lru_cache(maxsize=KEPT)
def _thousandths(text: str, face: Face) -> int:
    return sum(map(face.widths.__getitem__, _codes(text)))


def _codes(text: str) -> bytes:
    """Return the codes of the letters of a text as they are written."""
    plain = written(text)
    return plain.encode("ascii" if plain.isascii() else ENCODING)


def wrapped(text: str, width: float, size_pt: float, face: Face = REGULAR) -> list[str]:
    """Return the lines of a text, none wider than that (mm); words are divided only where they alone are wider."""
    plain = written(text)
    if width_mm(plain, size_pt, face) <= width:
        return [plain]
    made = [""]
    for piece in _pieces(plain.split(" "), width, size_pt, face):
        longer = f"{made[-1]} {piece}" if made[-1] else piece
        if width_mm(longer, size_pt, face) <= width:
            made[-1] = longer
        else:
            made.append(piece)
    return made if made[0] else made[1:]


def _pieces(words: list[str], width: float, size_pt: float, face: Face) -> Iterator[str]:
    """Yield words, those that are wider than a line in pieces that fill it."""
    for word in words:
        if width_mm(word, size_pt, face) <= width:
            yield word
            continue
        piece = ""
        for letter in word:
            if piece and width_mm(piece + letter, size_pt, face) > width:
                yield piece
                piece = ""
            piece += letter
        yield piece


def encoded(text: str) -> str:
    """Return a text as PDF writes it: ASCII, other letters by their octal codes."""
    return f"({_codes(text).decode('latin-1').translate(ESCAPES)})"


def _escape(code: int) -> str:
    letter = chr(code)
    if letter in "\\()":
        return "\\" + letter
    return letter if letter.isascii() and letter.isprintable() else f"\\{code:03o}"


ESCAPES = {code: _escape(code) for code in range(256)}
"""How each letter stands in a string of PDF, by its code."""
