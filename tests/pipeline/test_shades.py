"""What the scripts of the page and the pictures in Python both have is the same: light, sides, cells, colours."""

import re

import numpy as np

from pipeline.report.markup import percent
from pipeline.report.pages import asset
from pipeline.report.pictures.sheet import FILLS
from pipeline.report.shades import BACK_RGB, FRONT_RGB, LIGHT
from pipeline.report.summarycharts import told
from pipeline.report.view.cells import COLUMNS


def numbers(script: str, name: str) -> list[float]:
    """Return the list of numbers, or the one number, that a script calls so."""
    (text,) = re.findall(rf"\b{name} = (?:unit\()?\[?([-.\d, ]+)", asset(script))
    return [float(word) for word in text.strip(" ,").split(",")]


def test_a_formed_part_has_one_light_and_two_sides_wherever_it_is_shown() -> None:
    for name, values in (("LIGHT", LIGHT), ("FRONT", FRONT_RGB), ("BACK", BACK_RGB)):
        assert numbers("view3d_paint.js", name) == np.asarray(values).tolist()


def test_the_page_reads_as_many_cells_along_a_ruling_as_are_written() -> None:
    assert numbers("view3d_ruled.js", "COLUMNS") == [COLUMNS]


def test_a_part_has_one_colour_on_the_page_and_in_the_picture_of_its_sheet() -> None:
    (listed,) = re.findall(r"FILLS = \[([^]]*)\]", asset("sheets.js"))
    assert [word.strip(' "') for word in listed.split(",")] == [fill.lower() for fill in FILLS]


def test_what_is_not_all_is_not_shown_as_all() -> None:
    assert [percent(share) for share in (0.9996, 1.0)] == ["99.9\u00a0%", "100\u00a0%"]
    assert told("mean_utilisation", 0.9996) == "99.9\u00a0%"
