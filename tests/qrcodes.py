"""Reads a QR code of 21 or 25 modules by itself, from ISO/IEC 18004: for the tests of what is printed.

Nothing is corrected: where a syndrome is not zero, or the format is no word of its code, it fails.
"""

import numpy as np

Modules = np.ndarray
"""Dark modules as true, the upper row first."""

FORMAT_MASK, FORMAT_GENERATOR, FORMAT_BITS = 0x5412, 0x537, 15
FIELD = 0x11D
"""x^8 + x^4 + x^3 + x^2 + 1, in whose field the words are."""
TOTAL = {21: 26, 25: 44}
CORRECTING = {21: {1: 7, 0: 10, 3: 13, 2: 17}, 25: {1: 10, 0: 16, 3: 22, 2: 28}}
"""Words in a symbol, and how many of them correct the others, by the two bits of its level."""
BYTES = 0b0100
MASKS = (
    lambda x, y: (x + y) % 2,
    lambda x, y: y % 2,
    lambda x, y: x % 3,
    lambda x, y: (x + y) % 3,
    lambda x, y: (x // 3 + y // 2) % 2,
    lambda x, y: x * y % 2 + x * y % 3,
    lambda x, y: (x * y % 2 + x * y % 3) % 2,
    lambda x, y: ((x + y) % 2 + x * y % 3) % 2,
)


def read(modules: Modules) -> str:
    """Return the text of a code; `AssertionError` where it is none."""
    count = len(modules)
    assert modules.shape == (count, count)
    assert finder_like(modules), "three finders and two lines of timing"
    level, mask = _format(modules)
    words = _words(modules, mask)[: TOTAL[count]]
    correcting = CORRECTING[count][level]
    assert _syndromes(words, correcting) == [0] * correcting
    return _text(words[: len(words) - correcting])


def finder_like(modules: Modules) -> bool:
    """Return whether the corners and the lines between them are those of a code."""
    ring = np.ones((7, 7), dtype=bool)
    ring[1:6, 1:6] = False
    ring[2:5, 2:5] = True
    corners = [modules[:7, :7], modules[:7, -7:], modules[-7:, :7]]
    free = [modules[7, :8], modules[:8, 7], modules[7, -8:], modules[-8, :8], modules[:8, -8], modules[-8:, 7]]
    timing = [modules[6, 8:-8], modules[8:-8, 6]]
    beats = np.arange(len(modules) - 16) % 2 == 0
    return (
        all((corner == ring).all() for corner in corners)
        and not any(line.any() for line in free)
        and all((line == beats).all() for line in timing)
    )


def _format(modules: Modules) -> tuple[int, int]:
    """Return the bits of the level, and the number of the mask; both copies say the same."""
    n = len(modules)
    column = [(row, 8) for row in (0, 1, 2, 3, 4, 5, 7, 8)] + [(8, x) for x in (7, 5, 4, 3, 2, 1, 0)]
    other = [(8, n - 1 - i) for i in range(8)] + [(n - 7 + i, 8) for i in range(7)]
    assert modules[n - 8, 8], "the module that is always dark"
    found, again = (sum(int(modules[at]) << i for i, at in enumerate(places)) for places in (column, other))
    assert found == again
    word = found ^ FORMAT_MASK
    rest = word
    for shift in range(4, -1, -1):
        if rest >> (shift + 10) & 1:
            rest ^= FORMAT_GENERATOR << shift
    assert rest == 0, "no word of the code of formats"
    return word >> 13, word >> 10 & 7


def _words(modules: Modules, mask: int) -> list[int]:
    """Return the words in the order in which they stand, in pairs of columns from the right, up and down."""
    n = len(modules)
    bits = []
    for right in (*range(n - 1, 6, -2), 5, 3, 1):
        upward = (right + 1) & 2 == 0
        for step in range(n):
            y = n - 1 - step if upward else step
            bits += [bool(modules[y, x]) ^ (MASKS[mask](x, y) == 0) for x in (right, right - 1) if _is_free(n, x, y)]
    return [sum(bit << (7 - i) for i, bit in enumerate(bits[k : k + 8])) for k in range(0, len(bits) - 7, 8)]


def _is_free(n: int, x: int, y: int) -> bool:
    """Return whether a module holds a bit of a word."""
    corner = (x < 9 and y < 9) or (x >= n - 8 and y < 9) or (x < 9 and y >= n - 8)
    aligning = n > 21 and n - 9 <= x < n - 4 and n - 9 <= y < n - 4
    return not (corner or aligning or 6 in (x, y))


def _times(a: int, b: int) -> int:
    found = 0
    while b:
        found ^= a if b & 1 else 0
        a = a << 1 ^ (FIELD if a & 0x80 else 0)
        b >>= 1
    return found


def _syndromes(words: list[int], count: int) -> list[int]:
    """Return the values of the words as a polynomial at the powers of 2 that are its roots."""
    found, root = [], 1
    for _ in range(count):
        value = 0
        for word in words:
            value = _times(value, root) ^ word
        found.append(value)
        root = _times(root, 2)
    return found


def _text(words: list[int]) -> str:
    bits = "".join(f"{word:08b}" for word in words)
    assert int(bits[:4], 2) == BYTES
    count = int(bits[4:12], 2)
    return bytes(int(bits[12 + 8 * i : 20 + 8 * i], 2) for i in range(count)).decode("latin-1")
