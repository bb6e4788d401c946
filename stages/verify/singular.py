"""The rulings at which a normal of an exact patch vanishes: found without doubt, and named for what they are.

How often the ruling, the two speeds and the two normals vanish there decides:  where both normals change sign the
tangent plane turns back (the surface has an edge); where one does, the edge of regression comes in; where none does,
the edge of regression only touches an edge, or the directrices merely stop, and the surface goes on.
"""

from dataclasses import dataclass
from typing import Literal

from stages.geometry.numeric.bernstein import Polynomial, multiply
from stages.geometry.numeric.factors import Interval, leading_zeros, multiplicity, roots_inside, square_free
from stages.verify.plucker import Ingredients

Sort = Literal["zero-ruling", "cusp", "singular-ruling", "edge-of-regression", "touch", "stop", "tangent-ruling"]
"""What a singular ruling is.

zero-ruling: it has no length.  cusp: both directrices stop and turn back.  singular-ruling: it runs along the
directrices, and the surface turns back.  edge-of-regression: it crosses an edge of the patch.
touch: it touches an edge, or one directrix stops.  stop: both directrices stop, the surface is regular.
tangent-ruling: it runs along the directrices, and the surface goes on.
"""


@dataclass(frozen=True, slots=True)
class Singular:
    """A ruling at v where a normal vanishes, the interval it is known by, and what it is."""

    sort: Sort
    root: Interval

    @property
    def v(self) -> float:
        """Return its place."""
        return float(self.root[0] + self.root[1]) / 2.0


@dataclass(frozen=True, slots=True)
class Orders:
    """How often ruling, speeds and normals vanish at one v."""

    ruling: int
    speeds: tuple[int, int]
    normals: tuple[int, int]

    @property
    def merely_stops(self) -> bool:
        """Return whether another parametrisation would make the patch regular here: nothing but speeds vanishes.

        A ruling of no length, or along a directrix, makes a normal vanish more often than the speed.
        """
        return self.speeds == self.normals and self.normals[0] == self.normals[1]


def singular_rulings(made: Ingredients) -> tuple[Singular, ...]:
    """Return the singular rulings strictly inside the patch, from left to right."""
    normals = _normal_factors(made)
    every = multiply(*normals)
    roots = roots_inside(every)
    if not roots:
        return ()
    split = [square_free(f) for f in (made.ruling.factor, *(t.stop for t in made.tangents), *normals)]
    found = []
    for root in roots:
        p, s0, s1, n0, n1 = (multiplicity(f, root) for f in split)
        found.append(Singular(_sort(Orders(p, (s0, s1), (n0, n1))), root))
    return tuple(found)


def regular_at_ends(made: Ingredients) -> bool:
    """Return whether the surface has a normal along the whole of its first and its last ruling."""
    normals = _normal_factors(made)
    factors = (made.ruling.factor, *(t.stop for t in made.tangents), *normals)
    if all(f.scaled[0] and f.scaled[-1] for f in normals):
        return True
    for step in (1, -1):
        p, s0, s1, n0, n1 = (leading_zeros(f.scaled[::step]) for f in factors)
        if (n0 or n1) and not Orders(p, (s0, s1), (n0, n1)).merely_stops:
            return False
    return True


def _normal_factors(made: Ingredients) -> tuple[Polynomial, Polynomial]:
    """Return the factors of both normals; one that is nowhere defined takes that of the other."""
    n0, n1 = made.normals
    return (n1 if n0.is_zero else n0).factor, (n0 if n1.is_zero else n1).factor


def _sort(orders: Orders) -> Sort:
    if orders.ruling:
        return "zero-ruling"
    odd0, odd1 = (order % 2 == 1 for order in orders.normals)
    if odd0 != odd1:
        return "edge-of-regression"
    stops = all(orders.speeds)
    if odd0:
        return "cusp" if stops else "singular-ruling"
    if not all(orders.normals):
        return "touch"
    if orders.merely_stops:
        return "stop"
    return "touch" if orders.speeds == orders.normals else "tangent-ruling"
