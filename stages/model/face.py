"""The faces of a sheet, by name."""

from typing import Literal

Face = Literal["middle", "inner", "outer", "plus", "minus"]
"""The middle surface; the face on the concave or on the convex side; the face on the side of p x c0', or the other."""
