"""Places where a corner of an item meets a corner of a neighbour, an edge along an edge: kernels.

Only there do parts interlock that fit exactly.  Corners are drawn at random.
"""

from typing import no_type_check

import numpy as np

from stages.nest.separation.compiled import compiled

TRIES = 12
"""Pairs of corners drawn until one is found whose edges run along each other."""

ALONG = 1e-6
"""Edges run along each other if the sine of their angle is smaller."""

EITHER = 0.5
"""One or the other, as a coin falls."""


@compiled
@no_type_check
def contact(shapes, rules, layout, item, kind, bin_, span, angle):
    """Return (found, angle, x, y) where a corner of the item meets one of a neighbour, with edges along each other."""
    count = layout.x.size
    found = False
    bx = by = 0.0
    ba = angle
    t0 = shapes.tip[kind]
    t1 = shapes.tip[kind + 1]
    free = rules.span[span, 0] < rules.span[span, 1]
    for _ in range(TRIES):
        j = np.random.randint(0, count)
        if j == item or layout.bin[j] != bin_:
            continue
        other = layout.kind[j]
        u0 = shapes.tip[other]
        u1 = shapes.tip[other + 1]
        p = np.random.randint(t0, t1)
        q = np.random.randint(u0, u1)
        own = p if np.random.random() < EITHER else (p - 1 if p > t0 else t1 - 1)
        near = q if own != p else (q - 1 if q > u0 else u1 - 1)
        c = layout.cos[j]
        s = layout.sin[j]
        dx = c * shapes.tips[near, 2] - s * shapes.tips[near, 3]
        dy = s * shapes.tips[near, 2] + c * shapes.tips[near, 3]
        a = angle
        if free:
            a = np.arctan2(-dy, -dx) - np.arctan2(shapes.tips[own, 3], shapes.tips[own, 2])
            turns = np.floor((a - rules.span[span, 0]) / (2.0 * np.pi))
            a -= turns * 2.0 * np.pi
            if a > rules.span[span, 1]:
                continue
        ca = np.cos(a)
        sa = np.sin(a)
        ex = ca * shapes.tips[own, 2] - sa * shapes.tips[own, 3]
        ey = sa * shapes.tips[own, 2] + ca * shapes.tips[own, 3]
        tx = c * shapes.tips[q, 0] - s * shapes.tips[q, 1] + layout.x[j]
        ty = s * shapes.tips[q, 0] + c * shapes.tips[q, 1] + layout.y[j]
        bx = tx - (ca * shapes.tips[p, 0] - sa * shapes.tips[p, 1])
        by = ty - (sa * shapes.tips[p, 0] + ca * shapes.tips[p, 1])
        ba = a
        found = True
        if abs(ex * dy - ey * dx) < ALONG and ex * dx + ey * dy < 0.0:
            break
    return found, ba, bx, by
