"""W3 and W5 to W10: what the files of the samples hold."""

from collections.abc import Iterator
from io import StringIO
from math import degrees

import ezdxf
import numpy as np
from ezdxf.entities.circle import Circle
from ezdxf.entities.dxfgfx import DXFGraphic
from ezdxf.entities.lwpolyline import LWPolyline

from stages.geometry.arrays import Mask, norm
from stages.geometry.paths.arcpath import ArcPath, joint_turns
from stages.geometry.paths.biarc import LEAST_PIECE_MM
from stages.model.pattern import Contour, FlatPattern
from stages.write.faults import KINDS, faults
from stages.write.readback import read
from tests.bench.cutfiles.made import Made, drawings, samples
from tests.bench.cutfiles.rows import Row, Worst, counted, limited
from tests.bench.written import apart, box

SMOOTH_DEG, EXTENT_MM, WHOLE_TOLERANCE = 0.2, 0.01, 1.0
SAME_MM, HEIGHT_MM = 1e-6, 1e-3
MOST_BULGE = 1.0 + 1e-9
ARCS = ("polyline-arcs", "lines-arcs", "r12")
CUTS = ("CUT_OUTER", "CUT_INNER")
ORDER = {"readback-order", "readback-direction", "readback-open-contour"}
TWICE = {"readback-duplicate", "readback-common-cut"}


def distance() -> Row:
    """W3: how far drawings are from the exact development, as a share of what is allowed."""
    found = []
    for one in samples():
        for path, pattern, _ in one.flat():
            far = apart(one.texts[path], one.machine.layers, pattern)
            found.append(Worst(far.distance_mm / far.tolerance_mm, f"{one.where(path)}, {far.distance_mm:.4g} mm"))
    how = "polygons with corners on both, shapely; every flavour and side in tests/bench/test_written.py"
    return limited("W3", "two-sided distance / tolerance", (WHOLE_TOLERANCE, ""), found, how)


def smoothness() -> Row:
    """W5: how far the pieces of one smooth curve turn where they join."""
    found = []
    for one in samples():
        for path, pattern, _ in one.flat() if one.machine.flavour in ARCS else ():
            found += [Worst(turn, one.where(path)) for turn in inner_turns(one, path, pattern)]
    how = "vertices of contours that are not ends of exact edges"
    return limited("W5", "tangent jump at inner joins", (SMOOTH_DEG, "deg"), found, how)


def inner_turns(one: Made, path: str, pattern: FlatPattern) -> Iterator[float]:
    """Yield the largest turn, deg, between pieces of one exact edge, for each contour in the file of a part."""
    cut = [entity for entity in read(one.texts[path], one.machine.layers).entities if entity.layer in CUTS]
    contours = sorted((pattern.outer, *pattern.inner), key=_place)
    paths = sorted((entity.path for entity in cut if entity.path is not None), key=_middle)
    for contour, found in zip(contours, paths, strict=True):
        turns = np.abs(joint_turns(found))[_within(found, contour)]
        yield degrees(float(turns.max(initial=0.0)))


def _place(contour: Contour) -> tuple[float, ...]:
    return _middle(contour.path)


def _middle(path: ArcPath) -> tuple[float, ...]:
    """Return what contours are paired by: where their corners are, and how wide they are, to a thousandth."""
    low, high = path.vertices.min(axis=0), path.vertices.max(axis=0)
    return tuple(np.round([*(low + high) / 2.0, *(high - low)], 3).tolist())


def _within(path: ArcPath, contour: Contour) -> Mask:
    """Return which vertices of a path are not ends of the exact edges."""
    ends = np.concatenate([edge.at(np.array([0.0, 1.0])) for edge in contour.edges])
    far: Mask = norm(path.vertices[:, None] - ends[None]).min(axis=1) > SAME_MM
    return far


def wholeness() -> Row:
    """W6: contours that are one closed entity without repeated vertices, short pieces or wide arcs."""
    wrong, total = list[str](), 0
    for one, path, text in drawings():
        if one.machine.flavour != "polyline-arcs" or (path.startswith("cut/") and not one.bare):
            continue
        names = {one.machine.layers[meaning].name for meaning in CUTS}
        short = any(finding.code == "short-piece" for finding in one.result.write.report.findings)
        for entity in ezdxf.read(StringIO(text)).modelspace():
            if entity.dxf.layer in names:
                total += 1
                wrong += [f"{one.where(path)}: {fault}" for fault in flaws(entity, short=short)]
    return counted("W6", "contours whole, in one entity", wrong, total, "ezdxf, entity by entity; files without helps")


def flaws(entity: DXFGraphic, *, short: bool) -> Iterator[str]:
    """Yield what is wrong with the entity of a contour; short: the part itself has edges that are."""
    if isinstance(entity, Circle) and entity.dxftype() == "CIRCLE":
        return
    if not isinstance(entity, LWPolyline) or not entity.closed:
        yield f"{entity.dxftype()} is no closed polyline"
        return
    points = np.array(entity.get_points("xyb"))
    step = norm(np.diff(points[:, :2], axis=0, append=points[:1, :2]))
    if step.min() <= (SAME_MM if short else LEAST_PIECE_MM):
        yield f"a piece of {step.min():.3g} mm"
    if np.abs(points[:, 2]).max() > MOST_BULGE:
        yield "an arc of more than half a circle"


def judged() -> Iterator[Row]:
    """W7 and W8: order and directions, cuts that would be made twice."""
    wrong: dict[str, list[str]] = {"W7": [], "W8": []}
    total = 0
    for one, path, text in drawings():
        if one.machine.flavour == "aama" or (path.startswith("cut/") and not one.bare):
            continue
        total += 1
        chord = max(pattern.outer.chord_mm for pattern in one.patterns.values())
        found = {finding.code for finding in faults(read(text, one.machine.layers), path, 0.0, chord)}
        wrong["W7"] += [one.where(path)] * bool(found & ORDER)
        wrong["W8"] += [one.where(path)] * bool(found & TWICE)
    how = "own reader on every drawing without helps; that it sees faults is W16"
    yield counted("W7", "order and directions", wrong["W7"], total, how)
    yield counted("W8", "no cut twice", wrong["W8"], total, how)


def as_ezdxf_reads() -> Iterator[Row]:
    """W9 and W10: sorts of entities, and what ezdxf says of the files."""
    foreign, audited, extents, total = list[str](), list[str](), list[Worst](), 0
    for one, path, text in drawings():
        if one.machine.flavour == "aama":
            continue
        total += 1
        document = ezdxf.read(StringIO(text))
        kinds = {entity.dxftype() for entity in document.modelspace()} - KINDS
        foreign += [f"{one.where(path)}: {', '.join(sorted(kinds))}"] * bool(kinds)
        audited += [one.where(path)] * bool(document.audit().errors)
        corners = zip(("$EXTMIN", "$EXTMAX"), box(text, HEIGHT_MM), strict=True)
        off = [np.abs(np.array(document.header[name])[:2] - corner).max() for name, corner in corners]
        extents.append(Worst(float(max(off)), one.where(path)))
    yield counted("W9", "files of plain entities alone", foreign, total, "ezdxf: sorts of all entities")
    yield counted("W10", "files that ezdxf's audit passes", audited, total, "ezdxf audit")
    how = "box of lines, arcs and circles as ezdxf divides them, by chords within 0.001 mm"
    yield limited("W10", "extents against the box", (EXTENT_MM, "mm"), extents, how)
