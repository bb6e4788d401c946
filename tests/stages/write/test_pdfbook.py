"""A book of pages: its cross references, its forms, its texts in any script."""

import re

from stages.write.pdfbook import Form, book
from stages.write.pdfobjects import MM_PER_UNIT, Page
from tests.near import assert_near

PAGES = [Page(210.0, 297.0, "0 0 m 100 0 l S\n"), Page(420.0, 297.0, "/X0 Do\n")]


def test_every_object_is_where_the_table_says() -> None:
    text = book("Tür", PAGES, [Form((0.0, 0.0, 1.0, 1.0), "0 0 1 1 re f\n")])
    places = [int(place) for place in re.findall(r"(\d{10}) 00000 n ", text)]
    assert [text[place:].split(" ", 1)[0] for place in places] == [str(n) for n in range(1, len(places) + 1)]
    assert text[int(text.rsplit("startxref\n", 1)[1].split()[0]) :].startswith("xref")


def test_pages_are_as_large_as_they_are() -> None:
    boxes = re.findall(r"/MediaBox \[0 0 ([0-9.]+) ([0-9.]+)\]", book("t", PAGES))
    sizes = [float(side) * MM_PER_UNIT for box in boxes for side in box]
    assert_near(sizes, (210.0, 297.0, 420.0, 297.0), bound=1e-6, why="six decimals")


def test_streams_are_as_long_as_they_say() -> None:
    text = book("t", PAGES)
    for length, content in re.findall(r"/Length (\d+) >>\nstream\n(.*?)endstream", text, re.DOTALL):
        assert len(content) == int(length)


def test_a_title_is_in_any_script() -> None:
    assert f"<feff{'日'.encode('utf-16-be').hex()}>" in book("日", PAGES)


def test_the_file_is_ascii_without_a_date() -> None:
    text = book("Tür", PAGES)
    assert text.isascii()
    assert "Date" not in text
    assert "/ID" not in text
