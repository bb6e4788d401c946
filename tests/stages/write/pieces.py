"""Leather pieces to write as pattern files: a flap with everything that such a file can say."""

from math import pi

import numpy as np

from stages.geometry.curves.plane import CircularArc
from stages.geometry.paths.arcpath import ArcPath
from stages.model.cutfile import Machine, Style
from stages.model.features import NotchKind
from stages.model.pattern import Contour, FlatPattern, Mark, NotchPlace, Purpose, Text
from stages.model.patternlayers import PATTERN_LAYERS
from tests.stages.write.patterns import contour, hole, line_mark, pattern, polygon_edges

MACHINE = Machine(flavour="aama", version="R12", layers=PATTERN_LAYERS, style=Style("bag", "M", "calf"))
NOTCH_ON_ARC = np.array([80.0 + 40.0 * np.cos(pi / 6.0), 20.0])


def flap(part: str = "flap") -> FlatPattern:
    """Return a half disc on a rectangle, 120 x 80, with holes, notches, a sew line, a slit and marks."""
    arc = CircularArc(np.array([80.0, 0.0]), 40.0, -pi / 2.0, pi)
    boundary = contour([arc, *polygon_edges((80.0, 40.0), (0.0, 40.0), (0.0, -40.0), (80.0, -40.0))[:3]])
    made = pattern(part, boundary, (40.0, 0.0), hole(60.0, 20.0, 6.0), _round("stitch", 10.0, 30.0, 0.5))
    inner = ArcPath(
        np.array([[5.0, 35.0], [5.0, -35.0], [80.0, -35.0], [80.0, 35.0]]), np.array([0.0, 0.0, 1.0, 0.0]), True
    )
    marks = (
        line_mark((20.0, -20.0), (50.0, -20.0), (50.0, -10.0)),
        Mark("sew", inner, "SEW"),
        Mark("slit", line_mark((10.0, 0.0), (10.0, 8.0)).path, "CUT_SLIT"),
        Mark("notch-3", line_mark((0.0, 10.0), (4.0, 10.0)).path, "MARK"),
    )
    notches = (
        _notch("notch-1", "v", NOTCH_ON_ARC, -np.array([np.cos(pi / 6.0), 0.5]), size=(3.0, 2.0)),
        _notch("notch-2", "castle", np.array([40.0, 40.0]), np.array([0.0, -1.0]), size=(4.0, 3.0)),
        _notch("notch-3", "slit", np.array([0.0, 10.0]), np.array([1.0, 0.0]), size=(4.0, 1.0), outlined=False),
    )
    text = Text("text", "front", np.array([60.0, -5.0]), 4.0, 15.0)
    return made.replace(
        marks=marks, notches=notches, texts=(text,), axis_deg=30.0, thickness_mm=1.6, quantity=3, pair=True
    )


def _round(purpose: Purpose, x: float, y: float, radius: float) -> Contour:
    made = hole(x, y, radius)
    return Contour(made.edges, made.path, made.chord_mm, "hole", purpose=purpose)


def _notch(
    name: str, kind: NotchKind, at: np.ndarray, inward: np.ndarray, *, size: tuple[float, float], outlined: bool = True
) -> NotchPlace:
    """Return a notch; size: depth and width."""
    return NotchPlace(name, kind, at, inward, *size, outlined, (0, 0.0))
