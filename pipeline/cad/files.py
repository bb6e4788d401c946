"""STEP, IGES and 3DM files that a job points at: read in a child process, and the faces chosen that the job asks for.

The libraries that read them are an extra, `pip install planish[cad]`.  They are loaded in the child alone: loading
takes a second, they print to stdout, and a broken file may crash them, which here is an error of the job and no crash.
"""

import os
import re
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from hashlib import sha256
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from pipeline.cad import wire
from pipeline.cad.wire import Unreadable
from pipeline.decode import ResolveError
from pipeline.orphans import PARENT
from pipeline.plaintext import plain
from pipeline.reach import Reach
from stages.model.cadface import CadBody, CadFace
from stages.model.faces import FaceFile

SORTS = {".step": "step", ".stp": "step", ".iges": "iges", ".igs": "iges", ".3dm": "3dm"}
PACKAGES = {"step": "OCP", "iges": "OCP", "3dm": "rhino3dm"}
WORDS = {"step": "STEP", "iges": "IGES", "3dm": "3DM"}
SAMPLE = "sample:"
"""Names that begin so are files that come with planish."""
LARGEST_FILE = 200_000_000
"""Bytes."""
TIME_LIMIT_S = 300.0
CHILD = "from pipeline.cad.child import main; main()"
MOST_LISTED = 60
"""Faces in a message."""


@dataclass(frozen=True, slots=True)
class CadSource:
    """The faces that a part is made of, in mm, and the sha256 of their file."""

    body: CadBody
    digest: str


def cad_source(reach: Reach, table: FaceFile) -> CadSource:
    """Return the faces that a part asks for; ResolveError where the file or the face is not there."""
    sort = _sort(table.file)
    content = _content(reach, table.file)
    digest = sha256(content).hexdigest()
    if find_spec(PACKAGES[sort]) is None:
        message = f"{WORDS[sort]} files are read by a library that is not installed"
        raise ResolveError("file", message, "pip install planish[cad]")
    body = _body(CadText(digest, sort, content))
    if isinstance(body, CadBody):
        body = _whole(body, content, sort)
    if isinstance(body, Unreadable):
        hint = "export it again, or as a mesh"
        raise ResolveError("file", f"{table.file} is no {WORDS[sort]} file that can be read: {body.message}", hint)
    return CadSource(chosen(body, table), digest)


def _whole(body: CadBody, content: bytes, sort: str) -> CadBody | Unreadable:
    """Return the faces, unless the file names more of them: what the library cannot read it leaves out."""
    named = faces_named(content, sort)
    if named is None:
        return Unreadable("it is cut short")
    if len(body.faces) < named:
        return Unreadable(f"{named - len(body.faces)} of its {named} faces are broken")
    return body


def faces_named(content: bytes, sort: str) -> int | None:
    """Return how many faces the text of a STEP or IGES file names, 0 for a 3DM file; None where its end is missing."""
    if sort == "3dm":
        return 0
    if sort == "step":
        return len(STEP_FACE.findall(content)) if STEP_END in content else None
    lines = content.splitlines()
    sections = [line[SECTION : SECTION + 1] for line in lines]
    if b"T" not in sections[-2:]:
        return None
    directory = [line for line, section in zip(lines, sections, strict=True) if section == b"D"]
    return sum(line[:8].strip() in IGES_FACES for line in directory[::2])


STEP_FACE = re.compile(rb"=\s*(?:ADVANCED_FACE|FACE_SURFACE)\s*\(")
STEP_END = b"END-ISO-10303-21;"
IGES_FACES = (b"143", b"144", b"510")
"""Bounded surface, trimmed surface and face, as IGES 5.3 numbers its entities; two directory lines each."""
SECTION = 72
"""Column of the letter of a line's section in IGES: S, G, D, P, T."""


def _sort(name: str) -> str:
    """Return what sort of CAD file it is by its name."""
    ending = Path(name).suffix.lower()
    if ending not in SORTS:
        raise ResolveError("file", f"{name} is no CAD file by its name", f"files read here: {', '.join(SORTS)}")
    return SORTS[ending]


def _content(reach: Reach, name: str) -> bytes:
    """Return the bytes of a CAD file."""
    if name.startswith(SAMPLE):
        inside = Path(str(files("pipeline").joinpath("data", "cad")))
        return Reach(inside).content(Path(name[len(SAMPLE) :]).name, LARGEST_FILE, "")
    return reach.content(name, LARGEST_FILE, "export only the part that is cut")


@dataclass(frozen=True, slots=True)
class CadText:
    """The bytes of a CAD file, told apart by their sha256."""

    digest: str
    sort: str
    content: bytes = field(compare=False, repr=False)


@lru_cache(maxsize=4)
def _body(text: CadText) -> CadBody | Unreadable:
    """Return the faces of a file, read once for all the parts that are made of them.

    The library reads a copy in a folder that no one else may enter: what it sees are the bytes that were hashed.
    """
    with TemporaryDirectory(prefix="planish-") as folder:
        file = Path(folder, f"copy.{text.sort}")
        file.write_bytes(text.content)
        return read_guarded((sys.executable, "-P", "-c", CHILD, str(file), text.sort), TIME_LIMIT_S)


def read_guarded(command: Sequence[str], seconds: float) -> CadBody | Unreadable:
    """Return what a child process makes of a file; a child that crashes, hangs or says nothing cannot read it."""
    surroundings = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path), PARENT: str(os.getpid())}
    try:
        child = subprocess.run(
            command, stdin=subprocess.DEVNULL, capture_output=True, check=False, timeout=seconds, env=surroundings
        )
    except subprocess.TimeoutExpired:
        return Unreadable(f"reading it takes longer than {seconds:g} s")
    if child.returncode or not child.stdout:
        return Unreadable("the reader crashed over it")
    try:
        return wire.read(child.stdout)
    except wire.WireError:
        return Unreadable("the reader answered with something else than faces")


def chosen(body: CadBody, table: FaceFile) -> CadBody:
    """Return the faces that a part asks for; ResolveError with the list of all where it does not say which."""
    faces, count = body.faces, len(body.faces)
    if not faces:
        raise ResolveError("file", f"{table.file} holds no faces", "export surfaces or solids, no curves or meshes")
    if table.all or (table.index is None and count == 1):
        return body
    if table.index is None:
        raise ResolveError(
            "file", f"{table.file} holds {count} faces", f"say which by index, or all = true: {listing(faces)}"
        )
    if table.index >= count:
        message = f"{table.file} has no face {table.index}: it holds {count}"
        raise ResolveError("index", message, f"from 0 on: {listing(faces)}")
    return CadBody((faces[table.index],))


def listing(faces: Sequence[CadFace]) -> str:
    """Return faces by number, sort and area; by their extent where no area is known."""
    more = f", and {len(faces) - MOST_LISTED} more" if len(faces) > MOST_LISTED else ""
    return ", ".join(_listed(face) for face in faces[:MOST_LISTED]) + more


def _listed(face: CadFace) -> str:
    name = f' "{plain(face.name)}"' if face.name else ""
    if face.area_mm2 is not None:
        return f"{face.index}{name} {face.sort} {face.area_mm2:.6g} mm2"
    v = np.linspace(0.0, 1.0, 9)
    points = [curve.jet(v, 0)[0] for loop in face.loops for edge in loop for curve in edge.curves]
    size = np.ptp(np.concatenate(points), axis=0) if points else np.zeros(3)
    return f"{face.index}{name} {face.sort} {' x '.join(f'{x:.4g}' for x in size)} mm"
