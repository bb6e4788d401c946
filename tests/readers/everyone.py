"""All readers, and what each of them gets wrong in a flavour and version."""

import tempfile
from collections.abc import Sequence
from pathlib import Path

import pytest

from stages.model.cutfile import Flavour, Version
from tests.readers import dia, freecad, gdal, inkscape, librecad, npm, openscad, programs, trimeshed
from tests.readers.drawings import Sample, samples
from tests.readers.reading import Reader, Reading, can_read, complaints

READERS: tuple[Reader, ...] = (
    gdal.READER,
    librecad.READER,
    inkscape.READER,
    freecad.READER,
    trimeshed.READER,
    npm.DXF,
    npm.PARSER,
    npm.JSON,
    npm.JSCAD,
    programs.DXFGRABBER,
    programs.DXFLIB,
    programs.DXF2GCODE,
    programs.BCNC,
    programs.DIME,
    dia.READER,
    openscad.READER,
)


def readings(reader: Reader, files: Sequence[Sample]) -> dict[str, Reading]:
    """Return what a reader makes of some files, in one go."""
    with tempfile.TemporaryDirectory() as name:
        paths = [Path(name) / f"{one.name}.dxf" for one in files]
        for path, one in zip(paths, files, strict=True):
            path.write_text(one.text, "ascii")
        return reader.read(paths)


def wrong(reader: Reader, flavour: Flavour, version: Version) -> list[str]:
    """Return all that a reader gets wrong, each line with the name of its file."""
    files = [one for one in samples(flavour, version) if can_read(reader, one)]
    found = readings(reader, files)
    return [f"{one.name}: {line}" for one in files for line in complaints(reader, found[one.name], one)]


def must_be_here(reader: Reader) -> None:
    """Skip the test by name where the reader cannot be had."""
    if not reader.available():
        pytest.skip(f"{reader.name} is not installed: bash tests/readers/install.sh")
