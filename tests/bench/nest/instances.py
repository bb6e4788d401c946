"""Instances of the benchmark: JSON files of strips, sheets and hides, as the values that the nest takes.

The format is that of the published sets (`instances/README.md`).  Strip, sheets or hides is told by the keys and the
shapes: a file with `strip_height` is a roll of that width, a bin that is a plain rectangle a sheet, any other bin a
hide.  What a file says and planish cannot honour (quality zones on a part, say) is an error, never left out.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from pathlib import Path

import msgspec
import numpy as np

from stages.geometry.paths.arcpath import ArcPath, bounds
from stages.model.pattern import FlatPattern
from stages.model.sheet import NestOptions, Sheet, Zone
from tests.stages.nest.shapes import contour, pattern

FOLDER = Path(__file__).with_name("instances")

Corner = tuple[float, float]
Ring = list[Corner]


class Simple(msgspec.Struct, tag="simple_polygon", tag_field="type"):
    """A polygon without holes; the last corner may repeat the first."""

    data: Ring


class Rings(msgspec.Struct):
    outer: Ring
    inner: list[Ring] = []


class WithHoles(msgspec.Struct, tag="polygon", tag_field="type"):
    data: Rings


class Box(msgspec.Struct):
    x_min: float
    y_min: float
    width: float
    height: float


class Rectangle(msgspec.Struct, tag="rectangle", tag_field="type"):
    data: Box


Shape = Simple | WithHoles | Rectangle


class Area(msgspec.Struct):
    """A zone: of a bin it is honoured, of a part it is refused."""

    quality: int
    shape: Shape


class Item(msgspec.Struct, omit_defaults=True):
    id: int
    demand: int
    shape: Shape
    allowed_orientations: list[float] | None = None
    min_quality: int | None = None
    zones: list[Area] = []


class Bin(msgspec.Struct, omit_defaults=True):
    id: int
    shape: Shape
    stock: int | None = None
    cost: float | None = None
    zones: list[Area] = []


class File(msgspec.Struct, omit_defaults=True):
    """One file of the benchmark."""

    items: list[Item]
    name: str = ""
    strip_height: float | None = None
    bins: list[Bin] = []
    min_item_separation: float = 0.0
    min_edge_separation: float = 0.0
    known_optimal_length: float | None = None


@dataclass(frozen=True, slots=True)
class Instance:
    """What is to be nested on what; `name` is that of the file."""

    name: str
    patterns: tuple[FlatPattern, ...]
    stock: tuple[Sheet, ...]
    options: NestOptions

    @property
    def parts(self) -> int:
        """How many copies there are in all."""
        return sum(one.quantity for one in self.patterns)

    @property
    def is_strip(self) -> bool:
        return self.stock[0].is_roll


def load(folder: Path) -> list[Instance]:
    """Return the instances of a folder, by name."""
    return [from_json(file.stem, file.read_bytes()) for file in sorted(folder.glob("*.json"))]


def from_json(name: str, text: bytes) -> Instance:
    """Return the instance that a file holds; an error of it names the file."""
    try:
        return instance(name, msgspec.json.decode(text, type=File))
    except (msgspec.DecodeError, ValueError) as error:
        raise ValueError(f"{name}.json: {error}") from error


def instance(name: str, file: File) -> Instance:
    """Return the values of a file."""
    if (file.strip_height is None) == (not file.bins):
        raise ValueError("either strip_height or bins must be given")
    stock = [_sheet(one, file.min_edge_separation) for one in file.bins]
    if file.strip_height is not None:
        edge = file.min_edge_separation
        stock = [Sheet("strip", inf, file.strip_height, None, edge, kind="roll")]
    options = NestOptions(gap_mm=file.min_item_separation)
    return Instance(name, tuple(_pattern(one) for one in file.items), tuple(stock), options)


def on_sheets(strip: Instance, width_mm: float, height_mm: float) -> Instance:
    """Return a strip's parts on as many sheets of a size as they need."""
    edge = strip.stock[0].edge_gap_mm
    sheets = (Sheet("sheet", width_mm, height_mm, None, edge),)
    return replace(strip, name=f"{strip.name} on {width_mm:g} x {height_mm:g}", stock=sheets)


def _pattern(item: Item) -> FlatPattern:
    if item.zones:
        raise ValueError(f"item {item.id}: zones of a part are not supported")
    outer, inner = _rings(item.shape)
    turns = None if item.allowed_orientations is None else tuple(item.allowed_orientations) or (0.0,)
    holes = [contour(_open(ring), hole=True) for ring in inner]
    made = pattern(f"part-{item.id}", contour(_open(outer)), *holes, quantity=item.demand, rotations=turns)
    return replace(made, quality="best" if item.min_quality is None else item.min_quality)


def _sheet(bin_: Bin, edge_gap_mm: float) -> Sheet:
    """Return a bin; its stock is unlimited where it does not say."""
    if isinstance(bin_.shape, Rectangle) and (bin_.shape.data.x_min, bin_.shape.data.y_min) == (0.0, 0.0):
        width, height = bin_.shape.data.width, bin_.shape.data.height
        sheet = Sheet(f"sheet-{bin_.id}", width, height, bin_.stock, edge_gap_mm, bin_.cost)
        return replace(sheet, zones=tuple(map(_zone, bin_.zones)))
    outer, inner = _rings(bin_.shape)
    outline = _path(outer)
    low_x, low_y, high_x, high_y = bounds(outline)
    return Sheet(
        f"hide-{bin_.id}",
        high_x - low_x,
        high_y - low_y,
        bin_.stock,
        edge_gap_mm,
        bin_.cost,
        kind="hide",
        outline=outline,
        defects=tuple(map(_path, inner)),
        zones=tuple(map(_zone, bin_.zones)),
    )


def _zone(area: Area) -> Zone:
    outer, inner = _rings(area.shape)
    if inner:
        raise ValueError("a zone with holes is not supported")
    return Zone(_path(outer), area.quality)


def _rings(shape: Shape) -> tuple[Ring, Sequence[Ring]]:
    """Return the outer ring and those of the holes."""
    match shape:
        case Simple(ring):
            return ring, ()
        case WithHoles(rings):
            return rings.outer, rings.inner
        case Rectangle(box):
            x, y = box.x_min + box.width, box.y_min + box.height
            return [(box.x_min, box.y_min), (x, box.y_min), (x, y), (box.x_min, y)], ()


def _path(ring: Ring) -> ArcPath:
    return contour(_open(ring)).path


def _open(ring: Ring) -> Ring:
    """Return the corners without repetitions of the one before, the last without the first."""
    corners = np.array(ring, dtype=float)
    kept = corners[(corners != np.roll(corners, 1, axis=0)).any(axis=1)]
    return [(float(x), float(y)) for x, y in kept]
