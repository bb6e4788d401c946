"""Entities as a reader hands them over, divided into points here: its own numbers, and nobody else's arithmetic.

A reader that runs as a program of its own prints, as JSON by the path of each file, the unit of its drawing
(`$INSUNITS`, or none), the strings of its texts, and its entities: a `layer`, and `points` with one of their `bulges`
each and whether they are `closed`, or `center`, `radius` and the angles `from` and `to` in rad, `turn` if it is not
counter-clockwise.
"""

import json
import subprocess
from collections.abc import Callable, Mapping, Sequence
from math import ceil, pi, radians
from pathlib import Path
from typing import Any

import numpy as np

from stages.geometry.arrays import Points2
from tests.readers.reading import Piece, Reading

STEP_RAD = radians(1.0)
UNIT_MM = {1: 25.4, 4: 1.0, 5: 10.0, 6: 1000.0}
"""Of $INSUNITS, for readers that hand it over and leave it to the caller."""

Answer = dict[str, Any]


def reading_of(answer: Answer) -> Reading:
    """Return what one file holds, in mm."""
    scale = UNIT_MM.get(answer.get("unit") or 0, 1.0)
    pieces = tuple(
        Piece(one["layer"], points_of(one) * scale, bool(one.get("closed")))
        for one in answer["entities"]
        if "center" in one or len(one["points"]) > 1
    )
    texts = answer.get("texts")
    return Reading(pieces, None if texts is None else tuple(texts))


def points_of(entity: Answer) -> Points2:
    """Return the points of an arc, a circle or a polyline."""
    if "center" in entity:
        first, last = entity.get("from", 0.0), entity.get("to", 2.0 * pi)
        return arc(complex(*entity["center"]), entity["radius"], first, last, entity.get("turn", 1.0))
    corners = [complex(*point) for point in entity["points"]]
    return polyline(corners, entity.get("bulges") or [0.0] * len(corners), closed=bool(entity.get("closed")))


def arc(centre: complex, radius: float, first: float, last: float, sense: float = 1.0) -> Points2:
    """Return the points of an arc from one angle to another; from an angle to itself: of a circle."""
    turn = sense * ((sense * (last - first)) % (2.0 * pi) or 2.0 * pi)
    steps = first + np.linspace(0.0, turn, ceil(abs(turn) / STEP_RAD) + 1)
    made = centre + radius * np.exp(1j * steps)
    points: Points2 = np.column_stack([made.real, made.imag])
    return points


def polyline(corners: Sequence[complex], bulges: Sequence[float], *, closed: bool) -> Points2:
    """Return the points of a polyline."""
    ends = [*corners[1:], *(corners[:1] if closed else [])]
    made = [_bulged(*piece) for piece in zip(corners, ends, bulges, strict=False)]
    points = np.concatenate([[corners[0]], *made])
    both: Points2 = np.column_stack([points.real, points.imag])
    return both


def _bulged(start: complex, end: complex, bulge: float) -> np.ndarray:
    """Return points after the first of a piece with a bulge, by the tangent of a quarter of its turn."""
    turn = 4.0 * np.arctan(bulge)
    count = max(ceil(abs(turn) / STEP_RAD), 1)
    if not bulge or start == end:
        return np.array([end])
    arm = (start - end) / (1.0 - np.exp(1j * turn))
    made: np.ndarray = start - arm + arm * np.exp(1j * np.linspace(0.0, turn, count + 1)[1:])
    made[-1] = end
    return made


def program(
    command: Sequence[str], environment: Mapping[str, str] | None = None
) -> Callable[[Sequence[Path]], dict[str, Reading]]:
    """Return the reading of files by a program that prints what this module's head says."""

    def read(paths: Sequence[Path]) -> dict[str, Reading]:
        done = subprocess.run(
            [*command, *map(str, paths)], capture_output=True, check=True, timeout=60, env=environment
        )
        # a reader may print what it likes before
        answers = json.loads(done.stdout.splitlines()[-1])
        return {path.stem: reading_of(answers[str(path)]) for path in paths}

    return read
