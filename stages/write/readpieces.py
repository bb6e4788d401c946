"""What a pattern file says, read again from its text: its blocks with their lines, points and texts, and the rest.

Nothing of the pieces that were written is used here.  Layers are the numbers that the file has; what belongs into no
pattern file is kept by kind and layer.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from io import StringIO

import numpy as np
from ezdxf.document import Drawing as Document
from ezdxf.entities.dxfentity import DXFEntity
from ezdxf.entities.insert import Insert
from ezdxf.entities.line import Line
from ezdxf.entities.point import Point
from ezdxf.entities.polyline import Polyline
from ezdxf.entities.text import Text
from ezdxf.filemanagement import read as read_dxf
from ezdxf.lldxf.const import DXFError

from stages.geometry.paths.arcpath import ArcPath
from stages.write.readback import is_plain, old_path

LAYOUTS = ("*MODEL_SPACE", "*PAPER_SPACE", "$MODEL_SPACE", "$PAPER_SPACE")


@dataclass(frozen=True, slots=True)
class ReadLine:
    """A line or polyline on a layer; without a path if it has fewer than two vertices."""

    layer: str
    path: ArcPath | None


@dataclass(frozen=True, slots=True)
class ReadPoint:
    """A point on a layer; z, thickness and angle are the depth, width and direction of a notch."""

    layer: str
    x: float
    y: float
    depth_mm: float
    width_mm: float
    angle_deg: float


@dataclass(frozen=True, slots=True)
class ReadText:
    """A text on a layer, its point of alignment, height in mm and the angle of its line."""

    layer: str
    text: str
    x: float
    y: float
    height_mm: float
    angle_deg: float


@dataclass(frozen=True, slots=True)
class Content:
    """The lines, points and texts of a block or of the model space; what is none of them by kind and layer."""

    name: str
    lines: tuple[ReadLine, ...]
    points: tuple[ReadPoint, ...]
    texts: tuple[ReadText, ...]
    strangers: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ReadInsert:
    """An inserted block: its name, layer, place, factors and angle."""

    name: str
    layer: str
    x: float
    y: float
    scale: tuple[float, float]
    angle_deg: float


@dataclass(frozen=True, slots=True)
class ReadPieces:
    """A pattern file: its blocks in order, what is inserted, what else lies in the model space.

    layers: of the blocks themselves.  complaints: of the library, and what is not ASCII.
    """

    blocks: tuple[Content, ...]
    layers: tuple[str, ...]
    inserts: tuple[ReadInsert, ...]
    space: Content
    complaints: tuple[str, ...]


NOTHING = Content("", (), (), (), ())


def read_pieces(text: str) -> ReadPieces:
    """Return the content of a pattern file; where it cannot be read, only complaints."""
    try:
        document = read_dxf(StringIO(text))
        own = [block for block in document.blocks if block.name.upper() not in LAYOUTS]
        blocks = tuple(_content(block.name, block) for block in own)
        inserts = tuple(_insert(entity) for entity in document.modelspace() if isinstance(entity, Insert))
        space = _content("", [entity for entity in document.modelspace() if not isinstance(entity, Insert)])
    except (DXFError, ValueError) as error:
        return ReadPieces((), (), (), NOTHING, (f"cannot be read: {error}",))
    layers = tuple(str(block.block.dxf.layer) for block in own if block.block is not None)
    return ReadPieces(blocks, layers, inserts, space, (*_complaints(document), *_letters(text)))


def _complaints(document: Document) -> list[str]:
    return [f"{error.message}" for error in document.audit().errors]


def _letters(text: str) -> list[str]:
    return [] if text.isascii() else ["holds letters that are not ASCII"]


def _content(name: str, entities: Iterable[DXFEntity]) -> Content:
    every = list(entities)
    return Content(
        name,
        tuple(line for one in every if (line := _line(one)) is not None),
        tuple(_point(one) for one in every if isinstance(one, Point)),
        tuple(_text(one) for one in every if isinstance(one, Text)),
        tuple(f"{one.dxftype()} on {one.dxf.layer}" for one in every if _is_stranger(one)),
    )


def _is_stranger(entity: DXFEntity) -> bool:
    return _line(entity) is None and not isinstance(entity, Point | Text)


def _line(entity: DXFEntity) -> ReadLine | None:
    """Return a line or a plain polyline; None for anything else."""
    if isinstance(entity, Line):
        ends = np.array([(end.x, end.y) for end in (entity.dxf.start, entity.dxf.end)])
        return ReadLine(str(entity.dxf.layer), ArcPath(ends, np.zeros(2), closed=False))
    if not isinstance(entity, Polyline) or not is_plain(entity):
        return None
    return ReadLine(str(entity.dxf.layer), old_path(entity))


def _point(entity: Point) -> ReadPoint:
    at = entity.dxf.location
    width, angle = (float(entity.dxf.get(name, 0.0)) for name in ("thickness", "angle"))
    return ReadPoint(str(entity.dxf.layer), at.x, at.y, at.z, width, angle)


def _text(entity: Text) -> ReadText:
    _, at, _ = entity.get_placement()
    return ReadText(
        str(entity.dxf.layer), str(entity.dxf.text), at.x, at.y, float(entity.dxf.height), float(entity.dxf.rotation)
    )


def _insert(entity: Insert) -> ReadInsert:
    at = entity.dxf.insert
    scale = float(entity.dxf.xscale), float(entity.dxf.yscale)
    return ReadInsert(str(entity.dxf.name), str(entity.dxf.layer), at.x, at.y, scale, float(entity.dxf.rotation))
