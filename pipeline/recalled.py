"""What a drawing does not say of its pattern, from the side file beside it: what holes are for, notches, names.

    flat/<part>.dxf + flat/<part>.json -> the pattern with its features

A side file counts if it names the drawing by its digest and has as many contours, marks and texts; else nothing is
taken from it, and whoever asks is told so.  One that counts and that its drawing contradicts is refused.  Holes that
are drilled or stitched through are circles again, whatever chords the drawing holds; all other contours stay as they
were drawn.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice
from math import asin, pi, sin

import msgspec
import numpy as np
from msgspec import Struct

from pipeline.sideentries import DrillSide, FeatureSide, FileSide, NotchSide, Purpose, Row3
from pipeline.sidefaults import side_faults
from pipeline.store import digest
from stages.geometry.arrays import Vector2, norm
from stages.geometry.curves.plane import CircularArc
from stages.geometry.paths.arcpath import ArcPath, chords, distances, piece_count, sweeps
from stages.geometry.paths.biarc import trace
from stages.geometry.paths.edges import edges_of
from stages.model.pattern import Contour, Drill, FlatPattern, NotchPlace, Spot


class ContourEntry(Struct, frozen=True):
    """What is needed of a contour."""

    name: str
    layer: str
    purpose: Purpose | None
    circle: Row3 | None


class SideEntry(Struct, frozen=True):
    """What is needed of a side file."""

    files: tuple[FileSide, ...]
    contours: tuple[ContourEntry, ...]
    features: FeatureSide


class SideFileError(ValueError):
    """A side file that its own drawing contradicts."""


def recalled(pattern: FlatPattern, side: bytes | None, drawing: bytes) -> FlatPattern | None:
    """Return the pattern of a drawing with what its side file says; None where that is not the file of the drawing.

    Raises SideFileError where it is, and says what cannot be.
    """
    said = None if side is None else _decoded(side)
    if said is None or digest(drawing) not in {file.sha256 for file in said.files}:
        return None
    holes = [one for one in said.contours if one.layer == "CUT_INNER"]
    found = said.features
    counts = len(holes), len(found.marks), len(found.texts)
    if counts != (len(pattern.inner), len(pattern.marks), len(pattern.texts)):
        return None
    with np.errstate(over="ignore", invalid="ignore"):  # what overflows is not within any bound
        faults = [*islice(side_faults(pattern, [(one.name, one.circle) for one in holes], found), MOST_TOLD)]
    if faults:
        raise SideFileError("; ".join(faults))
    return _restored(pattern, holes, found)


MOST_TOLD = 5
"""Faults of one side file that are told."""


def _decoded(side: bytes) -> SideEntry | None:
    try:
        return msgspec.json.decode(side, type=SideEntry)
    except (msgspec.DecodeError, RecursionError):
        return None


def _restored(pattern: FlatPattern, holes: Sequence[ContourEntry], found: FeatureSide) -> FlatPattern:
    outline = pattern.boundary or pattern.outer
    if found.boundary is not None and pattern.outer.traced is None:
        rows = np.array(found.boundary)
        path = ArcPath(rows[:, :2], rows[:, 2], closed=True)
        outline = Contour(edges_of(path), path, pattern.outer.chord_mm)
    return pattern.replace(
        inner=tuple(_hole(contour, one) for contour, one in zip(pattern.inner, holes, strict=True)),
        marks=tuple(replace(mark, name=one.name) for mark, one in zip(pattern.marks, found.marks, strict=True)),
        texts=tuple(text.replace(name=name) for text, name in zip(pattern.texts, found.texts, strict=True)),
        notches=tuple(_notches(found.notches, outline)),
        boundary=None if outline is pattern.outer else outline,
        drills=tuple(map(_drill, found.drills)),
    )


def _hole(drawn: Contour, said: ContourEntry) -> Contour:
    """Return a hole as it was drawn, with its name and purpose; a round one that a tool makes as its circle."""
    drawn = replace(drawn, name=said.name, purpose=said.purpose or "cut")
    if said.circle is None:
        return drawn
    x, y, diameter = said.circle
    return _as_circle(drawn, np.array([x, y]), diameter)


def _as_circle(drawn: Contour, centre: Vector2, diameter_mm: float) -> Contour:
    """Return a round hole, whose path is kept where that has arcs."""
    edges = (circle(centre, diameter_mm),)
    path = drawn.path if drawn.path.bulges.any() else trace(edges, accuracy=drawn.chord_mm)
    return replace(drawn, edges=edges, path=path, traced=None)


def circle(centre: Vector2, diameter_mm: float) -> CircularArc:
    """Return the edge of a round hole."""
    return CircularArc(centre, diameter_mm / 2.0, 0.0, -2.0 * pi)


def _notches(said: Sequence[NotchSide], outline: Contour) -> Iterator[NotchPlace]:
    for one in said:
        at, inward = np.array(one.at), np.array(one.inward)
        sizes = one.depth_mm, one.width_mm
        yield NotchPlace(one.name, one.kind, at, inward, *sizes, one.in_outline, spot_of(at, outline), one.cut)


def spot_of(at: Vector2, outline: Contour) -> Spot:
    """Return where a place lies on an outline whose edges are the pieces of its path, none more than half a turn."""
    path = outline.path
    count = piece_count(path)
    piece = int(distances(np.broadcast_to(at, (count, 2)), path, np.arange(count)).argmin())
    start, end = (ends[piece] for ends in chords(path))
    share = min(float(norm(at - start)) / float(norm(end - start)), 1.0)
    half = float(sweeps(path)[piece]) / 2.0
    return piece, share if half == 0.0 else asin(share * sin(half)) / half


def _drill(said: DrillSide) -> Drill:
    return Drill(said.name, np.array(said.at), said.diameter_mm, said.purpose)
