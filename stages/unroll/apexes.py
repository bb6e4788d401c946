"""Sheet at an apex: what is unrolled where the neutral surface, parallel to the one given, does not reach so far.

At the distance l from the apex of a cone the radius is rho = l w / (beta L), with w the width and L the length of its
ruling at the other edge.  A parallel surface at the distance d towards the centre ends where rho = d, its edge of
regression: within l = d beta L / w of the apex (a few d) there is no neutral surface, and no sheet that is bent so
sharply is neutral anywhere.  In the shop the tip is creased, or hammered.

What is unrolled then is the cone from the given apex over the neutral line of its other edge: `tapered` in
`geometry.ruled.offset`.  Along that other edge all lengths are those of the neutral surface.  Towards the apex the
offset falls evenly to nothing, and so flat lengths across the rulings exceed those of the neutral surface (where there
is one) by a share of d times the turning of the normal, all of it at the apex: `apex_allowance_mm`.  Rulings of the
length L become sqrt(L^2 + d^2).  The finding `apex-tapered` says all of this in numbers.

Only where every piece that bends has its apex at one and the same edge of the strip, all others are triangles, and d is
the same both ways.  Any other part is refused: the job then gives the middle surface and K = 1/2, or cuts the tips off.
"""

from itertools import groupby

import numpy as np

from stages.geometry.arrays import norm
from stages.geometry.numeric.quadrature import nodes
from stages.geometry.ruled.tightest import Edge
from stages.geometry.ruled.turning import FLAT, Turning, is_fold
from stages.model.report import Finding, Metric, Where
from stages.unroll.bent import Bent


def kept_edge(bent: Bent, points: frozenset[Edge]) -> float | None:
    """Return u of the edge at which every piece that bends has its apex.

    None if there is none, if there are two offsets, or if a flat piece is no triangle: tapered it would be warped.
    """
    bends = bent.bends
    if not all({(i, 0.0), (i, 1.0)} & points for i in range(len(bends.pieces))):
        return None
    bending = {s.piece for s in bends.stretches if abs(s.angle_rad) > FLAT and not is_fold(s)}
    ways = {np.sign(s.angle_rad) for s in bends.stretches if s.piece in bending and not is_fold(s)}
    offsets = {abs(bent.sheet.neutral_mm(float(way), bent.k)) for way in ways if way}
    found = (u for u in (0.0, 1.0) if all((piece, u) in points for piece in bending))
    return next(found, None) if len(offsets) == 1 else None


def apex_report(bent: Bent, kept: float, points: frozenset[Edge]) -> tuple[Metric, Finding]:
    """Return what the tapered surface neglects at its apexes: the metric, and the finding that says so."""
    sign = 1.0 if sum(s.angle_rad for s in bent.bends.stretches) >= 0.0 else -1.0
    offset = abs(bent.sheet.neutral_mm(sign, bent.k))
    off = offset * _most_turning(bent.bends, kept, points)
    reach, place = _gone(bent, offset, kept)
    other = "c1" if kept == 0.0 else "c0"
    message = (
        f"within {reach:.4g} mm of an apex there is no neutral layer: it would lie {offset:.4g} mm towards the centre "
        f"of a sharper bend. Unrolled is the surface that runs from it at {other} into the apex: lengths across the "
        f"rulings are right along {other}, and up to {off:.4g} mm too long next to the apex; with the tip cut off they "
        "are right everywhere"
    )
    where: Where = {"v": bent.v_of(place), "u": kept}
    return Metric("apex_allowance_mm", off, "mm", "sampled", None, where), Finding(
        "apex-tapered", message, False, where
    )


def _most_turning(bends: Turning, kept: float, points: frozenset[Edge]) -> float:
    """Return the largest turning about one apex, rad: pieces that follow each other share it."""
    turned = [
        sum(abs(s.angle_rad) for s in bends.stretches if s.piece == i and not is_fold(s))
        for i in range(len(bends.pieces))
    ]
    runs = groupby(range(len(turned)), key=lambda i: (i, kept) in points)
    return max((sum(turned[i] for i in run) for at_apex, run in runs if at_apex), default=0.0)


def _gone(bent: Bent, offset: float, kept: float) -> tuple[float, float]:
    """Return the longest part of a ruling on which there is no neutral surface, mm, and its place: at Gauss nodes."""
    found = []
    for i, piece in enumerate(bent.bends.pieces):
        v = nodes(piece.breaks[:-1], piece.breaks[1:]).ravel()
        beta, width0, width1 = piece.rates.reshape(v.size, -1).T
        width = width1 if kept == 0.0 else width0
        length = norm(piece.patch.p.jet(v, 0)[0])
        reach = np.divide(offset * np.abs(beta) * length, width, out=np.zeros_like(v), where=width > 0.0)
        top = int(np.argmax(reach))
        found.append((float(reach[top]), i + float(v[top])))
    return max(found)
