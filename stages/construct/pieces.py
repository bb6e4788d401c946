"""Strips of pieces of other kinds: each piece turned such that it joins the one before along a common end ruling.

A piece may come with its rulings in the opposite order, with its edges exchanged, or both.  The first piece keeps its
edges, and its order too unless the second joins only at its first ruling.  The way round with the least gap is taken;
a gap above the tolerance is a finding, and the strip is not made.  How smoothly the pieces join is measured by
`joins`, like any other join.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stages.construct.built import Built
from stages.geometry.arrays import EPS, Matrix, norm
from stages.geometry.ruled.backwards import exchanged, reversed_patch
from stages.geometry.ruled.ruled import RuledPatch, at
from stages.model.report import Evidence, Finding, Metric, Where
from stages.model.tolerances import Tolerances

Patches = tuple[RuledPatch, ...]


def strip_of(pieces: Sequence[Built], tol: Tolerances) -> Built:
    """Return the strip of pieces that were built each by itself; places in what they report are the piece's own."""
    findings = tuple(_named(finding, i) for i, piece in enumerate(pieces) for finding in piece.findings)
    if not all(piece.patches for piece in pieces) or any(finding.fatal for finding in findings):
        return Built((), _worst(pieces), findings)
    runs, gaps = in_order([piece.patches for piece in pieces])
    residuals = [piece.residual for piece in pieces if piece.residual is not None]
    return Built(
        tuple(patch for run in runs for patch in run),
        _worst(pieces),
        (*findings, *_apart(runs, gaps, tol)),
        (lambda size: max(residual(size) for residual in residuals)) if residuals else None,
        {"pieces": [piece.detail for piece in pieces]} if any(piece.detail for piece in pieces) else {},
    )


def in_order(pieces: Sequence[Patches]) -> tuple[list[Patches], list[float]]:
    """Return the pieces turned such that each joins the one before as well as it can, and the gaps, mm."""
    runs, gaps = [pieces[0]], []
    if len(pieces) > 1:
        runs = [min((pieces[0], _back(pieces[0])), key=lambda run: _gap(run, _turned(run, pieces[1])))]
    for piece in pieces[1:]:
        turned = _turned(runs[-1], piece)
        gaps.append(_gap(runs[-1], turned))
        runs.append(turned)
    return runs, gaps


def _turned(run: Patches, piece: Patches) -> Patches:
    """Return the piece the way round in which it joins the run best."""
    return min(_ways(piece), key=lambda way: _gap(run, way))


def _ways(piece: Patches) -> tuple[Patches, ...]:
    """Return the piece as it is, with its edges exchanged, backwards, and both."""
    return piece, _swapped(piece), _back(piece), _back(_swapped(piece))


def _back(piece: Patches) -> Patches:
    return tuple(reversed_patch(patch) for patch in piece[::-1])


def _swapped(piece: Patches) -> Patches:
    return tuple(exchanged(patch) for patch in piece)


def _gap(before: Patches, after: Patches) -> float:
    """Return how far apart the last ruling of one piece and the first of the next are, mm, at the worse end.

    Rounding counts as nothing, so that a piece which joins in several ways stays as it is.
    """
    last, first = _ruling(before[-1], 1.0), _ruling(after[0], 0.0)
    gap = float(norm(last - first).max())
    return gap if gap > ROUNDING * float(np.abs(last).max()) else 0.0


ROUNDING = 64 * EPS
"""Points that differ by a smaller share of their coordinates coincide: a ruling's end is some ten operations off."""


def _ruling(patch: RuledPatch, v: float) -> Matrix:
    """Return both ends of a ruling, shape (2, 3)."""
    return at(patch, np.array([0.0, 1.0]), np.full(2, v))


def _apart(runs: Sequence[Patches], gaps: Sequence[float], tol: Tolerances) -> list[Finding]:
    found = []
    for i, gap in enumerate(gaps):
        if gap > tol.join_mm:
            message = (
                f"pieces[{i + 1}] does not join pieces[{i}] along an end ruling: whichever way round it is turned, "
                f"they stay {gap:.4g} mm apart, more than the {tol.join_mm:g} mm of tolerance.join"
            )
            found.append(Finding("pieces-apart", message, True, {"v": sum(len(run) for run in runs[: i + 1])}))
    return found


def _named(finding: Finding, piece: int) -> Finding:
    return replace(finding, message=f"pieces[{piece}]: {finding.message}", where=_in(piece, finding.where))


def _in(piece: int, where: Where | None) -> Where:
    """Return a place as one in a piece, by the piece's path in the job file."""
    return {"in": f"pieces[{piece}]", **(where or {})}


def _worst(pieces: Sequence[Built]) -> tuple[Metric, ...]:
    """Return every metric that a piece has measured, once: its largest value, and the piece that it is of."""
    rows: dict[str, list[tuple[int, Metric]]] = {}
    for i, piece in enumerate(pieces):
        for metric in piece.measured:
            rows.setdefault(metric.name, []).append((i, metric))
    return tuple(_largest(found) for found in rows.values())


def _largest(found: Sequence[tuple[int, Metric]]) -> Metric:
    """Return the metric with the largest value; its evidence is the weakest of all."""
    number, most = max(found, key=lambda row: -np.inf if row[1].value is None else float(row[1].value))
    evidence: Evidence = "proved" if all(metric.evidence == "proved" for _, metric in found) else "sampled"
    return replace(most, evidence=evidence, where=_in(number, most.where))
