"""What is to be said of the helps on a drawing: what was done, in numbers, and what could not be, with its remedy."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import inf, isfinite

from stages.model.helps import Helps
from stages.model.report import Finding, Where
from stages.write.drawing import Item


@dataclass(frozen=True, slots=True)
class Done:
    """What was done on one contour: the paths it is cut by, with leads.

    tabs, missing_tabs: how many it has, and how many more were asked for; uneven_mm: how far one is from even spacing.
    leads, blocked: how many there are, and how many paths have none since none is free; moved: it begins elsewhere.
    room_mm: how near a lead comes to another contour; infinite where it is not near any.
    shared: what is left of an outline that shares cuts.
    """

    items: tuple[Item, ...]
    part: str
    tabs: int = 0
    missing_tabs: int = 0
    uneven_mm: float = 0.0
    leads: int = 0
    blocked: int = 0
    moved: bool = False
    room_mm: float = inf
    shared: bool = False


def told(path: str, helps: Helps, done: Sequence[Done]) -> tuple[Finding, ...]:
    """Return the findings on the helps of one file; none of them stops the job."""
    return tuple(
        Finding(code, f"{path}: {text}", where={"file": path, **where})
        for code, text, where in (
            *_compensation(helps),
            *_begins(helps),
            *_tabs(helps, done),
            *_leads(helps, done),
            *_shared(helps, done),
        )
    )


Said = tuple[str, str, Where]


def _compensation(helps: Helps) -> Iterator[Said]:
    if helps.compensated:
        text = (
            f"contours are {helps.offset_mm:.6g} mm beside the nominal ones, half of the kerf of {helps.beam_mm:.6g} mm"
        )
        yield "kerf-compensated", f"{text}: do not offset them again", {"offset_mm": helps.offset_mm}


def _begins(helps: Helps) -> Iterator[Said]:
    if helps.start != "as-drawn":
        rule = helps.start if isinstance(helps.start, str) else f"{helps.start:g} of the length"
        yield "start-points", f"whole contours begin by the rule {rule!r}", {"rule": rule}


def _tabs(helps: Helps, done: Sequence[Done]) -> Iterator[Said]:
    if helps.tabs is None:
        return
    width, gap = helps.tabs.width_mm, helps.gap_mm
    count, held = sum(one.tabs for one in done), sum(one.tabs > 0 for one in done)
    uneven = max((one.uneven_mm for one in done), default=0.0)
    text = f"{count} tabs of {width:.6g} mm hold {held} contours, open over {gap:.6g} mm at each"
    numbers: Where = {"tabs": count, "contours": held, "width_mm": width, "gap_mm": gap, "uneven_mm": uneven}
    yield "tabs", f"{text}; at most {uneven:.4g} mm from even spacing", numbers
    for part, missing in _by_part((one.part, one.missing_tabs) for one in done):
        remedy = "ask for fewer or narrower ones"
        yield "tab-left-out", f"{missing} tabs of '{part}' find no place clear of corners: {remedy}", {"part": part}


def _leads(helps: Helps, done: Sequence[Done]) -> Iterator[Said]:
    if not helps.leads:
        return
    count, moved = sum(one.leads for one in done), sum(one.moved for one in done)
    room = min((one.room_mm for one in done), default=inf)
    near = f", at least {room:.4g} mm from all other contours" if isfinite(room) else ""
    numbers: Where = {"leads": count, "moved": moved, **({"room_mm": room} if isfinite(room) else {})}
    elsewhere = f"; {moved} contours begin elsewhere to make room" if moved else ""
    yield "leads", f"{count} leads on the layer for leads{near}{elsewhere}", numbers
    for part, blocked in _by_part((one.part, one.blocked) for one in done):
        remedy = "shorten it, or give nest.gap more room"
        yield "lead-left-out", f"{blocked} cuts of '{part}' have no room for a lead: {remedy}", {"part": part}


def _shared(helps: Helps, done: Sequence[Done]) -> Iterator[Said]:
    count = sum(one.shared for one in done)
    if count and (helps.begins or helps.tabs is not None):
        text = f"{count} pieces of outlines that share cuts have no start point, lead or tab of their own"
        yield "helps-and-common-lines", f"{text}: leave nest.common_line out to have them", {"pieces": count}


def _by_part(counted: Iterable[tuple[str, int]]) -> list[tuple[str, int]]:
    """Return the sums of all parts that have any, in their order."""
    sums: dict[str, int] = {}
    for part, count in counted:
        sums[part] = sums.get(part, 0) + count
    return [(part, count) for part, count in sums.items() if count]
