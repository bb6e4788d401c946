"""The flat pattern on paper: at true scale where it fits, else at a scale that is said, with what the tape measures.

On the first page of a part stands the whole pattern at one of the scales of `DENOMINATORS`, enlarged where it is small.
One that is then not at 1:1, and fits on a page of A4 or A3, has such a page besides, to be laid on the blank.
Corners have letters, diagonals are dashed, width and height are said outside.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import hypot

from pipeline.report.shopentries import BlankEntry, TapeEntry
from pipeline.report.traveller.ink import (
    BENDING,
    HAIR,
    HAIR_MM,
    INK,
    LINE_MM,
    OUTLINE_MM,
    QUIET,
    THIN_MM,
    TINT,
    Colour,
    Pen,
    filled,
    moved,
    rule,
    said,
    stroked,
)
from pipeline.report.traveller.inked import Inked
from pipeline.report.traveller.numbers import millimetres
from stages.write.helvetica import BOLD
from stages.write.pdf import numbers

DENOMINATORS = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.5)
ENLARGED = (10.0, 5.0, 2.0)
SMALL_MM = 60.0
"""A pattern whose longer side is smaller than that is shown enlarged."""

LETTER_PT, SIZE_PT = 9.5, 8.0
OUTSIDE_MM = 4.0
"""From a corner to the middle of its letter."""

AROUND_MM = 7.5
"""Room around a pattern for the letters at its corners."""

SIZES_MM = 6.5
"""Room for the width below it and the height beside it."""

TICK_MM = 1.2
CAPITAL_MM = 1.2
"""Half a capital's height of the letters at corners: their middle is what is placed."""

STYLES: dict[str, tuple[Colour, float, str]] = {
    "BEND_UP": (BENDING, THIN_MM, "[3 1] 0"),
    "BEND_DOWN": (BENDING, THIN_MM, "[3 1 0.6 1] 0"),
    "ROLL": (HAIR, HAIR_MM, "[] 0"),
    "SEW": (QUIET, THIN_MM, "[1.2 0.8] 0"),
    "CUT_SLIT": (INK, LINE_MM, "[] 0"),
    "MARK": (QUIET, THIN_MM, "[] 0"),
    "ENGRAVE": (QUIET, HAIR_MM, "[] 0"),
}
"""How marks are drawn: colour, width and dashes in mm on paper."""


@dataclass(frozen=True, slots=True)
class View:
    """How a pattern lies on paper: mm on paper for 1 mm, turned by a quarter or not, and its own extent."""

    scale: float
    turned: bool
    low: tuple[float, float]
    high: tuple[float, float]

    @property
    def size(self) -> tuple[float, float]:
        """Return width and height on paper, mm."""
        wide, high = (self.scale * (self.high[i] - self.low[i]) for i in (0, 1))
        return (high, wide) if self.turned else (wide, high)

    def place(self, x: float, y: float) -> tuple[float, float]:
        """Return where a point of the pattern lies on paper, from the lower left corner of its extent, mm."""
        right, up = self.scale * (x - self.low[0]), self.scale * (y - self.low[1])
        return (self.size[0] - up, right) if self.turned else (right, up)

    @property
    def operators(self) -> str:
        """Return the operator that takes the pattern's frame there."""
        s, (x, y) = self.scale, self.place(0.0, 0.0)
        return f"{numbers((0.0, s, -s, 0.0, x, y) if self.turned else (s, 0.0, 0.0, s, x, y))} cm\n"


def best_view(inked: Inked, room: tuple[float, float]) -> View:
    """Return the largest view of a pattern in a room (mm) at a scale of the series; unturned if that is as large."""
    views = [_view(inked.low, inked.high, room, turned=turned) for turned in (False, True)]
    return max(views, key=lambda view: view.scale)


def _view(low: tuple[float, float], high: tuple[float, float], room: tuple[float, float], *, turned: bool) -> View:
    scales = _scales(max(high[0] - low[0], high[1] - low[1]))
    return next(view for view in (View(scale, turned, low, high) for scale in scales) if fits(view, room))


def _scales(long_mm: float) -> Iterator[float]:
    """Yield scales for a pattern of that size, from the largest on."""
    if long_mm < SMALL_MM:
        yield from ENLARGED
    ten = 1.0
    while True:
        for denominator in DENOMINATORS:
            yield 1.0 / (ten * denominator)
        ten *= 10.0


def fits(view: View, room: tuple[float, float]) -> bool:
    """Return whether a view lies in a room."""
    return view.size[0] <= room[0] and view.size[1] <= room[1]


