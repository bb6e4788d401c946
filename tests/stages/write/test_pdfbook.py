"""A book of pages: its cross references, its forms, its texts in any script."""

import re

from stages.write.pdfbook import Form, book
from stages.write.pdfobjects import MM_PER_UNIT, Page
from tests.near import assert_near
from tests.pdfs import page_operators

PAGES = [Page(210.0, 297.0, "0 0 m 100 0 l S\n"), Page(420.0, 297.0, "/X0 Do\n")]


def test_every_object_is_where_the_table_says() -> None:
    text = book("Tür", PAGES, [Form((0.0, 0.0, 1.0, 1.0), "0 0 1 1 re f\n")]).decode("latin-1")
    places = [int(place) for place in re.findall(r"(\d{10}) 00000 n ", text)]
    assert [text[place:].split(" ", 1)[0] for place in places] == [str(n) for n in range(1, len(places) + 1)]
    assert text[int(text.rsplit("startxref\n", 1)[1].split()[0]) :].startswith("xref")


def test_pages_are_as_large_as_they_are() -> None:
    boxes = re.findall(rb"/MediaBox \[0 0 ([0-9.]+) ([0-9.]+)\]", book("t", PAGES))
    sizes = [float(side) * MM_PER_UNIT for box in boxes for side in box]
    assert_near(sizes, (210.0, 297.0, 420.0, 297.0), bound=1e-6, why="six decimals")


def test_streams_are_as_long_as_they_say_and_hold_what_is_drawn() -> None:
    content = book("t", PAGES)
    for found in re.finditer(rb"/Length (\d+) >>\nstream\n", content):
        assert content[found.end() + int(found[1]) :].startswith(b"endstream")
    assert [PAGES[i].content in page for i, page in enumerate(page_operators(content))] == [True, True]


def test_a_title_is_in_any_script() -> None:
    assert f"<feff{'日'.encode('utf-16-be').hex()}>".encode() in book("日", PAGES)


def test_the_file_says_that_it_is_no_text_and_has_no_date() -> None:
    content = book("Tür", PAGES)
    head, mark = content.split(b"\n")[:2]
    assert head == b"%PDF-1.5"
    assert mark[:1] == b"%"
    assert min(mark[1:]) >= 128
    assert b"Date" not in content
    assert b"/ID" not in content
