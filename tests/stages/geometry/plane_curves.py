"""Plane curves by formula, for the tests of what is fitted to them and measured on them."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from hypothesis import strategies as st
from scipy.spatial import KDTree

from stages.geometry.arrays import Array, Points2, Values
from stages.geometry.paths.arcpath import ArcPath, chords, sweeps

TAU = 2.0 * np.pi


@dataclass(frozen=True)
class Formula:
    """x + i y and its derivative as functions of t."""

    place: Callable[[Array], Array]
    slope: Callable[[Array], Array]

    def at(self, t: Values) -> Points2:
        z = self.place(t) + 0.0 * t
        return np.stack([z.real, z.imag], axis=1)

    def derivative(self, t: Values) -> Points2:
        z = self.slope(t) + 0.0 * t
        return np.stack([z.real, z.imag], axis=1)


K = 100.0 * np.tan(np.pi / 6.0)
SINE = Formula(
    lambda t: 100.0 * TAU * t + 1j * K * (1.0 - np.cos(TAU * t)),
    lambda t: 100.0 * TAU + 1j * K * TAU * np.sin(TAU * t),
)
"""A cylinder of radius 100 cut at 30 degrees, unrolled."""

ELLIPSE = Formula(
    lambda t: 100.0 * np.cos(TAU * t) + 50j * np.sin(TAU * t),
    lambda t: TAU * (-100.0 * np.sin(TAU * t) + 50j * np.cos(TAU * t)),
)

HALF_ANGLE = np.radians(20.0)


def _slant(t: Array) -> Array:
    return 300.0 / (np.cos(HALF_ANGLE) - 0.4 * np.sin(HALF_ANGLE) * np.cos(TAU * t))


def _slant_slope(t: Array) -> Array:
    return -(_slant(t) ** 2) / 300.0 * 0.4 * np.sin(HALF_ANGLE) * np.sin(TAU * t) * TAU


CONE = Formula(
    lambda t: _slant(t) * np.exp(1j * TAU * t * np.sin(HALF_ANGLE)),
    lambda t: (_slant_slope(t) + 1j * TAU * np.sin(HALF_ANGLE) * _slant(t)) * np.exp(1j * TAU * t * np.sin(HALF_ANGLE)),
)
"""A cone of half-angle 20 degrees cut by the plane z = 300 + 0.4 x, unrolled."""


def wave(amplitudes: list[float], phases: list[float]) -> Formula:
    """Return a graph over 200 mm: a sum of sines, one to so many periods."""
    n = np.arange(1, len(amplitudes) + 1)
    a, p = np.array(amplitudes), np.array(phases)
    return Formula(
        lambda t: 200.0 * t + 1j * (a * np.sin(TAU * n * t[:, None] + p)).sum(axis=1),
        lambda t: 200.0 + 1j * (a * n * TAU * np.cos(TAU * n * t[:, None] + p)).sum(axis=1),
    )


def waves() -> st.SearchStrategy[Formula]:
    """Return smooth curves with up to three periods and several inflections."""
    three = st.lists(st.floats(-8.0, 8.0), min_size=3, max_size=3)
    return st.builds(wave, three, st.lists(st.floats(0.0, 6.0), min_size=3, max_size=3))


def stroked(path: ArcPath, steps: int) -> Points2:
    """Return points along the path from centres and angles: written without the code under test's own formulas."""
    points = []
    for (a, b), sweep in zip(np.stack(chords(path), axis=1), sweeps(path), strict=True):
        f = np.arange(steps + 1) / steps
        z, w = complex(*a), complex(*b)
        if abs(sweep) < 1e-7:
            line = z + (w - z) * f
        else:
            centre = (z + w) / 2.0 + 1j * (w - z) / 2.0 / np.tan(sweep / 2.0)
            line = centre + (z - centre) * np.exp(1j * sweep * f)
        points.append(np.stack([line.real, line.imag], axis=1)[:-1])
    return np.concatenate([*points, np.array([[w.real, w.imag]])])


def polygon_distance(queries: Points2, polygon: Points2) -> Values:
    """Return the distance of each query to the two chords at its nearest polygon point; too large, if not exact."""
    _, nearest = KDTree(polygon).query(queries)
    found = []
    for first in (np.maximum(nearest - 1, 0), np.minimum(nearest, polygon.shape[0] - 2)):
        start, chord = polygon[first], polygon[first + 1] - polygon[first]
        f = ((queries - start) * chord).sum(axis=1) / np.maximum((chord**2).sum(axis=1), 1e-300)
        found.append(np.linalg.norm(queries - start - np.clip(f, 0.0, 1.0)[:, None] * chord, axis=1))
    return np.minimum(*found)


def brute_distance(curves: list[Formula], path: ArcPath, count: int = 4000) -> float:
    """Return the two-sided distance of polygons of curve and path, without the code under test."""
    exact = np.concatenate([curve.at(np.linspace(0.0, 1.0, count)) for curve in curves])
    arcs = stroked(path, 200)
    return float(max(polygon_distance(exact, arcs).max(), polygon_distance(arcs, exact).max()))
