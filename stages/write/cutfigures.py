"""How long the beam cuts, how often it pierces, and how far the head travels besides, of a file as it reads."""

from collections.abc import Sequence

import numpy as np

from stages.geometry.arrays import norm
from stages.geometry.paths import manypaths
from stages.geometry.paths.arcpath import bounds
from stages.write.chains import Entity
from stages.write.readback import ReadFile

FOLLOWED = frozenset({"ENGRAVE", "MARK", "CUT_SLIT", "LEAD", "CUT_INNER", "CUT_OUTER"})
"""The layers along which the head goes."""


def cut_figures(back: ReadFile) -> dict[str, float]:
    """Return the cut length in mm, the number of pierces, and how far the head travels without cutting, in mm."""
    return {**cuts(back.entities), "travel_mm": _travel(back)}


def cuts(entities: Sequence[Entity]) -> dict[str, float]:
    """Return how long the beam cuts, leads too and gaps of tabs not, in mm, and how often it pierces.

    A lead is of one piercing with the cut beside it; each path between two tabs has one of its own.
    """
    cut = [entity.path for entity in entities if entity.layer.startswith("CUT_") and entity.path is not None]
    leads = [entity.path for entity in entities if entity.layer == "LEAD" and entity.path is not None]
    return {"cut_length_mm": float(sum(manypaths.lengths([*cut, *leads]).tolist())), "pierces": float(len(cut))}


def _travel(back: ReadFile) -> float:
    """Return the way between marks and cuts as they follow in the file, begun at the corner of a sheet, mm."""
    starts, ends = manypaths.ends([one.path for one in back.entities if one.layer in FOLLOWED and one.path is not None])
    sheet = next((one.path for one in back.entities if one.layer == "SHEET" and one.path is not None), None)
    begin = starts[:1] if sheet is None else np.reshape(bounds(sheet)[:2], (1, 2))
    return float(norm(starts - np.concatenate([begin, ends])[: starts.shape[0]]).sum())
