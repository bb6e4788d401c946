"""Random ruled patches by a seed: general ones, and developable ones of every sort, moved off as little as wanted."""

import random
from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import pairwise
from math import hypot, sqrt

from stages.geometry.curves.curves import Bezier, RationalBezier, bezier, elevated, rational
from stages.geometry.ruled.ruled import RuledPatch, between
from tests.parts import Table, patches

Rows = list[list[Fraction]]
Pair = tuple[Rows, Rows]


def wavy(rng: random.Random, degree: int) -> Rows:
    """Return a curve along x that bends to all sides, decimals of three places."""
    return [[Fraction(round(x * 1000), 1000) for x in (10 * i / degree, rng.uniform(-2, 2), rng.uniform(-2, 2))]
            for i in range(degree + 1)]  # fmt: skip


def cone(rng: random.Random, degree: int) -> Pair:
    rows, apex = wavy(rng, degree), [Fraction(5), Fraction(rng.randint(-3, 3)), Fraction(12)]
    return rows, [[x + (a - x) * Fraction(2, 5) for x, a in zip(row, apex, strict=True)] for row in rows]


def cylinder(rng: random.Random, degree: int) -> Pair:
    rows, d = wavy(rng, degree), [Fraction(rng.randint(-1, 1)), Fraction(1, 4), Fraction(6)]
    return rows, [[x + a for x, a in zip(row, d, strict=True)] for row in rows]


def aumann_pair(rng: random.Random, degree: int) -> Pair:
    L, M = rng.choice([(Fraction(9, 5), Fraction(23, 10)), (Fraction(-1), Fraction(-2)), (Fraction(3), Fraction(5, 2))])
    c = wavy(rng, degree)
    d = [[c[0][0], c[0][1] + 1, c[0][2] + 5]]
    for a, b in pairwise(c):
        d.append([((1 - L) * x + L * y - (1 - M) * z) / M for x, y, z in zip(a, b, d[-1], strict=True)])
    return c, d


def tangent_part(rng: random.Random, degree: int) -> Pair:
    """Return r + r' / 4 and r + 3 r' / 4: part of the tangent surface of r."""
    r = wavy(rng, degree)
    slopes = [[degree * (b - a) for a, b in zip(p, q, strict=True)] for p, q in pairwise(r)]
    raised = elevated(tuple((x, y, z) for x, y, z in slopes), degree)
    near, far = ([[x + share * y for x, y in zip(p, q, strict=True)] for p, q in zip(r, raised, strict=True)]
                 for share in (Fraction(1, 4), Fraction(3, 4)))  # fmt: skip
    return near, far


def theorem_2_2_pair(rng: random.Random, degree: int) -> Pair:
    (patch,) = patches(theorem_2_2(rng.randrange(10**6)))
    assert isinstance(patch.c0, Bezier)
    assert isinstance(patch.c1, Bezier)
    return [list(p) for p in patch.c0.exact], [list(p) for p in patch.c1.exact]


def general(rng: random.Random, degree: int) -> Pair:
    """Return directrices that have nothing to do with each other, of different degrees."""
    return wavy(rng, degree), [[x, y + Fraction(1, 2), z + 6] for x, y, z in wavy(rng, rng.randint(1, 9))]


DEVELOPABLE: tuple[Callable[[random.Random, int], Pair], ...] = (
    cone, cylinder, aumann_pair, tangent_part, theorem_2_2_pair,
)  # fmt: skip


def theorem_2_2(seed: int) -> Table:
    """Return a cylinder with data as one types them."""
    rng = random.Random(seed)

    def decimals(low: float, high: float) -> str:
        return f"{rng.uniform(low, high):.4f}"

    def unit() -> list[str]:
        direction = [rng.gauss(0, 1) for _ in range(3)]
        length = sqrt(sum(x * x for x in direction))
        return [f"{x / length:.4f}" for x in direction]

    vectors = {key: unit() for key in ("t0", "t1", "n0", "n1")}
    corners = {"p0": [decimals(-5, 5) for _ in range(3)], "p1": [decimals(6, 16) for _ in range(3)],
               "q0": [decimals(-5, 5), decimals(-5, 5), decimals(8, 19)]}  # fmt: skip
    sizes = {key: decimals(0.5, 4) for key in ("alpha0", "alpha1", "s0", "s1", "g")}
    return {"kind": "quintic-cylinder", "k0": decimals(-1, 1), "k1": decimals(-1, 1)} | vectors | corners | sizes


def weights(rng: random.Random) -> list[Fraction]:
    return [Fraction(rng.randint(40, 300), 100) for _ in range(10)]


def weighted(rows: Rows, by: Sequence[Fraction]) -> RationalBezier:
    return rational([[*(w * x for x in row), w] for row, w in zip(rows, by, strict=False)])


def size_of(pair: Pair) -> float:
    rows = [*pair[0], *pair[1]]
    return hypot(*(float(max(r[k] for r in rows) - min(r[k] for r in rows)) for k in range(3)))


def moved_off(pair: Pair, rng: random.Random, amount: float) -> Pair:
    """Return the pair with every coordinate moved at random by up to that share of the size."""
    far = Fraction(amount * size_of(pair))
    a, b = ([[x + Fraction(rng.uniform(-1, 1)) * far for x in row] for row in rows] for rows in pair)
    return a, b


def scaled(pair: Pair, factor: Fraction) -> Pair:
    a, b = ([[factor * x for x in row] for row in rows] for rows in pair)
    return a, b


def patch_of(pair: Pair) -> RuledPatch:
    return between(bezier(pair[0]), bezier(pair[1]))


def perturbed(seed: int) -> RuledPatch:
    """Return a patch that is not developable, by 1e-2 to 1e-9 of its size, 1e-6 to 1e6 times that of a hand.

    Every sixth is general, and every third has weights: the same on both sides where that keeps a cone or a cylinder.
    """
    rng = random.Random(seed)
    make = (*DEVELOPABLE, general)[seed % 6]
    pair = moved_off(make(rng, rng.randint(2, 7)), rng, 10.0 ** -rng.uniform(2, 9))
    a, b = scaled(pair, Fraction(10) ** rng.choice((-6, 0, 0, 6)))
    if (seed // 6) % 3:
        return patch_of((a, b))
    if make is general:
        return between(weighted(a, weights(rng)), bezier(b))
    return between(*(weighted(rows, by) for rows, by in zip((a, b), [weights(rng)] * 2, strict=True)))


def developable(seed: int) -> RuledPatch:
    """Return a patch that is developable in the numbers as typed; every second cone and cylinder has weights."""
    rng = random.Random(seed)
    make = DEVELOPABLE[seed % 5]
    pair = scaled(make(rng, rng.randint(1 if make in (cone, cylinder) else 2, 9)), Fraction(10) ** rng.randint(-6, 6))
    if make in (cone, cylinder) and seed % 2:
        by = weights(rng)
        return between(*(weighted(rows, by) for rows in pair))
    return patch_of(pair)
