"""Verify: surfaces that are developable and surfaces that are not quite, told apart by the certificate or by a mesh.

Cones, cylinders, parts of tangent surfaces, Aumann's pairs and the cylinders of Theorem 2.2, all from seeds, of
degrees 2 to 7; and the same with every control point moved at random until the normal turns by so many degrees along
the worst ruling.  The certificate has the curves.  The angle defect is that of libigl at the inner vertices of an
irregular mesh with its vertices on the surface; its threshold is a fixed one, or the one that makes the fewest
mistakes on this very set, which nobody has who does not know the answers.
"""

import random
from collections.abc import Iterator, Sequence
from functools import partial
from itertools import pairwise
from statistics import median
from typing import NamedTuple

import igl
import numpy as np

from stages.geometry.mesh.mesh import Mesh
from stages.geometry.ruled.ruled import RuledPatch, warp
from stages.verify.certificate import certify
from tests.bench.rows import Asked, Extent, Row
from tests.bench.surroundings import version
from tests.bench.timing import once
from tests.meshes import COLUMNS, ROWS, sheet
from tests.stages.verify.families import DEVELOPABLE, Pair, moved_off, patch_of

ABOUT = (
    "False alarms: developable surfaces that are called warped. Misses: warped ones that are called developable. "
    "Seeded cones, cylinders, tangent surfaces and Bezier pairs of degrees 2 to 7. The certificate has the curves, the "
    "angle defect (largest of all inner vertices) an irregular mesh with exact vertices. Median time of one verdict."
)
WARPS_DEG = 0.5, 0.05
EACH: dict[Extent, int] = {"quick": 1, "usual": 10, "full": 40}
"""Surfaces of each family."""
CELLS: dict[Extent, tuple[int, int]] = {"quick": (24, 8), "usual": (COLUMNS, ROWS), "full": (COLUMNS, ROWS)}
FIXED_RAD = 1e-3
START, TURNS, NEAR = 1e-4, 12, 1e-3
"""Share of the size that control points are moved by at first; corrections of it at most; where they end, relative."""
V = np.linspace(0.0, 1.0, 401)
DEGREES = 2, 7


class Case(NamedTuple):
    """A surface, the warp that it was given, deg, and what both ways to look at it tell, with their seconds."""

    warp_deg: float
    developable: bool
    certificate_s: float
    defect: float
    defect_s: float


def rows(asked: Asked) -> Iterator[Row]:
    """Yield the mistakes of each way."""
    cases = [one for number in range(EACH[asked.extent] * len(DEVELOPABLE)) for one in family(number, asked.extent)]
    best = best_threshold(cases)
    triangles = f"{2 * CELLS[asked.extent][0] * CELLS[asked.extent][1]} triangles"
    yield from of_certificate(cases)
    yield from of_defects(cases, FIXED_RAD, f"libigl angle defect below {FIXED_RAD:g} rad", triangles)
    yield from of_defects(cases, best, "libigl angle defect, best threshold", triangles, f"below {best:.2g} rad")


def of_certificate(cases: Sequence[Case]) -> Iterator[Row]:
    """Yield the mistakes of the certificate."""
    seconds = median(one.certificate_s for one in cases)
    for what, wrong, count in mistakes(cases, [one.developable for one in cases]):
        yield Row(what, "exact curves", "planish", version("planish"), wrong, f"of {count}", seconds)


def of_defects(cases: Sequence[Case], limit: float, program: str, size: str, how: str = "") -> Iterator[Row]:
    """Yield the mistakes of a threshold for the largest angle defect."""
    seconds = median(one.defect_s for one in cases)
    for what, wrong, count in mistakes(cases, [one.defect < limit for one in cases]):
        yield Row(what, size, program, version("libigl"), wrong, f"of {count}", seconds, None, how)


def family(number: int, extent: Extent) -> Iterator[Case]:
    """Yield a developable surface and the same with warp, looked at both ways."""
    rng = random.Random(number)
    pair = DEVELOPABLE[number % len(DEVELOPABLE)](rng, rng.randint(*DEGREES))
    for warp_deg in (0.0, *WARPS_DEG):
        patch = warped(pair, warp_deg, number) if warp_deg else patch_of(pair)
        proof, certificate_s, _ = once(partial(certify, patch))
        defect, defect_s, _ = once(partial(largest_defect, sheet(patch, number, *CELLS[extent])))
        yield Case(warp_deg, proof.developable, certificate_s, defect, defect_s)


def warped(pair: Pair, warp_deg: float, seed: int) -> RuledPatch:
    """Return the patch with its control points moved until its largest warp is that; it is nearly linear in them."""
    amount, turn = START, 0.0
    for _ in range(TURNS):
        patch = patch_of(moved_off(pair, random.Random(seed), amount))
        turn = float(np.degrees(warp(patch, V).max()))
        if abs(turn - warp_deg) <= NEAR * warp_deg:
            return patch
        amount *= warp_deg / turn
    raise ValueError(f"surface {seed} has a warp of {turn} deg, {warp_deg} was asked for")


def largest_defect(mesh: Mesh) -> float:
    """Return the largest angle defect of an inner vertex, rad, either way."""
    defects = np.abs(igl.gaussian_curvature(np.array(mesh.vertices), np.array(mesh.faces)))
    defects[np.concatenate(igl.boundary_loop_all(mesh.faces))] = 0.0
    return float(defects.max())


def best_threshold(cases: Sequence[Case]) -> float:
    """Return the threshold with the fewest mistakes, a share of false alarms weighing as much as one of misses.

    One halfway between two neighbours among the defects, or beyond all of them.
    """
    found = sorted(one.defect for one in cases)
    between = [found[0] / 2.0, *((a + b) / 2.0 for a, b in pairwise(found)), 2.0 * found[-1]]
    return min(between, key=lambda limit: sum(_weight(one) for one in cases if _is_mistaken(one, limit)))


def _is_mistaken(one: Case, limit: float) -> bool:
    """Return whether a threshold tells the wrong thing."""
    return (one.defect < limit) != (one.warp_deg == 0.0)


def _weight(one: Case) -> int:
    """Return how much a mistake weighs: there are so many more warped surfaces."""
    return 1 if one.warp_deg else len(WARPS_DEG)


def mistakes(cases: Sequence[Case], verdicts: Sequence[bool]) -> Iterator[tuple[str, int, int]]:
    """Yield what kind of mistake was made how often, of how many; verdicts: whether developable."""
    for warp_deg in (0.0, *WARPS_DEG):
        called = [verdict for one, verdict in zip(cases, verdicts, strict=True) if one.warp_deg == warp_deg]
        wrong = sum(called) if warp_deg else len(called) - sum(called)
        yield (f"misses, warp {warp_deg:g} deg" if warp_deg else "false alarms"), wrong, len(called)
