"""bCNC's reader of DXF, as bCNC itself calls it: lines and arcs of each layer.  Asked with Debian's own Python."""

import json
import math
import sys

sys.path[:0] = ["/usr/share/bcnc/bCNC/lib", "/usr/share/bcnc/bCNC"]

from bpath import Path, Segment  # noqa: E402  it is found only now
from dxf import DXF  # noqa: E402


def piece(layer, one):
    if one.type == Segment.LINE:
        return {"layer": layer, "points": [[one.A[0], one.A[1]], [one.B[0], one.B[1]]]}
    first, last = (math.atan2(end[1] - one.C[1], end[0] - one.C[0]) for end in (one.A, one.B))
    sense = 1.0 if one.type == Segment.CCW else -1.0
    radius = math.hypot(one.A[0] - one.C[0], one.A[1] - one.C[1])
    return {"layer": layer, "center": [one.C[0], one.C[1]], "radius": radius, "from": first, "to": last, "turn": sense}


def answer(file):
    drawing = DXF(file, "r")
    drawing.readFile()
    drawing.close()
    drawing.sort()
    drawing.convert2Polylines()
    drawing.expandBlocks()
    pieces = []
    for name in drawing.layers:
        path = Path(name)
        path.fromDxf(drawing, drawing.entities(name), DXF.MILLIMETERS)
        pieces += [piece(name, one) for one in path]
    return {"entities": pieces}


print(json.dumps({file: answer(file) for file in sys.argv[1:]}))
