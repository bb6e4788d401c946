"""A drawing as SVG at 1:1: user units are millimetres, arcs are arcs, every path is an element of its own.

The page is the drawing's extent; y runs down, so that a point (x, y) of the drawing lies at (x - left, top - y), with
left and top in `data-left` and `data-top` of the root.  Groups follow each other as the drawing does, a group for each
copy of a part and in it one for each layer, in the colour of that layer: what programs that cut go by.  A layer is
stated by what it means (`data-kind`) and as the profile calls it.  Texts are texts; whoever wants strokes has them on
ENGRAVE.

An arc is written by its radius and its end, to the decimals of a DXF file.  One whose height over its chord is below
`FLAT_MM` is a line: its radius would be so large that viewers, which count in single precision, lose its place.
"""

import re
from collections.abc import Iterator, Sequence
from itertools import groupby
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from stages.geometry.arrays import Points2, Vector2, norm
from stages.geometry.paths.arcpath import ArcPath, chords, radii, sweeps
from stages.model.cutfile import Machine
from stages.write.colours import rgb, web
from stages.write.drawing import Drawing, Item, Label, extent
from stages.write.numerals import numerals

NAMESPACE = "http://www.w3.org/2000/svg"
INKSCAPE = "http://www.inkscape.org/namespaces/inkscape"

HAIRLINE_MM = 0.025
"""Below 0.001 in, the width up to which drivers of laser cutters take a line for a cut."""

FLAT_MM = 1e-6
"""Height over the chord below which an arc is a line: a ten-thousandth of the finest tolerance."""

CAPITAL_SHARE = 0.72
"""Height of a capital over the size of a sans-serif typeface, as of Helvetica and Arial; the height is a DXF text's."""

UNSAFE = re.compile(r"[^A-Za-z0-9_.-]")
"""What an id is not made of here."""

UNKNOWN = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""What XML 1.0 does not know, not even escaped; a question mark stands for it."""

PART_FREE = "sheet"
"""The group of what belongs to no part: stock, defects, common lines."""


def svg_text(drawing: Drawing, machine: Machine) -> str:
    """Return the drawing as the text of an SVG file, in ASCII; the same drawing gives the same text."""
    low_x, low_y, high_x, high_y = extent(item.path for item in drawing.items)
    width, height, left, top = numerals(np.array([high_x - low_x, high_y - low_y, low_x, high_y]))
    root = Element("svg", {
        "xmlns": NAMESPACE, "xmlns:inkscape": INKSCAPE, "version": "1.1", "width": f"{width}mm",
        "height": f"{height}mm", "viewBox": f"0 0 {width} {height}", "data-left": left, "data-top": top,
    })  # fmt: skip
    SubElement(root, "title").text = drawing.path.rpartition(".")[0]
    corner = np.array([low_x, high_y])
    drawn = SubElement(root, "g", {"fill": "none", "stroke-width": f"{HAIRLINE_MM:g}", "stroke-linejoin": "round"})
    for name, items in _groups(drawing.items):
        _add_group(drawn, name, items, machine, corner)
    _add_labels(root, drawing.labels, machine, corner)
    ElementTree.indent(root, " ")
    text = ElementTree.tostring(root, encoding="us-ascii", xml_declaration=True).decode("ascii")
    return f"{text}\n"


def _groups(items: Sequence[Item]) -> Iterator[tuple[str, list[Item]]]:
    """Yield what lies together of one copy of a part, and an id for it that occurs once."""
    seen: dict[str, int] = {}
    for (part, copy), found in groupby(items, key=lambda item: (item.part, item.copy)):
        name = f"part-{part}-{copy}" if part and copy else f"part-{part}" if part else PART_FREE
        name = UNSAFE.sub("_", name)
        seen[name] = seen.get(name, 0) + 1
        yield name if seen[name] == 1 else f"{name}..{seen[name]}", list(found)


def _add_group(parent: Element, name: str, items: list[Item], machine: Machine, corner: Vector2) -> None:
    """Add the group of a copy of a part, with a group for each of its layers as they follow."""
    first = items[0]
    about = {"data-part": _known(first.part)} if first.part else {}
    about |= {"data-copy": str(first.copy)} if first.copy else {}
    group = SubElement(parent, "g", {"id": name, **about})
    for number, (kind, found) in enumerate(groupby(items, key=lambda item: item.layer), 1):
        layer = machine.layers[kind]
        inner = SubElement(group, "g", {
            "id": f"{name}-{kind}-{number}", "data-kind": kind, "inkscape:label": layer.name,
            "inkscape:groupmode": "layer", "stroke": web(rgb(layer.colour)),
        })  # fmt: skip
        for item in found:
            about = {} if item.contour is None else {"data-contour": str(item.contour)}
            about |= {"data-name": _known(item.name)} if item.name else {}
            SubElement(inner, "path", {**about, "d": path_text(item.path, corner)})


def path_text(path: ArcPath, corner: Vector2) -> str:
    """Return a path as SVG states it, y running down from `corner`."""
    start, *ends = _places(np.concatenate([path.vertices[:1], chords(path)[1]]), corner)
    arcs = ["" if flat else arc for arc, flat in zip(_arcs(path), _is_flat(path), strict=True)]
    made = [f"{arc or 'L'}{end}" for arc, end in zip(arcs, ends, strict=True)]
    if path.closed and not arcs[-1]:
        made.pop()
    return "".join([f"M{start}", *made, "Z" if path.closed else ""])


def _is_flat(path: ArcPath) -> list[bool]:
    """Return which pieces are lines, or as good as lines."""
    start, end = chords(path)
    flat: list[bool] = (np.abs(path.bulges[: len(start)]) * norm(end - start) / 2.0 < FLAT_MM).tolist()
    return flat


def _arcs(path: ArcPath) -> list[str]:
    """Return the beginnings of arcs: radii, turn, whether over a half circle, whether clockwise as seen."""
    radius, sweep = radii(path), sweeps(path)
    long = numerals(np.where(np.isfinite(radius), radius, 0.0))
    return [
        f"A{one} {one} 0 {int(abs(turn) > np.pi)} {int(turn < 0.0)} "
        for one, turn in zip(long, sweep.tolist(), strict=True)
    ]


def _places(points: Points2, corner: Vector2) -> list[str]:
    """Return points, y running down from `corner`."""
    written = numerals((points - corner) * np.array([1.0, -1.0]))
    return [f"{x} {y}" for x, y in zip(written[::2], written[1::2], strict=True)]


def _known(name: str) -> str:
    return UNKNOWN.sub("?", name)


def _add_labels(root: Element, labels: Sequence[Label], machine: Machine, corner: Vector2) -> None:
    """Add the texts, each with its middle at its place."""
    for kind, found in groupby(labels, key=lambda label: label.layer):
        layer = machine.layers[kind]
        group = SubElement(root, "g", {
            "id": kind, "data-kind": kind, "inkscape:label": layer.name, "inkscape:groupmode": "layer",
            "fill": web(rgb(layer.colour)), "font-family": "Helvetica, Arial, sans-serif", "text-anchor": "middle",
        })  # fmt: skip
        for label in found:
            (at,) = _places(label.at[None, :], corner)
            angle, down, size = numerals(
                np.array([-label.angle_deg, label.height_mm / 2.0, label.height_mm / CAPITAL_SHARE])
            )
            place = {"transform": f"translate({at}) rotate({angle})", "y": down, "font-size": size}
            SubElement(group, "text", place).text = label.text
