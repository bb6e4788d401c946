"""What a reader makes of a cut file, and what it should have made of it, as the same few figures.

A reader hands over pieces of curves, as points; some keep contours whole, some take them apart into loose pieces, some
forget the layers.  Pieces are joined by their ends, and length, closed contours with their areas, and the box are
taken from that.  The expected figures come from the lines and arcs of the drawing by closed formulas, so that the two
sides share nothing but the file.

Figures are of one layer, or of all together for a reader that forgets them.  Texts are read by their strings alone:
their shape is the reader's font.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import cos, dist, pi, sin
from pathlib import Path

import numpy as np

from stages.geometry.arrays import Points2
from stages.geometry.paths import arcpath
from stages.geometry.paths.arcpath import ArcPath
from stages.write.drawing import Item, extent
from tests.readers.drawings import Sample

ALL_LAYERS = ""


@dataclass(frozen=True)
class Piece:
    """A curve as a reader sees it: its layer, its points in mm, and whether the reader says that it is closed."""

    layer: str
    points: Points2
    closed: bool = False


@dataclass(frozen=True)
class Reading:
    """All that a reader found; texts: None where the reader has none to give."""

    pieces: tuple[Piece, ...]
    texts: tuple[str, ...] | None = None


@dataclass(frozen=True)
class Figures:
    """What is measured of a layer, mm and mm2.

    contours: area and length of each closed one, from small to large.  box: x least, y least, x most, y most.
    turn: by how much all curves turn, corners included, in rad; of what was written, not of what was read.
    """

    length: float
    contours: tuple[tuple[float, float], ...]
    box: tuple[float, float, float, float]
    turn: float = 0.0


@dataclass(frozen=True)
class Fineness:
    """How finely a reader states curves: what its figures may differ by, and nothing else may.

    step_rad: largest turn between two points on an arc; 0: arcs are not chorded.
    grid_mm: how far rounding moves a point.
    stray_mm: how far a point that the reader put on an arc may lie from it (chords by sagitta, not by step).
    """

    step_rad: float = 0.0
    grid_mm: float = 0.0
    stray_mm: float = 0.0

    @property
    def off_mm(self) -> float:
        """How far apart the ends of pieces that meet may be, and how far the box may be off by rounding."""
        return 2.0 * self.grid_mm + JOINED_MM

    def length_bound(self, length: float, turn: float, pieces: int) -> float:
        """Of n chords of step a: each is short by 1 - sin(a/2)/(a/2).  A curve d off another differs by d per radian.

        turn: of all curves, corners included, twice since what is rounded turns to and fro; both ends of a piece move.
        """
        half = self.step_rad / 2.0
        short = 1.0 - sin(half) / half if half else 0.0
        off = self.grid_mm + self.stray_mm
        return length * (short + FILE_ERROR) + 2.0 * off * turn + 2.0 * self.grid_mm * pieces

    def area_bound(self, area: float, length: float) -> float:
        """Of an arc the chords cut off less than of a circle of its length, and that share is 1 - sin(a)/a.

        length: of the contour; the circle of that length has the area length^2 / (4 pi).
        """
        lost = 1.0 - sin(self.step_rad) / self.step_rad if self.step_rad else 0.0
        return lost * length * length / (4.0 * pi) + length * (2.0 * self.grid_mm + self.stray_mm) + FILE_ERROR * area

    def box_bound(self, radius: float) -> float:
        """The box misses at most the height of one chord's arc."""
        return radius * (1.0 - cos(self.step_rad / 2.0)) + self.off_mm + self.stray_mm


JOINED_MM = 1e-6
"""Ends that meet: a reader that computes an arc's end from centre, radius and angle is off by the angle's digits."""

FILE_ERROR = 1e-9
"""Of lengths and areas, relative: coordinates in the file are rounded to 1e-10 mm."""


@dataclass(frozen=True)
class Reader:
    """A reader: its name, whether it can be had here, and how to read all files of a folder in one go.

    layered: whether it keeps layers; where it does not, figures are of all layers together.
    only: the layers that it is asked for, of files in which all contours on them are closed; none: all layers.
    block_layers: whether it keeps the layers of what is in blocks; where it does not, those of pattern files are lost.
    keeps_pieces: whether its answer tells which lines and arcs belong to one contour, or none.
    """

    name: str
    available: Callable[[], bool]
    read: Callable[[Sequence[Path]], dict[str, Reading]]
    fineness: Fineness
    layered: bool = True
    keeps_pieces: bool = True
    only: tuple[str, ...] = ()
    block_layers: bool = True


def measured(reading: Reading, fineness: Fineness, layered: bool) -> dict[str, Figures]:
    """Return the figures of what a reader found."""
    return {layer: _measured(pieces, fineness) for layer, pieces in _grouped(reading, layered).items()}


def _grouped(reading: Reading, layered: bool) -> dict[str, list[Piece]]:
    """Return the pieces by layer, or all of them as one."""
    groups: dict[str, list[Piece]] = {}
    for piece in reading.pieces:
        groups.setdefault(piece.layer if layered else ALL_LAYERS, []).append(piece)
    return groups


