"""The shortest way of a ruling along two rails: over arcs of F = 0 and cones, with folds where nothing else leads on.

A strip between rails r(t) and c(s) is a path on which neither parameter falls, from the first ruling to the last.
Three moves make developables: ALONG an arc of F = 0 (a ruled piece), ON_A (t moves, s stays: a cone with its apex on b,
a plane triangle over a straight piece) and ON_B.  Two moves meet smoothly where F = 0 and the zero is open; elsewhere
they meet in a fold of exactly the warp of that ruling.  Zeros on the lattice are nodes of a graph with one state per
move; the moves between them are its edges, and a corner of the lattice beside an open zero stands for the exact corner
that `way` puts in its place.  Dijkstra's algorithm [1]_ finds the cheapest path: fewest folds, then least angle of
folds, then least turning of cones.

Junctions are lattice places: a path that needs a corner between two lines is found beside it.

.. [1] E. W. Dijkstra, "A note on two problems in connexion with graphs", Numerische Mathematik 1 (1959), 269-271.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import Literal

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from stages.geometry.arrays import Array
from stages.geometry.rails.chords import chords, from_shared_ends, met
from stages.geometry.rails.zeros import Field, Lines, Place, Zeros, angles

Move = Literal["along", "on_a", "on_b"]
CONES: tuple[Move, ...] = ("on_a", "on_b")
MOVES: tuple[Move, ...] = ("along", *CONES)
Cell = tuple[int, int]
State = tuple[Place, Move]
"""A place of the lattice (a zero, or ("corner", i, j)) and the move one is in there."""

FOLD = 1e6
"""What a fold costs beside its angle: more than all other costs together, so that fewest folds win."""
ANGLE = 1e3
"""What a degree of folding costs: a smaller fold is worth further pieces, but for the last 1e-5 deg."""
CONE = 1e-3
"""What a degree of turning of a cone costs: ruled pieces are preferred, as cones bend sharply at their apex."""
START = 1e-2
"""What each further piece costs: ten degrees of a cone."""
STEP = 1e-9
"""What any edge costs: an explicit zero would be no edge."""
SMOOTH = 1e-9
"""A warp below this, rad, is none: rounding of cross products."""
BESIDE = np.radians(45.0)
"""A lattice corner beside an open zero stands for the exact corner only if its own warp is below this."""


@dataclass(frozen=True, slots=True)
class Rules:
    """What a strip may do: fold by at most `fold_rad`.

    beside: whether lattice corners beside an open zero stand for an exact one, which may turn out not to be there.
    cones: whether cones may bend; else only plane triangles have an apex on a rail.
    meeting: whether an arc may begin or end where the rails meet: its rulings shrink to a point there.
    """

    fold_rad: float = 0.0
    beside: bool = True
    cones: bool = True
    meeting: bool = False


@dataclass(frozen=True, slots=True)
class Stop:
    """A place on the way, the move that one is in there, and whether the place is a corner that folds."""

    move: Move
    t: float
    s: float
    fold: bool


@dataclass(frozen=True, slots=True)
class Way:
    """Where a ruling stops on its way, and what the way costs; no stops and an infinite cost if there is none."""

    stops: tuple[Stop, ...]
    cost: float


@dataclass(slots=True)
class _Graph:
    """Edges in the making, by the numbers of their states."""

    number: dict[State, int] = field(default_factory=dict)
    edges: list[tuple[int, int, float]] = field(default_factory=list)

    def add(self, start: State, end: State, cost: float) -> None:
        """Add an edge unless its cost is infinite."""
        if cost < np.inf:
            number = self.number
            tail = number.setdefault(start, len(number))
            self.edges.append((tail, number.setdefault(end, len(number)), cost + STEP))


def way(found: Field, every: Zeros, rules: Rules, folds: Iterable[Cell] | None = None) -> Way:
    """Return the cheapest way from the first ruling to the last that keeps the rules.

    folds: the corners of the lattice that may fold if the rules allow it; unless given, every fourth each way.
    """
    graph = _Graph()
    ends = from_shared_ends(found, every) if rules.meeting else ()
    for first, second in (*chords(found, every), *met(every), *ends):
        graph.add((first, "along"), (second, "along"), STEP)
    corners = _corners(found, every, rules, coarse(found) if folds is None else folds)
    for place, cost in corners.items():
        graph.add((place, "on_a"), (place, "on_b"), cost)
        graph.add((place, "on_b"), (place, "on_a"), cost)
    kinks = _over_both_breaks(found, rules)
    for (start, end), cost in kinks.items():
        graph.add(start, end, cost)
    used = [place for place in every if every[place].open]
    for place in used:
        move: Move = "on_b" if place[0] == "column" else "on_a"
        graph.add((place, "along"), (place, move), START)
        graph.add((place, move), (place, "along"), START)
    both = [place for pair in kinks for place, _ in pair]
    at = {place: where(found, every, place) for place in (*used, *corners, *both)}
    _add_cones(graph, found, at, "on_a", rules)
    _add_cones(graph, found, at, "on_b", rules)
    path, cost = _shortest(graph, found.F.shape)
    if not path:
        return Way((), cost)
    folded = {(place, place) for place, price in corners.items() if price >= FOLD}
    folded |= {(start[0], end[0]) for (start, end), price in kinks.items() if price >= FOLD}
    following = [*(place for place, _ in path[1:]), None]
    stops = (
        Stop(move, *where(found, every, place), (place, after) in folded)
        for (place, move), after in zip(path, following, strict=True)
    )
    return Way(tuple(stops), cost)


def _over_both_breaks(found: Field, rules: Rules) -> dict[tuple[State, State], float]:
    """Return the steps over a break of either rail at once, as between the corners of two frames, with their costs."""
    a, b = found.a, found.b
    steps: dict[tuple[State, State], float] = {}
    for i in _kinks(a):
        for j in _kinks(b):
            p = b.point[j] - a.point[i]
            before = {"on_a": np.cross(p, a.slope[i]), "on_b": np.cross(p, b.slope[j])}
            after = {"on_a": np.cross(p, a.slope[i + 1]), "on_b": np.cross(p, b.slope[j + 1])}
            for first, second in product(CONES, CONES):
                fold = float(angles(before[first], after[second]))
                if fold <= max(rules.fold_rad, SMOOTH):
                    price = START if fold <= SMOOTH else fold_cost(fold)
                    steps[(("corner", i, j), first), (("corner", i + 1, j + 1), second)] = price
    return steps


def fold_cost(angle: float) -> float:
    """Return what a fold by an angle in rad costs."""
    return FOLD + ANGLE * float(np.degrees(angle))


def _kinks(of: Lines) -> list[int]:
    """Return the lines before breaks at which the tangent turns."""
    breaks = np.nonzero(~of.inside)[0]
    kinks: list[int] = breaks[angles(of.slope[breaks], of.slope[breaks + 1]) > SMOOTH].tolist()
    return kinks


def _corners(found: Field, every: Zeros, rules: Rules, folds: Iterable[Cell]) -> dict[Place, float]:
    """Return the lattice corners at which a path may turn from one cone to another, with their costs."""
    n, m = found.F.shape
    zero = {(int(i), int(j)) for i, j in np.argwhere((found.F == 0.0) & (found.warp <= SMOOTH))}
    costs = dict.fromkeys(zero if len(zero) <= MANY * (n + m) else zero.intersection(coarse(found)), START)
    for corner in _beside(found, every) if rules.beside else ():
        costs.setdefault(corner, START + CONE * float(np.degrees(found.warp[corner])))
    if rules.fold_rad > 0.0:
        for corner in folds:
            if found.warp[corner] <= rules.fold_rad:
                costs.setdefault(corner, fold_cost(found.warp[corner]))
    costs |= {(0, 0): 0.0, (n - 1, m - 1): 0.0}
    return {("corner", i, j): cost for (i, j), cost in costs.items()}


MANY = 4
"""Zeros at more than so many lines' worth of corners are a plane or one cone."""


