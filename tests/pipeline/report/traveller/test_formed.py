"""The picture of the formed part on paper: its faces look to one side, whole cells and cut ones."""

import json

import msgspec
import numpy as np

from pipeline.report.traveller.formed import _of_rulings
from pipeline.report.view.entries import Ruled
from pipeline.report.view.formed import ruled_part
from stages.geometry.arrays import Array
from stages.model.surface import RuledSurface
from tests.parts import passage

HALF_PIPE = {
    "kind": "cylinder",
    "directrix": {"arc": {"center": [0, 0, 0], "radius": 300, "normal": [1, 0, 0], "start": 0, "end": 180}},
    "direction": [1, 0, 0],
    "length": 800,
}
DRILLED = {"name": "fix", "kind": "drill", "at": [0.5, 0.25], "diameter": 80}


def outwards(faces: Array) -> Array:
    """Return how far the normals of faces point away from the axis of the pipe: the sign counts."""
    normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, -1] - faces[:, 0])
    return np.asarray((normals * faces.mean(axis=1) * [0.0, 1.0, 1.0]).sum(axis=1))


def test_whole_cells_and_cut_ones_look_to_the_same_side() -> None:
    made = passage(HALF_PIPE, hole=[DRILLED])
    assert isinstance(made.surface, RuledSurface)
    document = json.dumps(ruled_part(made.surface, made.pattern, None))
    shape = _of_rulings(msgspec.json.decode(document, type=Ruled))
    whole, cut = outwards(shape.quads), outwards(shape.triangles)
    large = np.abs(cut) > 1e-6 * np.abs(whole).max()
    assert large.sum() > 10
    assert np.ptp(np.sign(whole)) == 0
    assert set(np.sign(cut[large])) == {np.sign(whole[0])}
