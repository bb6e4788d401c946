"""The seams of a part on the outline of its flat pattern: which edges each takes, and places along them.

An outline is divided where a seam begins or ends inside an edge; ends within `SNAP_MM` of a corner are that corner.
Places along a seam are counted in its own sense: c0 and c1 with v, start and end with u, an outline counter-clockwise.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Indices, Numbers, Values
from stages.geometry.curves.evenly import Measured, along, measured
from stages.geometry.curves.plane import PlaneCurve, stretch
from stages.model.pattern import EdgeRun, FlatPattern, Spot
from stages.model.report import Finding
from stages.model.sewing import SeamSpec

SNAP_MM = 0.01
"""Lengths along an outline are worked out by hand to a hundredth of a mm."""


Pieces = tuple[tuple[int, tuple[float, ...]], ...]
"""For each edge of an undivided outline the first of its pieces, by its number, and where they end in t."""


@dataclass(frozen=True, slots=True)
class Line:
    """A seam: its edges by their numbers in the divided outline, in its order; `backwards`: it runs against that."""

    spec: SeamSpec
    numbers: tuple[int, ...]
    edges: tuple[Measured, ...]
    backwards: bool

    @property
    def length_mm(self) -> float:
        """The length of the sew line."""
        return sum(edge.length_mm for edge in self.edges)

    def places(self, fractions: Values) -> tuple[Numbers, Values]:
        """Return the edges, by their numbers in the divided outline, and t on them at fractions of the seam."""
        share = 1.0 - fractions if self.backwards else fractions
        number, t = along(self.edges, share * self.length_mm)
        return np.array(self.numbers, dtype=np.int64)[number], t


@dataclass(frozen=True, slots=True)
class Seams:
    """The outline of a pattern, divided where seams begin and end, and the seams on it by name."""

    outline: tuple[PlaneCurve, ...]
    pieces: Pieces
    lines: dict[str, Line]

    def spot(self, spot: Spot) -> Spot:
        """Return a spot of the undivided outline on the divided one."""
        first, ends = self.pieces[spot[0]]
        k = next((i for i, end in enumerate(ends) if spot[1] <= end), len(ends) - 1)
        low = ends[k - 1] if k else 0.0
        return first + k, (spot[1] - low) / (ends[k] - low)

    def of_edge(self, number: int) -> Line | None:
        """Return the seam that an edge of the divided outline belongs to."""
        return next((line for line in self.lines.values() if number in line.numbers), None)


def seams(pattern: FlatPattern, specs: Sequence[SeamSpec]) -> Seams | Finding:
    """Return the seams of a pattern that has not been widened, or what is wrong with one.

    Raises NoSolutionError where the length of an edge is not resolved.
    """
    known = [measured(edge) for edge in pattern.outer.edges]
    wrong = next((found for spec in specs if (found := _wrong(spec, pattern, known)) is not None), None)
    if wrong is not None:
        return wrong
    ends = {spec.called: _ends(spec, known) for spec in specs if spec.from_ is not None}
    divided, pieces = _divided(pattern.outer.edges, [spot for pair in ends.values() for spot in pair])
    lengths = [measured(edge) for edge in divided]
    lines = {}
    for spec in specs:
        side = next((one for one in pattern.sides if one.name == spec.edge), None)
        numbers = (
            _of_side(side, pieces, len(divided)) if side else _of_outline(ends.get(spec.called), pieces, len(divided))
        )
        measures = tuple(lengths[i] for i in numbers)
        lines[spec.called] = Line(spec, numbers, measures, side is not None and side.backwards)
    made = Seams(divided, pieces, lines)
    return _doubled(made) or made


def _wrong(spec: SeamSpec, pattern: FlatPattern, known: Sequence[Measured]) -> Finding | None:
    """Return what is wrong with a seam by itself."""
    names = [side.name for side in pattern.sides] or ["outline"]
    if spec.edge not in names:
        return _finding(spec, "no-such-edge", f"this pattern has no edge {spec.edge!r}: one of {', '.join(names)}")
    whole = sum(edge.length_mm for edge in known)
    far = max(float(spec.from_ or 0), float(spec.to or 0))
    if far > whole + SNAP_MM:
        return _finding(spec, "seam-off-edge", f"{far:g} mm is more than the outline is long, {whole:.6g} mm")
    return None


def _ends(spec: SeamSpec, known: Sequence[Measured]) -> tuple[Spot, Spot]:
    """Return where a seam begins and ends that is a stretch of the outline."""
    first, last = _spots(known, np.array([float(spec.from_ or 0), float(spec.to or 0)]))
    return first, last


def _spots(edges: Sequence[Measured], lengths_mm: Values) -> list[Spot]:
    """Return the spots at lengths along an outline, those near a corner at the beginning of the edge after it."""
    number: Indices
    number, t = along(edges, lengths_mm)
    found: list[Spot] = []
    for i, at, length in zip(number.tolist(), t.tolist(), lengths_mm.tolist(), strict=True):
        before = sum(edge.length_mm for edge in edges[:i])
        if length - before <= SNAP_MM:
            found.append((i, 0.0))
        elif before + edges[i].length_mm - length <= SNAP_MM:
            found.append(((i + 1) % len(edges), 0.0))
        else:
            found.append((i, at))
    return found


def _divided(edges: Sequence[PlaneCurve], spots: Sequence[Spot]) -> tuple[tuple[PlaneCurve, ...], Pieces]:
    """Return the outline cut at spots inside its edges, and the pieces of each old edge."""
    made: list[PlaneCurve] = []
    pieces: list[tuple[int, tuple[float, ...]]] = []
    for i, edge in enumerate(edges):
        ends = (*sorted({t for number, t in spots if number == i and t > 0.0}), 1.0)
        pieces.append((len(made), ends))
        made += [stretch(edge, low, high) for low, high in zip((0.0, *ends), ends, strict=False)]
    return tuple(made), tuple(pieces)


def _of_side(side: EdgeRun, pieces: Pieces, count: int) -> tuple[int, ...]:
    """Return the edges of a named side in the divided outline."""
    last = pieces[side.last][0] if side.last < len(pieces) else count
    return tuple(range(pieces[side.first][0], last))


def _of_outline(ends: tuple[Spot, Spot] | None, pieces: Pieces, count: int) -> tuple[int, ...]:
    """Return the edges of a stretch of the divided outline, or all of it; a stretch may pass its beginning."""
    if ends is None:
        return tuple(range(count))
    first, last = (_begins(pieces, spot) for spot in ends)
    return tuple(i % count for i in range(first, last if last > first else last + count))


def _begins(pieces: Pieces, spot: Spot) -> int:
    """Return the piece that begins at a spot at which the outline was divided, or which is a corner."""
    first, ends = pieces[spot[0]]
    return first if spot[1] == 0.0 else first + 1 + ends.index(spot[1])


def _doubled(made: Seams) -> Finding | None:
    """Return what stands against two seams on one edge."""
    taken: dict[int, str] = {}
    for name, line in made.lines.items():
        for number in line.numbers:
            if taken.setdefault(number, name) != name:
                where = made.outline[number].at(np.array([0.5]))[0]
                message = f"the seams {taken[number]} and {name} both lie at ({where[0]:.5g}, {where[1]:.5g})"
                return _finding(line.spec, "seams-overlap", message)
    return None


def _finding(spec: SeamSpec, code: str, message: str) -> Finding:
    return Finding(code, f"{spec.called}: {message}", fatal=True, where={"seam": spec.called})