def scale_text(scale: float) -> str:
    """Return a scale as drawings say it."""
    return f"{scale:.6g} : 1" if scale > 1.0 else f"1 : {1.0 / scale:.6g}"


def drawn_pattern(inked: Inked, view: View, tape: TapeEntry | None) -> str:
    """Return a pattern, the lower left corner of its extent at the origin.  tape: the corners to be named."""
    made = ["q ", view.operators, _lines(inked, view.scale), "Q\n"]
    if tape is not None:
        made += [*_diagonals(tape, view), *_letters(tape, view)]
    return "".join(made)


def _lines(inked: Inked, scale: float) -> str:
    """Return contours and marks of a pattern in its own frame, so wide that they are right on paper."""
    made = [f"1 j {filled(TINT)} ", stroked(INK, OUTLINE_MM / scale), f"/X{inked.number} Do\n"]
    for layer, (colour, width, dash) in STYLES.items():
        made += [
            stroked(colour, width / scale, _dashes(dash, scale)) + strokes
            for name, strokes in inked.marks
            if name == layer
        ]
    return "".join(made)


def _dashes(dash: str, scale: float) -> str:
    """Return dashes that are as long as given on paper."""
    steps = [float(word) / scale for word in dash.strip("[] 0").split()] if dash != "[] 0" else []
    return f"[{numbers(steps)}] 0" if steps else "[] 0"


def _diagonals(tape: TapeEntry, view: View) -> Iterator[str]:
    """Yield the diagonals that are measured."""
    at = {letter: (spot.x, spot.y) for spot in tape.spots for letter in spot.letters}
    yield stroked(QUIET, HAIR_MM, "[0.8 1.2] 0")
    for span in tape.spans:
        if span.along_mm is None:
            yield rule(*view.place(*at[span.first]), *view.place(*at[span.last]))
    yield stroked(INK, LINE_MM)


def _letters(tape: TapeEntry, view: View) -> Iterator[str]:
    """Yield the letters of the corners, outside of the pattern."""
    middle = view.size[0] / 2.0, view.size[1] / 2.0
    for spot in tape.spots:
        x, y = view.place(spot.x, spot.y)
        away = hypot(x - middle[0], y - middle[1]) or 1.0
        at = x + OUTSIDE_MM * (x - middle[0]) / away, y + OUTSIDE_MM * (y - middle[1]) / away
        yield said(at[0], at[1] - CAPITAL_MM, " = ".join(spot.letters), Pen(LETTER_PT, BOLD, align="middle"))


def sizes(blank: BlankEntry, view: View) -> str:
    """Return width and height of a pattern with their lines, below and left of its extent."""
    wide, high = view.size
    across, upwards = (blank.height, blank.width) if view.turned else (blank.width, blank.height)
    below, beside = -AROUND_MM - 1.0, -AROUND_MM - 1.0
    pen = Pen(SIZE_PT, align="middle")
    return "".join([
        stroked(QUIET, HAIR_MM),
        _measured(0.0, below, wide, below),
        _measured(beside, 0.0, beside, high),
        said(wide / 2.0, below - SIZES_MM / 2.0 - 0.5, millimetres(across), pen),
        said(beside - 1.5, high / 2.0, millimetres(upwards), Pen(SIZE_PT, align="middle", angle_deg=90.0)),
    ])  # fmt: skip


def _measured(x: float, y: float, to_x: float, to_y: float) -> str:
    """Return a line with ticks across its ends."""
    upright = x == to_x
    ticks = [
        rule(end_x - TICK_MM * upright, end_y - TICK_MM * (not upright), end_x + TICK_MM * upright,
             end_y + TICK_MM * (not upright))
        for end_x, end_y in ((x, y), (to_x, to_y))
    ]  # fmt: skip
    return "".join([rule(x, y, to_x, to_y), *ticks])


PAPERS: Sequence[tuple[str, float, float]] = (
    ("A4", 210.0, 297.0),
    ("A4", 297.0, 210.0),
    ("A3", 297.0, 420.0),
    ("A3", 420.0, 297.0),
)
"""Papers for a page at true scale, upright and across (ISO 216), the first that is large enough."""


def true_view(inked: Inked, room: tuple[float, float]) -> View | None:
    """Return a view at 1:1 if it lies in a room."""
    views = (View(1.0, turned, inked.low, inked.high) for turned in (False, True))
    return next((view for view in views if fits(view, room)), None)


def shifted(content: str, view: View, room: tuple[float, float]) -> str:
    """Return what is drawn of a view in the middle of a room."""
    return moved(content, (room[0] - view.size[0]) / 2.0, (room[1] - view.size[1]) / 2.0)
