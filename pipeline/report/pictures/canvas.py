"""A page to draw on, measured in inches from its lower left corner, and how millimetres are laid on it.

One axes without ticks fills the page, so that every place and every distance of type is known while drawing; the
matplotlib figure is used without pyplot, with its default settings whatever the user's own are, and the PNG holds
pixels only: the same drawing gives the same bytes.

Limits: type is DejaVu Sans, which comes with matplotlib.  Signs that it lacks (Chinese, say) are shown as boxes.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from io import BytesIO
from typing import TYPE_CHECKING, Literal

import numpy as np

from stages.geometry.arrays import Array, Points2, Vector3, norm, unit

if TYPE_CHECKING:
    from matplotlib.path import Path

DPI = 110
POINTS_PER_INCH = 72.0
COMPRESSION = 6

INK = "#1A1A1A"
GREY = "#8C8C8C"
PALE = "#C8C8C8"
BLUE = "#0072B2"
VERMILLION = "#D55E00"
GREEN = "#007D5C"
PURPLE = "#B0307A"
"""Okabe-Ito's colours that are told apart by colour-blind eyes; green and purple darkened to print well in grey."""

BOX_SIGN = "\u25a1"
ELLIPSIS = "\u2026"

HAlign = Literal["left", "center", "right"]
VAlign = Literal["bottom", "center", "top", "baseline"]


@dataclass(frozen=True, slots=True)
class Box:
    """A rectangle of the page, inches."""

    left: float
    bottom: float
    right: float
    top: float

    @property
    def width(self) -> float:
        """Return the width, inches."""
        return self.right - self.left

    @property
    def height(self) -> float:
        """Return the height, inches."""
        return self.top - self.bottom

    def inset(self, left: float, bottom: float, right: float, top: float) -> "Box":
        """Return what is left after margins, inches."""
        return Box(self.left + left, self.bottom + bottom, self.right - right, self.top - top)


@dataclass(frozen=True, slots=True)
class Fit:
    """Millimetres on the page: turned by -90 deg if `turned`, scaled by inches per mm, the middle moved to `centre`."""

    middle: tuple[float, float]
    centre: tuple[float, float]
    scale: float
    turned: bool = False

    def place(self, points: Array) -> Points2:
        """Return points on the page, inches."""
        return np.array(self.centre) + self.scale * self.turn(points - np.array(self.middle))

    def turn(self, vectors: Array) -> Points2:
        """Return directions as they are shown."""
        return np.stack([vectors[..., 1], -vectors[..., 0]], axis=-1) if self.turned else vectors

    @property
    def fine_mm(self) -> float:
        """Return a third of a pixel in mm: what nobody sees."""
        return 1.0 / (3.0 * DPI * self.scale)


def fitted(points: Array, box: Box, *, turned: bool = False) -> Fit:
    """Return the largest view of the points that the box holds, in its middle."""
    low, high = points.min(axis=0), points.max(axis=0)
    middle, extent = (low + high) / 2.0, high - low
    width, height = (extent[1], extent[0]) if turned else (extent[0], extent[1])
    scale = min(box.width / max(width, TINY_MM), box.height / max(height, TINY_MM))
    centre = (box.left + box.right) / 2.0, (box.bottom + box.top) / 2.0
    return Fit((float(middle[0]), float(middle[1])), centre, float(scale), turned)


TINY_MM = 1e-9
"""No extent is taken for less, so that a line can be shown too."""


@contextmanager
def own_settings() -> Iterator[None]:
    """Draw with matplotlib's defaults, whatever the user has set."""
    import matplotlib

    with matplotlib.rc_context(matplotlib.rcParamsDefault):
        yield


class Canvas:
    """A white page; what is drawn later lies above."""

    def __init__(self, width: float, height: float) -> None:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        self._agg = FigureCanvasAgg(Figure(figsize=(width, height), dpi=DPI))
        self._axes = self._agg.figure.add_axes((0.0, 0.0, 1.0, 1.0))
        self._axes.set_axis_off()
        self._axes.set_xlim(0.0, width)
        self._axes.set_ylim(0.0, height)
        self._layer = 1

    def polygons(
        self,
        corners: Sequence[Array],
        fill: str | Array,
        edge: str | Array = "none",
        width: float | Array = 0.0,
    ) -> None:
        """Draw polygons, one after the other; colours and widths (points) for all or for each."""
        from matplotlib.collections import PolyCollection

        closed = PolyCollection(
            corners, facecolors=fill, edgecolors=edge, linewidths=width, joinstyle="round", capstyle="round"
        )
        self._axes.add_collection(closed, autolim=False)
        self._raise(closed)

    def areas(
        self, paths: Sequence["Path"], fill: str, edge: str = "none", width: float = 0.0, hatch: str = ""
    ) -> None:
        """Draw areas, holes included."""
        from matplotlib.collections import PathCollection

        drawn = PathCollection(paths, facecolors=fill, edgecolors=edge, linewidths=width, hatch=hatch or None)
        self._axes.add_collection(drawn, autolim=False)
        self._raise(drawn)

    def lines(
        self,
        points: Sequence[Array],
        colour: str = INK,
        width: float = 0.8,
        dashes: tuple[float, ...] = (),
        alpha: float = 1.0,
    ) -> None:
        """Draw open lines, width and dashes in points."""
        from matplotlib.collections import LineCollection

        style = (0.0, dashes) if dashes else "solid"
        drawn = LineCollection(
            points, colors=colour, linewidths=width, linestyles=style, alpha=alpha, capstyle="butt", joinstyle="round"
        )
        self._axes.add_collection(drawn, autolim=False)
        self._raise(drawn)

    def dots(self, points: Points2, colour: str = INK, size: float = 2.6) -> None:
        """Draw small rings, size in points."""
        (drawn,) = self._axes.plot(
            points[:, 0], points[:, 1], "o", ms=size, mfc="white", mec=colour, mew=0.6, scalex=False, scaley=False
        )
        self._raise(drawn)

    def text(
        self,
        at: Sequence[float] | Array,
        words: str,
        size: float = 9.0,
        colour: str = INK,
        align: tuple[HAlign, VAlign] = ("center", "center"),
        *,
        angle_deg: float = 0.0,
        bold: bool = False,
        on_white: bool = False,
    ) -> None:
        """Write one line of plain text, size in points."""
        plate = {"facecolor": "white", "edgecolor": "none", "pad": 1.0} if on_white else None
        drawn = self._axes.text(
            float(at[0]), float(at[1]), shown(words), fontsize=size, color=colour, ha=align[0], va=align[1],
            rotation=angle_deg, rotation_mode="anchor" if align[1] == "baseline" else "default",
            fontweight="bold" if bold else "normal", parse_math=False, bbox=plate,
        )  # fmt: skip
        self._raise(drawn)

    def png(self) -> bytes:
        """Return the page as PNG."""
        from PIL import Image

        self._agg.draw()  # type: ignore[no-untyped-call]
        pixels = np.asarray(self._agg.buffer_rgba())[..., :3]  # type: ignore[no-untyped-call]
        stream = BytesIO()
        Image.fromarray(np.ascontiguousarray(pixels)).save(stream, "png", compress_level=COMPRESSION)
        return stream.getvalue()

    def _raise(self, artist: object) -> None:
        self._layer += 1
        artist.set_zorder(self._layer)  # type: ignore[attr-defined]


