"""What a written file says, read again from its text: header, entities as paths, and what the library complains of.

Nothing of the drawing that was written is used here.  Texts are kept with what they say and where; entities that are
neither (what does not belong into a cut file) by kind and layer.
"""

from dataclasses import dataclass
from io import StringIO

import numpy as np
from ezdxf.document import Drawing as Document
from ezdxf.entities.circle import Circle
from ezdxf.entities.dxfentity import DXFEntity
from ezdxf.entities.line import Line
from ezdxf.entities.lwpolyline import LWPolyline
from ezdxf.entities.text import Text
from ezdxf.filemanagement import read as read_dxf
from ezdxf.lldxf.const import DXFError

from stages.geometry.arcpath import ArcPath


@dataclass(frozen=True, slots=True)
class Writing:
    """A text by its letters, the place of its middle, its height (mm) and the direction of its line."""

    text: str
    x: float
    y: float
    height_mm: float
    angle_deg: float


@dataclass(frozen=True, slots=True)
class Entity:
    """One entity: its DXF name, layer, colour index, its path if it is one, whether it closes, what it says.

    A circle is a closed path of two half circles, counter-clockwise.
    """

    kind: str
    layer: str
    colour: int
    path: ArcPath | None
    closed: bool
    writing: Writing | None = None


@dataclass(frozen=True, slots=True)
class ReadFile:
    """A file as read: header variables, entities in order, layer colours, and complaints of the reader."""

    header: dict[str, object]
    entities: tuple[Entity, ...]
    layers: dict[str, int]
    complaints: tuple[str, ...]


def read(text: str) -> ReadFile:
    """Return the content of a DXF text; where it cannot be read, only complaints."""
    try:
        document = read_dxf(StringIO(text))
        entities = tuple(_entity(entity) for entity in document.modelspace())
    except (DXFError, ValueError) as error:
        return ReadFile({}, (), {}, (f"cannot be read: {error}",))
    complaints = [f"{error.message}" for error in document.audit().errors]
    if not text.isascii():
        complaints.append("holds letters that are not ASCII")
    return ReadFile(_header(document), entities, _layers(document), tuple(complaints))


def _header(document: Document) -> dict[str, object]:
    """Return all header variables by name."""
    return {name: document.header[name] for name in document.header.varnames()}


def _layers(document: Document) -> dict[str, int]:
    """Return the colour index of each layer."""
    return {str(layer.dxf.name): int(layer.dxf.color) for layer in document.layers}


def _entity(entity: DXFEntity) -> Entity:
    """Return one entity with its path, if it is a line, a polyline or a circle."""
    path, closed = None, False
    if isinstance(entity, LWPolyline):
        path, closed = _polyline(entity), bool(entity.closed)
    elif isinstance(entity, Circle):
        path, closed = _circle(entity), True
    elif isinstance(entity, Line):
        ends = [(end.x, end.y) for end in (entity.dxf.start, entity.dxf.end)]
        path = _path(ends, [0.0, 0.0], closed=False)
    writing = _writing(entity) if isinstance(entity, Text) else None
    # colour 256: as the layer
    return Entity(entity.dxftype(), str(entity.dxf.layer), int(entity.dxf.get("color", 256)), path, closed, writing)


def _writing(entity: Text) -> Writing:
    """Return a text with its point of alignment, whatever that is of its box."""
    _, at, _ = entity.get_placement()
    return Writing(str(entity.dxf.text), at.x, at.y, float(entity.dxf.height), float(entity.dxf.rotation))


def _polyline(entity: LWPolyline) -> ArcPath | None:
    """Return the path of a polyline, or None if it has fewer than two vertices."""
    points = np.array(entity.get_points("xyb"), dtype=np.float64).reshape(-1, 3)
    if points.shape[0] < 2:  # noqa: PLR2004  no path
        return None
    return _path(points[:, :2], points[:, 2], closed=bool(entity.closed))


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
