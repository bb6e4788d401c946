"""Whether a part lies safely on the slats of a table once it is cut free, or tips up into the way of the head.

Measured is the smallest rectangle around the part, turned any way, since it is nested turned.  A part whose shorter
side is under two pitches of the slats may be carried by one slat; one whose sides are both under 4/3 of a pitch surely
tips or falls between two.  With slats 75 mm apart these are sides under 150 mm, and both under 100 mm.
"""

from collections.abc import Iterator

import numpy as np

from stages.geometry.paths.arcpath import ArcPath, polygon
from stages.model.pattern import Contour
from stages.model.process import Process
from stages.model.report import Finding

CARRIED_PITCHES, SURE_PITCHES = 2.0, 4.0 / 3.0
"""Below the first of a pitch a side may rest on one slat; with both sides below the second a part has no second one."""

POLYGON_MM = 0.05
"""How near the polygon comes to the arcs: nobody knows where a part lies on its slats to that."""


def tipping(outer: Contour, process: Process) -> Iterator[Finding]:
    """Yield that a part may tip up or fall, if the table is known and no tab holds it."""
    pitch = process.slat_pitch_mm
    if pitch is None:
        return
    short, long = sides(outer.path)
    tabs = process.tabs
    held = tabs is not None and (tabs.below_mm is None or short < tabs.below_mm)
    if held or short >= CARRIED_PITCHES * pitch:
        return
    sure = long < SURE_PITCHES * pitch
    what = "tips up or falls between the slats" if sure else "may tip up"
    size = f"{short:.4g} x {long:.4g} mm on slats {pitch:.4g} mm apart"
    message = f"the part {what} once it is cut, {size}: hold it with tabs ([process.tabs])"
    yield Finding("tip-up", message, where={"short_mm": short, "long_mm": long, "pitch_mm": pitch, "sure": int(sure)})


def sides(path: ArcPath) -> tuple[float, float]:
    """Return both sides of the rectangle of least area around a closed path, the shorter first, mm."""
    import shapely

    box = shapely.Polygon(polygon(path, accuracy=POLYGON_MM, outside=True)).minimum_rotated_rectangle
    corners = np.array(box.exterior.coords)
    short, long = sorted(np.hypot(*np.diff(corners[:3], axis=0).T).tolist())
    return short, long