HEAD = 0.09


def arrow(canvas: Canvas, tail: Array, tip: Array, width: float = 0.8) -> None:
    """Draw an arrow with a head of `HEAD` inches; one shorter than its head is left out."""
    direction = unit(tip - tail)
    if norm(tip - tail) <= HEAD:
        return
    across = np.array([-direction[1], direction[0]]) * HEAD / 3.0
    base = tip - HEAD * direction
    canvas.lines([np.stack([tail, base])], INK, width)
    canvas.polygons([np.stack([tip, base + across, base - across])], INK)


@lru_cache(maxsize=1)
def _signs() -> frozenset[int]:
    """Return the code points that the typeface has."""
    from matplotlib.font_manager import FontProperties, findfont, get_font

    return frozenset(get_font(findfont(FontProperties(family="DejaVu Sans"))).get_charmap())


def shown(words: str) -> str:
    """Return the text as the typeface can show it: one line, a box for each sign that it lacks."""
    line = "".join(sign if sign.isprintable() else " " for sign in words)
    return "".join(sign if ord(sign) in _signs() else BOX_SIGN for sign in line)


def shortened(words: str, most: int) -> str:
    """Return a text of at most so many signs, its middle left out if need be."""
    if len(words) <= most:
        return words
    head = (most - 1 + 1) // 2
    tail = most - 1 - head
    return words[:head] + ELLIPSIS + (words[-tail:] if tail else "")


def length_text(mm: float) -> str:
    """Return a length without unit, to a share that can be measured: 3 decimals below 10 mm, 1 above 1 m."""
    decimals = 3 if mm < FINE_MM else 2 if mm < COARSE_MM else 1
    return f"{mm:.{decimals}f}"


FINE_MM, COARSE_MM = 10.0, 1000.0
"""Below the one a thousandth is written, from the other on a tenth: what callipers and tapes show."""


def area_text(mm2: float) -> str:
    """Return an area with its unit, five digits: mm2 up to a tenth of a square metre, m2 beyond."""
    return f"{mm2:.5g} mm\u00b2" if mm2 < MM2_PER_M2 / 10.0 else f"{mm2 / MM2_PER_M2:.5g} m\u00b2"


MM2_PER_M2 = 1e6


def scale_bar(canvas: Canvas, right: float, bottom: float, scale: float, room: float) -> None:
    """Draw a bar of 1, 2 or 5 times a power of ten mm, at most `room` inches long, ending at `right`."""
    power = 10.0 ** np.floor(np.log10(room / scale))
    mm = float(max(step * power for step in (1.0, 2.0, 5.0) if step * power * scale <= room * (1.0 + ROUNDING)))
    length = mm * scale
    ends = np.array([[right - length, bottom], [right, bottom]])
    tick = np.array([0.0, 0.05])
    canvas.lines([ends, np.stack([ends[0] - tick, ends[0] + tick]), np.stack([ends[1] - tick, ends[1] + tick])])
    canvas.text((right - length / 2.0, bottom + 0.05), f"{mm:g} mm", 8.0, align=("center", "bottom"))


ROUNDING = 1e-9
"""A bar may exceed its room by rounding."""


def caption(canvas: Canvas, box: Box, name: str, more: str) -> None:
    """Write what a view shows into its upper left corner, in two lines."""
    canvas.text((box.left + 0.02, box.top - 0.12), name, 9.5, INK, LEFT)
    canvas.text((box.left + 0.02, box.top - 0.3), more, 8.0, GREY, LEFT)


def size_text(size_mm: Vector3 | None) -> str:
    """Return how large a formed part is along its axes; nothing where that is not known."""
    if size_mm is None:
        return ""
    words = "   ".join(f"{axis} {length_text(mm)}" for axis, mm in zip("xyz", size_mm.tolist(), strict=True))
    return f"extent  {words} mm"


LEFT: tuple[HAlign, VAlign] = ("left", "center")
