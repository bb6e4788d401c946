"""What the kernels work on: shapes, the rules where each may lie, and a layout, as flat arrays.

Shapes lie about the middle of their box.  A kind is a shape with its rules; an item is one copy, and has one kind, or
two of them where it may be turned over.  Bins are sheets, hides, or a roll.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Whole = NDArray[np.int64]

RECTANGLE, NOWHERE = -1, -2
"""In place of the number of a region: the whole rectangle of the bin; nothing of it."""


class Shapes(NamedTuple):
    """Shapes of the kinds: `first` and `pole` say where the edges and poles of each begin.

    edges: (e, 4), start and end of each, a hair inside the true ones, so that what touches does not overlap.
    tips: (e, 4): a true corner and the direction of the edge that leaves it, unit length; `tip` says where they begin.
    poles: (3, p), centre and radius of discs inside the shape, the largest first.
    weight: root of the area of the hull.  size: longer side of the box.  reach: farthest point from the middle.
    """

    edges: Floats
    first: Whole
    tips: Floats
    tip: Whole
    poles: Floats
    pole: Whole
    weight: Floats
    size: Floats
    reach: Floats


class Rules(NamedTuple):
    """Where each kind may lie.

    region: (kinds, bins), the number of its region, RECTANGLE or NOWHERE.
    turn, turns: (kinds, bins) and (kinds, bins), first and end of its spans of angles.
    span: (s, 4): low, high in rad, and the cosine and sine of low, exact for quarter turns.
    """

    region: Whole
    turn: Whole
    turns: Whole
    span: Floats


class Regions(NamedTuple):
    """Where parts may lie, if not on a whole rectangle: edges, a point of each ring, and the distance to the edge.

    field: the distance on a grid, positive inside, row by row from `start`; shape: rows and columns; origin, cell: mm.
    """

    edges: Floats
    first: Whole
    points: Floats
    point: Whole
    field: Floats
    start: Whole
    shape: Whole
    origin: Floats
    cell: Floats


class Items(NamedTuple):
    """The copies: `kind` and, where it may be turned over, `other` (else the same); `fixed`: it stays where it is."""

    kind: Whole
    other: Whole
    fixed: NDArray[np.bool_]


class Layout(NamedTuple):
    """Where every item lies: middle of its shape, angle (rad) with its cosine and sine, span, kind, bin.

    edges, first, poles, pole, box: the shapes where they lie, item by item.
    """

    x: Floats
    y: Floats
    angle: Floats
    cos: Floats
    sin: Floats
    span: Whole
    kind: Whole
    bin: Whole
    edges: Floats
    first: Whole
    poles: Floats
    pole: Whole
    box: Floats


class Bins(NamedTuple):
    """Width and height of each bin, (b, 2): the width is what the search makes smaller."""

    size: Floats


class Weights(NamedTuple):
    """How much an overlap counts: of two items (n, n), of an item with the edge of its bin (n,)."""

    pair: Floats
    wall: Floats


class Pose(NamedTuple):
    """Room for one shape in one angle, about its middle: edges, poles, box.

    near: room for edges, column by column.  turn: cosine and sine of the angle; span: its span if that is one angle,
    else -1.  filled: 0 as long as there is but the box: edges and poles are turned when they are asked for.
    """

    edges: Floats
    poles: Floats
    box: Floats
    near: Floats
    turn: Floats
    span: Whole
    filled: Whole


class Tables(NamedTuple):
    """How badly kinds overlap, by their relative place: what `tables` fills and looks up.

    number: (kinds, kinds, relative angles), that of the table, the kind with the lower number first; -1: none.
    relation: (spans, spans), the relative angle of one span beside another, -1 if one of them is more than one angle.
    turn: cosine and sine of the relative angles.  box: (kinds, spans, 4), the box of a kind in a span of one angle.
    frame: (t, 4), where the grid of a table starts and its cells a mm.  winding, start: (t, cells) of one point of each
    cell, and where its segments begin; segments: (s, 4).  cost: (t, nodes).
    """

    number: Whole
    relation: Whole
    turn: Floats
    box: Floats
    frame: Floats
    winding: NDArray[np.int8]
    start: NDArray[np.int32]
    segments: Floats
    cost: NDArray[np.float32]
