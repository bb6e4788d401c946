"""The joins of a strip as construct reports them: the worst of each figure, and every join with its continuity.

G0: the rulings coincide within `tol.join_mm`; G1: the normals agree within `SMOOTH_RAD`; G2: the curvatures agree too,
at both ends of the ruling.  A jump of curvature is a jump of the roll setting.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from stages.geometry.ruled.joins import Join, join
from stages.geometry.ruled.ruled import RuledPatch
from stages.model.report import Metric
from stages.model.tolerances import Tolerances

SMOOTH_RAD = np.radians(0.01)
"""Normals closer than this make one surface to the eye and to the roll: 0.1 mm per 600 mm of flange.  End data typed to
four decimals stays below."""
SMOOTH_CURVATURE = 1e-2
"""A jump of curvature below this share of 1/D: over the whole part it opens by less than D/800."""
GAP, POSITION, TANGENT, CURVATURE = -1, 0, 1, 2
NAMES = {GAP: "gap", POSITION: "G0", TANGENT: "G1", CURVATURE: "G2"}


def joins_of(patches: Sequence[RuledPatch]) -> tuple[Join, ...]:
    """Return how each patch meets the next."""
    return tuple(join(a, b) for a, b in pairwise(patches))


def continuity(met: Join, size_mm: float, tol: Tolerances) -> int:
    """Return the order of continuity of a join: -1 a gap, 0 position, 1 tangent plane, 2 curvature.

    Where no curvature is defined on the ruling (an apex at both its ends) there is none to agree: at most 1.
    """
    if met.gap_mm > tol.join_mm:
        return GAP
    if met.normal_rad > SMOOTH_RAD:
        return POSITION
    return CURVATURE if met.jump is not None and met.jump * size_mm <= SMOOTH_CURVATURE else TANGENT


def join_metrics(joins: Sequence[Join], size_mm: float, tol: Tolerances) -> list[Metric]:
    """Return gap, angle of normals, jump of curvature (times D) and order of continuity, the worst of all joins."""
    if not joins:
        return []
    gap = max(range(len(joins)), key=lambda i: joins[i].gap_mm)
    turn = max(range(len(joins)), key=lambda i: joins[i].normal_rad)
    orders = [continuity(met, size_mm, tol) for met in joins]
    least = orders.index(min(orders))
    jumps = [(met.jump, i) for i, met in enumerate(joins) if met.jump is not None]
    jump, place = max(jumps, default=(None, None))
    return [
        Metric("join_gap_mm", joins[gap].gap_mm, "mm", "sampled", tol.join_mm, {"v": gap + 1}),
        Metric("join_normal_deg", float(np.degrees(joins[turn].normal_rad)), "deg", where={"v": turn + 1}),
        Metric(
            "join_curvature_jump",
            None if jump is None else jump * size_mm,
            "1/D",
            where=None if place is None else {"v": place + 1},
        ),
        Metric("join_continuity", float(orders[least]), "G", where={"v": least + 1}),
    ]


def join_rows(joins: Sequence[Join], size_mm: float, tol: Tolerances) -> list[dict[str, object]]:
    """Return every join in numbers, in the order of v."""
    return [
        {
            "v": i + 1,
            "continuity": NAMES[continuity(met, size_mm, tol)],
            "gap_mm": met.gap_mm,
            "normal_deg": float(np.degrees(met.normal_rad)),
            "curvature_jump": [None if jump is None else jump * size_mm for jump in met.jumps],
        }
        for i, met in enumerate(joins)
    ]
