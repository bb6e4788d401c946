"""DXF: how many lines and arcs a contour takes at one tolerance, and how far the drawing then is from the exact one.

The distance is measured from the text of the file by programs that share nothing with those that wrote it
(`tests/bench/written.py`), in both directions.  Uniform sampling is what most exporters do: each edge is cut into
equal steps of its parameter, here into the fewest that keep the tolerance; straight edges stay one line.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from io import StringIO

import ezdxf
import numpy as np

from stages.geometry.arrays import Array, Points2
from stages.geometry.curves.plane import PlaneCurve, Segment
from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.biarc import trace
from stages.model.cutfile import CutFile, Flavour, Machine
from stages.model.helps import Helps, Lead, Tabs
from stages.model.pattern import Contour, FlatPattern
from stages.model.report import Outcome
from stages.model.sheet import Nesting, Placement, Sheet, SheetLayout
from stages.write import readback, write
from stages.write.drawing import flat_drawing
from stages.write.dxf import dxf_text
from stages.write.flavours import as_cut
from tests.bench.rows import Asked, Extent, Row
from tests.bench.surroundings import version
from tests.bench.timing import Took, measured
from tests.bench.written import HEIGHT, apart, drawn_lines
from tests.parts import QUINTIC_TANGENT, TAN_30, Table, passage
from tests.stages.write.patterns import plate

ABOUT = (
    "Lines and arcs on the cut layers at a tolerance of 0.05 mm (each piece of a polyline counts), and the largest "
    "distance between drawing and exact development, either way, found in the DXF text, with the bound of that search "
    "(0.0008 mm) added. Time from contour to text; of a sheet from its layout to a text that is read back and judged."
)
CIRCLE: Table = {"circle": {"center": [0, 0, 0], "radius": 100}}
PARTS: dict[str, Table] = {
    "tangent developable, 0.8 m": QUINTIC_TANGENT,
    "frustum, 0.8 m": {"kind": "cone", "radius0": 400, "radius1": 125, "height": 450, "sweep": 180},
    "oblique cone, 0.6 m": {"kind": "cone", "apex": [75, 0, 350], "directrix": CIRCLE, "fraction": [0, 0.5]},
    "mitred pipe, 0.6 m": {
        "kind": "cylinder", "directrix": CIRCLE, "direction": [0, 0, 1],
        "end_plane": {"point": [0, 0, 250], "normal": [f"-{TAN_30}", 0, 1]},
    },
}  # fmt: skip
OURS: tuple[Flavour, ...] = ("polyline-arcs", "polylines")
PLATES: dict[Extent, int] = {"quick": 3, "usual": 300, "full": 300}
"""Of 100 x 60 mm with two holes and two marks."""
BEAM_MM = 0.2
ALL_HELPS = Helps(
    beam_mm=BEAM_MM, compensated=True, start="corner", lead_in=Lead("arc", 2.0, 90.0), lead_out=Lead("line", 1.0, 45.0),
    tabs=Tabs(0.4, spacing_mm=80.0),
)  # fmt: skip
BETWEEN = 16
"""Places in each step at which its distance from the edge is asked."""
MOST = 1 << 16


def rows(asked: Asked) -> Iterator[Row]:
    """Yield lines, arcs and deviation of every part, as we and as others write it."""
    yield from sheets(asked)
    for name, table in PARTS.items():
        pattern = passage(table).pattern
        assert pattern is not None
        for flavour in OURS:
            call = partial(ours, pattern, Machine(flavour=flavour))
            yield from judged(name, f"planish {flavour}", version("planish"), pattern, measured(call, asked.rounds))
        took = measured(partial(sampled, pattern), asked.rounds)
        yield from judged(name, "uniform sampling, ezdxf", version("ezdxf"), pattern, took)
        if asked.extent == "quick":
            return


def sheets(asked: Asked) -> Iterator[Row]:
    """Yield how long a sheet of plates takes from layout to judged text, plain and with all helps of the process."""
    count = PLATES[asked.extent]
    places = (Placement("plate", i + 1, Rigid2(10 + 110.0 * (i % 30), 10 + 70.0 * (i // 30))) for i in range(count))
    layout = SheetLayout(Sheet("sheet", 4000.0, 2600.0), 1, tuple(places), 0.9)
    for what, helps in (("plain", Helps(beam_mm=BEAM_MM)), ("all helps", ALL_HELPS)):
        took = measured(partial(anew, Nesting((layout,)), helps), asked.rounds)
        if not took.result.report.passed:
            raise RuntimeError(f"a sheet of plates, {what}: {took.result.report.findings}")
        found = version("planish")
        yield Row(f"a sheet of plates, {what}", f"{count} plates", "planish", found, None, "", *took[1:])


def anew(nesting: Nesting, helps: Helps) -> Outcome[tuple[CutFile, ...]]:
    """Return the drawing of a sheet, its text read for the first time."""
    readback.forget()
    return write([plate()], nesting, Machine(helps=helps))


def judged(name: str, program: str, found: str, pattern: FlatPattern, took: Took[str]) -> Iterator[Row]:
    """Yield what the drawing of a part is made of and how far off it is."""
    layers = Machine().layers
    chord = pattern.outer.chord_mm
    count = sum(map(len, drawn_lines(took.result, layers, HEIGHT * chord).values()))
    size, off = f"{chord:g} mm", apart(took.result, layers, pattern).distance_mm
    yield Row(name, size, program, found, count, "lines and arcs", took.seconds, took.memory_mb, took.how)
    yield Row(f"{name}: deviation", size, program, found, off, "mm")


def ours(pattern: FlatPattern, machine: Machine) -> str:
    """Return our drawing of a part, its arcs or chords fitted anew."""
    if machine.flavour != "polylines":
        arcs = trace(pattern.outer.edges, accuracy=pattern.outer.chord_mm)
        pattern = pattern.replace(outer=replace(pattern.outer, path=arcs))
    return dxf_text(flat_drawing(as_cut(pattern, machine), machine), machine)


def sampled(pattern: FlatPattern) -> str:
    """Return the drawing of an exporter that samples every edge evenly."""
    made, layers = ezdxf.new("R2000"), Machine().layers
    outer = [("CUT_OUTER", pattern.outer)]
    for meaning, contour in [*outer, *(("CUT_INNER", hole) for hole in pattern.inner)]:
        layer = layers[meaning]
        attributes = {"layer": layer.name, "color": layer.colour}
        made.modelspace().add_lwpolyline(evenly(contour), close=True, dxfattribs=attributes)
    text = StringIO()
    made.write(text)
    return text.getvalue()


def evenly(contour: Contour) -> Points2:
    """Return the corners of a contour whose edges are cut into equal steps."""
    made = [edge.at(np.arange(count) / count) for edge in contour.edges for count in [steps(edge, contour.chord_mm)]]
    return np.concatenate(made)


def steps(edge: PlaneCurve, chord_mm: float) -> int:
    """Return the least number of equal steps of t whose chords are within the tolerance of an edge."""
    if isinstance(edge, Segment):
        return 1
    high = 1
    while rise(edge, high) > chord_mm:
        high *= 2
        if high > MOST:
            raise ValueError(f"an edge is not within {chord_mm} mm of {high} chords")
    low = high // 2
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if rise(edge, middle) > chord_mm else (low, middle)
    return high


def rise(edge: PlaneCurve, count: int) -> float:
    """Return how far an edge is from its chords, mm, across them."""
    t = np.linspace(0.0, 1.0, count * BETWEEN + 1)
    points = edge.at(t)
    corners = points[::BETWEEN]
    along = np.diff(corners, axis=0)
    away = points[:-1].reshape(count, BETWEEN, 2) - corners[:-1, None]
    across: Array = along[:, None, 0] * away[..., 1] - along[:, None, 1] * away[..., 0]
    length = np.hypot(along[:, 0], along[:, 1])[:, None]
    return float(np.abs(across / np.where(length > 0.0, length, np.inf)).max())
