"""The helps of a file as read from its text: contours beside the nominal ones, leads clear of them.

Leads are measured against all contours of the file; that each begins or ends on the contour beside it in the file is
looked at first.  Gaps of tabs are those of `bridged`: a contour that does not close over them is an open one.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import norm
from stages.geometry.paths import manypaths
from stages.geometry.paths.arcpath import ArcPath, backwards
from stages.geometry.paths.compensation import Fit
from stages.geometry.paths.leads import APART_MM, Obstacles
from stages.model.helps import Helps
from stages.model.report import Finding
from stages.write.chains import Entity
from stages.write.cutfigures import cuts
from stages.write.drawing import Drawing
from stages.write.helps import LEAD, SHUT_LAYERS
from stages.write.kerf import CUT_LAYERS, fits
from stages.write.readback import ReadFile

MEETS_MM = 1e-6
"""How near a lead must come to the end of its cut: ends of arcs that are read are off by as much."""


@dataclass(frozen=True, slots=True)
class HelpFigures:
    """What a file has of helps: its contours beside the nominal ones, and what is wrong."""

    fits: tuple[Fit, ...] = ()
    findings: tuple[Finding, ...] = ()


def help_figures(back: ReadFile, whole: ReadFile, drawing: Drawing) -> HelpFigures:
    """Return the helps of a file.  whole: the same file with its contours put together where they have tabs."""
    helps = drawing.helps
    if not helps.any:
        return HelpFigures()
    found = fits(whole.entities, drawing.items, helps.offset_mm) if helps.compensated else []
    wrong = [*_lead_faults(back.entities, whole.entities, helps), *_offset_faults(found, drawing, helps)]
    return HelpFigures(
        tuple(found),
        tuple(Finding(code, f"{drawing.path}: {text}", True, {"file": drawing.path}) for code, text in wrong),
    )


def cuts_of_parts(back: ReadFile, drawing: Drawing) -> dict[str, dict[str, float]]:
    """Return what the cuts of each part of a file are, leads among them, and for how many copies.

    Of a file that holds what was drawn, and in which no cuts are shared.
    """
    paths = [entity for entity in back.entities if entity.kind != "TEXT"]
    rows: dict[str, list[Entity]] = {}
    copies: dict[str, set[int]] = {}
    for entity, item in zip(paths, drawing.items, strict=True):
        if entity.layer == LEAD or entity.layer.startswith("CUT_"):
            rows.setdefault(item.part, []).append(entity)
            copies.setdefault(item.part, set()).add(item.copy)
    return {part: {**cuts(row), "copies": float(len(copies[part]))} for part, row in rows.items()}


def _offset_faults(found: Sequence[Fit], drawing: Drawing, helps: Helps) -> Iterator[tuple[str, str]]:
    """Yield that contours are not there to be compared."""
    wanted = sum(item.nominal is not None for item in drawing.items)
    if helps.compensated and len(found) != wanted:
        yield "readback-offset", f"holds other contours than the {wanted} that lie beside nominal ones"


def _lead_faults(entities: Sequence[Entity], whole: Sequence[Entity], helps: Helps) -> Iterator[tuple[str, str]]:
    """Yield the leads that hang in the air, and those that come too near to a contour."""
    obstacles = Obstacles([one.path for one in whole if one.layer in SHUT_LAYERS and one.path is not None])
    least = max(helps.beam_mm / 2.0 - helps.offset_mm, APART_MM)
    ways = list(_ending(entities))
    ending = [way for way in ways if way is not None]
    for _ in range(len(ways) - len(ending)):
        yield "readback-lead", "a lead does not end on the cut beside it"
    for _ in range(int(np.count_nonzero(~obstacles.are_free(ending, least)))):
        yield "readback-lead", "a lead comes too near to a contour"


def _ending(entities: Sequence[Entity]) -> Iterator[ArcPath | None]:
    """Yield each lead such that its end lies on the cut beside it, the one after it first; None if neither end does.

    Which way round it runs is not asked: an ARC has no direction.
    """
    known = [number for number, entity in enumerate(entities) if entity.path is not None]
    paths = [entity.path for entity in entities if entity.path is not None]
    tips = np.full((2, len(entities) + 2, 2), np.nan)
    tips[:, np.array(known, dtype=np.int64) + 1] = manypaths.ends(paths)
    starts, ends = tips
    cut = np.array([False, *(entity.layer in CUT_LAYERS for entity in entities), False])
    leads = [(number, path) for number, path in zip(known, paths, strict=True) if entities[number].layer == LEAD]
    place = np.array([number for number, _ in leads], dtype=np.int64) + 1
    sides = ((place + 1, starts), (place - 1, ends))
    met = [cut[side] & (norm(at[side] - tip[place]) <= MEETS_MM) for side, at in sides for tip in (ends, starts)]
    turn = np.select(met, (1, -1, 1, -1), 0)
    for (_, lead), way in zip(leads, turn.tolist(), strict=True):
        yield None if way == 0 else lead if way > 0 else backwards(lead)
