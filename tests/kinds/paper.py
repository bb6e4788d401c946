"""The paper's patches over one uneven quintic: (2.2), and what Theorems 2.1 to 3.1 derive from it.

The quintic is written by its power series at v = 0 and what that misses at v = 1; the program writes control points.
"""

from collections.abc import Sequence
from fractions import Fraction

from mpmath import mpf

from tests import oracles
from tests.kinds.example import Pair, numbers, one, point
from tests.oracles import Space, Vec, add, exact
from tests.parts import Table

End = tuple[Vec, Vec, Vec]
"""r, r' and r'' at an end."""


def quintic(start: End, end: End) -> Space:
    """Return the quintic with these ends, from its power series at v = 0 and what is missing at v = 1 (Hermite)."""
    (p, p1, p2), (q, q1, q2) = start, end

    def jet(v: mpf) -> oracles.Jet:
        h = [10 * v**3 - 15 * v**4 + 6 * v**5, -4 * v**3 + 7 * v**4 - 3 * v**5, (v**3 - 2 * v**4 + v**5) / 2]
        d = [
            30 * v**2 - 60 * v**3 + 30 * v**4,
            -12 * v**2 + 28 * v**3 - 15 * v**4,
            (3 * v**2 - 8 * v**3 + 5 * v**4) / 2,
        ]
        r, slope = [], []
        for a, a1, a2, b, b1, b2 in zip(p, p1, p2, q, q1, q2, strict=True):
            missing = (b - a - a1 - a2 / 2, b1 - a1 - a2, b2 - a2)
            r.append(a + a1 * v + a2 * v**2 / 2 + sum(x * y for x, y in zip(missing, h, strict=True)))
            slope.append(a1 + a2 * v + sum(x * y for x, y in zip(missing, d, strict=True)))
        return tuple(r), tuple(slope), (mpf(0),) * 3

    return jet


def ending(P: Sequence[object], T: Sequence[object], N: Sequence[object], k: object, *shape: object) -> End:
    """Return r, r' = alpha T and r'' = beta T + k alpha^2 N."""
    p, t, n = (numbers(row) for row in (P, T, N))
    a, b = (exact(value) for value in shape)
    bend = exact(k) * a**2
    return p, tuple(a * x for x in t), tuple(b * x + bend * y for x, y in zip(t, n, strict=True))


def shifted(end: End, step: Vec) -> End:
    return add(end[0], step), end[1], end[2]


T0, T1, T2 = ["0.6", "0.8", 0], ["0.28", 0, "0.96"], [0, "0.6", "0.8"]
N0, N1, N2 = ["-0.8", "0.6", 0], ["-0.96", 0, "0.28"], [1, 0, 0]


def ends_table(size: Fraction, suffix: str = "", factor: object = 1) -> Table:
    """Return the end data of an uneven quintic, shrunk by a factor."""
    by = size * Fraction(str(factor))
    return {
        f"t0{suffix}": T0, f"t1{suffix}": T1, f"n0{suffix}": N0, f"n1{suffix}": N1,
        f"k0{suffix}": str(Fraction("0.3") / by), f"k1{suffix}": str(Fraction("-0.05") / by),
        f"alpha0{suffix}": one(2, by), f"alpha1{suffix}": one(9, by),
        f"beta0{suffix}": one(4, by), f"beta1{suffix}": one(3, by),
    }  # fmt: skip


P0, P1, APEX = [0, 0, 0], [5, 4, "2.5"], [2, -3, 8]
UNEVEN_ENDS = ending(P0, T0, N0, "0.3", 2, 4), ending(P1, T1, N1, "-0.05", 9, 3)


def half_way(row: Sequence[object]) -> list[str]:
    return [str((Fraction(str(x)) + Fraction(str(a))) / 2) for x, a in zip(row, APEX, strict=True)]


