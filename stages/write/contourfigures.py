"""What each contour and each layer of a file comes to, measured on the file as it reads; of a part also its marks.

Which contour is which is known from the drawing, whose paths the file holds in the same order; areas and lengths are
those of what was read.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from stages.geometry.paths import manypaths
from stages.geometry.paths.arcpath import ArcPath
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
    names = dict.fromkeys([*(entity.layer for entity in paths), *(label.layer for label in drawing.labels)])
    marks = [{"name": item.name, "layer": item.layer} for _, item in pairs if item.contour is None]
    return {
        "contours": _rows([(_path(entity), item) for entity, item in pairs if item.layer.startswith(CUT)]),
        "layers": _layers(list(names), paths, layers),
        "marks": marks if drawing.path.startswith(FLAT) else [],
    }


def _path(entity: Entity) -> ArcPath:
    if entity.path is None:
        raise ValueError("a file that was compared with its drawing holds a path for each of its items")
    return entity.path


def _rows(cuts: Sequence[tuple[ArcPath, Item]]) -> list[Row]:
    """Return a row for each contour; mm and mm2, the area None for a path that is not closed."""
    every = [path for path, _ in cuts]
    closed = [number for number, path in enumerate(every) if path.closed]
    areas = dict(zip(closed, np.abs(manypaths.areas([every[number] for number in closed])).tolist(), strict=True))
    lengths, boxes = manypaths.lengths(every).tolist(), manypaths.boxes(every).tolist()
    return [
        {
            "part": item.part,
            "copy": item.copy,
            "contour": item.contour,
            "name": item.name,
            "layer": item.layer,
            "purpose": item.purpose,
            "circle": None if item.drill is None else [*item.drill.at.tolist(), item.drill.diameter_mm],
            "area_mm2": areas.get(number),
            "length_mm": lengths[number],
            "box": boxes[number],
        }
        for number, (_, item) in enumerate(cuts)
    ]


def _layers(names: Sequence[str], entities: Sequence[Entity], layers: Mapping[str, Layer]) -> dict[str, Row]:
    """Return what a file calls its layers, and what lies on them; texts are not counted."""
    known = [(entity.layer, entity.path) for entity in entities if entity.path is not None]
    lengths: dict[str, list[float]] = {name: [] for name in names}
    for (name, _), long in zip(known, manypaths.lengths([path for _, path in known]).tolist(), strict=True):
        lengths[name].append(long)
    return {
        name: {
            "name": layers[name].name,
            "colour": layers[name].colour,
            "paths": len(some),
            "length_mm": float(sum(some)),
        }
        for name, some in lengths.items()
    }
