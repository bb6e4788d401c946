"""Pages of a PDF as Poppler shows them: pixels and words with their places, in mm from the lower left corner."""

import re
import shutil
import subprocess
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

DPI, COARSE_DPI = 254, 101.6
PIXELS_PER_MM = 10
MM_PER_POINT = 25.4 / 72.0

needs_poppler = pytest.mark.skipif(shutil.which("pdftoppm") is None, reason="poppler-utils are not installed")


class Word(NamedTuple):
    """A word and the middle of its box."""

    text: str
    x: float
    y: float


def grey(file: Path, page: int) -> np.ndarray:
    """Return a page in grey, 0 to 255, the lowest row first, ten pixels a mm."""
    command = ["pdftoppm", "-gray", "-r", str(DPI), "-f", str(page), "-l", str(page), str(file)]
    made = subprocess.run(command, check=True, capture_output=True, timeout=60).stdout
    head = re.match(rb"P5\s+(\d+)\s+(\d+)\s+255\s", made)
    assert head is not None
    width, height = int(head[1]), int(head[2])
    return np.frombuffer(made[head.end() :], np.uint8).reshape(height, width)[::-1].astype(np.int64)


def colours(file: Path, page: int) -> np.ndarray:
    """Return a page in red, green and blue, 0 to 255, the upper row first, four pixels a mm."""
    command = ["pdftoppm", "-r", str(COARSE_DPI), "-f", str(page), "-l", str(page), str(file)]
    made = subprocess.run(command, check=True, capture_output=True, timeout=60).stdout
    head = re.match(rb"P6\s+(\d+)\s+(\d+)\s+255\s", made)
    assert head is not None
    width, height = int(head[1]), int(head[2])
    return np.frombuffer(made[head.end() :], np.uint8).reshape(height, width, 3).astype(np.int64)


def count(file: Path) -> int:
    """Return how many pages there are."""
    made = subprocess.run(["pdfinfo", str(file)], check=True, capture_output=True, timeout=60).stdout.decode()
    found = re.search(r"^Pages:\s+(\d+)$", made, re.MULTILINE)
    assert found is not None
    return int(found[1])


def words(file: Path, page: int) -> list[Word]:
    """Return the words of a page with their places."""
    command = ["pdftotext", "-bbox", "-f", str(page), "-l", str(page), str(file), "-"]
    made = subprocess.run(command, check=True, capture_output=True, timeout=60).stdout.decode()
    size = re.search(r'<page width="[0-9.]+" height="([0-9.]+)"', made)
    assert size is not None
    high = float(size[1])
    boxes = re.findall(r'<word xMin="(\S+)" yMin="(\S+)" xMax="(\S+)" yMax="(\S+)">(.*?)</word>', made)
    return [_word(text, [float(side) for side in sides], high) for *sides, text in boxes]


def _word(text: str, box: list[float], high: float) -> Word:
    low_x, low_y, high_x, high_y = box
    return Word(text, MM_PER_POINT * (low_x + high_x) / 2.0, MM_PER_POINT * (high - (low_y + high_y) / 2.0))
