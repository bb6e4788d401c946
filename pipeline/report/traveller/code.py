"""The id of a page as a QR code (ISO/IEC 18004), beside its letters: what a scanner reads is what a person reads there.

Dark squares of `MODULE_MM` on the white of the paper, of which `QUIET_MM` stay free all around, as the standard wants.
The symbol is segno's: the smallest that holds the text, with the most correction of errors that this one has room for.
Ids of up to 17 signs take one of 21 modules.  The mask is not chosen by the standard's rules of penalty, as that takes
four times as long as all the rest: a reader reads any, and this is the one that they choose for half of all ids.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import groupby

from pipeline.report.traveller.ink import INK, filled

MODULE_MM = 0.5
"""What a phone reads from a hand's breadth, and a laser printer of 300 dots an inch prints as six of them."""

QUIET_MM = 4.0 * MODULE_MM
MASK = 2
KEPT = 8
"""The pages of a part have one id."""


@dataclass(frozen=True, slots=True)
class Code:
    """A QR code: its side without what stays free around it, mm; operators that draw it from its lower left corner."""

    side_mm: float
    content: str


@lru_cache(maxsize=KEPT)
def code_of(text: str) -> Code:
    """Return the code of a text."""
    from segno import make_qr

    rows = make_qr(text, error="l", mode="byte", mask=MASK, boost_error=True).matrix
    runs = " ".join(_runs(rows))
    return Code(MODULE_MM * len(rows), f"q {MODULE_MM} 0 0 {MODULE_MM} 0 0 cm {filled(INK)} {runs} f Q\n")


def _runs(rows: Sequence[bytearray]) -> Iterator[str]:
    """Yield dark modules beside each other as rectangles, row by row from the top: together they are one path."""
    for up, row in zip(range(len(rows) - 1, -1, -1), rows, strict=True):
        at = 0
        for dark, run in groupby(row):
            count = sum(1 for _ in run)
            if dark:
                yield f"{at} {up} {count} 1 re"
            at += count
