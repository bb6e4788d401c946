"""Numbers that a format shows, and where they may come from: every number of a report made a different one first.

Counts of what is listed (up to `MOST_COUNTED`) are no numbers of the report; all numbers put in are larger.
"""

import re
from collections.abc import Callable, Iterable, Iterator

NUMBER = re.compile(r"(?<![\w.])[-\N{MINUS SIGN}]?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?![\w.]*\d)")
MOST_COUNTED = 40
FIRST, STEP = 101.0, 3.7317
KEPT = frozenset(("index", "copy", "where", "schema", "provenance", "run", "colour"))
"""Keys of which the values stay: what other files are found by, and what nobody shows."""


def distinct(report: object) -> object:
    """Return a report in which no two numbers are alike, all above 100; whole ones stay whole."""
    counted = iter(range(10**6))

    def changed(value: object) -> object:
        if isinstance(value, dict):
            return {key: item if key in KEPT else _wordless(key, changed(item)) for key, item in value.items()}
        if isinstance(value, list):
            return [changed(item) for item in value]
        if isinstance(value, bool) or not isinstance(value, int | float):
            return value
        number = next(counted)
        return int(FIRST) + 2 * number if isinstance(value, int) else FIRST + STEP * number

    return changed(report)


def _wordless(key: str, item: object) -> object:
    """Return a message without its numbers: they are texts of the report already."""
    return "words" if key == "message" else item


def numbers_of(document: object) -> Iterator[float]:
    """Yield every number of a document."""
    if isinstance(document, dict | list):
        for item in document.values() if isinstance(document, dict) else document:
            yield from numbers_of(item)
    elif isinstance(document, int | float) and not isinstance(document, bool):
        yield document


def told(texts: Iterable[str]) -> list[str]:
    """Return the numbers in some texts, counts left out."""
    found = [one.replace("\N{MINUS SIGN}", "-") for text in texts for one in NUMBER.findall(text)]
    return [one for one in found if not (one.isdigit() and int(one) <= MOST_COUNTED)]


def foreign(shown: Iterable[str], document: object, ways: Iterable[Callable[[float], str]]) -> list[str]:
    """Return the numbers that are not those of a document in one of the ways to write them."""
    listed = [*ways]
    known = {way(number) for number in numbers_of(document) for way in listed}
    return [one for one in shown if one not in known]
