"""The tables of a problem: which pairs of kinds get one, and their filling.

Threads fill them together, once, and all look them up.  Kinds with holes get none, nor do angles that are not lists but
for the few that stand for any; where there would be too many, those of the kinds with most copies come first.
"""

from collections import Counter
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from stages.nest.separation.convolution import GRID, NODES
from stages.nest.separation.problem import MOST_TABLES, Arrays, Problem
from stages.nest.separation.state import Floats, Tables, Whole
from stages.nest.separation.tables import NO_TABLE, fill

MOST_RELATIONS = 128
"""Relative angles; where there are more, no table would be asked often enough to be worth its filling."""

SAME = 1e-9
"""Relative angles are the same within this, rad."""

Beside = tuple[int, int, int]
"""A kind, one beside it with the same or a higher number, and their relative angle."""


def tables_for(problem: Problem, given: Arrays, threads: int = 1) -> Tables:
    """Return the tables of a problem, filled."""
    relation, turn = _relations(given.rules.span)
    wanted = _wanted(problem, given, relation)[:MOST_TABLES]
    kinds, count = len(problem.kinds), len(wanted)
    number = np.full((kinds, kinds, len(turn)), NO_TABLE, dtype=np.int64)
    for table, beside in enumerate(wanted):
        number[beside] = table
    tables = Tables(
        number, relation, turn, _boxes(given), np.zeros((count, 4)), np.zeros((count, GRID * GRID), dtype=np.int8),
        np.zeros((count, GRID * GRID + 1), dtype=np.int32), np.zeros((0, 4)),
        np.zeros((count, NODES * NODES), dtype=np.float32),
    )  # fmt: skip
    with ThreadPoolExecutor(threads) as pool:
        rows = list(pool.map(lambda one: fill(tables, given.shapes, one[0], *one[1]), enumerate(wanted)))
    begin = np.concatenate([[0], np.cumsum([len(one) for one in rows])])[:-1]
    tables.start[:] += begin[:, None].astype(np.int32)
    return tables._replace(segments=np.concatenate([np.zeros((0, 4)), *rows]))


def _wanted(problem: Problem, given: Arrays, relation: Whole) -> list[Beside]:
    """Return all that may lie beside one another, those with most copies first."""
    rules = given.rough
    copies = Counter(kind for item in problem.items for kind in {item.kind, item.other})
    spans = {kind: _spans(rules.turn[kind], rules.turns[kind]) for kind in copies}
    simple = [kind for kind in sorted(copies) if not problem.kinds[kind].shape.interiors]
    found: list[tuple[int, Beside]] = []
    for one in simple:
        for other in simple:
            pairs = copies[one] * copies[other] if one < other else copies[one] * (copies[one] - 1)
            if one <= other and pairs:
                angles = np.unique(relation[np.ix_(spans[one], spans[other])])
                found += [(-pairs, (one, other, int(angle))) for angle in angles if angle >= 0]
    return [beside for _, beside in sorted(found)]


def _spans(first: Whole, end: Whole) -> Whole:
    """Return the spans of a kind in any bin."""
    return np.unique(np.concatenate([np.arange(a, b) for a, b in zip(first, end, strict=True)])).astype(np.int64)


def _relations(span: Floats) -> tuple[Whole, Floats]:
    """Return the relative angle of each span of one angle beside each other, and the cosine and sine of them."""
    relation = np.full((len(span), len(span)), -1, dtype=np.int64)
    listed = np.flatnonzero(span[:, 0] == span[:, 1])
    c, s = span[listed, 2], span[listed, 3]
    cos = c[:, None] * c + s[:, None] * s
    sin = c[:, None] * s - s[:, None] * c
    turn = np.stack([cos.ravel(), sin.ravel()], axis=1)
    _, first, place = np.unique(np.round(turn / SAME), axis=0, return_index=True, return_inverse=True)
    if len(first) > MOST_RELATIONS:
        return relation, np.zeros((0, 2))
    relation[np.ix_(listed, listed)] = place.reshape(len(listed), len(listed))
    return relation, turn[first]


def _boxes(given: Arrays) -> Floats:
    """Return the box of each kind in each span: (kinds, spans, 4)."""
    shapes, span = given.shapes, given.rules.span
    boxes = np.zeros((len(shapes.size), len(span), 4))
    for kind in range(len(shapes.size)):
        points = shapes.edges[shapes.first[kind] : shapes.first[kind + 1]].reshape(-1, 2)
        x = points[:, :1] * span[:, 2] - points[:, 1:] * span[:, 3]
        y = points[:, :1] * span[:, 3] + points[:, 1:] * span[:, 2]
        boxes[kind] = np.stack([x.min(axis=0), y.min(axis=0), x.max(axis=0), y.max(axis=0)], axis=1)
    return boxes
