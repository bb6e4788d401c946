"""The table `[dxf]`: how drawings are written, and what is said of it to the write stage.

Names of layers are ASCII, for R12 capital letters, digits, dash, dollar and underscore, at most 31 of them; what else
tells layers apart is the colour.  Fields of file names have the values that a job has; a clock is none of them.
"""

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated

from msgspec import Meta
from msgspec.structs import asdict

from stages.model.caps import MOST_ROWS
from stages.model.curves import Table, Trouble
from stages.model.cutfile import (
    FIELD,
    FILE_NAMES,
    PROFILES,
    FilePer,
    Flavour,
    Layer,
    Lettering,
    Machine,
    Paper,
    Picture,
    Profile,
    Side,
    Style,
    Version,
)
from stages.model.patternlayers import PATTERN_LAYERS

Colour = Annotated[int, Meta(ge=1, le=255)]
LayerName = Annotated[str, Meta(min_length=1, max_length=255)]

JOB_FIELDS = ("job", "customer", "revision", "material", "thickness")
OWN_FIELDS: dict[FilePer, tuple[str, ...]] = {"sheet": ("stock", "index"), "part": ("part",), "material": ()}
"""The fields without which the files of a job would be called the same."""

OLD: tuple[Flavour, ...] = ("r12", "aama")
"""The flavours that are R12."""

SIZE = re.compile(r"[A-Za-z0-9_$-]+")
OLD_NAME = re.compile(r"[A-Z0-9_$-]{1,31}")
NEW_NAME = re.compile(r"[!#-)+.0-9@-Z\[\]^_a-{}~ -]+")
"""Printable ASCII but for what names of tables must not hold: < > / \\ " : ; ? * | , = and the backquote."""

PLAIN = re.compile(r"[A-Za-z0-9_][A-Za-z0-9._-]*")
APART = re.compile(r"\{stock\}[^{}]*[^{}0-9][^{}]*\{index\}|\{index\}[^{}]*[^{}0-9][^{}]*\{stock\}")
"""Stock and index with more than digits between them: `a1` and 1 is not `a` and 11."""


class LayerTable(Table, frozen=True, kw_only=True):
    """A layer of one's own; absent values are those of the profile `planish`."""

    name: LayerName | None = None
    colour: Colour | None = None


class LayersTable(Table, frozen=True, kw_only=True, rename="upper"):
    """Layers of one's own, by what they mean; absent ones are those of the profile `planish`."""

    cut_outer: LayerTable = LayerTable()
    cut_inner: LayerTable = LayerTable()
    mark: LayerTable = LayerTable()
    bend_up: LayerTable = LayerTable()
    bend_down: LayerTable = LayerTable()
    label: LayerTable = LayerTable()
    sheet: LayerTable = LayerTable()
    sheet_keepout: LayerTable = LayerTable()
    roll: LayerTable = LayerTable()
    engrave: LayerTable = LayerTable()
    sew: LayerTable = LayerTable()
    cut_slit: LayerTable = LayerTable()
    lead: LayerTable = LayerTable()


class DxfTable(Table, frozen=True, kw_only=True):
    """How the drawings are written.

    flavour: closed polylines with arcs, lines and arcs, closed polylines without arcs, polylines of R12, or pattern
        files of ASTM D6673 (DXF-AAMA) for leather and garments, with all pieces in one file in `pieces/` too.
    version: R2000 if absent, R12 for the flavours r12 and aama.
    layers: a profile of names, or a name and colour (AutoCAD's index) of one's own for some of them.
    side: of the exact outline on which the written one may lie; outside: parts only grow and holes only shrink.
    text: on LABEL, or as strokes of a single-line font on ENGRAVE.
    one_file_per: sheet; part: each by itself, without a sheet; material: all sheets of the job beside each other.
    name: of the files in `cut/`, with the fields job, customer, revision, material, thickness, stock, index, part.
    also: each drawing as SVG or PDF as well, at 1:1 and of the same name.
    paper: of the PDF: one page as large as the drawing, or as many of A4 or A3 as show all of it.
    size: that a pattern file says its pieces are of; ONE if absent.
    """

    flavour: Flavour = "polyline-arcs"
    version: Version | None = None
    layers: Profile | LayersTable = "planish"
    side: Side = "either"
    text: Lettering = "TEXT"
    one_file_per: FilePer = "sheet"
    name: Annotated[str, Meta(min_length=1, max_length=80)] | None = None
    also: Annotated[tuple[Picture, ...], Meta(max_length=MOST_ROWS)] = ()
    paper: Paper = "fit"
    size: Annotated[str, Meta(min_length=1, max_length=12)] | None = None

    def troubles(self) -> Iterator[Trouble]:
        """Yield versions that do not hold the flavour, names of layers and files that cannot be."""
        if self.flavour == "polyline-arcs" and self.version == "R12":
            yield Trouble("version", "R12 has no polylines of that kind", 'flavour = "r12" is the same in R12')
        if self.flavour in OLD and self.version not in (None, "R12"):
            yield Trouble("version", f"the flavour {self.flavour} is R12, not {self.version}", "leave version out")
        yield from _pattern_troubles(self)
        if self.flavour != "aama":
            yield from _layer_troubles(layers_of(self), version_of(self))
        yield from _picture_troubles(self.also, self.paper)
        yield from _name_troubles(self.name or FILE_NAMES[self.one_file_per], self.one_file_per)


