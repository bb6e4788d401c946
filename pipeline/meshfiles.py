"""Mesh files: STL, OBJ, PLY, OFF and 3MF -> triangles in the unit of the file, or what is wrong with the file.

trimesh parses; this module sees to it that what it parsed is all that the file says, since it drops some of what it
does not understand.  Held against the file itself: the number of triangles that a binary STL announces and its
length, the `endfacet`s and the end of a text STL, the counts in the headers of PLY and OFF, what an archive would
unpack to.  What trimesh logs as a warning, and a number that it stops reading at, is an error here.

Polygons become fans of triangles.  Colours, textures and normals are not read.  Objects of one file are one mesh; the
objects of a 3MF are where its build items put them.  Vertex numbers of OBJ that count backwards are refused: trimesh
counts them from the end of the file, the format from where they stand.  An OBJ carries no count: cut off at the end
of a line it is a smaller mesh, and nothing tells."""

import re
import warnings
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from logging import WARNING, Handler, LogRecord, getLogger
from typing import TYPE_CHECKING

import numpy as np

from stages.geometry.mesh.mesh import Mesh

if TYPE_CHECKING:
    from trimesh import Trimesh

FORMATS = ("stl", "obj", "ply", "off", "3mf")
LARGEST_FILE = 1_000_000_000
"""Bytes, also of what an archive unpacks to: some 20 million triangles."""
LARGEST_TEXT = 400_000_000
"""Bytes of a text: it takes ten times its length of memory while it is read."""
MOST_TRIANGLES = 5_000_000
"""Beyond these a mesh takes more than some 8 GB and a quarter of an hour."""
UNIT_NAMES = {
    "micron": "um",
    "millimeter": "mm",
    "millimeters": "mm",
    "centimeter": "cm",
    "inch": "in",
    "foot": "ft",
    "meter": "m",
}
"""Units of a 3MF, and what trimesh calls the one that is meant where none is written."""

HEADER, RECORD = 84, 50
"""Bytes of a binary STL before its triangles, and of each triangle."""


class MeshFileError(Exception):
    """A file that holds no mesh that can be read: what is wrong, and what would be right."""

    def __init__(self, message: str, hint: str) -> None:
        super().__init__(message)
        self.message, self.hint = message, hint


@dataclass(frozen=True, slots=True)
class FileMesh:
    """A mesh in the unit of its file; unit: as the file states it, None where its format has none."""

    mesh: Mesh
    unit: str | None


def format_of(name: str) -> str:
    """Return the format that the ending of a file name says."""
    ending = name.rsplit(".", 1)[-1].casefold() if "." in name else ""
    if ending not in FORMATS:
        raise MeshFileError(f"{name} is of no known format", f"a file that ends in .{', .'.join(FORMATS)}")
    return ending


def parsed(content: bytes, name: str) -> FileMesh:
    """Return the mesh that a file holds."""
    sort = format_of(name)
    if not content:
        raise MeshFileError(f"{name} is empty", "export it again")
    _right_ending(content, sort, name)
    is_text = CHECKS[sort](content, name)
    if is_text and len(content) > LARGEST_TEXT:
        hint = "export it as binary STL or binary PLY, or with fewer triangles"
        raise MeshFileError(f"{name} is text of more than {LARGEST_TEXT // 10**6} MB", hint)
    found = _trimeshes(_in_utf8(content) if is_text else content, sort, name)
    if not found:
        raise MeshFileError(f"{name} has no triangles", "export the surface as triangles")
    return FileMesh(_joined(found, name), _unit(found, name) if sort == "3mf" else None)


def _in_utf8(content: bytes) -> bytes:
    """Return a text in UTF-8; what is not is taken as Latin-1, which older programs write names in."""
    try:
        content.decode("utf-8")
    except UnicodeDecodeError:
        return content.decode("latin-1").encode("utf-8")
    return content


SIGNS = {"ply": re.compile(rb"\s*ply\s"), "off": re.compile(rb"\s*C?OFF\s"), "3mf": re.compile(rb"PK")}


def _right_ending(content: bytes, sort: str, name: str) -> None:
    """Refuse a file whose first bytes are those of another format."""
    said = next((other for other, sign in SIGNS.items() if sign.match(content[:64])), None)
    if sort in SIGNS and said != sort:
        what = f"is no {sort.upper()} file" if said is None else f"holds {said.upper()}"
        raise MeshFileError(
            f"{name} {what}: it begins with {content[:12]!r}", "give it its right ending, or export it again"
        )
    if said is not None and said != sort and not (sort == "stl" and _is_binary_stl(content)):
        raise MeshFileError(f"{name} holds {said.upper()}", f"give it the ending .{said}")


