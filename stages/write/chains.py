"""Paths put together again from the lines and arcs that a file gives one by one.

A piece goes on with the one before it in the file if both lie on one layer, in one colour, and it begins where that
one ended; a piece that names its line type begins a path of its own.  A path that is back at its start is closed.  An
ARC has no direction: it is taken from its end where that is the end that meets.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from stages.geometry.arrays import Vector2, norm
from stages.geometry.paths.arcpath import ArcPath, backwards

JOINT_MM = 1e-6
"""Ends as near as this meet: ten decimals of centre and radius are 2e-10 mm, doubles of a radius of 1e9 mm 4e-7 mm."""

SINGLE = ("LINE", "ARC")


@dataclass(frozen=True, slots=True)
class Writing:
    """A text by its letters, the place of its middle, its height (mm) and the direction of its line."""

    text: str
    x: float
    y: float
    height_mm: float
    angle_deg: float


@dataclass(frozen=True, slots=True)
class Entity:
    """One entity: its DXF name, layer, colour index, its path if it is one, whether it closes, what it says.

    Several that make up one path are one, of the kind CHAIN.  A circle is a closed path of two half circles,
    counter-clockwise.

    begins: whether it says that a path begins with it.
    count: of how many entities of the file it consists.
    gap_mm: the widest gap between two of them.
    """

    kind: str
    layer: str
    colour: int
    path: ArcPath | None
    closed: bool
    writing: Writing | None = None
    begins: bool = False
    count: int = 1
    gap_mm: float = 0.0


def chained(entities: Sequence[Entity]) -> tuple[Entity, ...]:
    """Return the entities with the lines and arcs that follow each other as one."""
    made: list[Entity] = []
    run: list[Entity] = []
    for entity in entities:
        run = _turned_round(run, entity)
        if run and _goes_on(run, entity):
            run.append(_facing(run[-1], entity))
            continue
        made += _joined(run)
        run = [entity] if entity.kind in SINGLE else []
        made += [] if run else [entity]
    return (*made, *_joined(run))


def _ends(entity: Entity) -> tuple[Vector2, Vector2]:
    """Return where a piece begins and where it ends."""
    if entity.path is None:
        raise ValueError("a line or an arc has a path")
    return entity.path.vertices[0], entity.path.vertices[-1]


def _meet(one: Vector2, other: Vector2) -> bool:
    return bool(norm(one - other) <= JOINT_MM)


def _turned_round(run: list[Entity], entity: Entity) -> list[Entity]:
    """Return a run of one ARC such that it ends where the next piece begins or, an ARC too, ends."""
    if len(run) != 1 or run[0].kind != "ARC" or entity.kind not in SINGLE or entity.begins:
        return run
    ahead = _ends(entity) if entity.kind == "ARC" else _ends(entity)[:1]
    start, end = _ends(run[0])
    if any(_meet(end, point) for point in ahead) or not any(_meet(start, point) for point in ahead):
        return run
    return [_backwards(run[0])]


def _goes_on(run: Sequence[Entity], entity: Entity) -> bool:
    """Return whether an entity goes on where a run of pieces ends, which has not come back to its start."""
    last = run[-1]
    alike = (entity.layer, entity.colour) == (last.layer, last.colour)
    if entity.kind not in SINGLE or entity.begins or not alike:
        return False
    start, end = _ends(entity)
    at = _ends(last)[1]
    back = len(run) > 1 and _meet(at, _ends(run[0])[0])
    return not back and (_meet(at, start) or (entity.kind == "ARC" and _meet(at, end)))


def _facing(last: Entity, entity: Entity) -> Entity:
    """Return the entity in the direction in which it goes on from the last one."""
    start, end = _ends(entity)
    at = _ends(last)[1]
    return _backwards(entity) if entity.kind == "ARC" and norm(at - end) < norm(at - start) else entity


def _backwards(entity: Entity) -> Entity:
    return entity if entity.path is None else replace(entity, path=backwards(entity.path))


def _joined(run: Sequence[Entity]) -> list[Entity]:
    """Return a run of pieces as one path, its vertices those of lines where lines and arcs meet."""
    if len(run) < 2:  # noqa: PLR2004  a piece by itself stays what it is
        return list(run)
    starts, ends = np.stack([_ends(one)[0] for one in run]), np.stack([_ends(one)[1] for one in run])
    closed = _meet(ends[-1], starts[0])
    exact = np.array([one.kind == "LINE" for one in run])
    before = np.roll(ends, 1, axis=0)
    gaps = norm(starts - before)[0 if closed else 1 :]
    # the end of a line is written as it is, that of an arc is computed
    use_before = (np.roll(exact, 1) & ~exact) if closed else np.concatenate([[False], exact[:-1] & ~exact[1:]])
    vertices = np.where(use_before[:, None], before, starts)
    bulges = np.array([one.path.bulges[0] for one in run if one.path is not None])
    if not closed:
        vertices, bulges = np.concatenate([vertices, ends[-1:]]), np.append(bulges, 0.0)
    path = ArcPath(vertices, bulges, closed)
    return [replace(run[0], kind="CHAIN", path=path, closed=closed, count=len(run), gap_mm=float(gaps.max()))]