def _beside(found: Field, every: Zeros) -> set[tuple[int, int]]:
    """Return the corners at both ends of the lattice edges that open zeros lie on."""
    sides = {"column": (0, 1), "row": (1, 0)}
    both = {
        (i + shift * sides[kind][0], j + shift * sides[kind][1])
        for (kind, i, j), zero in every.items()
        if zero.open
        for shift in (0, 1)
    }
    return {corner for corner in both if found.warp[corner] < BESIDE}


def coarse(found: Field) -> Iterable[Cell]:
    """Return every fourth corner each way, and those at breaks and ends."""
    return [(i, j) for i in _coarse_lines(found.a) for j in _coarse_lines(found.b)]


def _coarse_lines(of: Lines) -> list[int]:
    breaks = np.nonzero(~of.inside)[0]
    return sorted({*of.even[::COARSE].tolist(), int(of.even[-1]), *breaks.tolist(), *(breaks + 1).tolist()})


COARSE = 4
"""Folds may lie on every fourth line: `folds` finds their exact place."""


def _add_cones(graph: _Graph, found: Field, at: Mapping[Place, tuple[float, float]], move: Move, rules: Rules) -> None:
    """Add the cones between places that follow each other at one parameter of the fixed rail; a break has one."""
    turning_on_b = move == "on_b"
    fixed, moving = (found.a, found.b) if turning_on_b else (found.b, found.a)
    costs = _costs(found.turn_b if turning_on_b else found.turn_a.T, moving, rules)
    lanes: dict[float, list[tuple[float, int, int, Place]]] = {}
    for place, (t, s) in at.items():
        kind, i, j = place
        if kind in ("column" if turning_on_b else "row", "corner"):
            rests, x, line, below = (t, s, i, j) if turning_on_b else (s, t, j, i)
            lanes.setdefault(round(rests, DIGITS), []).append((round(x, DIGITS), line, below, place))
    line_at = {round(float(value), DIGITS): k for k, value in enumerate(fixed.value)}
    for rests, lane in lanes.items():
        _add_lane(graph, sorted(lane), costs[line_at[rests]], move)