def _triangles_announced(content: bytes) -> int:
    return int.from_bytes(content[HEADER - 4 : HEADER], "little")


def _is_binary_stl(content: bytes) -> bool:
    """Return whether the length is that of the triangles announced; a binary STL too may begin with "solid"."""
    return len(content) >= HEADER and len(content) == HEADER + RECORD * _triangles_announced(content)


def _check_stl(content: bytes, name: str) -> bool:
    """Refuse a truncated file, and one that is neither text nor binary; return whether it is text."""
    if _is_binary_stl(content):
        return False
    is_text = content[:HEADER].lstrip()[:5].lower() == b"solid" and b"facet" in content[:TEXT_SIGNS].lower()
    if not is_text:
        count = _triangles_announced(content) if len(content) >= HEADER else 0
        held = max(len(content) - HEADER, 0) / RECORD
        message = f"{name} announces {count} triangles and holds {held:.6g}: it is cut off, or no STL"
        raise MeshFileError(message, "copy or export it again")
    lower = content.lower()
    if not lower.rstrip().rsplit(b"\n", 1)[-1].lstrip().startswith(b"endsolid"):
        raise MeshFileError(
            f"{name} does not end with endsolid: it is cut off or mixed with other data", "export it again"
        )
    facets, ends, corners = (
        len(re.findall(word, lower)) for word in (rb"\bfacet\s+normal\b", rb"\bendfacet\b", rb"\bvertex\s")
    )
    if facets != ends or corners != 3 * facets:
        message = f"{name} has {facets} facets, {ends} ends of facets and {corners} corners: some are damaged"
        raise MeshFileError(message, "export it again")
    return True


TEXT_SIGNS = 2000
"""Bytes within which a text STL has its first facet, after a name of whatever length."""


def _check_obj(content: bytes, name: str) -> bool:
    if re.search(rb"^\s*f\s[^\n]*-", content, re.MULTILINE):
        raise MeshFileError(
            f"{name} has vertex numbers that count backwards", "export it with absolute numbers, or as STL"
        )
    if not re.search(rb"^\s*f\s", content, re.MULTILINE):
        raise MeshFileError(f"{name} has no faces", "export the surface as triangles")
    return True


def _check_ply(content: bytes, name: str) -> bool:
    header = content[: content.find(b"end_header") + 1]
    if b"\nformat " not in header.replace(b"\r", b"\n"):
        raise MeshFileError(f"{name} has no complete PLY header", "export it again")
    return b"format ascii" in header


def _check_off(content: bytes, name: str) -> bool:
    if re.match(rb"\s*C?OFF\s+BINARY", content):
        raise MeshFileError(f"{name} is binary OFF", "export it as text OFF, or as STL")
    return True


def _check_3mf(content: bytes, name: str) -> bool:
    try:
        with zipfile.ZipFile(BytesIO(content)) as archive:
            size = sum(entry.file_size for entry in archive.infolist())
            names = [entry.filename.casefold() for entry in archive.infolist()]
            broken = archive.testzip() if size <= LARGEST_FILE else None
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, OSError, EOFError, ValueError, zlib.error) as error:
        raise MeshFileError(f"{name} is a damaged archive: {error}", "copy or export it again") from None
    if size > LARGEST_TEXT:
        raise MeshFileError(
            f"{name} unpacks to {size // 10**6} MB", f"at most {LARGEST_TEXT // 10**6} MB; export it as STL"
        )
    if broken is not None:
        raise MeshFileError(f"{name} is damaged in {broken}", "copy or export it again")
    if not any("3d/3dmodel.model" in entry for entry in names):
        raise MeshFileError(f"{name} holds no 3D/3dmodel.model", "export it as 3MF again")
    return False


CHECKS = {"stl": _check_stl, "obj": _check_obj, "ply": _check_ply, "off": _check_off, "3mf": _check_3mf}


class _Kept(Handler):
    """Keeps what trimesh warns of, which it logs."""

    def __init__(self) -> None:
        super().__init__(WARNING)
        self.messages: list[str] = []

    def emit(self, record: LogRecord) -> None:
        """Keep a message."""
        self.messages.append(record.getMessage())


