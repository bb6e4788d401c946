"""W11, W12, W14 and W15: figures of the samples' files against their reports, bends, copies, pattern files."""

import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from io import StringIO
from math import radians
from pathlib import Path

import ezdxf
import numpy as np

from pipeline.run import Runner, finish
from stages.geometry.paths.arcpath import ArcPath, area, chords, distances, length, piece_count, split
from stages.model.cutfile import Machine
from stages.model.pattern import FlatPattern
from stages.model.patternlayers import PATTERN_LAYERS
from stages.model.surface import BranchedSurface, RuledSurface, Surface
from stages.write.chains import Entity
from stages.write.readback import read
from tests.bench.cutfiles.made import Made, Side, drawings, samples
from tests.bench.cutfiles.rows import Row, Worst, counted, limited
from tests.readers import gdal
from tests.readers.reading import Fineness, Reading, measured
from tests.stages.test_bend_tables import turning_deg

BY_GDAL, BY_US, ANGLE_DEG, ENDS_MM = 2e-4, 1e-9, 0.1, 0.05
CUTS = ("CUT_OUTER", "CUT_INNER")
STEP_DEG = 0.2
"""A degree, as the readers' tests have it, takes 1e-3 off a strake of 3 m, whose arcs are as flat."""
QUARTER_BULGE = 0.41421356237309503
D6673 = {*map(str, range(1, 16)), *map(str, range(80, 88))}
Sums = dict[str, tuple[float, float]]
"""Area and length of a layer, mm2 and mm, by what the layer means."""


def round_trip() -> Iterator[Row]:
    """W11: area and cut length of each layer as files are read, against the side files and the patterns."""
    by_gdal, by_us = list[Worst](), list[Worst]()
    for one, path, text in drawings():
        if one.machine.flavour == "aama" or (path.startswith("cut/") and not one.bare):
            continue
        told = _told(one.sides[path])
        if gdal.READER.available():
            by_gdal += [Worst(error, one.where(path)) for error in errors(_by_gdal(one, path, text), told)]
        if wanted := dict(_of_patterns(one, path)):
            by_us += [Worst(error, one.where(path)) for error in errors(_by_us(one, path, text), wanted)]
    how = f"area and length of each cut layer, GDAL (chords of {STEP_DEG:g} deg) against the side file"
    yield limited("W11", "as GDAL reads", (BY_GDAL, ""), by_gdal, how)
    how = "the same, our reader against contours of the patterns times their copies"
    yield limited("W11", "as we read", (BY_US, ""), by_us, how)


def errors(found: Sums, wanted: Sums) -> Iterator[float]:
    """Yield the relative errors of areas and lengths; infinite for a layer that is not there."""
    for layer in {**found, **wanted}:
        pairs = zip(found.get(layer, (0.0, 0.0)), wanted.get(layer, (0.0, 0.0)), strict=True)
        yield from (abs(a - b) / b if b else float("inf") * bool(a) for a, b in pairs)


def _told(side: Side) -> Sums:
    """Return what a side file says of the cut layers."""
    rows = [row for row in side["contours"] if row["layer"] in CUTS]
    layers = {row["layer"] for row in rows}
    return {name: tuple(_sum(rows, name, key) for key in ("area_mm2", "length_mm")) for name in layers}  # type: ignore[misc]


def _sum(rows: list[dict], layer: str, key: str) -> float:
    return float(sum(row[key] or 0.0 for row in rows if row["layer"] == layer))


