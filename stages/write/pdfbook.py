"""A PDF file of pages of texts, lines and areas, as `pdfobjects` has one of drawings.

There is neither a date nor an identity, as there; but the file is not ASCII.  Pages are in Helvetica (`/R`) and
Helvetica Bold (`/B`) of `helvetica`.  What is shown more than once is a form: `/X0 Do`, `/X1 Do` ... draw it, in the
colours and the width of line that are then set.

What is drawn is compressed (Flate), as bytes: a job has hundreds of pages, and to write them as ASCII takes longer than
all else.
"""

import zlib
from collections.abc import Sequence
from dataclasses import dataclass

from stages.write.helvetica import BOLD, REGULAR, Face
from stages.write.pdf import numbers
from stages.write.pdfobjects import HEAD, TREE, Box, Page, content_of, file_of, page_of, stream_of

ABOUT, SHARED, FIRST_FREE = 3, 4, 5
"""Numbers of objects, behind those of the catalog and the list of pages; shared: what pages may draw with."""

EFFORT = 4
"""Of compression, 1 to 9: 6, the library's own, takes twice as long for a twentieth less."""

BYTES = "%\xe2\xe3\xcf\xd3\n"
"""Four bytes beyond ASCII in a comment behind the head: for programs that would take the file for a text (7.5.2)."""

CODES = "latin-1"
"""A file is put together as a text in which every letter is a byte."""


@dataclass(frozen=True, slots=True)
class Form:
    """Something that is drawn in several places: the box that it lies in (x least, y least, x most, y most)."""

    box: Box
    content: str


def book(title: str, pages: Sequence[Page], forms: Sequence[Form] = ()) -> bytes:
    """Return a PDF file of some pages, a unit being 1 mm."""
    faces = (REGULAR, BOLD)
    first_form = FIRST_FREE + len(faces)
    first_page = first_form + len(forms)
    typed = " ".join(f"/{face.key} {FIRST_FREE + i} 0 R" for i, face in enumerate(faces))
    shown = " ".join(f"/X{i} {first_form + i} 0 R" for i in range(len(forms)))
    sheets = [f"{first_page + 2 * i} 0 R" for i in range(len(pages))]
    objects = [
        f"<< /Type /Catalog /Pages {TREE} 0 R /ViewerPreferences << /PrintScaling /None >> >>",
        f"<< /Type /Pages /Count {len(pages)} /Kids [{' '.join(sheets)}] >>",
        f"<< /Title {_words(title)} /Producer {_words('planish')} >>",
        f"<< /Font << {typed} >> /XObject << {shown} >> >>",
        *map(_font, faces),
        *map(_form, forms),
    ]
    for number, page in enumerate(pages):
        objects += [page_of(page, f"{SHARED} 0 R", first_page + 2 * number + 1), _packed(content_of(page))]
    return file_of(objects, ABOUT, HEAD + BYTES).encode(CODES)


def _words(text: str) -> str:
    """Return a text that is not on a page, in any script: such texts are UTF-16."""
    return f"<feff{text.encode('utf-16-be').hex()}>"


def _font(face: Face) -> str:
    return f"<< /Type /Font /Subtype /Type1 /BaseFont /{face.name} /Encoding /WinAnsiEncoding >>"


def _form(form: Form) -> str:
    return _packed(form.content, f"/Type /XObject /Subtype /Form /BBox [{numbers(form.box)}]")


def _packed(content: str, entries: str = "") -> str:
    """Return operators as an object, compressed."""
    packed = zlib.compress(content.encode("ascii"), EFFORT).decode(CODES)
    return stream_of(f"{packed}\n", f"{entries} /Filter /FlateDecode".strip())
