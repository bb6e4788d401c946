"""Random surfaces of the kinds that follow from one curve, admissible by design; the same ones moved and turned back.

Space curves have r' = (1, b s, c s^2 / 2) with b, c > 0 over an uneven parameter s(v): curvature and torsion wherever s
runs on.  Plane curves are convex.  Normals are those of a bowl, which has no direction without curvature.
"""

from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import pairwise

from hypothesis import strategies as st

from tests.inflections import control_points, rising
from tests.parts import Table
from tests.strategies import Motion, decimals, texts

Rows = list[list[str]]
Reach = Callable[[Fraction], Fraction]


def space_curves(places: st.SearchStrategy[list[str]]) -> st.SearchStrategy[Rows]:
    """Return control points of curves whose curvature vanishes at these places, 1 to 2 long over [0, 1] of s."""
    factor = decimals(0.5, 1.5, 2)

    def made(b: Fraction, c: Fraction, at: list[str], speed: Fraction) -> Rows:
        s = rising(at) if at else [Fraction(0), speed, 1 - speed]
        return control_points(([1], [0, b], [0, 0, c / 2]), s)

    return st.builds(made, factor, factor, places, decimals(0.3, 0.7, 2))


EVERYWHERE_BENT: st.SearchStrategy[list[str]] = st.just([])
BENT_BACK = st.sampled_from([["0.3"], ["0.7", "0.7"], ["1/3", "2/3"], ["0"], ["1", "1"]])


def straps() -> st.SearchStrategy[Table]:
    """Return straps, half of them through inflections."""
    return st.builds(
        lambda rows, half: {"kind": "strap", "centre": {"bezier": rows}, "half_width": str(half)},
        space_curves(st.one_of(EVERYWHERE_BENT, BENT_BACK)), decimals(0.005, 0.04),
    )  # fmt: skip


def tangents() -> st.SearchStrategy[Table]:
    """Return tangent surfaces on either side of their edge, or beginning on it."""
    reach = st.tuples(decimals(0, 3, 1), decimals(0.1, 3, 1), st.sampled_from([1, -1]))
    return st.builds(
        lambda rows, reach: {"kind": "tangent", "edge": {"bezier": rows}, "from": str(reach[2] * reach[0]),
                             "to": str(reach[2] * (reach[0] + reach[1]))},
        space_curves(EVERYWHERE_BENT), reach,
    )  # fmt: skip


def slopes() -> st.SearchStrategy[Table]:
    """Return slopes that open: on the outside of a convex curve, which turns to the right."""
    step, height = decimals(0.1, 4, 1), decimals(0.5, 4, 1)

    def made(x: tuple[Fraction, ...], y: tuple[Fraction, ...], angle: int, length: Fraction) -> Table:
        rows = [[Fraction(0)] * 3, [x[0], y[0], Fraction(0)], [x[0] + x[1], y[0] * Fraction(9, 10), Fraction(0)],
                [sum(x), Fraction(0), Fraction(0)]]  # fmt: skip
        return {"kind": "slope", "curve": {"bezier": [texts(row) for row in rows]}, "angle": str(angle), "side": "in",
                "length": str(length), "normal": ["0", "0", "1"]}  # fmt: skip

    return st.builds(made, st.tuples(step, step, step), st.tuples(height), st.integers(-85, 85), decimals(0.2, 5, 1))


def ribbons() -> st.SearchStrategy[Table]:
    """Return bands of a bowl z = (a x^2 + b y^2) / 2 along a slanting way, at uneven places."""
    bowl, steps = decimals(0.1, 0.4, 2), st.lists(decimals(0.2, 0.6, 2), min_size=5, max_size=7)

    def made(a: Fraction, b: Fraction, steps: list[Fraction], slant: Fraction, widths: tuple[Fraction, ...]) -> Table:
        x = [sum(steps[:k], Fraction(-1)) for k in range(len(steps) + 1)]
        points = [(t, slant * t + t * t / 10) for t in x]
        rows = [texts([p, q, (a * p * p + b * q * q) / 2]) for p, q in points]
        normals = [texts([-a * p, -b * q, Fraction(1)]) for p, q in points]
        return {"kind": "ribbon", "curve": {"points": rows}, "normals": normals, "widths": texts(widths)}

    width = decimals(0.05, 0.3, 2)
    return st.builds(made, bowl, bowl, steps, decimals(-1, 1, 1), st.tuples(width, width))


