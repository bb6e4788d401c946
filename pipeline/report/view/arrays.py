"""Arrays as text for a page: little-endian numbers in base64, positions as whole steps of a hundred-thousandth.

A position is its corner of least coordinates plus whole steps from 0 to 65535; a step is the longest side of the box
over 65535, so that what is read back is off by at most half a step, 0.8e-5 of the size, in each coordinate.
"""

from base64 import b64encode
from math import sqrt
from typing import Literal

import numpy as np

from stages.geometry.arrays import Array, Numbers

STEPS = 65535
"""Whole steps along the longest side: what two bytes hold."""

Numeral = Literal["<f4", "<u2", "<u4", "u1"]


def encoded_array(values: Array | Numbers, numeral: Numeral) -> str:
    """Return an array row by row in base64."""
    return b64encode(np.ascontiguousarray(values.astype(numeral)).tobytes()).decode("ascii")


def encoded_numbers(values: Numbers) -> dict[str, str | int]:
    """Return whole numbers from 0 on in base64, two bytes each where that is enough."""
    short = values.size == 0 or int(values.max()) <= STEPS
    return {"bytes": 2 if short else 4, "numbers": encoded_array(values, "<u2" if short else "<u4")}


def encoded_points(points: Array) -> dict[str, object]:
    """Return points, of shape (any, ..., 2 or 3) and in mm, as whole steps from their least corner."""
    flat = points.reshape(-1, points.shape[-1])
    low = flat.min(axis=0)
    step = step_mm(points)
    steps = np.rint((flat - low) / step) if step > 0.0 else np.zeros_like(flat)
    return {"low": low.tolist(), "step": step, "points": encoded_array(steps, "<u2")}


def step_mm(points: Array) -> float:
    """Return the step that points are rounded to, mm."""
    flat = points.reshape(-1, points.shape[-1])
    return float(np.ptp(flat, axis=0).max()) / STEPS


def rounding_mm(points: Array) -> float:
    """Return how far a point may be from where it is read back, mm."""
    return step_mm(points) * sqrt(points.shape[-1]) / 2.0
