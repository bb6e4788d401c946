"""The tables of a job file that say what is cut from and how it is nested: `[[stock]]` and `[nest]`.

A stock is a rectangle, a closed outline, or a file: a drawing whose layers have a meaning (`LayersTable`), a JSON file
of pieces with defects and zones, or the remnants of an earlier job (`pipeline.stockfiles`).
"""

from collections.abc import Iterator, Sequence
from typing import Annotated, Literal

from msgspec import Meta, field

from pipeline.materials import are_same
from stages.model.caps import MOST_ANGLES, MOST_PLACES, MOST_ROWS
from stages.model.curves import CurveSpec, Table, Trouble, negatives, not_positive
from stages.model.part import PartSpec
from stages.model.scalars import Angle, Length, Number
from stages.model.sheet import NestOptions, StockKind

Rotations = Literal["free"] | Annotated[tuple[Angle, ...], Meta(max_length=MOST_ANGLES)]
Name = Annotated[str, Meta(min_length=1, max_length=80)]
LayerName = Annotated[str, Meta(min_length=1, max_length=255)]
LayerNames = Annotated[tuple[LayerName, ...], Meta(max_length=MOST_ROWS)]
DEFAULTS = NestOptions()
MOST_SHEETS = 100_000
"""Of one kind: as many as there may be copies."""
BEST_ZONE, WORST_ZONE = 50, 56
"""Layers of quality zones in leather CAD; that the first is the best is our reading, no standard fixes it."""


class ZoneLayer(Table, frozen=True, kw_only=True):
    """A layer whose closed contours are zones of one quality."""

    layer: LayerName
    quality: int


def zone_layers() -> tuple[ZoneLayer, ...]:
    """Return the layers 50 to 56 of leather CAD as qualities 7 to 1."""
    return tuple(
        ZoneLayer(layer=str(layer), quality=WORST_ZONE + 1 - layer) for layer in range(BEST_ZONE, WORST_ZONE + 1)
    )


class LayersTable(Table, frozen=True, kw_only=True):
    """What the layers of a drawing of stock mean; the first that the drawing has counts as the outline.

    outline: each closed contour is a piece of stock.  defects: nothing lies on them, holes are defects.
    grain: lines along the grain, or along the line of tightness of a hide.  stretch: lines across it.
    """

    outline: LayerNames = ("SHEET", "21", "1")
    defects: LayerNames = ("SHEET_KEEPOUT", "11")
    zones: Annotated[tuple[ZoneLayer, ...], Meta(max_length=MOST_ROWS)] = field(default_factory=zone_layers)
    grain: LayerNames = ("7",)
    stretch: LayerNames = ("33",)

    def troubles(self) -> Iterator[Trouble]:
        """Yield layers that mean two things."""
        seen: dict[str, str] = {}
        for key in ("outline", "defects", "grain", "stretch"):
            for i, name in enumerate(getattr(self, key)):
                yield from _twice(seen, f"{key}[{i}]", name)
        for i, zone in enumerate(self.zones):
            yield from _twice(seen, f"zones[{i}].layer", zone.layer)


def _twice(seen: dict[str, str], key: str, layer: str) -> Iterator[Trouble]:
    first = seen.setdefault(layer.casefold(), key)
    if first != key:
        yield Trouble(key, f'the layer "{layer}" is {first} as well', "a layer has one meaning")


class ZoneTable(Table, frozen=True, kw_only=True):
    """A zone that is worse than the rest of a sheet; quality: a whole number, higher is better."""

    outline: CurveSpec
    quality: int


