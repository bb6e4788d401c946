"""The light and the two sides of a formed part, in pictures and on the traveller alike.

The side that is seen flat (that of p x c0') is blue, the other sand-coloured.  The page that can be turned has the same
values in `view3d_paint.js`.
"""

import numpy as np

LIGHT = np.array([-0.45, 0.55, 0.70])
"""Direction of the light in the frame of the picture: from the upper left, behind the viewer."""

FRONT_RGB = np.array([0.78, 0.88, 0.96])
BACK_RGB = np.array([0.93, 0.87, 0.74])
