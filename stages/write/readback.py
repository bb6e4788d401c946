"""What a written file says, read again from its text: header, entities as paths, and what the library complains of.

Lines and arcs that follow each other are one path again (`chains`).  Layers go by what they mean: a profile says how
the file calls them, and two that share a name are told apart by colour.

Nothing of the drawing that was written is used here.  Texts are kept with what they say and where; entities that are
neither (what does not belong into a cut file) by kind and layer.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from io import StringIO

import numpy as np
from ezdxf.document import Drawing as Document
from ezdxf.entities.arc import Arc
from ezdxf.entities.circle import Circle
from ezdxf.entities.dxfentity import DXFEntity
from ezdxf.entities.line import Line
from ezdxf.entities.lwpolyline import LWPolyline
from ezdxf.entities.polyline import Polyline
from ezdxf.entities.text import Text
from ezdxf.filemanagement import read as read_dxf
from ezdxf.lldxf.const import DXFError

from stages.geometry.arrays import Points3
from stages.geometry.paths.arcpath import ArcPath
from stages.model.cutfile import PROFILES, Layer
from stages.write.blocks import drawn
from stages.write.chains import Entity, Writing, chained

FULL_TURN = 360.0
MOST_FLAGS = 1 + 128
"""A plain polyline in the plane is closed or not, and may say that its line type runs on; all else is another thing."""


@dataclass(frozen=True, slots=True)
class ReadFile:
    """A file as read: its version, header variables, entities in order, layer colours, and complaints of the reader.

    layers: those that are declared and mean something, by what they mean.
    """

    header: dict[str, object]
    entities: tuple[Entity, ...]
    layers: dict[str, int]
    complaints: tuple[str, ...]
    version: str = ""


KEPT = 8
"""Texts whose content is kept: what compares a file with its drawing and what certifies it ask one after the other."""


def read(text: str, layers: Mapping[str, Layer] = PROFILES["planish"]) -> ReadFile:
    """Return the content of a DXF text; where it cannot be read, only complaints.

    layers: how the file calls them.
    """
    return _read(text, tuple(layers.items()))


@lru_cache(maxsize=KEPT)
def _read(text: str, named: tuple[tuple[str, Layer], ...]) -> ReadFile:
    """Return the content of a text; it is not to be changed."""
    layers = dict(named)
    try:
        document = read_dxf(StringIO(text))
        entities = chained(_meant([_entity(entity) for entity in drawn(document, layers)], layers))
    except (DXFError, ValueError) as error:
        return ReadFile({}, (), {}, (f"cannot be read: {error}",))
    complaints = [f"{error.message}" for error in document.audit().errors]
    if not text.isascii():
        complaints.append("holds letters that are not ASCII")
    version = str(document.acad_release)
    return ReadFile(_header(document), entities, _colours(document, layers), tuple(complaints), version)


def forget() -> None:
    """Read again what has been read: for who measures how long that takes."""
    _read.cache_clear()


def _meant(entities: Sequence[Entity], layers: Mapping[str, Layer]) -> list[Entity]:
    """Return entities on the layers that their layers' names mean, and their colours where several share a name."""
    meaning = {said: _meaning(*said, layers) for said in {(one.layer, one.colour) for one in entities}}
    return [
        one if meaning[one.layer, one.colour] == one.layer else replace(one, layer=meaning[one.layer, one.colour])
        for one in entities
    ]


def _meaning(name: str, colour: int, layers: Mapping[str, Layer]) -> str:
    """Return what a layer of a file is in a colour."""
    named = [meaning for meaning, layer in layers.items() if layer.name.casefold() == name.casefold()]
    coloured = [meaning for meaning in named if layers[meaning].colour == colour]
    return (coloured or named or [_foreign(name, layers)])[0]


def _foreign(name: str, layers: Mapping[str, Layer]) -> str:
    """Return the name of a layer that means nothing, such that nobody takes it for one that does."""
    return f"{name} of another profile" if name in layers else name


def _colours(document: Document, layers: Mapping[str, Layer]) -> dict[str, int]:
    """Return the colours of the layers that the file declares; where several share a name, each has its own."""
    declared = {str(layer.dxf.name).casefold(): int(layer.dxf.color) for layer in document.layers}
    shared = Counter(layer.name.casefold() for layer in layers.values())
    return {
        meaning: declared[name] if shared[name] == 1 else layer.colour
        for meaning, layer in layers.items()
        if (name := layer.name.casefold()) in declared
    }


