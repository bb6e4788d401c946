"""The pattern file of one part -> its pattern, as `stages.write` puts it into `flat/` in the flavour aama.

The chords that were written stand for themselves, with the turn points, curve points and finer curves that the file has
for them; notches and drill holes come back from their points.  Of marks nothing tells any more where they were curved:
their vertices are turn points when they are written again.
"""

from collections.abc import Iterator, Mapping, Sequence
from math import cos, radians, sin

import numpy as np

from stages.geometry.arrays import Vector2, norm
from stages.geometry.paths.arcpath import ArcPath
from stages.geometry.paths.edges import edges_of
from stages.model.cutfile import Layer
from stages.model.features import NotchKind
from stages.model.pattern import (
    LETTER_WIDTH,
    MARK_LAYERS,
    Contour,
    Drill,
    FlatPattern,
    Mark,
    MarkLayer,
    NotchPlace,
    Text,
    Traced,
)
from stages.model.patternlayers import ANNOTATION, BOUNDARY, CUT_OUT, DRILL, NOTCH_LAYERS, TURN, VALIDATION
from stages.write.piecetext import LINE_STEP
from stages.write.readback import read
from stages.write.readpieces import Content, ReadText, read_pieces

NAME = "Piece Name:"
DECIMALS = 8
"""Places of a mm by which a point is on a vertex."""

DRAWN: dict[str, MarkLayer] = {layer: layer for layer in MARK_LAYERS}
NO_CORNERS = np.zeros((4, 2))


class NoPatternError(ValueError):
    """A drawing that is not that of one part."""


def piece_pattern(text: str, chord_mm: float, layers: Mapping[str, Layer]) -> FlatPattern:
    """Return the pattern of a file of one piece, one copy of it, named as the piece is."""
    back = read_pieces(text)
    if back.complaints or len(back.blocks) != 1:
        raise NoPatternError("; ".join(back.complaints) or f"{len(back.blocks)} pieces")
    block = back.blocks[0]
    own = [one for one in block.texts if one.layer == BOUNDARY]
    outer = list(_contours(block, BOUNDARY, chord_mm))
    if len(outer) != 1 or not own or not own[0].text.startswith(NAME):
        raise NoPatternError(f"{len(outer)} outlines and {len(own)} texts")
    return FlatPattern(
        part=own[0].text.removeprefix(NAME).strip(),
        quantity=1,
        outer=outer[0],
        inner=tuple(_contours(block, CUT_OUT, chord_mm)),
        marks=tuple(_marks(text, layers)),
        label_at=_middle(own),
        corners=NO_CORNERS,
        texts=tuple(_texts(block)),
        notches=tuple(_notches(block, outer[0].path)),
        drills=tuple(_drills(block)),
    )


def _contours(block: Content, layer: str, chord_mm: float) -> Iterator[Contour]:
    """Yield the closed lines on a layer with what the file says of them."""
    lines, curves = ([one.path for one in block.lines if one.layer == name] for name in (layer, VALIDATION[layer]))
    turns = {_key(one.x, one.y) for one in block.points if one.layer == TURN}
    for path, finer in zip(lines, curves, strict=True):
        if path is None or finer is None:
            raise NoPatternError(f"a line on {layer} has no two points")
        if path.closed:
            flags = tuple(_key(x, y) in turns for x, y in path.vertices.tolist())
            yield Contour(edges_of(path), path, chord_mm, traced=Traced(flags, finer))


def _key(x: float, y: float) -> tuple[float, float]:
    return round(x, DECIMALS), round(y, DECIMALS)


def _marks(text: str, layers: Mapping[str, Layer]) -> list[Mark]:
    """Return the lines that are no contours, in the order of the file, counted."""
    found: list[tuple[MarkLayer, ArcPath]] = [
        (DRAWN[one.layer], one.path)
        for one in read(text, layers).entities
        if one.layer in DRAWN and one.path is not None
    ]
    return [Mark(f"{layer}-{number}", path, layer) for number, (layer, path) in enumerate(found, 1)]


def _middle(lines: Sequence[ReadText]) -> Vector2:
    """Return the middle of texts below each other, which was the place of the part's name."""
    height = lines[0].height_mm
    wide, high = LETTER_WIDTH * max(len(one.text) for one in lines), LINE_STEP * len(lines)
    return np.array([lines[0].x + wide / 2.0 * height, lines[0].y - (high / 2.0 - 1.0) * height])


def _texts(block: Content) -> Iterator[Text]:
    said = [one for one in block.texts if one.layer == ANNOTATION]
    for number, one in enumerate(said, 1):
        yield Text(f"text-{number}", one.text, np.array([one.x, one.y]), one.height_mm, one.angle_deg)


def _notches(block: Content, outline: ArcPath) -> Iterator[NotchPlace]:
    """Yield the notches; on the layer of V notches one without a width is a slit."""
    kinds: dict[str, NotchKind] = {layer: kind for kind, layer in NOTCH_LAYERS.items() if kind != "slit"}
    for number, one in enumerate((point for point in block.points if point.layer in kinds), 1):
        kind = "slit" if kinds[one.layer] == "v" and one.width_mm == 0.0 else kinds[one.layer]
        inward = np.array([cos(radians(one.angle_deg)), sin(radians(one.angle_deg))])
        at = np.array([one.x, one.y])
        vertex = int(norm(outline.vertices - at).argmin())
        yield NotchPlace(
            f"notch-{number}", kind, at, inward, one.depth_mm, one.width_mm, in_outline=True, spot=(vertex, 0.0)
        )


def _drills(block: Content) -> Iterator[Drill]:
    for number, one in enumerate((point for point in block.points if point.layer == DRILL), 1):
        yield Drill(f"drill-{number}", np.array([one.x, one.y]), one.width_mm)
