"""`python -m tests.readers.table`: which reader reads which flavour right, measured, as a table in Markdown.

Right: length, area and number of the closed contours, place and size, layers and texts as far as the reader keeps
them, in all files of `drawings` and in every version that holds the flavour; otherwise the first thing that is wrong.
Whole: a contour of lines and arcs comes as one closed piece; loose: as pieces that meet; a print does not tell.
Without layers: what is in blocks, as in pattern files, is read right but for its layers.
Unit: a file that says inches instead of mm comes 25.4 times as large, or the reader takes numbers as they are.
"""

from dataclasses import replace
from math import dist

from stages.model.cutfile import Flavour
from tests.near import assert_relative
from tests.readers.drawings import FLAVOURS, Sample, kinds, samples
from tests.readers.everyone import READERS, readings, wrong
from tests.readers.reading import JOINED_MM, Reader, Reading

INCH_MM = 25.4
IN_MILLIMETRES, IN_INCHES = "$INSUNITS\n 70\n4\n", "$INSUNITS\n 70\n1\n"
NEARLY = 1e-2


def row(reader: Reader) -> list[str]:
    """Return the cells of one reader."""
    return [reader.name, *(cell(reader, flavour) for flavour in FLAVOURS), unit(reader)]


def cell(reader: Reader, flavour: Flavour) -> str:
    """Return what one reader makes of one flavour."""
    faults = [line for kind in kinds() if kind[0] == flavour for line in wrong(reader, *kind)]
    if faults:
        return f"wrong: {faults[0]}"
    right = f"right, {_pieces(reader, flavour)}" if reader.keeps_pieces else "right"
    lost = flavour == "aama" and reader.layered and not reader.block_layers
    return f"{right}, without layers" if lost else right


def unit(reader: Reader) -> str:
    """Return whether a reader takes the unit from the file."""
    plate = _sample("plate", "polyline-arcs")
    assert IN_MILLIMETRES in plate.text
    inches = replace(plate, text=plate.text.replace(IN_MILLIMETRES, IN_INCHES))
    factor = _width(readings(reader, [inches])[plate.name]) / _width(readings(reader, [plate])[plate.name])
    taken = abs(factor / INCH_MM - 1.0) < NEARLY
    if not taken:
        assert_relative(factor, 1.0, bound=NEARLY, why="a reader takes the unit or leaves it")
    return "from the file" if taken else "as it is"


def _sample(name: str, flavour: Flavour) -> Sample:
    """Return a sample in the first version that holds a flavour."""
    version = next(version for held, version in kinds() if held == flavour)
    return next(one for one in samples(flavour, version) if one.name == name)


def _pieces(reader: Reader, flavour: Flavour) -> str:
    """Return whether every contour of lines and arcs comes as one closed piece."""
    sector = _sample("sector", flavour)
    pieces = readings(reader, [sector])[sector.name].pieces
    ends = [dist(one.points[0], one.points[-1]) for one in pieces if len(one.points) > 2]
    closed = sum(item.path.closed for item in sector.drawing.items)
    return "whole" if sum(gap <= JOINED_MM for gap in ends) == closed else "loose"


def _width(reading: Reading) -> float:
    """Return how far all that was read reaches along x, in mm."""
    return max(float(one.points[:, 0].max()) for one in reading.pieces) - min(
        float(one.points[:, 0].min()) for one in reading.pieces
    )


def table() -> list[str]:
    """Return the lines of the table; readers that are not installed are left out by name."""
    here = [reader for reader in READERS if reader.available()]
    heads = ["reader", *FLAVOURS, "unit"]
    lines = [" | ".join(cells) for cells in (heads, ["---"] * len(heads), *map(row, here))]
    missing = [reader.name for reader in READERS if not reader.available()]
    return [*(f"| {line} |" for line in lines), *(f"Not installed: {name}" for name in missing)]


if __name__ == "__main__":
    print("\n".join(table()))