@contextmanager
def _warned(name: str) -> Iterator[None]:
    """Turn whatever goes wrong inside trimesh, warnings too, into an error about the file."""
    kept, logger = _Kept(), getLogger("trimesh")
    logger.addHandler(kept)
    hint = "export it again, or in another format"
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", DeprecationWarning)
            yield
    except MeshFileError:
        raise
    except MemoryError:
        raise MeshFileError(f"{name} does not fit into memory", "export it with fewer triangles") from None
    except IndexError:
        raise MeshFileError(f"{name} has a face that names a vertex that is not there", hint) from None
    except Exception as error:  # a parser meets damage in as many ways as there are files
        text = " ".join(str(error).split())[:200]
        raise MeshFileError(f"{name} is damaged: {type(error).__name__}: {text}", hint) from None
    finally:
        logger.removeHandler(kept)
    if kept.messages:
        raise MeshFileError(f"{name} is not read in full: {kept.messages[0][:200]}", hint)


def _trimeshes(content: bytes, sort: str, name: str) -> "list[Trimesh]":
    """Return the meshes of a file, each where it belongs."""
    import trimesh

    with _warned(name):
        scene = trimesh.load_scene(BytesIO(content), file_type=sort, process=False, skip_materials=True)
        found = [one for one in scene.dump() if isinstance(one, trimesh.Trimesh)]
        if sort in ("ply", "off"):
            _all_there(content, sort, found, name)
    return [one for one in found if len(one.faces)]


COUNTS = {
    "ply": re.compile(rb"element\s+vertex\s+(\d+).*?element\s+face\s+(\d+)", re.DOTALL),
    "off": re.compile(rb"OFF\s+(?:#[^\n]*\s+)*(\d+)\s+(\d+)"),
}


def _all_there(content: bytes, sort: str, found: "list[Trimesh]", name: str) -> None:
    """Refuse a file of fewer vertices or faces than its header counts; polygons make more."""
    counts = COUNTS[sort].search(content)
    if counts is None:
        raise MeshFileError(f"{name} has no counts of vertices and faces in its header", "export it again")
    held = sum(len(one.vertices) for one in found), sum(len(one.faces) for one in found)
    for what, said, there in zip(("vertices", "faces"), map(int, counts.groups()), held, strict=True):
        if there < said:
            message = f"{name} announces {said} {what} and holds {there}: it is cut off or damaged"
            raise MeshFileError(message, "copy or export it again")


def _joined(found: "list[Trimesh]", name: str) -> Mesh:
    """Return all meshes of a file as one; refuse numbers that are no positions or name no vertex."""
    if sum(len(one.faces) for one in found) > MOST_TRIANGLES:
        message = f"{name} has more than {MOST_TRIANGLES} triangles"
        raise MeshFileError(
            message, "export it coarser; a chord error of a tenth of the cutting tolerance is fine enough"
        )
    vertices = [np.asarray(one.vertices, dtype=np.float64) for one in found]
    faces = [np.asarray(one.faces, dtype=np.int64) for one in found]
    for points, corners in zip(vertices, faces, strict=True):
        if corners.min() < 0 or corners.max() >= len(points):
            message = f"{name} has a face that names vertex {int(corners.max()) + 1} of {len(points)}"
            raise MeshFileError(message, "it is damaged: export it again")
        bad = np.flatnonzero(~(np.abs(points) <= LARGEST).all(axis=1))
        if len(bad):
            message = f"{name} has a vertex at ({', '.join(f'{x:g}' for x in points[bad[0]])})"
            raise MeshFileError(message, "it is damaged: export it again")
    shifts = np.cumsum([0, *(len(points) for points in vertices)])
    return Mesh(
        np.concatenate(vertices), np.concatenate([one + shift for one, shift in zip(faces, shifts[:-1], strict=True)])
    )


LARGEST = 1e12
"""In any unit; no file means a coordinate beyond."""


def _unit(found: "list[Trimesh]", name: str) -> str:
    """Return the unit that a 3MF states."""
    said = str(found[0].metadata.get("units", "millimeter"))
    if said not in UNIT_NAMES:
        raise MeshFileError(f'{name} has the unit "{said}"', f"one of {', '.join(UNIT_NAMES)}")
    return UNIT_NAMES[said]