def version_of(table: DxfTable) -> Version:
    """Return the version of the drawings."""
    return table.version or ("R12" if table.flavour in OLD else "R2000")


def layers_of(table: DxfTable) -> dict[str, Layer]:
    """Return the layers of the drawings, by what they mean."""
    if table.flavour == "aama":
        return dict(PATTERN_LAYERS)
    if isinstance(table.layers, str):
        return dict(PROFILES[table.layers])
    own = asdict(table.layers)
    return {meaning: _layer(own[meaning.lower()], usual) for meaning, usual in PROFILES["planish"].items()}


def _layer(own: LayerTable, usual: Layer) -> Layer:
    return Layer(own.name or usual.name, own.colour or usual.colour)


def machine_of(table: DxfTable) -> Machine:
    """Return what the drawings must be like; the fields of file names are filled once the job is known."""
    return Machine(
        flavour=table.flavour,
        version=version_of(table),
        layers=layers_of(table),
        side=table.side,
        text=table.text,
        file_per=table.one_file_per,
        file_name=table.name or FILE_NAMES[table.one_file_per],
        also=table.also,
        paper=table.paper,
        style=Style(size=table.size or Style().size),
    )


def alone_troubles(table: DxfTable, *, common_line: bool) -> Iterator[Trouble]:
    """Yield the wish for cuts that parts share where each part has a file of its own."""
    if common_line and table.one_file_per == "part":
        yield Trouble("dxf.one_file_per", "parts by themselves share no cuts", "leave nest.common_line out")
    if common_line and table.flavour == "aama":
        yield Trouble("dxf.flavour", "every piece of a pattern file has a whole outline", "leave nest.common_line out")


def _layer_troubles(layers: Mapping[str, Layer], version: Version) -> Iterator[Trouble]:
    """Yield layers that a file of that version cannot have, and such as nobody could tell apart."""
    allowed, hint = (OLD_NAME, "A-Z 0-9 _ $ -, at most 31") if version == "R12" else (NEW_NAME, "letters, digits, _ -")
    seen = Counter((layer.name.casefold(), layer.colour) for layer in layers.values())
    spelt = {layer.name.casefold(): layer.name for layer in layers.values()}
    for meaning, layer in layers.items():
        if layer.name == "0" or not allowed.fullmatch(layer.name):
            yield Trouble(f"layers.{meaning}.name", f'"{layer.name}" is no name of a layer in {version}', hint)
        elif spelt[layer.name.casefold()] != layer.name:
            yield Trouble(f"layers.{meaning}.name", f'"{layer.name}" is spelt in two ways', "capitals do not count")
        elif seen[layer.name.casefold(), layer.colour] > 1:
            message = f'"{layer.name}" in colour {layer.colour} is another layer too'
            yield Trouble(f"layers.{meaning}", message, "give it a name or a colour of its own")


def _pattern_troubles(table: DxfTable) -> Iterator[Trouble]:
    """Yield what a pattern file does not hold, and what is said for one where none is written."""
    if table.flavour != "aama":
        if table.size is not None:
            yield Trouble("size", f"drawings of the flavour {table.flavour} say no size", 'flavour = "aama" does')
        return
    if table.layers != "planish":
        yield Trouble("layers", "a pattern file has the layers of ASTM D6673", "leave layers out")
    if table.text != "TEXT":
        yield Trouble("text", "a pattern file says its texts as texts", "leave text out")
    if table.side != "either":
        yield Trouble("side", "curve points lie on the exact outline, chords on either side", "leave side out")
    if table.also:
        yield Trouble("also", "a pattern file says notches and drill holes by points", "run the job in another flavour")
    if table.size is not None and not SIZE.fullmatch(table.size):
        yield Trouble("size", f'"{table.size}" cannot be part of the name of a block', "letters, digits, - _ $")


def _picture_troubles(also: Sequence[Picture], paper: Paper) -> Iterator[Trouble]:
    """Yield a format that is asked for twice, and a paper on which nothing is printed."""
    for number, picture in enumerate(also):
        if picture in also[:number]:
            yield Trouble(f"also[{number}]", f'"{picture}" is there twice', "once is enough")
    if paper != "fit" and "pdf" not in also:
        yield Trouble("paper", f"no PDF is written that {paper} could be the paper of", 'also = ["pdf"]')


def _name_troubles(name: str, per: FilePer) -> Iterator[Trouble]:
    """Yield fields that a name does not have, and names that two files of a job could share."""
    fields = FIELD.findall(name)
    for unknown in sorted(set(fields) - {*JOB_FIELDS, *OWN_FIELDS[per]}):
        known = ", ".join(f"{{{one}}}" for one in (*OWN_FIELDS[per], *JOB_FIELDS))
        yield Trouble("name", f'a file for each {per} has no "{unknown}"', f"fields are {known}")
    for missing in sorted(set(OWN_FIELDS[per]) - set(fields)):
        yield Trouble("name", "files would be called the same", f"put {{{missing}}} into it")
    if not PLAIN.fullmatch(FIELD.sub("x", name)):
        yield Trouble("name", f'"{name}" is no file name for every system', "letters, digits, dot, dash, underscore")
    if per == "sheet" and {"stock", "index"} <= set(fields) and not APART.search(name):
        yield Trouble("name", "stock and index run into each other", "put a dash between them: {stock}-{index}")
