"""Lengths on the smooth surface between vertices that an edge joins, from the surface fitted at both ends.

In the plane of the edge and of the mean of both normals, x from 0 to 1 along the chord of length L, the section's
height is taken as the quintic with the slopes m0, m1 and curvatures of both ends [1]_; its length by Gauss's
rule.  The shortest way leaves that plane: between normals that turn sideways by q1 - q0 it is shorter by (m1 -
m0)^2 (q1 - q0)^2 / 1440 of L.

Where that comes from: for small slopes the way (y, z) over the chord obeys y'' = -z_y z'' with z'' = c constant and
the sideways slope z_y = t (x - L/2); then int y'^2 = c^2 t^2 L^5 / 720, and half of it is saved.  To the second
order in m the slopes alone give L (1 + (m0^2 + m1^2) / 15 - m0 m1 / 30), the cubic's length; the quintic gains two
orders in L.

.. [1] G. Farin, "Curves and Surfaces for CAGD", 5th ed., 2002, section 7.6.
"""

import numpy as np

from stages.geometry.arrays import EPS, Array, Indices, Mask, Numbers, Points3, Values, cross3, dot, norm, unit
from stages.geometry.mesh.fit import SurfaceFit

POINTS = 6
"""Gauss points: exact for the square of the quintic's slope, of degree 8, and for all but 1e-3 of its fourth power."""
SIDEWAYS = 1.0 / 1440.0
STEEP = 0.7
"""An end slope above this, 35 deg, is not that of a smooth surface with vertices near enough: the chord is taken."""
UNEXPLAINED = 0.02
"""What a fit leaves of a vertex's surroundings, over what a plane leaves, from which on its slopes are not believed: by
experiment on coarse, sharp and noisy meshes from there on lengths on the fit may be worse than chords."""


def chords(vertices: Array, ends: Numbers) -> Values:
    """Return the straight lengths of edges, mm."""
    return norm(vertices[ends[:, 1]] - vertices[ends[:, 0]])


def curved(vertices: Array, ends: Numbers, fit: SurfaceFit) -> tuple[Values, Mask]:
    """Return the lengths of edges on the fitted surface, mm, and where the fit is to be believed."""
    ways = vertices[ends[:, 1]] - vertices[ends[:, 0]]
    length = norm(ways)
    along = unit(ways)
    middle = fit.normals[ends[:, 0]] + fit.normals[ends[:, 1]]
    up = unit(middle - dot(middle, along)[:, None] * along)
    (m0, c0, q0), (m1, c1, q1) = (_end(fit, ends[:, k], along, up, length) for k in range(2))
    slopes = np.stack([m0, m1, c0, c1], axis=1) @ _QUINTIC
    nodes, weights = np.polynomial.legendre.leggauss(POINTS)
    heights = slopes @ np.vander((nodes + 1.0) / 2.0, DEGREE + 1, increasing=True).T
    share = np.sqrt(1.0 + heights**2) @ weights / 2.0 - SIDEWAYS * ((m1 - m0) * (q1 - q0)) ** 2
    known = fit.residual <= np.maximum(UNEXPLAINED * fit.relief, ROUNDINGS * EPS * norm(vertices))
    smooth = known[ends].all(axis=1) & (np.maximum(np.abs(m0), np.abs(m1)) < STEEP)
    return length * share, np.asarray(smooth)


ROUNDINGS = 16
"""Heights of a plane differ by the rounding of their coordinates, and have no other shape."""


def mended(lengths: Values, straight: Values, of_half: Numbers) -> Values:
    """Return the lengths with those of the chords wherever three would not make a triangle.

    of_half: the edge of each side of every triangle.
    """
    made = lengths.copy()
    while True:
        sides = made[of_half].reshape(-1, 3)
        open_ = 2.0 * sides.max(axis=1) >= sides.sum(axis=1)
        edges = np.unique(of_half.reshape(-1, 3)[open_])
        if not (made[edges] != straight[edges]).any():
            return made
        made[edges] = straight[edges]


DEGREE = 4
"""Of the slope of a quintic."""

_QUINTIC = np.array([
    [1.0, 0.0, -18.0, 32.0, -15.0], [0.0, 0.0, -12.0, 28.0, -15.0],
    [0.0, 1.0, -4.5, 6.0, -2.5], [0.0, 0.0, 1.5, -4.0, 2.5],
])  # fmt: skip
"""Slope, by rising powers of x, of the quintics with one of slope at 0, slope at 1, curvature at 0, at 1 equal to 1."""


def _end(fit: SurfaceFit, at: Indices, along: Points3, up: Points3, length: Values) -> tuple[Values, Values, Values]:
    """Return slope, second derivative and slope sideways of the surface over the chord at one end of every edge."""
    normal = fit.normals[at]
    rise = dot(normal, up)
    rise = np.where(rise > TURNED, rise, TURNED)
    m = -dot(normal, along) / rise
    tangent = unit(along + m[:, None] * up)
    across = dot(normal, up - m[:, None] * along) / np.sqrt(1.0 + m * m)
    c = fit.bending(at, tangent) / np.where(across > TURNED, across, TURNED) * (1.0 + m * m) ** 1.5 * length
    return m, c, -dot(normal, cross3(along, up)) / rise


TURNED = 0.1
"""Keeps the quotients finite where the normals of the ends look away from each other; the slopes are then too steep."""
