"""Unroll: how far from its exact place a point of the flat pattern lies, over the size of the part, and how soon.

The exact places are those of 40-digit arithmetic (`tests/oracles.py`), by another formula than the program's.  Methods
that get a mesh are held against the program's development, which the first row of each surface places within some
1e-15 of them.  All after the best rigid motion.
"""

from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

import numpy as np
from mpmath import mpf

from stages.geometry.arrays import Points2, Points3, Values, norm
from stages.geometry.curves.curves import Bezier, Circular
from stages.geometry.flat.development import develop
from stages.geometry.ruled.ruled import RuledPatch, between
from tests import oracles
from tests.bench.rows import Asked, Extent, Row
from tests.bench.surroundings import version
from tests.bench.timing import measured
from tests.bench.topics.flatteners import LIBIGL, Method, by_equations, in_space, planish, triangle_strip, zigzag
from tests.meshes import COLUMNS, OBLIQUE_CONE, ROWS, Known, jittered, misplaced, ruled
from tests.parts import EXAMPLE_2_CYLINDER, QUINTIC_TANGENT, Table, patches

ABOUT = (
    "Largest distance of a point of the flat pattern from its exact place (40 digits), over the size of the part; "
    "time to lay out every vertex of the mesh, or the strip. Exact surface: planish and `solve_ivp` have the curves, "
    "triangle strips points on rulings; the others have the mesh alone."
)
U, V = (axis.ravel() for axis in np.meshgrid([0.0, 0.45, 1.0], np.linspace(0.0, 1.0, 9)))
RULINGS = 128, 1024
CELLS: dict[Extent, tuple[int, int]] = {"quick": (24, 8), "usual": (COLUMNS, ROWS), "full": (COLUMNS, ROWS)}
FRUSTUM_RADII, FRUSTUM_HEIGHT, FRUSTUM_TURN = (1.5, 0.75), 0.75, 4.25
"""Of the right cone: numbers that are the same in doubles; 243 deg, which are 172 deg in the flat."""
SIZE = "of the size"
SEED = 0
Places = Callable[[RuledPatch, Values, Values], Points2]


class Surface(NamedTuple):
    """A developable, and both its edges to 40 digits."""

    patch: RuledPatch
    edges: tuple[oracles.Space, oracles.Space]


def surfaces() -> dict[str, Surface]:
    """Return developables of each sort."""
    tables = {
        "oblique cone over a quintic": OBLIQUE_CONE, "cylinder over a quintic": EXAMPLE_2_CYLINDER,
        "tangent developable": QUINTIC_TANGENT,
    }  # fmt: skip
    return {"right cone": right_cone(), **{name: polynomial(table) for name, table in tables.items()}}


def right_cone() -> Surface:
    """Return a frustum that is not closed."""
    turn, none = mpf(FRUSTUM_TURN), (0, 0, 0)
    lower, upper = (
        oracles.turning((0, 0, z), (radius, 0, 0), (0, radius, 0), none, turn)
        for z, radius in ((0, FRUSTUM_RADII[0]), (FRUSTUM_HEIGHT, FRUSTUM_RADII[1]))
    )
    return Surface(frustum(), (lower, upper))


def frustum() -> RuledPatch:
    """Return the same patch in doubles."""
    x, y, z = np.eye(3)
    lower, upper = (
        Circular(height * z, radius * x, radius * y, 0.0 * z, 0.0, FRUSTUM_TURN)
        for height, radius in ((0.0, FRUSTUM_RADII[0]), (FRUSTUM_HEIGHT, FRUSTUM_RADII[1]))
    )
    return between(lower, upper)


def polynomial(table: Table) -> Surface:
    """Return a patch whose edges are Bezier curves."""
    (patch,) = patches(table)
    assert isinstance(patch.c0, Bezier)
    assert isinstance(patch.c1, Bezier)
    return Surface(patch, (oracles.bezier(patch.c0.exact), oracles.bezier(patch.c1.exact)))


def rows(asked: Asked) -> Iterator[Row]:
    """Yield what every method reaches on every surface."""
    for name, surface in surfaces().items():
        yield from of_curves(name, surface, asked)
        yield from of_rulings(name, surface.patch, asked)
        yield from of_mesh(name, ruled(surface.patch, SEED, *CELLS[asked.extent]), asked)
        if asked.extent == "quick":
            return


def of_curves(name: str, surface: Surface, asked: Asked) -> Iterator[Row]:
    """Yield the rows of the methods that have the curves."""
    exact, patch, (v, u, _) = exact_places(surface), surface.patch, jittered(SEED, *CELLS[asked.extent])
    size = extent(in_space(patch, u, v))
    methods: dict[tuple[str, str], Places] = {
        ("planish", version("planish")): developed, ("scipy solve_ivp DOP853", version("scipy")): by_equations,
    }  # fmt: skip
    for (program, found), method in methods.items():
        took = measured(partial(method, patch, u, v), asked.rounds)
        error = misplaced(method(patch, U, V), exact) / size
        yield Row(name, f"{len(u)} points", program, found, error, SIZE, took.seconds, took.memory_mb, took.how)


def of_rulings(name: str, patch: RuledPatch, asked: Asked) -> Iterator[Row]:
    """Yield the rows of triangle strips."""
    for count in RULINGS:
        u, v = zigzag(count)
        corners = in_space(patch, u, v)
        took = measured(partial(triangle_strip, corners), asked.rounds)
        error = misplaced(took.result, developed(patch, u, v)) / extent(corners)
        size, program = f"{count} rulings", "triangle strip"
        yield Row(name, size, program, "", error, SIZE, took.seconds, took.memory_mb, took.how)


def of_mesh(name: str, known: Known, asked: Asked) -> Iterator[Row]:
    """Yield the rows of the methods that have a mesh."""
    size = f"{len(known.mesh.faces)} triangles"
    methods: dict[str, Method] = {"planish, from the mesh": planish, **LIBIGL}
    for program, method in methods.items():
        took = measured(partial(method, known.mesh), asked.rounds)
        error = misplaced(took.result, known.flat) / known.size
        found = version("libigl" if program in LIBIGL else "planish")
        yield Row(name, size, program, found, error, SIZE, took.seconds, took.memory_mb, took.how)


def extent(points: Points3) -> float:
    """Return the diagonal of the box about points."""
    return float(norm(np.ptp(points, axis=0)))


def developed(patch: RuledPatch, u: Values, v: Values) -> Points2:
    """Return the flat positions by the program's own development."""
    return develop((patch,)).pieces[0].positions(u, v)


def exact_places(surface: Surface) -> Points2:
    """Return the flat places at U, V by 40-digit arithmetic."""
    flat = oracles.flat_map(*surface.edges)
    return np.array([flat(mpf(u), mpf(v)) for u, v in zip(U, V, strict=True)], dtype=float)
