"""SVG and PDF files as they read again, against their drawing: every path on its layer, in its place, of its size.

Nothing of the writers is used: paths come from the text by what the formats say.  Lengths and areas of arcs are those
of circles, those of cubics come from Gauss's quadrature of five nodes: areas exactly, lengths to 1e-9 on what stands
for an arc of up to a quarter turn.  Texts are not looked at: they are not cut.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from math import asin, pi, sin
from xml.etree import ElementTree

import numpy as np

from stages.geometry.paths.arcpath import ArcPath, area, length, sweeps
from stages.model.cutfile import CutFile, Machine
from stages.model.report import Finding
from stages.write.drawing import Drawing

NODES, WEIGHTS = np.polynomial.legendre.leggauss(5)
PLACE_MM = 1e-6
"""How far the beginning of a path may be off: ten decimals, ten thousand times over."""

OFF_MM = {"svg": 1e-6, "pdf": 1e-4}
"""How far the curves of a format may be off: arcs too flat to be arcs in SVG, cubics beside arcs in PDF."""

SHARE = 1e-8
"""Of lengths, and of areas as large as a square of that length: rounding and the quadrature."""

LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"
Place = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Seen:
    """A path as read: the layer it is on, where it begins, how long it is, what it encloses (0 if it is open)."""

    layer: str
    start: Place
    length_mm: float
    area_mm2: float
    closed: bool


def picture_faults(file: CutFile, drawing: Drawing, machine: Machine) -> list[Finding]:
    """Return what a picture does not show as it was drawn; each of it is fatal."""
    kind = file.path.rpartition(".")[2]
    try:
        seen = list(svg_paths(file.text) if kind == "svg" else pdf_paths(file.text))
    except (ValueError, IndexError, KeyError, ElementTree.ParseError) as error:
        return [_fault(file, f"cannot be read: {error}")]
    if [one.layer for one in seen] != [machine.layers[item.layer].name for item in drawing.items]:
        text = f"holds {len(seen)} paths on other layers or in another order than the {len(drawing.items)} drawn"
        return [_fault(file, text)]
    pairs = zip(seen, drawing.items, strict=True)
    return [_fault(file, text) for one, item in pairs for text in _unlike(one, item.path, OFF_MM[kind])]


def _fault(file: CutFile, text: str) -> Finding:
    return Finding("readback-picture", f"{file.path}: {text}", fatal=True, where={"file": file.path})


def _unlike(seen: Seen, path: ArcPath, off_mm: float) -> Iterator[str]:
    """Yield where a path is not the one that was drawn; a curve d off another is longer by d times its turning."""
    x, y = path.vertices[0].tolist()
    long, enclosed = length(path), area(path) if path.closed else 0.0
    turning = 2.0 * pi + float(np.abs(sweeps(path)).sum())
    if seen.closed != path.closed:
        yield f"the path from ({x:.6g}, {y:.6g}) is {'closed' if seen.closed else 'open'}"
    if not abs(complex(*seen.start) - complex(x, y)) <= PLACE_MM:
        yield f"the path from ({x:.6g}, {y:.6g}) begins at ({seen.start[0]:.6g}, {seen.start[1]:.6g})"
    if not abs(seen.length_mm - long) <= off_mm * turning + SHARE * long:
        yield f"the path from ({x:.6g}, {y:.6g}) is {seen.length_mm:.6f} mm long, drawn {long:.6f} mm"
    if not abs(seen.area_mm2 - enclosed) <= (off_mm + SHARE * long) * long:
        yield f"the path from ({x:.6g}, {y:.6g}) encloses {seen.area_mm2:.6f} mm2, drawn {enclosed:.6f} mm2"


@dataclass(slots=True)
class Pen:
    """Where a path has come to, how long it is, and what the line from the origin has swept over."""

    at: complex
    length_mm: float = 0.0
    swept_mm2: float = 0.0

    def line(self, end: complex) -> None:
        """Go on along a line."""
        self._go(end, abs(end - self.at), 0.0)

    def arc(self, end: complex, radius: float, *, left: bool) -> None:
        """Go on along an arc of less than a half circle."""
        turn = 2.0 * asin(min(abs(end - self.at) / (2.0 * radius), 1.0))
        segment = radius**2 * (turn - sin(turn)) / 2.0
        self._go(end, radius * turn, segment if left else -segment)

    def _go(self, end: complex, long: float, beyond: float) -> None:
        """Go on to a point; beyond: what is swept over besides the triangle, mm2."""
        self.swept_mm2 += (self.at.conjugate() * end).imag / 2.0 + beyond
        self.length_mm += long
        self.at = end

    def cubic(self, first: complex, second: complex, end: complex) -> None:
        """Go on along a cubic."""
        t = (NODES + 1.0) / 2.0
        control = np.array([self.at, first, second, end])
        basis = np.array([(1.0 - t) ** 3, 3.0 * t * (1.0 - t) ** 2, 3.0 * t**2 * (1.0 - t), t**3])
        rates = 3.0 * np.array([(1.0 - t) ** 2, 2.0 * t * (1.0 - t), t**2])
        here, rate = control @ basis, np.diff(control) @ rates
        self.length_mm += float(WEIGHTS @ np.abs(rate)) / 2.0
        self.swept_mm2 += float(WEIGHTS @ (here.conj() * rate).imag) / 4.0
        self.at = end


def svg_paths(text: str) -> Iterator[Seen]:
    """Yield the paths of an SVG file in the frame of its drawing, y upwards."""
    root = ElementTree.fromstring(text)
    corner = complex(float(root.attrib["data-left"]), float(root.attrib["data-top"]))
    for group in root.iter("{http://www.w3.org/2000/svg}g"):
        for path in group.findall("{http://www.w3.org/2000/svg}path"):
            yield _svg_path(group.attrib[LABEL], path.attrib["d"], corner)


def _svg_path(layer: str, described: str, corner: complex) -> Seen:
    steps = [(step[0], [float(word) for word in step[1:].split()]) for step in re.findall(r"[A-Z][^A-Z]*", described)]
    places = [corner + complex(numbers[-2], -numbers[-1]) for letter, numbers in steps if letter != "Z"]
    pen, closed = Pen(places[0]), steps[-1][0] == "Z"
    for (letter, numbers), end in zip(steps[1:], [*places[1:], places[0]], strict=False):
        if letter == "A":
            pen.arc(end, numbers[0], left=numbers[4] == 0.0)
        else:
            pen.line(end)
    return _seen(layer, places[0], pen, closed=closed)


def pdf_paths(text: str) -> Iterator[Seen]:
    """Yield the paths of the drawing in a PDF file."""
    names = re.findall(r"/Type /OCG /Name \(([^)]*)\)", text)
    drawing = text.partition("/Subtype /Form")[2].partition("stream\n")[2].partition("endstream")[0]
    layer = ""
    for line in drawing.splitlines():
        if line.startswith("/OC /L"):
            layer = names[int(line.split()[1].removeprefix("/L"))]
        elif line[-2:] in (" s", " S"):
            yield _pdf_path(layer, line)


def _pdf_path(layer: str, line: str) -> Seen:
    steps = [([float(word) for word in numbers.split()], letter) for numbers, letter in re.findall(STEP, line)]
    start, closed = complex(*steps[0][0]), line.endswith("s")
    pen = Pen(start)
    for numbers, letter in steps[1:]:
        points = [complex(x, y) for x, y in zip(numbers[::2], numbers[1::2], strict=True)]
        if letter == "c":
            pen.cubic(points[0], points[1], points[2])
        else:
            pen.line(points[0])
    if closed:
        pen.line(start)
    return _seen(layer, start, pen, closed=closed)


STEP = r"([-0-9. ]+) ([mlc])"


def _seen(layer: str, start: complex, pen: Pen, *, closed: bool) -> Seen:
    return Seen(layer, (start.real, start.imag), pen.length_mm, pen.swept_mm2 if closed else 0.0, closed)
