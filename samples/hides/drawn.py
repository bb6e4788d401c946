"""Draws the two sides of leather of this sample: one as leather CAD would, one as a hide scanner would.

    python3 samples/hides/drawn.py

`side-left.dxf`: a spline on the layer SHEET, defects on SHEET_KEEPOUT, zones of lower quality on 52 and 54, and the
line of tightness, along the backbone, on 7.  `scanned.json`: the other side as polygons, mirrored.  Lengths in mm.
"""

import json
from pathlib import Path

import ezdxf
import numpy as np
from ezdxf.math import Vec3, fit_points_to_cad_cv
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

Array = NDArray[np.float64]
SIDE = (
    (27, 682), (310, 695), (621, 691), (932, 695), (1188, 686), (1256, 634), (1235, 540), (1262, 432), (1310, 310),
    (1330, 189), (1269, 148), (1174, 202), (1066, 223), (878, 159), (648, 128), (432, 151), (256, 202), (148, 155),
    (68, 84), (7, 108), (-3, 216), (34, 351), (-34, 473), (-74, 580), (-34, 655), (27, 682),
)  # fmt: skip
"""Half a hide, its backbone above, the hind leg on the right."""

BELLY = ((162, 209), (432, 159), (648, 136), (878, 167), (1080, 232), (1053, 277), (837, 216), (648, 186), (405, 216))
NECK = ((-27, 475), (-65, 580), (-27, 645), (34, 668), (94, 648), (81, 540), (40, 459))
SCARS = ((756, 405, 57, 12, 20), (338, 560, 40, 16, -35))
"""Ellipses: centre, both semi-axes, and the direction of the longer one in degrees."""

HOLE = (1026, 513, 19)
"""A circle."""

FINE = 8
"""Points of a scan between two points of the spline."""


def scanned(points: tuple[tuple[int, int], ...]) -> list[list[float]]:
    """Return points of the closed spline through the points, mirrored, to a tenth of a millimetre."""
    closed = np.array(points if points[0] == points[-1] else (*points, points[0]), dtype=np.float64)
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
    curve = CubicSpline(along, closed, bc_type="periodic")
    t = np.interp(np.arange(FINE * (len(closed) - 1)) / FINE, np.arange(len(closed)), along)
    return np.round(curve(t) * [-1.0, 1.0] + [1240.0, 0.0], 1).tolist()


def ellipse(x: float, y: float, major: float, minor: float, angle_deg: float) -> tuple[tuple[int, int], ...]:
    """Return points of an ellipse."""
    t, a = np.arange(8) * np.pi / 4.0, np.radians(angle_deg)
    u, v = major * np.cos(t), minor * np.sin(t)
    places = np.stack([x + u * np.cos(a) - v * np.sin(a), y + u * np.sin(a) + v * np.cos(a)], axis=1)
    return tuple((round(px), round(py)) for px, py in places.tolist())


def drawing() -> ezdxf.document.Drawing:
    """Return the left side as a drawing."""
    document = ezdxf.new("R2000", units=ezdxf.units.MM)
    space = document.modelspace()
    curve = fit_points_to_cad_cv([Vec3(x, y) for x, y in SIDE])
    space.add_spline(dxfattribs={"layer": "SHEET"}).apply_construction_tool(curve)
    for x, y, major, minor, angle in SCARS:
        axis = Vec3.from_deg_angle(angle, major)
        space.add_ellipse((x, y), axis, minor / major, dxfattribs={"layer": "SHEET_KEEPOUT"})
    space.add_circle(HOLE[:2], HOLE[2], dxfattribs={"layer": "SHEET_KEEPOUT"})
    space.add_lwpolyline(BELLY, close=True, dxfattribs={"layer": "54"})
    space.add_lwpolyline(NECK, close=True, dxfattribs={"layer": "52"})
    space.add_line((135, 594), (1080, 594), dxfattribs={"layer": "7"})
    return document


def scan() -> dict[str, object]:
    """Return the right side as polygons with zones."""

    def polygon(points: tuple[tuple[int, int], ...]) -> dict[str, object]:
        return {"type": "simple_polygon", "data": scanned(points)}

    scar, hole = ellipse(864, 351, 47, 14, 70), ellipse(*HOLE[:2], HOLE[2], HOLE[2], 0)
    outline = {"outer": scanned(SIDE), "inner": [scanned(scar), scanned(hole)]}
    zones = [{"quality": 3, "shape": polygon(BELLY)}, {"quality": 5, "shape": polygon(NECK)}]
    side = {"id": "right", "stock": 1, "shape": {"type": "polygon", "data": outline}, "zones": zones}
    return {"name": "sides", "bins": [side]}


def main() -> None:
    """Write both files beside this one."""
    folder = Path(__file__).parent
    drawing().saveas(folder / "side-left.dxf")
    (folder / "scanned.json").write_text(json.dumps(scan()) + "\n", "utf-8")


if __name__ == "__main__":
    main()
