"""Small builders of patterns for the tests of the nest."""

from math import radians, tan

import numpy as np

from stages.geometry.paths.arcpath import ArcPath, area, backwards
from stages.model.pattern import Contour, FlatPattern

Corners = list[tuple[float, float]]


def contour(corners: Corners, bulges: list[float] | None = None, *, hole: bool = False) -> Contour:
    path = ArcPath(np.array(corners, dtype=float), np.array(bulges or [0.0] * len(corners), dtype=float), closed=True)
    if (area(path) < 0.0) != hole:
        path = backwards(path)
    return Contour((), path, 0.0)


def pattern(
    name: str,
    outer: Contour,
    *inner: Contour,
    quantity: int = 1,
    rotations: tuple[float, ...] | None = None,
) -> FlatPattern:
    return FlatPattern(name, quantity, outer, tuple(inner), (), np.zeros(2), np.zeros((4, 2)), rotations)


def rectangle(
    name: str, width: float, height: float, quantity: int = 1, rotations: tuple[float, ...] | None = None
) -> FlatPattern:
    return pattern(name, contour(box(width, height)), quantity=quantity, rotations=rotations)


def box(width: float, height: float, x: float = 0.0, y: float = 0.0) -> Corners:
    return [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]


def angle_piece(name: str, size: float, thick: float, quantity: int = 1) -> FlatPattern:
    corners = [(0.0, 0.0), (size, 0.0), (size, thick), (thick, thick), (thick, size), (0.0, size)]
    return pattern(name, contour(corners), quantity=quantity)


def sector(name: str, inner: float, outer: float, sweep_deg: float, quantity: int = 1) -> FlatPattern:
    """An annulus sector: two arcs and two straight sides."""
    sweep, bulge = radians(sweep_deg), tan(radians(sweep_deg) / 4.0)
    c, s = float(np.cos(sweep)), float(np.sin(sweep))
    corners = [(inner, 0.0), (outer, 0.0), (outer * c, outer * s), (inner * c, inner * s)]
    return pattern(name, contour(corners, [0.0, bulge, 0.0, -bulge]), quantity=quantity)


def circle(radius: float, *, hole: bool = False) -> Contour:
    return contour([(radius, 0.0), (-radius, 0.0)], [1.0, 1.0], hole=hole)


def disc(name: str, radius: float, quantity: int = 1) -> FlatPattern:
    return pattern(name, circle(radius), quantity=quantity)


def ring(name: str, radius: float, hole: float, quantity: int = 1) -> FlatPattern:
    return pattern(name, circle(radius), circle(hole, hole=True), quantity=quantity)