def _header(document: Document) -> dict[str, object]:
    """Return all header variables by name."""
    return {name: document.header[name] for name in document.header.varnames()}


def _entity(entity: DXFEntity) -> Entity:
    """Return one entity with its path, if it is a line, an arc, a polyline or a circle."""
    if isinstance(entity, LWPolyline):
        # x, y, two widths, bulge
        points = np.asarray(entity.lwpoints.values, dtype=np.float64)[:, [0, 1, 4]]
        return _found(entity, _polyline(points, closed=bool(entity.closed)), closed=bool(entity.closed))
    if isinstance(entity, Polyline) and is_plain(entity):
        return _found(entity, old_path(entity), closed=bool(entity.is_closed))
    # an arc is a circle to the library
    if isinstance(entity, Arc):
        return _found(entity, _arc(entity))
    if isinstance(entity, Circle):
        return _found(entity, _circle(entity), closed=True)
    if isinstance(entity, Line):
        ends = [(end.x, end.y) for end in (entity.dxf.start, entity.dxf.end)]
        return _found(entity, _path(ends, [0.0, 0.0], closed=False))
    return _found(entity, None, writing=_writing(entity) if isinstance(entity, Text) else None)


def _found(entity: DXFEntity, path: ArcPath | None, *, closed: bool = False, writing: Writing | None = None) -> Entity:
    """Return an entity with what it is; a piece that names its line type begins a path."""
    dxf = entity.dxf
    begins = isinstance(entity, Arc | Line) and dxf.hasattr("linetype")
    # colour 256: as the layer
    return Entity(entity.dxftype(), str(dxf.layer), int(dxf.get("color", 256)), path, closed, writing, begins)


def _writing(entity: Text) -> Writing:
    """Return a text with its point of alignment, whatever that is of its box."""
    _, at, _ = entity.get_placement()
    return Writing(str(entity.dxf.text), at.x, at.y, float(entity.dxf.height), float(entity.dxf.rotation))


def is_plain(entity: Polyline) -> bool:
    """Return whether an old polyline is one in the plane, neither smoothed nor a mesh."""
    return not int(entity.dxf.flags) & ~MOST_FLAGS


def old_path(entity: Polyline) -> ArcPath | None:
    """Return the path of an old polyline; none if it has fewer than two vertices."""
    corners = [(corner.dxf.location.x, corner.dxf.location.y, corner.dxf.bulge) for corner in entity.vertices]
    return _polyline(np.array(corners, dtype=np.float64).reshape(-1, 3), closed=bool(entity.is_closed))


def _polyline(points: Points3, *, closed: bool) -> ArcPath | None:
    """Return the path of a polyline of x, y and bulge; none if it has fewer than two vertices."""
    if points.shape[0] < 2:  # noqa: PLR2004  no path
        return None
    return _path(points[:, :2], points[:, 2], closed=closed)


def _arc(entity: Arc) -> ArcPath:
    """Return an arc, which runs counter-clockwise, with the ends that a reader computes."""
    x, y, radius = entity.dxf.center.x, entity.dxf.center.y, entity.dxf.radius
    sweep = (entity.dxf.end_angle - entity.dxf.start_angle) % FULL_TURN or FULL_TURN
    angles = np.radians([entity.dxf.start_angle, entity.dxf.start_angle + sweep])
    ends = np.stack([x + radius * np.cos(angles), y + radius * np.sin(angles)], axis=1)
    return _path(ends, [np.tan(np.radians(sweep) / 4.0), 0.0], closed=False)


def _circle(entity: Circle) -> ArcPath:
    """Return a circle as two half circles."""
    x, y, radius = entity.dxf.center.x, entity.dxf.center.y, entity.dxf.radius
    return _path([(x + radius, y), (x - radius, y)], [1.0, 1.0], closed=True)


def _path(vertices: object, bulges: object, *, closed: bool) -> ArcPath:
    """Return the path; the bulge after the last vertex of an open one is dropped, as readers do."""
    bends = np.array(bulges, dtype=np.float64)
    if not closed:
        bends[-1] = 0.0
    return ArcPath(np.array(vertices, dtype=np.float64).reshape(-1, 2), bends, closed)