DIGITS = 12
"""Decimals to which parameters are told apart."""


@dataclass(frozen=True, slots=True)
class _Costs:
    """Costs of a cone up to each line, and in how many intervals it has done what the rules forbid."""

    value: list[float]
    cost: list[float]
    barred: list[int]

    def up_to(self, x: float, line: int) -> float:
        """Return the cost up to x, on the line or in the interval above it."""
        above = min(line + 1, len(self.value) - 1)
        width = self.value[above] - self.value[line]
        share = (x - self.value[line]) / width if width > 0.0 else 0.0
        return self.cost[line] + share * (self.cost[above] - self.cost[line])


def _costs(turns: Array, moving: Lines, rules: Rules) -> list[_Costs]:
    """Return the costs of the cones along every line of the rail at rest, by how they turn from line to line."""
    inside = moving.inside
    fold = ~inside & (turns > SMOOTH)
    step = np.where(fold, FOLD + ANGLE * np.degrees(turns), np.where(inside, CONE * np.degrees(turns), 0.0))
    bent = inside & (turns > SMOOTH) if not rules.cones else np.zeros_like(fold)
    barred = np.cumsum(bent | (fold & (turns > rules.fold_rad)), axis=1)
    cost = np.cumsum(step, axis=1)
    value, none = moving.value.tolist(), np.zeros((len(turns), 1))
    rows = zip(np.hstack([none, cost]).tolist(), np.hstack([none, barred]).astype(int).tolist(), strict=True)
    return [_Costs(value, *row) for row in rows]


def _add_lane(graph: _Graph, lane: Sequence[tuple[float, int, int, Place]], costs: _Costs, move: Move) -> None:
    """Add the cones along one lane, each from a place to the next, but not over what the rules forbid."""
    before: tuple[Place, float, int] | None = None
    for x, _, below, place in lane:
        here, barred = costs.up_to(x, below), costs.barred[below]
        if before is not None and barred == before[2]:
            graph.add((before[0], move), (place, move), max(here - before[1], 0.0))
        before = place, here, barred


def where(found: Field, every: Zeros, place: Place) -> tuple[float, float]:
    """Return the parameters t and s of a place."""
    if place[0] == "corner":
        return float(found.a.value[place[1]]), float(found.b.value[place[2]])
    return every[place].t, every[place].s


def _shortest(graph: _Graph, shape: tuple[int, ...]) -> tuple[list[State], float]:
    """Return the states of the cheapest path and its cost; none if no path leads to the end."""
    n, m = shape
    states = list(graph.number)
    starts, ends = (
        [graph.number[corner, move] for move in MOVES if (corner, move) in graph.number]
        for corner in (("corner", 0, 0), ("corner", n - 1, m - 1))
    )
    if not (starts and ends):
        return [], np.inf
    tails, heads, costs = (np.array(column) for column in zip(*graph.edges, strict=True))
    order = np.lexsort((costs, heads, tails))
    first = np.append(True, (np.diff(tails[order]) != 0) | (np.diff(heads[order]) != 0))
    kept = order[first]
    matrix = coo_matrix((costs[kept], (tails[kept], heads[kept])), shape=(len(states), len(states))).tocsr()
    cost, before, _ = dijkstra(matrix, indices=starts, return_predecessors=True, min_only=True)
    last = min(ends, key=lambda state: float(cost[state]))
    if not np.isfinite(cost[last]):
        return [], np.inf
    path = [last]
    while before[path[-1]] >= 0:
        path.append(int(before[path[-1]]))
    return [states[k] for k in path[::-1]], float(cost[last])