def quintic_ruled(size: Fraction) -> Table:
    """Return a cone by both its edges, the second half-way to the apex: half the derivatives."""
    corners = {"p0": P0, "p1": P1, "q0": half_way(P0), "q1": half_way(P1)}
    return (
        {"kind": "quintic-ruled"} | {key: point(row, size) for key, row in corners.items()}
        | ends_table(size) | ends_table(size, "_hat", "0.5")
    )  # fmt: skip


def ruled_pairs() -> list[list[Pair]]:
    r = quintic(*UNEVEN_ENDS)
    return [[(r, oracles.toward(r, APEX, "0.5"))]]


def quintic_planar(size: Fraction) -> Table:
    corners = {"p0": [1, 3, 2], "q0": [1, 3, 6], "p1": [3, 11, 1], "q1": [3, 11, 5]}
    shapes = {"alpha0": 2, "alpha1": "0.5", "beta0": 4, "beta1": 1}
    hats = {"alpha0_hat": 2, "alpha1_hat": 4, "beta0_hat": "0.1", "beta1_hat": 1}
    lengths = {key: one(value, size) for key, value in (shapes | hats).items()}
    return {"kind": "quintic-planar"} | {key: point(row, size) for key, row in corners.items()} | lengths


def planar_pairs() -> list[list[Pair]]:
    up, none = [0, 0, 1], [0, 0, 0]
    lower = ending([1, 3, 2], up, none, 0, 2, 4), ending([3, 11, 1], up, none, 0, "0.5", 1)
    upper = ending([1, 3, 6], up, none, 0, 2, "0.1"), ending([3, 11, 5], up, none, 0, 4, 1)
    return [[(quintic(*lower), quintic(*upper))]]


Q0 = [1, "-1.5", 3]
CYLINDER_ENDS = ending(P0, T0, N0, "0.3", 2, 1), ending(P1, T1, N1, "-0.05", 9, "2.25")
"""s0 = 1/2, s1 = 1/4: beta = s alpha."""


def quintic_cylinder(size: Fraction) -> Table:
    made = {key: value for key, value in ends_table(size).items() if not key.startswith("beta")}
    corners = {"p0": point(P0, size), "p1": point(P1, size), "q0": point(Q0, size)}
    return {"kind": "quintic-cylinder"} | corners | made | {"s0": "0.5", "s1": "0.25", "g": "1.75"}


def times(factor: object, row: Sequence[object]) -> Vec:
    x, y, z = numbers(row)
    return exact(factor) * x, exact(factor) * y, exact(factor) * z


def cylinder_pair() -> Pair:
    start, end = CYLINDER_ENDS
    return quintic(start, end), quintic(shifted(start, numbers(Q0)), shifted(end, times("1.75", Q0)))


def quintic_cone(size: Fraction) -> Table:
    return {
        "kind": "quintic-cone", "p0": point(P0, size), "p1": point(P1, size), "apex": point(APEX, size),
        "fraction": ["0.1", "0.7"],
    } | ends_table(size)  # fmt: skip


def cone_pairs() -> list[list[Pair]]:
    r = quintic(*UNEVEN_ENDS)
    return [[(oracles.toward(r, APEX, "0.1"), oracles.toward(r, APEX, "0.7"))]]


P2 = [7, 9, 5]


def quintic_strip(size: Fraction) -> Table:
    following = {
        "p1": point(P2, size), "t1": T2, "n1": N2, "k1": str(Fraction("0.2") / size), "alpha1": one(4, size),
        "s1": "0.5", "g": "0.6",
    }  # fmt: skip
    return {"kind": "quintic-strip", "first": quintic_cylinder(size), "next": [following]}


def strip_pairs() -> list[list[Pair]]:
    """The second patch goes on with r, r' and r'' of the first; its rulings, from those of the first's end, times g."""
    before = CYLINDER_ENDS[1]
    end, step = ending(P2, T2, N2, "0.2", 4, 2), times("1.75", Q0)
    far = tuple(exact("0.6") * x for x in step)
    second = quintic(before, end), quintic(shifted(before, step), shifted(end, far))
    return [[cylinder_pair(), second]]
