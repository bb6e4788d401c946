"""What each contour and each layer of a file comes to, measured on the file as it reads; of a part also its marks.

Which contour is which is known from the drawing, whose paths the file holds in the same order; areas and lengths are
those of what was read.
"""

from collections.abc import Mapping

from stages.geometry.arcpath import area, bounds, length
from stages.model.cutfile import Layer
from stages.write.chains import Entity
from stages.write.drawing import Drawing, Item
from stages.write.readback import ReadFile

CUT = "CUT_"
FLAT = "flat/"
Row = dict[str, object]


def measured_file(back: ReadFile, drawing: Drawing, layers: Mapping[str, Layer]) -> dict[str, object]:
    """Return the contours that are cut and the layers in use, of a file that holds what was drawn."""
    paths = [entity for entity in back.entities if entity.kind != "TEXT"]
    pairs = list(zip(paths, drawing.items, strict=True))
    rows = [_row(entity, item) for entity, item in pairs if item.layer.startswith(CUT)]
    names = dict.fromkeys([*(entity.layer for entity in paths), *(label.layer for label in drawing.labels)])
    marks = [{"name": item.name, "layer": item.layer} for _, item in pairs if item.contour is None]
    return {
        "contours": rows,
        "layers": {name: _layer(name, layers[name], paths) for name in names},
        "marks": marks if drawing.path.startswith(FLAT) else [],
    }


def _row(entity: Entity, item: Item) -> Row:
    """Return one contour; mm and mm2, the area None for a path that is not closed."""
    path = entity.path
    if path is None:
        raise ValueError("a file that was compared with its drawing holds a path for each of its items")
    return {
        "part": item.part,
        "copy": item.copy,
        "contour": item.contour,
        "name": item.name,
        "layer": item.layer,
        "purpose": item.purpose,
        "circle": None if item.drill is None else [*item.drill.at.tolist(), item.drill.diameter_mm],
        "area_mm2": abs(area(path)) if path.closed else None,
        "length_mm": length(path),
        "box": list(bounds(path)),
    }


def _layer(name: str, layer: Layer, entities: list[Entity]) -> Row:
    """Return what a file calls a layer, and what lies on it; texts are not counted."""
    paths = [entity.path for entity in entities if entity.layer == name and entity.path is not None]
    return {
        "name": layer.name,
        "colour": layer.colour,
        "paths": len(paths),
        "length_mm": float(sum(length(path) for path in paths)),
    }
