"""Small builders of stock for the tests of the nest."""

import math

import numpy as np

from stages.geometry.paths.arcpath import ArcPath
from stages.model.sheet import Sheet, Zone
from tests.stages.nest.shapes import Corners


def outline(corners: Corners, bulges: list[float] | None = None) -> ArcPath:
    return ArcPath(np.array(corners, dtype=float), np.array(bulges or [0.0] * len(corners), dtype=float), closed=True)


def round_outline(radius: float, x: float = 0.0, y: float = 0.0) -> ArcPath:
    return outline([(x + radius, y), (x - radius, y)], [1.0, 1.0])


def hide(name: str, corners: Corners, *, edge_gap: float = 0.0, quantity: int = 1, **more: object) -> Sheet:
    points = np.array(corners, dtype=float)
    width, height = points.max(axis=0) - points.min(axis=0)
    fields = {"kind": "hide", "outline": outline(corners), "edge_gap_mm": edge_gap, "quantity": quantity, **more}
    return Sheet(name, float(width), float(height), **fields)


def zone(corners: Corners, quality: int) -> Zone:
    return Zone(outline(corners), quality)


def roll(name: str, height: float, *, edge_gap: float = 0.0, price: float | None = None, **more: object) -> Sheet:
    return Sheet(name, math.inf, height, 1, edge_gap, price, kind="roll", **more)


def lobed(radius: float, depth: float, lobes: int, x: float = 0.0, y: float = 0.0, *, corners: int = 60) -> Corners:
    """A hollow outline like that of a hide: a circle with lobes."""
    turn = np.linspace(0.0, 2.0 * np.pi, corners, endpoint=False)
    reach = radius * (1.0 + depth * np.cos(lobes * turn))
    return [(x + r * math.cos(t), y + r * math.sin(t)) for r, t in zip(reach.tolist(), turn.tolist(), strict=True)]
