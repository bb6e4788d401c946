"""Every reader on every sample; one file, so that the samples are made once."""

from pathlib import Path

import pytest

from stages.model.cutfile import Flavour, Version
from tests.near import assert_relative
from tests.readers.drawings import FLAVOURS, asked, samples
from tests.readers.everyone import READERS, must_be_here, wrong
from tests.readers.reading import Reader

pytestmark = pytest.mark.readers

READ_RIGHT: dict[str, tuple[Flavour, ...]] = {"OpenSCAD": ("lines-arcs", "polylines")}
"""What a reader can read, where that is not all: the table says so, and both of yes and no are kept true here."""


@pytest.mark.parametrize(("flavour", "version"), asked())
@pytest.mark.parametrize("reader", READERS, ids=[reader.name for reader in READERS])
def test_every_file_is_read_right_or_the_table_says_so(reader: Reader, flavour: Flavour, version: Version) -> None:
    must_be_here(reader)
    faults = wrong(reader, flavour, version)
    if flavour in READ_RIGHT.get(reader.name, FLAVOURS):
        assert faults == []
    else:
        assert faults != []


def test_the_length_of_trimesh_needs_straight_polylines_where_arcs_are_flat(tmp_path: Path) -> None:
    """It calls an arc of half a degree straight, and refuses; told of in the table's notes, so kept true here."""
    import trimesh

    def its_length(flavour: Flavour) -> float:
        strip = next(one for one in samples(flavour, "R2000") if one.name == "strip")
        path = tmp_path / f"{flavour}.dxf"
        path.write_text(strip.text, "ascii")
        return float(trimesh.load_path(str(path)).length) / strip.figures["cut_length_mm"]

    with pytest.raises(ValueError, match="colinear"):
        its_length("polyline-arcs")
    assert_relative(its_length("polylines"), 1.0, bound=1e-9, why="straight pieces, rounded to 1e-10 mm")