class StockTable(Table, frozen=True, kw_only=True):
    """Stock: width and height of a rectangle (roll: the width across), a closed outline, or a file.

    quantity absent: as many as needed; of a hide and of a remnant 1, of JSON pieces what the file says.
    price: of one, of a metre of a roll.
    grain: direction in degrees, counter-clockwise from x, of rolling or of the line of tightness; absent: that of
        [material].
    defects: nothing lies on them.  zones: parts say which quality they accept.
    file: a drawing (see `layers`), JSON pieces, or remnant.json; entry: which of the pieces of a JSON file.
    material, thickness: what it is made of, if known; stock of another material or thickness is refused.
    """

    id: Name | None = None
    kind: StockKind = "sheet"
    width: Length | None = None
    height: Length | None = None
    outline: CurveSpec | None = None
    file: Annotated[str, Meta(max_length=500)] | None = None
    layers: LayersTable | None = None
    entry: Annotated[str, Meta(max_length=255)] | int | None = None
    quantity: Annotated[int, Meta(ge=1, le=MOST_SHEETS)] | None = None
    edge_gap: Length = field(default_factory=Length)
    price: Number | None = None
    grain: Angle | None = None
    defects: Annotated[tuple[CurveSpec, ...], Meta(max_length=MOST_PLACES)] = ()
    zones: Annotated[tuple[ZoneTable, ...], Meta(max_length=MOST_PLACES)] = ()
    material: Annotated[str, Meta(max_length=200)] | None = None
    thickness: Length | None = None

    @property
    def name(self) -> str:
        """Its id, which everything but stock of a file that was not read has."""
        return self.id or ""

    def troubles(self) -> Iterator[Trouble]:
        """Yield sizes that are no stock, keys that contradict each other, and outlines that enclose nothing."""
        yield from not_positive(self, "width", "height", "thickness")
        yield from negatives(self, "edge_gap", "price")
        if self.id is None and self.file is None:
            yield Trouble("id", "missing", "give the stock a name")
        yield from self._size_troubles()
        if self.file is None:
            yield from self._shape_troubles()

    def _size_troubles(self) -> Iterator[Trouble]:
        """Yield what is missing or too much for a size."""
        given = [key for key in ("file", "outline", "width") if getattr(self, key) is not None]
        if len(given) > 1:
            yield Trouble(given[1], f"beside {given[0]}", "one of width and height, outline, file")
        if not given:
            yield Trouble(
                "", f"a {self.kind} of no size", _SIZES.get(self.kind, "give width and height, or an outline")
            )
        if self.kind == "roll" and self.outline is not None:
            yield Trouble("outline", "a roll has no outline", "give its width, across; its length is open")
        if self.height is not None and (self.kind == "roll" or self.width is None):
            yield Trouble("height", f"without a width, or of a {self.kind}", "a roll has a width only, across")
        elif self.width is not None and self.height is None and self.kind != "roll":
            yield Trouble("height", "missing", "a rectangle has width and height")
        for key in ("layers", "entry") if self.file is None else ():
            if getattr(self, key) is not None:
                yield Trouble(key, "without a file", 'give file = "..." too')
        yield from self._gap_troubles()

    def _gap_troubles(self) -> Iterator[Trouble]:
        """Yield a margin that is wider than the sheet."""
        sides = [side for side in (self.width, self.height) if side is not None and side > 0]
        if sides and self.edge_gap > 0 and 2 * self.edge_gap >= min(sides):
            yield Trouble("edge_gap", f"{float(self.edge_gap):g} mm leaves no room", "less than half the sheet")

    def _shape_troubles(self) -> Iterator[Trouble]:
        """Yield outlines, defects and zones that are no closed contours round an area."""
        if self.outline is not None or self.defects or self.zones:
            from pipeline.stockshapes import shape_troubles

            yield from shape_troubles(self)


_SIZES = {
    "roll": "give its width, across; its length is open",
    "hide": "give its outline, or a file",
}


class NestTable(Table, frozen=True, kw_only=True):
    """Wishes for the nest; gap: between nominal contours, kerf included; time_limit in seconds.

    mirror: any copy may be turned over.  one_direction: all copies of a part lie in one angle.
    common_line: straight edges of neighbours may be cut together.
    offcut_min: what is left over counts from this shorter side on.
    offcut_credit: what it is worth, as a share of what the same area of the sheet costs.
    layout: a file that says where copies lie, seen from the job file: `layout.json` or `report.json` of a job that was
        nested, edited or not, as `--layout` takes it.
    """

    gap: Length = field(default_factory=Length)
    rotations: Rotations = "free"
    time_limit: Number = field(default_factory=lambda: Number(10))
    seed: Annotated[int, Meta(ge=0, le=2**31)] = 0
    mirror: bool = DEFAULTS.mirror
    one_direction: bool = DEFAULTS.one_direction
    common_line: bool = DEFAULTS.common_line
    offcut_min: Length = field(default_factory=lambda: Length(repr(DEFAULTS.offcut_min_mm)))
    offcut_credit: Number = field(default_factory=Number)
    layout: Annotated[str, Meta(min_length=1, max_length=500)] | None = None

    def troubles(self) -> Iterator[Trouble]:
        """Yield negative lengths, no time, and an empty list of angles."""
        yield from negatives(self, "gap")
        yield from not_positive(self, "time_limit", "offcut_min")
        if not 0 <= self.offcut_credit <= 1:
            yield Trouble("offcut_credit", f"{float(self.offcut_credit):g}", "a share: from 0 (worth nothing) to 1")
        if not self.rotations:
            yield Trouble("rotations", "no angle is allowed", 'list at least one, such as [0], or write "free"')


def grain_troubles(parts: Sequence[PartSpec], stock: Sequence[StockTable], grain: Angle | None) -> Iterator[Trouble]:
    """Yield the parts with a direction where some stock has none.  grain: that of the material."""
    unknown = [row.name for row in stock if row.grain is None and grain is None]
    for i, part in enumerate(parts if unknown else ()):
        for key in ("grain", "stretch_axis"):
            if getattr(part, key) is not None:
                message = f'the grain of the stock "{unknown[0]}" is not known'
                yield Trouble(f"part[{i}].{key}", message, "give material.grain, or grain under [[stock]]")


def other_material(stock: Sequence[StockTable], material: str, thickness: Length | None) -> Iterator[Trouble]:
    """Yield the stock that is not of the material or of the thickness of the job, where both are known."""
    for i, row in enumerate(stock):
        if row.material and material and not are_same(row.material, material):
            hint = f'material.name is "{material}": take other stock'
            yield Trouble(f"stock[{i}]", f'"{row.name}" is of "{row.material}"', hint)
        if row.thickness is not None and thickness is not None and row.thickness != thickness:
            hint = f"material.thickness is {float(thickness):g} mm: take other stock"
            yield Trouble(f"stock[{i}]", f'"{row.name}" is {float(row.thickness):g} mm thick', hint)
