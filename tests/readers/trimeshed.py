"""trimesh's `load_path`: units from the header; where a polyline has arcs, layers are lost and its pieces loose.

Its `length` raises ValueError on an arc that turns by less than 0.7 degrees; its `discrete`, used here, reads it.
"""

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from tests.readers.reading import Fineness, Piece, Reader, Reading

STEP_MM = 0.05
"""What `discrete` divides arcs into at scale 1: its `seg_frac`."""

LEAST_RADIUS_MM = 4.0
"""Of the samples: on a larger arc the step is a smaller angle."""

FEWEST_STEPS = 3
"""Of an arc; where an arc has few, dividing by one less than was counted makes steps longer by a third at most."""


def available() -> bool:
    return find_spec("trimesh") is not None


def read(paths: Sequence[Path]) -> dict[str, Reading]:
    return {path.stem: _read(path) for path in paths}


def _read(path: Path) -> Reading:
    import trimesh

    drawing = trimesh.load_path(str(path))
    drawing.convert_units("millimeters")
    texts = tuple(str(one.text) for one in drawing.entities if type(one).__name__ == "Text")
    curves = [one for one in drawing.entities if type(one).__name__ != "Text"]
    return Reading(tuple(Piece("", one.discrete(drawing.vertices, scale=1.0)[:, :2]) for one in curves), texts)


STEP_RAD = STEP_MM / LEAST_RADIUS_MM * (FEWEST_STEPS + 1) / FEWEST_STEPS
READER = Reader("trimesh", available, read, Fineness(step_rad=STEP_RAD), layered=False)
