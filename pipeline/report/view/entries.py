"""What the traveller reads of `view.json`, typed: the flat pattern as lines and arcs, the formed part as its net."""

from collections.abc import Mapping

import msgspec
from msgspec import Struct

VIEW = "view.json"


class Numbers(Struct, frozen=True):
    """Whole numbers of so many bytes, in base64."""

    bytes: int
    numbers: str


class CellsEntry(Struct, frozen=True):
    """What is left of a net."""

    whole: str
    corners: str


class LineEntry(Struct, frozen=True):
    """A line by its places on the net."""

    kind: str
    places: str


class Ruled(Struct, frozen=True, tag_field="kind", tag="ruled"):
    """A formed part by its rulings."""

    frame: tuple[tuple[float, float, float], ...]
    low: tuple[float, ...]
    step: float
    points: str
    breaks: tuple[int, ...]
    rulings: tuple[int, ...]
    cells: CellsEntry | None
    outlines: tuple[str, ...]
    lines: tuple[LineEntry, ...]


class Triangles(Struct, frozen=True, tag_field="kind", tag="mesh"):
    """A formed part by its triangles."""

    frame: tuple[tuple[float, float, float], ...]
    low: tuple[float, ...]
    step: float
    points: str
    triangles: Numbers
    outlines: tuple[Numbers, ...]


class PathView(Struct, frozen=True):
    """A path by x, y and bulge of one vertex after another, mm."""

    closed: bool
    points: list[float]


class MarkView(PathView, frozen=True, kw_only=True):
    """A mark on its layer."""

    layer: str


class FlatView(Struct, frozen=True):
    """A flat pattern, its outer contour first; label: where its name stands."""

    contours: tuple[PathView, ...]
    marks: tuple[MarkView, ...]
    label: tuple[float, float]


class PartView(Struct, frozen=True):
    """A part, flat and formed."""

    name: str
    flat: FlatView | None
    formed: Ruled | Triangles | None


class View(Struct, frozen=True):
    """What is drawn of the parts."""

    parts: tuple[PartView, ...]


def part_views(files: Mapping[str, bytes], path: str) -> dict[str, PartView]:
    """Return what is drawn of the parts by their names."""
    return {part.name: part for part in msgspec.json.decode(files[path], type=View).parts}
