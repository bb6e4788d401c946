r"""The file around the pages of a PDF (ISO 32000-1): objects, cross references, layers, one typeface.

Everything is ASCII, nothing is compressed, and there is neither a date nor an identity: the same pages give the same
bytes with every version of every library.  The drawing is one object that every page shows a part of.  The typeface is
Courier, which every reader has or replaces by one as wide; its letters are all equally wide, so that a text can be
centred without a table of widths.

Readers are asked not to scale when they print.  A page of more than 5.08 m goes beyond what Acrobat shows, and it says
so.  The larger unit that PDF 1.6 has for that (`UserUnit`) is not used: readers that do not know it (Poppler's) would
show the drawing smaller without a word.
"""

from collections.abc import Sequence
from dataclasses import dataclass

MM_PER_UNIT = 25.4 / 72.0
HEAD = "%PDF-1.5\n"
"""The first version with layers."""

CATALOG, TREE, FONT, ABOUT, DRAWING, FIRST_FREE = 1, 2, 3, 4, 5, 6
"""Numbers of the objects that every file has."""

CAPITAL_SHARE = 0.562
LETTER_SHARE = 0.6
"""Of Courier: the height of a capital and the width of every letter over the size (Adobe's metrics of the typeface)."""

Box = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Page:
    """A page in mm from its lower left corner, and what is drawn on it in operators of PDF, a unit being 1 mm."""

    width_mm: float
    height_mm: float
    content: str


def pdf_text(title: str, layers: Sequence[str], box: Box, drawing: str, pages: Sequence[Page]) -> str:
    """Return a PDF file: on its pages `/D Do` shows the drawing, which lies in a box, `/L0`, `/L1` ... are the layers.

    box: x least, y least, x most, y most; operators of PDF in mm, as on the pages.
    """
    first_page = FIRST_FREE + len(layers)
    groups = [f"{FIRST_FREE + i} 0 R" for i in range(len(layers))]
    sheets = [f"{first_page + 2 * i} 0 R" for i in range(len(pages))]
    shown = f"<< /OCGs [{' '.join(groups)}] /D << /Order [{' '.join(groups)}] /BaseState /ON >> >>"
    named = " ".join(f"/L{i} {group}" for i, group in enumerate(groups))
    known = f"/Font << /F {FONT} 0 R >> /Properties << {named} >>"
    corners = " ".join(f"{side:.3f}" for side in box)
    form = f"/Type /XObject /Subtype /Form /BBox [{corners}] /Resources << {known} >>"
    known = f"<< {known} /XObject << /D {DRAWING} 0 R >> >>"
    objects = [
        f"<< /Type /Catalog /Pages {TREE} 0 R /OCProperties {shown} /ViewerPreferences << /PrintScaling /None >> >>",
        f"<< /Type /Pages /Count {len(pages)} /Kids [{' '.join(sheets)}] >>",
        "<< /Type /Font /Subtype /Type1 /BaseFont /Courier /Encoding /WinAnsiEncoding >>",
        f"<< /Title {string(title)} /Producer {string('planish')} >>",
        stream_of(drawing, form),
        *(f"<< /Type /OCG /Name {string(layer)} >>" for layer in layers),
    ]
    for number, page in enumerate(pages):
        objects += [page_of(page, known, first_page + 2 * number + 1), stream_of(content_of(page))]
    return file_of(objects, ABOUT)


def page_of(page: Page, known: str, content: int) -> str:
    """Return the object of a page whose content has that number."""
    box = " ".join(f"{side / MM_PER_UNIT:.6f}" for side in (page.width_mm, page.height_mm))
    return f"<< /Type /Page /Parent {TREE} 0 R /MediaBox [0 0 {box}] /Resources {known} /Contents {content} 0 R >>"


def content_of(page: Page) -> str:
    """Return the operators of a page, their unit made 1 mm."""
    scale = f"{1.0 / MM_PER_UNIT:.12f}"
    return f"q {scale} 0 0 {scale} 0 0 cm\n{page.content}Q\n"


def stream_of(content: str, entries: str = "") -> str:
    """Return operators as an object."""
    return f"<< {entries} /Length {len(content)} >>\nstream\n{content}endstream"


def file_of(objects: Sequence[str], about: int, head: str = HEAD) -> str:
    """Return a file of objects, numbered from 1, with the table of where they begin.

    The first is the catalog, the second (`TREE`) the list of pages; `about` is what says of the file what it is.
    Every letter is a byte.
    """
    made, places = [head], list[int]()
    at = len(head)
    for number, content in enumerate(objects, 1):
        places.append(at)
        made.append(f"{number} 0 obj\n{content}\nendobj\n")
        at += len(made[-1])
    table = "".join(f"{place:010d} 00000 n \n" for place in places)
    count = len(objects) + 1
    end = f"trailer\n<< /Size {count} /Root {CATALOG} 0 R /Info {about} 0 R >>\nstartxref\n{at}\n%%EOF\n"
    return f"{''.join(made)}xref\n0 {count}\n0000000000 65535 f \n{table}{end}"


def string(text: str) -> str:
    """Return a text as PDF writes it; what is not printable ASCII as a question mark."""
    known = (letter if letter.isascii() and letter.isprintable() else "?" for letter in text)
    return "(" + "".join("\\" + letter if letter in "\\()" else letter for letter in known) + ")"