def _measured(pieces: list[Piece], fineness: Fineness) -> Figures:
    """Return the figures of some pieces, joined by their ends; a line there and back encloses nothing."""
    length = sum(_length(piece.points) for piece in pieces)
    whole = [piece.points for piece in pieces if _ends_meet(piece.points, fineness.off_mm)]
    open_ones = [piece.points for piece in pieces if not _ends_meet(piece.points, fineness.off_mm)]
    closed = [*whole, *loops(open_ones, fineness.off_mm)]
    enclosed = [(abs(_area(loop)), _length(loop)) for loop in closed]
    contours = sorted((area, around) for area, around in enclosed if area > fineness.off_mm * around)
    every = np.concatenate([piece.points for piece in pieces])
    (x0, y0), (x1, y1) = every.min(axis=0), every.max(axis=0)
    return Figures(length, tuple(contours), (float(x0), float(y0), float(x1), float(y1)))


def loops(pieces: Sequence[Points2], off_mm: float) -> list[Points2]:
    """Return the closed loops that open pieces make, each piece in one at most; where several meet, the first."""
    left, found = list(pieces), []
    while left:
        chain = left.pop(0)
        while not _ends_meet(chain, off_mm):
            nearest = min(range(len(left)), key=lambda k: max(_reach(chain, left[k]), JOINED_MM), default=None)
            if nearest is None or _reach(chain, left[nearest]) > off_mm:
                break
            further = left.pop(nearest)
            turned = further if dist(chain[-1], further[0]) <= dist(chain[-1], further[-1]) else further[::-1]
            chain = np.concatenate([chain, turned[1:]])
        if _ends_meet(chain, off_mm):
            found.append(chain)
    return found


def _reach(chain: Points2, piece: Points2) -> float:
    """Return how far the end of a chain is from the nearer end of a piece."""
    return min(dist(chain[-1], piece[0]), dist(chain[-1], piece[-1]))


def _ends_meet(points: Points2, off_mm: float) -> bool:
    return len(points) > 3 and dist(points[0], points[-1]) <= off_mm


def _length(points: Points2) -> float:
    return float(np.hypot(*np.diff(points, axis=0).T).sum())


def _area(points: Points2) -> float:
    """Return the signed area; from the first point, so that far from the origin no digits are lost."""
    x, y = (points - points[0]).T
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2.0)


def expected(sample: Sample, layered: bool) -> dict[str, Figures]:
    """Return the figures of the lines and arcs that were written, by closed formulas."""
    groups: dict[str, list[Item]] = {}
    for item in sample.drawing.items:
        groups.setdefault(item.layer if layered else ALL_LAYERS, []).append(item)
    return {layer: _expected(items) for layer, items in groups.items()}


def _expected(items: list[Item]) -> Figures:
    paths = [item.path for item in items]
    contours = sorted((abs(arcpath.area(path)), arcpath.length(path)) for path in paths if path.closed)
    return Figures(sum(map(arcpath.length, paths)), tuple(contours), extent(paths), sum(map(_turn, paths)))


def _turn(path: ArcPath) -> float:
    """Return by how much a path turns, corners included, in rad."""
    return float(np.abs(arcpath.sweeps(path)).sum() + np.abs(arcpath.joint_turns(path)).sum())


def widest(sample: Sample) -> float:
    """Return the largest radius of an arc that may be on the box, the length of the box at most, in mm."""
    low_x, low_y, high_x, high_y = extent(item.path for item in sample.drawing.items)
    return max(high_x - low_x, high_y - low_y)


def can_read(reader: Reader, sample: Sample) -> bool:
    """Return whether a sample holds nothing but closed contours on the layers that a reader is asked for."""
    return all(item.path.closed for item in sample.drawing.items if item.layer in reader.only)


def complaints(reader: Reader, reading: Reading, sample: Sample) -> list[str]:
    """Return what a reader got wrong, one line for each figure; empty: it read the file right."""
    layered = reader.layered and (reader.block_layers or not sample.pattern)
    want = expected(sample, layered)
    want = {layer: figures for layer, figures in want.items() if not reader.only or layer in reader.only}
    got = measured(reading, reader.fineness, layered)
    if set(got) != set(want):
        return [f"layers {sorted(got)} instead of {sorted(want)}"]
    count = len(reading.pieces)
    said = [line for layer in want for line in _differences(reader.fineness, got[layer], want[layer], sample, count)]
    labels = tuple(sorted(label.text for label in sample.drawing.labels))
    if reading.texts is not None and tuple(sorted(reading.texts)) != labels:
        said.append(f"texts {reading.texts} instead of {labels}")
    return said


def _differences(fine: Fineness, got: Figures, want: Figures, sample: Sample, count: int) -> list[str]:
    """Return where two sets of figures differ by more than how finely the reader states curves."""
    said = []
    bound = fine.length_bound(want.length, want.turn, count)
    if abs(got.length - want.length) > bound:
        said.append(f"length {got.length:.6g} mm instead of {want.length:.6g} (within {bound:.2g})")
    if len(got.contours) != len(want.contours):
        said.append(f"{len(got.contours)} closed contours instead of {len(want.contours)}")
    for (area, _), (right, around) in zip(got.contours, want.contours, strict=False):
        bound = fine.area_bound(right, around)
        if abs(area - right) > bound:
            said.append(f"area {area:.6g} mm2 instead of {right:.6g} (within {bound:.2g})")
    bound = fine.box_bound(widest(sample))
    if np.abs(np.array(got.box) - np.array(want.box)).max() > bound:
        said.append(f"box {got.box} instead of {want.box} (within {bound:.2g})")
    return said
