"""How much a conformal map that keeps the boundary's scale would have to magnify a surface, place by place.

The logarithm u of that magnification has -laplace u = K inside and 0 on the boundary; linear elements, K dA from the
angle defects of the vertices.  Where |u| is largest, a cut takes the most strain away: that is where flattenings by
prescribed curvature put their cones [1]_.  Noise of the defects hardly shows: the Laplacian's inverse is smooth.

.. [1] M. Ben-Chen, C. Gotsman, G. Bunin, "Conformal flattening by curvature prescription and metric scaling", Computer
   Graphics Forum 27 (2), 2008, 449-458.
"""

import numpy as np
from scipy.sparse import coo_array, csc_array

from stages.geometry.arrays import Array, Triples, Values
from stages.geometry.numeric.sparsesolve import factorised


def scale_factors(faces: Triples, corners: Array, defects: Values, inside: Values) -> Values:
    """Return u at every vertex; 0 on the boundary.

    corners: of every triangle laid flat, shape (m, 3, 2).  defects: at every vertex, rad.  inside: 1 there, else 0.
    """
    n, free = len(inside), np.flatnonzero(inside)
    rows, columns, values = [], [], []
    for i in range(3):
        a, b, apex = (corners[:, (i + k) % 3] for k in (0, 1, 2))
        one, other = a - apex, b - apex
        across = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
        cotangent = (one * other).sum(axis=1) / across / 2.0
        p, q = faces[:, i], faces[:, (i + 1) % 3]
        rows += [p, q, p, q]
        columns += [q, p, p, q]
        values += [-cotangent, -cotangent, cotangent, cotangent]
    places = (np.concatenate(rows), np.concatenate(columns))
    stiffness = csc_array(coo_array((np.concatenate(values), places), shape=(n, n)))
    u = np.zeros(n)
    u[free] = factorised(csc_array(stiffness[free][:, free])).solved(defects[free])
    return u