def bezier_pairs() -> st.SearchStrategy[Table]:
    """Return pairs over curves that run on in x, their first ruling upwards, the edge of regression outside."""
    row = st.tuples(decimals(0.2, 2, 1), decimals(-0.5, 0.5, 1), decimals(-0.5, 0.5, 1))
    shares = st.sampled_from([("2", "3"), ("3", "2"), ("-1", "-2"), ("-2", "-1"), ("1.5", "2.5")])

    def made(steps: list[tuple[Fraction, ...]], shares: tuple[str, str], elevate: int) -> Table:
        points = [[sum((step[k] for step in steps[:i]), Fraction(0)) for k in range(3)] for i in range(len(steps) + 1)]
        return {"kind": "bezier-pair", "points": [texts(row) for row in points], "first": ["0.1", "0.5", "6"],
                "lambda": shares[0], "mu": shares[1], "elevate": elevate}  # fmt: skip

    return st.builds(made, st.lists(row, min_size=2, max_size=4), shares, st.integers(0, 1))


ADMISSIBLE = {"strap": straps(), "tangent": tangents(), "slope": slopes(), "ribbon": ribbons(),
              "bezier-pair": bezier_pairs()}  # fmt: skip
POINTS = ("points", "first", "centre", "edge", "curve")
LENGTHS = ("half_width", "length", "from", "to", "widths")
DIRECTIONS = ("normal", "normals")


def mapped(table: Table, keys: Sequence[str], change: Callable[[list[Fraction]], list[Fraction]]) -> Table:
    """Return the table with every row of numbers under these keys changed."""

    def through(value: object) -> object:
        if isinstance(value, dict):
            return {key: through(inner) for key, inner in value.items()}
        if isinstance(value, list) and isinstance(value[0], list):
            return [through(inner) for inner in value]
        row = value if isinstance(value, list) else [value]
        made = texts(change([Fraction(str(x)) for x in row]))
        return made if isinstance(value, list) else made[0]

    return {key: through(value) if key in keys else value for key, value in table.items()}


def grown(table: Table, factor: Fraction) -> Table:
    """Return the same shape in another size."""
    return mapped(table, POINTS + LENGTHS, lambda row: [factor * x for x in row])


def carried(table: Table, motion: Motion) -> Table:
    """Return the same shape elsewhere."""
    rows, shift = motion

    def turned(row: list[Fraction]) -> list[Fraction]:
        return [sum((a * x for a, x in zip(axis, row, strict=True)), Fraction(0)) for axis in rows]

    there = mapped(table, POINTS, lambda row: [x + d for x, d in zip(turned(row), shift, strict=True)])
    return mapped(there, DIRECTIONS, turned)


def turned_back(table: Table) -> Table:
    """Return the same surface by its curve run from end to start."""
    match table["kind"]:
        case "strap":
            return table | {"centre": _back(table["centre"])}
        case "tangent":
            ends = {key: str(-Fraction(str(table[key]))) for key in ("from", "to")}
            return table | {"edge": _back(table["edge"])} | ends
        case "slope":
            return table | {"curve": _back(table["curve"]), "side": "out"}
        case "ribbon":
            turned = {key: list(reversed(table[key])) for key in ("normals", "widths")}  # type: ignore[call-overload]
            return table | {"curve": _back(table["curve"])} | turned
    return _pair_back(table)


def _back(curve: object) -> Table:
    assert isinstance(curve, dict)
    return {key: rows[::-1] for key, rows in curve.items()}


def _pair_back(table: Table) -> Table:
    """Return the pair from its last ruling: 1 - lambda, 1 - mu, and the last point of the other curve."""
    rows = [[Fraction(x) for x in row] for row in table["points"]]  # type: ignore[attr-defined]
    L, M = Fraction(str(table["lambda"])), Fraction(str(table["mu"]))
    for _ in range(int(str(table["elevate"]))):
        n = len(rows)
        inner = [[Fraction(i, n) * a + (1 - Fraction(i, n)) * b for a, b in zip(rows[i - 1], rows[i], strict=True)]
                 for i in range(1, n)]  # fmt: skip
        rows = [rows[0], *inner, rows[-1]]
    d = [Fraction(str(x)) for x in table["first"]]  # type: ignore[attr-defined]
    for a, b in pairwise(rows):
        d = [((1 - L) * x + L * y - (1 - M) * z) / M for x, y, z in zip(a, b, d, strict=True)]
    back = {"points": table["points"][::-1], "first": texts(d)}  # type: ignore[index]
    return table | back | {"lambda": str(1 - L), "mu": str(1 - M)}