def _by_gdal(one: Made, path: str, text: str) -> Sums:
    """Return what GDAL reads."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "drawing.dxf"
        file.write_text(text, "ascii")
        reading = gdal.stated(file, STEP_DEG)
    names = {one.machine.of_file(path).layers[meaning].name: meaning for meaning in CUTS}
    cut = Reading(tuple(piece for piece in reading.pieces if piece.layer in names))
    found = measured(cut, Fineness(step_rad=radians(STEP_DEG)), layered=True)
    return {names[name]: (sum(area for area, _ in one.contours), one.length) for name, one in found.items()}


def _by_us(one: Made, path: str, text: str) -> Sums:
    """Return what our own reader reads."""
    entities = read(text, one.machine.of_file(path).layers).entities
    return _summed((entity.layer, entity.path) for entity in entities if entity.layer in CUTS and entity.path)


def _of_patterns(one: Made, path: str) -> Iterator[tuple[str, tuple[float, float]]]:
    """Yield what the contours of the patterns in a drawing come to; nothing where it is not known which they are."""
    alone = {place: [pattern] for place, pattern, _ in one.flat()}
    nested = {place: [one.patterns[placed.part] for placed in layout.placements] for place, layout in one.sheets()}
    patterns = (alone | nested).get(path, [])
    yield from _summed(
        (layer, contour.path)
        for pattern in patterns
        for layer, contours in zip(CUTS, ((pattern.outer,), pattern.inner), strict=True)
        for contour in contours
    ).items()


def _summed(paths: Iterator[tuple[str, ArcPath]]) -> Sums:
    found: Sums = {}
    for layer, path in paths:
        wide, long = found.get(layer, (0.0, 0.0))
        found[layer] = (wide + abs(area(path)), long + length(path))
    return found


def bends() -> Iterator[Row]:
    """W12: bend tables against the turning of the surfaces, and where bend lines end."""
    angles, ends = list[Worst](), list[Worst]()
    for one in samples():
        for path, pattern, run in one.flat():
            rows, surface = one.sides[path]["bends"] or [], run.surface
            told = {metric.name for step in run.steps for metric in step.report.metrics}
            if "bend_angle_error_deg" in told and surface is not None:
                total = sum(row["angle_deg"] for row in rows)
                angles.append(Worst(abs(total - _turning_deg(surface)), one.where(path)))
            ends += [Worst(far, one.where(path)) for far in _ends(one, path, pattern)]
    how = "side files against the normal of the finished surface, followed from ruling to ruling"
    yield limited("W12", "sum of the signed bend angles", (ANGLE_DEG, "deg"), angles, how)
    how = "ends of bend lines in the file to the nearest contour, closed form"
    yield limited("W12", "bend lines end on the contour", (ENDS_MM, "mm"), ends, how)


def _turning_deg(surface: Surface) -> float:
    """Return how far the normal of a surface turns about its rulings, signs counted."""
    if isinstance(surface, RuledSurface):
        return turning_deg(surface)
    if isinstance(surface, BranchedSurface):
        return sum(turning_deg(face) for face in surface.faces)
    return 0.0


def _ends(one: Made, path: str, pattern: FlatPattern) -> Iterator[float]:
    """Yield how far the ends of bend lines are from the nearest contour of a part, mm."""
    entities = read(one.texts[path], one.machine.layers).entities
    gentle = [split(contour.path, max_bulge=QUARTER_BULGE) for contour in (pattern.outer, *pattern.inner)]
    for entity in entities:
        if entity.layer.startswith("BEND_") and entity.path is not None:
            for end in entity.path.vertices[[0, -1]]:
                yield min(
                    float(distances(np.tile(end, (len(chords(way)[0]), 1)), way, np.arange(piece_count(way))).min())
                    for way in gentle
                )


def copies() -> Row:
    """W14: sheets on which every copy has the pieces of its part, arc for arc, and all that is on it."""
    wrong, total = list[str](), 0
    for one in samples():
        parts = {path: _kinds(read(text, one.machine.layers).entities) for path, text in one.texts.items()}
        for path, layout in one.sheets() if one.bare else ():
            total += 1
            wanted: Counter[tuple] = sum((parts[f"flat/{placed.part}.dxf"] for placed in layout.placements), Counter())
            found = Counter({kind: count for kind, count in parts[path].items() if not kind[0].startswith("SHEET")})
            wrong += [one.where(path)] * (found != wanted)
    return counted("W14", "sheets whose copies are whole", wrong, total, "entities by layer, sort, pieces and arcs")


def _kinds(entities: tuple[Entity, ...]) -> Counter[tuple]:
    """Return how many entities there are of each layer, sort, number of pieces and of arcs.

    Up is down on a copy that is turned over.
    """
    made: Counter[tuple] = Counter()
    for one in entities:
        layer = "BEND" if one.layer.startswith("BEND_") else one.layer
        pieces = (0, 0) if one.path is None else (piece_count(one.path), int(np.count_nonzero(one.path.bulges)))
        made[layer, one.kind, *pieces] += 1
    return made


def pattern_files() -> Row:
    """W15: pattern files of all samples: layers of D6673 alone, one block for each piece, inserted once."""
    machine, wrong, total = Machine(flavour="aama", version="R12", layers=PATTERN_LAYERS), list[str](), 0
    for one in samples():
        job = replace(one.result.job, stock=(), layout=None, machine=machine)
        for file in finish(Runner(), job, one.result.parts).write.product or ():
            total += 1
            wrong += [f"{one.where(file.path)}: {fault}" for fault in unlike_d6673(file.text)]
    return counted("W15", "pattern files of D6673", wrong, total, "ezdxf: layers of all entities, blocks, insertions")


def unlike_d6673(text: str) -> Iterator[str]:
    """Yield what a pattern file has that D6673 has not."""
    document = ezdxf.read(StringIO(text))
    blocks = [block for block in document.blocks if not block.name.lower().startswith(("*", "$"))]
    inserted = [insert.dxf.name for insert in document.modelspace().query("INSERT")]
    names = [block.name for block in blocks]
    if not names or sorted(inserted) != sorted(names):
        yield f"blocks {names}, inserted {inserted}"
    entities = [*document.modelspace(), *(entity for block in blocks for entity in block)]
    foreign = {str(entity.dxf.layer) for entity in entities} - D6673
    if foreign:
        yield f"layers {sorted(foreign)}"
