"""What stands in a PDF of pages: the operators of each page and its texts, read by the tests themselves."""

import re
import zlib

STREAM = rb"\n%d 0 obj\n<< [^\n]*?/Length (\d+) >>\nstream\n"


def page_operators(pdf: bytes) -> list[str]:
    """Return what is drawn on each page, in operators."""
    return [operators(pdf, int(number)) for number in re.findall(rb"/Contents (\d+) 0 R", pdf)]


def operators(pdf: bytes, number: int) -> str:
    """Return the operators of an object."""
    match = re.search(STREAM % number, pdf)
    assert match is not None
    return zlib.decompress(pdf[match.end() : match.end() + int(match[1])]).decode("ascii")


def texts(page: str) -> list[str]:
    """Return the texts of a page, in the order in which they are drawn."""
    found = re.findall(r"\((.*?)(?<!\\)\) Tj", page)
    letters = [re.sub(r"\\(\d{3})", lambda code: bytes([int(code[1], 8)]).decode("cp1252"), one) for one in found]
    return [re.sub(r"\\(.)", r"\1", one) for one in letters]


def all_texts(pdf: bytes) -> list[str]:
    """Return the texts of all pages."""
    return [one for page in page_operators(pdf) for one in texts(page)]
