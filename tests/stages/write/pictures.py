"""Paths of SVG and PDF as tests read them: by what the formats say, with no formula of the writers.

An SVG arc is turned into centre and angles (SVG 1.1, appendix F.6.5); lengths and areas are those of circles in polar
form.  A cubic of PDF is evaluated by de Casteljau's points, its area is exact by a quadrature of five nodes.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np

from stages.geometry.arrays import Array, Points2

SVG = "{http://www.w3.org/2000/svg}"


@dataclass(frozen=True)
class Shape:
    """A path as read: its area (y upwards, 0 for an open one), length, points along it; curved: its arcs or cubics."""

    area: float
    length: float
    points: Points2
    curved: int
    closed: bool
    about: dict[str, str]


def svg_shapes(text: str) -> list[Shape]:
    """Return the paths of an SVG file in their order, points back in the frame of the drawing."""
    root = ElementTree.fromstring(text)
    corner = np.array([float(root.attrib[f"data-{side}"]) for side in ("left", "top")])
    return [_svg_shape(path, about, corner) for path, about in _svg_paths(root, {})]


def _svg_paths(element: Element, about: dict[str, str]) -> Iterator[tuple[Element, dict[str, str]]]:
    mine = {**about, **element.attrib}
    for child in element:
        if child.tag == f"{SVG}path":
            yield child, {**mine, **child.attrib}
        else:
            yield from _svg_paths(child, mine)


def _svg_shape(path: Element, about: dict[str, str], corner: Array) -> Shape:
    words = re.findall(r"[MLAZ]|-?[0-9.]+", path.attrib["d"])
    at, area, length, curved, closed = 0j, 0.0, 0.0, 0, False
    points: list[complex] = []
    while words:
        letter = words.pop(0)
        if letter == "Z":
            closed = True
            end = points[0]
        elif letter == "A":
            radius, _, _, large, sweep, x, y = (float(words.pop(0)) for _ in range(7))
            end = complex(x, y)
            centre, begin, turn = _circle(at, end, radius, large == sweep)
            on = centre + (at - centre) * np.exp(1j * np.linspace(0.0, turn, 65))
            curved += 1
            length += radius * abs(turn)
            ahead = begin + turn
            area += (
                0.5
                * radius
                * (
                    radius * turn
                    + centre.real * (np.sin(ahead) - np.sin(begin))
                    - centre.imag * (np.cos(ahead) - np.cos(begin))
                )
            )
            points += list(on[1:])
            at = end
            continue
        else:
            end = complex(float(words.pop(0)), float(words.pop(0)))
        if letter != "M":
            length += abs(end - at)
            area += 0.5 * (at.real * end.imag - end.real * at.imag)
        points.append(end)
        at = end
    drawn = np.array([[point.real + corner[0], corner[1] - point.imag] for point in points])
    return Shape(-area if closed else 0.0, length, drawn, curved, closed, about)


def _circle(start: complex, end: complex, radius: float, right: bool) -> tuple[complex, float, float]:
    """Return centre, angle at the start and turn; right: whether large-arc and sweep flags are the same."""
    half = (start - end) / 2.0
    away = np.sqrt(max(radius**2 - abs(half) ** 2, 0.0)) / abs(half)
    centre = (start + end) / 2.0 + (-1.0 if right else 1.0) * away * complex(half.imag, -half.real)
    begin, last = np.angle(start - centre), np.angle(end - centre)
    # of the arcs up to a half circle, which is all that is written, sweep is what the side of the centre says
    turn = (last - begin + np.pi) % (2.0 * np.pi) - np.pi
    return centre, float(begin), float(turn)


def pdf_shapes(text: str) -> list[Shape]:
    """Return the paths of the drawing in a PDF file, the layer of each in `about`."""
    content = stream(text, 5)
    names = re.findall(r"/Type /OCG /Name \((\w+)\)", text)
    found, about = [], dict[str, str]()
    for line in content.splitlines():
        if layer := re.match(r"/OC /L(\d+) BDC", line):
            about = {"layer": names[int(layer[1])]}
        elif re.search(r" m .* [sS]$", line):
            found.append(_pdf_shape(line, about))
    return found


def stream(text: str, number: int) -> str:
    """Return the content of an object, found by the table of cross references alone."""
    start = int(text.rpartition("startxref\n")[2].split()[0])
    lines = text[start:].splitlines()
    assert lines[0] == "xref"
    place = int(lines[2 + number].split()[0])
    assert text[place:].startswith(f"{number} 0 obj\n")
    head, _, rest = text[place:].partition("stream\n")
    (length,) = re.findall(r"/Length (\d+)", head)
    assert rest[int(length) :].startswith("endstream")
    return rest[: int(length)]


NODES, WEIGHTS = np.polynomial.legendre.leggauss(5)


def _pdf_shape(line: str, about: dict[str, str]) -> Shape:
    stack: list[float] = []
    at = first = np.zeros(2)
    area, length, curved = 0.0, 0.0, 0
    points: list[Array] = []
    for word in line.split():
        if word not in "mlcsS":
            stack.append(float(word))
            continue
        corners = np.array(stack).reshape(-1, 2)
        stack = []
        if word == "m":
            at = first = corners[0]
            points.append(at)
            continue
        if word == "S":
            continue
        control = np.vstack([at, corners if word != "s" else first])
        curved += word == "c"
        on = _curve(control, np.linspace(0.0, 1.0, 65)) if word == "c" else control
        t = (NODES + 1.0) / 2.0
        here, rate = _curve(control, t), _curve(np.diff(control, axis=0) * (len(control) - 1), t)
        area += float(WEIGHTS @ (here[:, 0] * rate[:, 1] - here[:, 1] * rate[:, 0])) / 4.0
        length += float(WEIGHTS @ np.hypot(*rate.T)) / 2.0
        points += list(on[1:])
        at = control[-1]
    closed = line.endswith(" s")
    return Shape(area if closed else 0.0, length, np.array(points), curved, closed, about)


def _curve(control: Points2, t: Array) -> Points2:
    """Return points of a Bezier curve by repeated interpolation."""
    rows = np.repeat(control[None], len(t), axis=0)
    while rows.shape[1] > 1:
        rows = rows[:, :-1] + t[:, None, None] * np.diff(rows, axis=1)
    made: Points2 = rows[:, 0]
    return made
