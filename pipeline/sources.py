"""Curves that a job file takes from drawings: `{file = "rails.dxf", layer = "A"}` -> curves of its own sorts.

A drawing lies where the job file says, seen from the job file.  Its unit is that of its header ($INSUNITS); a drawing
without a unit has that of the job, and that is noted.  Pieces whose ends meet become one curve (`pipeline.drawings`).
An outline must be closed; the holes of a plate, and the defects of a sheet, are all closed contours of their layer.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from hashlib import sha256
from io import BytesIO, TextIOWrapper
from math import dist
from typing import TYPE_CHECKING

from pipeline.decode import ResolveError, Several, suggestion
from pipeline.parse import LARGEST_FILE
from pipeline.paths import Path
from pipeline.reach import Reach
from pipeline.stocktables import LayersTable, NestTable, StockTable
from pipeline.units import UnreadableError, describe
from stages.model.curves import CurveSpec, Table
from stages.model.faces import FaceFile
from stages.model.meshes import MeshFile, MeshNormals

if TYPE_CHECKING:
    from ezdxf.document import Drawing

    from pipeline.cad.files import CadSource
    from pipeline.drawings import Piece
    from pipeline.meshsources import MeshSource

UNIT_OF_CODE = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m", 13: "um"}
"""$INSUNITS, as the DXF reference numbers the units; 0 is none."""

NO_DXF = "it is no DXF file"
LARGEST_DRAWING = 100_000_000
"""Bytes."""


Tell = Callable[[str], None]
"""Is told what takes long."""


@dataclass(slots=True)
class Sources:
    """The drawings and meshes of one job file, each read once, and their names and sha256.

    meshes, faces: by the number of the part; touched: the meshes besides that its surface points at.
    layout: name and bytes of the file that says where copies lie, if there is one.
    tolerances: the keys of [tolerance] that the job gives itself, whatever their values are.
    """

    reach: Reach
    unit: str
    notes: list[str] = field(default_factory=list)
    drawings: dict[str, "Drawing"] = field(default_factory=dict)
    digests: list[tuple[str, str]] = field(default_factory=list)
    meshes: dict[int, "MeshSource"] = field(default_factory=dict)
    faces: dict[int, "CadSource"] = field(default_factory=dict)
    touched: dict[int, "dict[MeshNormals, MeshSource]"] = field(default_factory=dict)
    layout: tuple[str, bytes] | None = None
    tolerances: frozenset[str] = frozenset()

    def resolve(self, table: Table, path: Path) -> Table | Several:
        """Return the curve, or curves, that a reference to a drawing stands for; other tables as they are."""
        if isinstance(table, MeshFile):
            self.meshes[_part(path)] = self._mesh(table)
        if isinstance(table, MeshNormals):
            self.touched.setdefault(_part(path), {})[table] = self._mesh(table)
        if isinstance(table, FaceFile):
            self._read_faces(table, path)
        if isinstance(table, NestTable) and table.layout is not None:
            self.layout = table.layout, self._laid(table.layout)
        if isinstance(table, StockTable) and table.file is not None:
            return Several(_sound(self._stock(table, table.file)))
        if not isinstance(table, CurveSpec) or table.file is None:
            return table
        curves, key = self._curves(table.file, table.layer), "layer" if table.layer else "file"
        if {"holes", "defects"} & {*path[-2:]}:
            _all_closed(curves, key)
            return Several(tuple(curve.spec() for curve in curves))
        if len(curves) != 1:
            raise ResolveError(key, *_not_one(curves))
        if path[-1:] == ("outline",):
            _all_closed(curves, key)
        return curves[0].spec()

    def _mesh(self, table: MeshFile | MeshNormals) -> "MeshSource":
        """Return the mesh of a file."""
        from pipeline.meshsources import content_of, mesh_source

        content = content_of(self.reach, table.file)
        source = mesh_source(content, table, self.unit)
        said = table.file, sha256(content).hexdigest()
        if said not in self.digests:
            self.digests.append(said)
        note = f"{table.file} states no unit: taken as {source.unit}, the unit of the job"
        if source.assumed and note not in self.notes:
            self.notes.append(note)
        return source

    def _read_faces(self, table: FaceFile, path: Path) -> None:
        """Read the faces of a part."""
        from pipeline.cad.files import cad_source

        source = cad_source(self.reach, table)
        if (table.file, source.digest) not in self.digests:
            self.digests.append((table.file, source.digest))
        self.faces.update({number: source for number in path if isinstance(number, int)})

    def _stock(self, row: StockTable, name: str) -> tuple[StockTable, ...]:
        """Return the pieces of stock of a drawing or of a JSON file."""
        from pipeline import stockfiles

        if name.casefold().endswith(".json"):
            from pipeline.stockjson import rows_of_json

            if row.layers is not None:
                raise ResolveError("layers", f"{name} has no layers", "leave them out")
            blank = stockfiles.plain_row(row, stockfiles.stem_of(name))
            return rows_of_json(row, blank, self._content(name, LARGEST_DRAWING, "is this stock?"), self.unit)
        if row.entry is not None:
            raise ResolveError("entry", f"the pieces of {name} have no names", "leave it out: all are taken")
        layers = row.layers or LayersTable()
        present = {str(entity.dxf.layer) for entity in self._drawing(name).modelspace()}
        used = stockfiles.used_layers(layers, present)
        if missing := stockfiles.missing_layers(layers, present):
            self.notes.append(f"{name}: {missing}")
        unused = sorted(present - {*used})
        if unused:
            self.notes.append(f"{name}: nothing is read from the layers {', '.join(unused)}")
        try:
            curves = {layer: self._curves(name, layer) for layer in used}
        except ResolveError as error:
            raise ResolveError("file", error.message, error.hint) from None
        return stockfiles.rows_of_drawing(row, curves)

    def _laid(self, name: str) -> bytes:
        """Return the bytes of the file of a layout."""
        try:
            return self._content(name, LARGEST_FILE, "is this a layout?")
        except ResolveError as error:
            raise ResolveError("layout", error.message, error.hint) from None

    def _content(self, name: str, largest: int, hint: str) -> bytes:
        """Return the bytes of a file, their sha256 noted."""
        content = self.reach.content(name, largest, hint)
        said = name, sha256(content).hexdigest()
        if said not in self.digests:
            self.digests.append(said)
        return content

    def _curves(self, name: str, layer: str | None) -> "list[Piece]":
        """Return all curves of a layer, or of the whole model space."""
        from pipeline.drawings import chains, pieces

        drawing = self._drawing(name)
        unit = self._unit(drawing, name)
        layers = sorted({entity.dxf.layer for entity in drawing.modelspace()})
        chosen = [entity for entity in drawing.modelspace() if layer is None or _same(entity.dxf.layer, layer)]
        if not chosen:
            message = f'{name} has nothing on the layer "{layer}"' if layer else f"{name} is empty"
            raise ResolveError("layer" if layer else "file", message, suggestion(layer, layers) if layers else "")
        try:
            return chains([piece for entity in chosen for piece in pieces(entity, unit)])
        except UnreadableError as error:
            raise ResolveError("layer" if layer else "file", f"{name}: {error.message}", error.hint) from None

    def _drawing(self, name: str) -> "Drawing":
        if name not in self.drawings:
            content = self.reach.content(name, LARGEST_DRAWING, "is this a drawing?")
            self.drawings[name] = _read(content, name)
            self.digests.append((name, sha256(content).hexdigest()))
        return self.drawings[name]

    def _unit(self, drawing: "Drawing", name: str) -> str:
        """Return the unit of a drawing."""
        code = drawing.header.get("$INSUNITS", 0)
        if code == 0:
            note = f"{name} states no unit ($INSUNITS = 0): taken as {self.unit}, the unit of the job"
            if note not in self.notes:
                self.notes.append(note)
            return self.unit
        if code not in UNIT_OF_CODE:
            known = ", ".join(f"{number} = {unit}" for number, unit in UNIT_OF_CODE.items())
            raise ResolveError("file", f"{name} has the unit $INSUNITS = {code}", f"units read here: {known}")
        return UNIT_OF_CODE[code]


def _sound(rows: tuple[StockTable, ...]) -> tuple[StockTable, ...]:
    """Return the pieces of stock of a file; refuse what breaks the rules of a stock."""
    for text in (text for row in rows for text in (row.name, row.material or "")):
        if len(text) > LONGEST_NAME or not text.isprintable():
            raise ResolveError("file", f"{describe(text)} is no name of a piece or of a material", "plain text")
    wrong = [(row.name, trouble) for row in rows for trouble in row.troubles()]
    if wrong:
        told = (f'"{name}" {trouble.key}: {trouble.message}' for name, trouble in wrong[:MOST_WRONG])
        more = f"; and {len(wrong) - MOST_WRONG} more" if len(wrong) > MOST_WRONG else ""
        raise ResolveError("file", "; ".join(told) + more, wrong[0][1].hint)
    return rows


LONGEST_NAME = 200
"""Letters: those of a name in a job file and of one in the other file."""
MOST_WRONG = 5
"""Faults of the stock in one file that are told."""


def _part(path: Path) -> int:
    """Return the number of the part that a path leads into."""
    return next(number for number in path if isinstance(number, int))


def _same(a: str, b: str) -> bool:
    """Return whether two layer names are one: DXF does not tell upper from lower case."""
    return a.casefold() == b.casefold()


def _not_one(curves: "Sequence[Piece]") -> tuple[str, str]:
    """Return the message and the hint for curves that are not one."""
    from pipeline.drawings import GAP_MM, least_gap

    gap = least_gap(curves)
    apart = "" if gap is None else f": the nearest ends are {gap:.4g} mm apart"
    hint = f"give each a layer of its own, or make their ends meet within {GAP_MM:g} mm"
    return f"{len(curves)} separate curves where one belongs{apart}", hint


def _all_closed(curves: "list[Piece]", key: str) -> None:
    """Refuse open curves."""
    for curve in curves:
        if not curve.closed:
            (x0, y0, _), (x1, y1, _) = curve.start, curve.end
            ends = f"the curve from ({x0:.6g}, {y0:.6g}) to ({x1:.6g}, {y1:.6g}) mm is open"
            message = f"{ends}, its ends {dist(curve.start, curve.end):.4g} mm apart"
            raise ResolveError(key, message, "close the contour in the drawing")


def _read(content: bytes, name: str) -> "Drawing":
    """Return the drawing."""
    from ezdxf.lldxf.const import DXFError

    try:
        return _drawing_of(content)
    except OSError:
        raise ResolveError("file", f"{name} cannot be read: {NO_DXF}", "") from None
    except (DXFError, ValueError, KeyError, IndexError, TypeError, AttributeError) as error:
        hint = "write it again as DXF R2000 or later"
        raise ResolveError("file", f"{name} is no drawing that can be read: {error}", hint) from None


def _drawing_of(content: bytes) -> "Drawing":
    """Return the drawing of a binary DXF file, or of a text in the encoding that it names; `OSError` for no DXF."""
    from ezdxf.document import Drawing
    from ezdxf.filemanagement import dxf_stream_info, read
    from ezdxf.lldxf.tagger import binary_tags_loader
    from ezdxf.lldxf.validator import is_dxf_stream

    if content.startswith(BINARY_DXF):
        return Drawing.load(binary_tags_loader(content, errors="replace"))
    if not is_dxf_stream(_text(content, "utf-8", "ignore")):
        raise OSError(NO_DXF)
    info = dxf_stream_info(_text(content, "utf-8", "ignore"))
    return read(_text(content, info.encoding, "replace"))


BINARY_DXF = b"AutoCAD Binary DXF"


def _text(content: bytes, encoding: str, errors: str) -> TextIOWrapper:
    return TextIOWrapper(BytesIO(content), encoding, errors)
