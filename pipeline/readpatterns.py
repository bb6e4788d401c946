"""The drawing of one part -> its pattern: contours, marks and texts as `stages.write` puts them into `flat/`.

The exact edges are not in a drawing: the lines and arcs that were written stand for themselves.  Holes come back in the
order of cutting, the smallest first.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from pipeline.readpieces import NoPatternError, piece_pattern
from stages.geometry.paths.arcpath import ArcPath, area, backwards
from stages.geometry.paths.edges import edges_of
from stages.model.cutfile import PROFILES, Layer
from stages.model.pattern import MARK_LAYERS, Contour, FlatPattern, Mark, MarkLayer, Text
from stages.model.patternlayers import is_pattern_profile
from stages.write.chains import Entity, Writing
from stages.write.readback import ReadFile, read

DRAWN: dict[str, MarkLayer] = {layer: layer for layer in MARK_LAYERS}
NO_CORNERS = np.zeros((4, 2))


def read_pattern(text: str, chord_mm: float, layers: Mapping[str, Layer] = PROFILES["planish"]) -> FlatPattern:
    """Return the pattern, one copy of it, named as its label says; one whose texts are strokes has no name.

    chord_mm: what its contours were held to.  layers: how the drawing calls them.
    """
    if is_pattern_profile(layers):
        return piece_pattern(text, chord_mm, layers)
    back = read(text, layers)
    if back.complaints:
        raise NoPatternError("; ".join(back.complaints))
    outer = [entity for entity in back.entities if entity.layer == "CUT_OUTER"]
    writings = [entity.writing for entity in back.entities if entity.writing is not None]
    strangers = _strangers(back)
    engraved = [entity.path for entity in back.entities if entity.layer == "ENGRAVE" and entity.path is not None]
    if len(outer) != 1 or not (writings or engraved) or strangers:
        raise NoPatternError(strangers or f"{len(outer)} outer contours and {len(writings)} texts")
    name, *texts = writings or [_unread(engraved[0])]
    return FlatPattern(
        part=name.text,
        quantity=1,
        outer=_contour(outer[0], chord_mm, sense=1.0),
        inner=tuple(_contour(one, chord_mm, sense=-1.0) for one in back.entities if one.layer == "CUT_INNER"),
        marks=tuple(_marks(back.entities)),
        label_at=np.array([name.x, name.y]),
        corners=NO_CORNERS,
        texts=tuple(_text(writing, i) for i, writing in enumerate(texts)),
    )


def _unread(stroke: ArcPath) -> Writing:
    """Return a name in the place of a stroke of it: strokes are marks and tell nothing."""
    x, y = stroke.vertices[:2].mean(axis=0)
    return Writing("", float(x), float(y), 0.0, 0.0)


def _strangers(back: ReadFile) -> str:
    """Return what belongs to no part, or nothing."""
    odd = [one for one in back.entities if not _belongs(one)]
    return ", ".join(f"{one.kind} on {one.layer}" for one in odd)


def _belongs(entity: Entity) -> bool:
    """Return whether an entity is a path or a text on a layer of its own sort."""
    if entity.writing is not None:
        return entity.layer == "LABEL"
    return entity.path is not None and (entity.layer in DRAWN or entity.layer in ("CUT_OUTER", "CUT_INNER"))


def _contour(entity: Entity, chord_mm: float, *, sense: float) -> Contour:
    """Return a contour that runs counter-clockwise (sense 1) or clockwise (-1): circles have no sense of their own."""
    path = _closed(entity)
    if area(path) * sense < 0.0:
        path = backwards(path)
    return Contour(edges_of(path), path, chord_mm)


def _closed(entity: Entity) -> ArcPath:
    if entity.path is None or not entity.path.closed:
        raise NoPatternError(f"an open contour on {entity.layer}")
    return entity.path


def _marks(entities: Sequence[Entity]) -> list[Mark]:
    """Return the marks in the order of the drawing, counted."""
    drawn = [(DRAWN[one.layer], one.path) for one in entities if one.layer in DRAWN]
    return [Mark(f"{layer}-{i}", path, layer) for i, (layer, path) in enumerate(drawn, 1) if path is not None]


def _text(writing: Writing, number: int) -> Text:
    at = np.array([writing.x, writing.y])
    return Text(f"text-{number + 1}", writing.text, at, writing.height_mm, writing.angle_deg)
