"""Mesh files: what every format holds arrives in full, and a damaged file is refused in words."""

import struct
import zipfile
from collections.abc import Callable
from io import BytesIO

import numpy as np
import pytest
import trimesh

from pipeline import meshfiles
from pipeline.meshfiles import MeshFileError, parsed
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.repair import repaired
from tests.near import assert_near
from tests.tubes import holed, rolled, soup

SHEET = holed(9, [(0.3, 0.2, 0.3)], rolled)


def exported(mesh: Mesh, sort: str) -> bytes:
    """Return a file of a mesh as trimesh writes it."""
    written = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).export(file_type=sort)
    return written.encode() if isinstance(written, str) else bytes(written)


def binary_stl(mesh: Mesh, header: bytes = b"") -> bytes:
    """Return a binary STL, written after its description and by no library."""
    corners = mesh.vertices[mesh.faces].astype("<f4")
    rows = b"".join(struct.pack("<3f", 0, 0, 0) + corner.tobytes() + b"\0\0" for corner in corners)
    return header.ljust(80)[:80] + struct.pack("<I", len(corners)) + rows


def text_stl(mesh: Mesh, name: str = "part", encoding: str = "utf-8") -> bytes:
    lines = [f"solid {name}"]
    for corner in mesh.vertices[mesh.faces]:
        lines += ["facet normal 0 0 0", " outer loop", *(f"  vertex {x!r} {y!r} {z!r}" for x, y, z in corner.tolist())]
        lines += [" endloop", "endfacet"]
    return "\n".join([*lines, f"endsolid {name}", ""]).encode(encoding)


def archive(model: str, name: str = "3D/3dmodel.model") -> bytes:
    store = BytesIO()
    with zipfile.ZipFile(store, "w", zipfile.ZIP_DEFLATED) as written:
        written.writestr(name, model)
    return store.getvalue()


TRIANGLE = (
    '<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="2" y="0" z="0"/><vertex x="0" y="3" z="0"/></vertices>'
    '<triangles><triangle v1="0" v2="1" v3="2"/></triangles></mesh>'
)
CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"


def model(
    items: str, unit: str = ' unit="inch"', objects: str = f'<object id="1" type="model">{TRIANGLE}</object>'
) -> str:
    return (
        f'<?xml version="1.0"?><model{unit} xmlns="{CORE}"><resources>{objects}</resources>'
        f"<build>{items}</build></model>"
    )


FILES: dict[str, tuple[str, bytes]] = {
    "binary stl": ("a.stl", binary_stl(SHEET)),
    "binary stl that says solid": ("a.stl", binary_stl(SHEET, b"solid facet of a part")),
    "text stl": ("a.stl", text_stl(SHEET)),
    "stl by trimesh": ("a.stl", exported(SHEET, "stl")),
    "text stl by trimesh": ("a.stl", exported(SHEET, "stl_ascii")),
    "obj": ("a.obj", exported(SHEET, "obj")),
    "ply": ("a.ply", exported(SHEET, "ply")),
    "off": ("a.off", exported(SHEET, "off")),
    "3mf": ("a.3mf", exported(SHEET, "3mf")),
}


@pytest.mark.parametrize("name", FILES)
def test_every_format_gives_the_same_surface(name: str) -> None:
    file, content = FILES[name]
    found = repaired(parsed(content, file).mesh).mesh
    assert (len(found.vertices), len(found.faces)) == (len(SHEET.vertices), len(SHEET.faces))
    there = np.sort(found.vertices[found.faces].mean(axis=1).sum(axis=1))
    here = np.sort(SHEET.vertices[SHEET.faces].mean(axis=1).sum(axis=1))
    assert_near(there, here, bound=1e-6, why="float32, or eight digits")


def refusal(content: bytes, name: str = "a.stl") -> str:
    with pytest.raises(MeshFileError) as caught:
        parsed(content, name)
    assert caught.value.hint
    return caught.value.message


STL, TEXT = binary_stl(SHEET), text_stl(SHEET)
REFUSED: dict[str, tuple[str, bytes, str]] = {
    "empty": ("a.stl", b"", "is empty"),
    "unknown ending": ("a.stp", STL, "of no known format"),
    "no ending": ("mesh", STL, "of no known format"),
    "cut off": ("a.stl", STL[:-70], f"announces {len(SHEET.faces)} triangles and holds {len(SHEET.faces) - 1.4:.6g}"),
    "cut off in its header": ("a.stl", STL[:50], "cut off, or no STL"),
    "too long": ("a.stl", STL + b"xyz", "announces"),
    "text cut off": ("a.stl", TEXT[: len(TEXT) // 2], "does not end with endsolid"),
    "text and binary": ("a.stl", TEXT + STL, "does not end with endsolid"),
    "text with a corner lost": ("a.stl", TEXT.replace(b"vertex", b"vertix", 1), "some are damaged"),
    "text with a number lost": ("a.stl", TEXT.replace(b"vertex 0.", b"vertex x.", 1), "is damaged"),
    "not a number": ("a.stl", STL[:100] + struct.pack("<f", float("nan")) + STL[104:], "has a vertex at ("),
    "no triangles": ("a.stl", STL[:80] + struct.pack("<I", 0), "has no triangles"),
    "ply called stl": ("a.stl", exported(SHEET, "ply"), "holds PLY"),
    "stl called ply": ("a.ply", STL, "is no PLY file"),
    "off called 3mf": ("a.3mf", exported(SHEET, "off"), "holds OFF"),
    "points only": ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                    b"property float z\nend_header\n0 0 0\n", "no counts"),
    "ply cut off": ("a.ply", exported(SHEET, "ply")[:-20], "a.ply"),
    "off cut off": ("a.off", b"OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "announces 2 faces and holds 1"),
    "off beyond its vertices": ("a.off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", "outside the range"),
    "binary off": ("a.off", b"OFF BINARY\n\0\0", "is binary OFF"),
    "obj without faces": ("a.obj", b"v 0 0 0\nv 1 0 0\n", "has no faces"),
    "obj that counts backwards": ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n", "count backwards"),
    "obj beyond its vertices": ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "names a vertex that is not there"),
    "no archive": ("a.3mf", b"PK\3\4 nothing", "damaged archive"),
    "archive of something else": ("a.3mf", archive("x", "word/document.xml"), "holds no 3D/3dmodel.model"),
    "a part that is not there": ("a.3mf", archive(model('<item objectid="7"/>')), "not read in full"),
    "a unit that is none": ("a.3mf", archive(model('<item objectid="1"/>', ' unit="ell"')), 'the unit "ell"'),
    "a part without items": ("a.3mf", archive(model("")), "a.3mf"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_a_file_that_holds_no_mesh_is_refused_in_words(case: str) -> None:
    name, content, words = REFUSED[case]
    assert words in refusal(content, name)


def test_latin_1_and_utf_8_names_are_read_in_texts_and_their_file_names() -> None:
    for encoding in ("utf-8", "latin-1"):
        content = text_stl(SHEET, "Trichter Größe 1", encoding)
        assert len(parsed(content, "Trichter Größe 1.STL").mesh.faces) == len(SHEET.faces)


def test_quads_become_two_triangles_and_texture_corners_one_vertex() -> None:
    points = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n"
    quads = parsed((points + "f 1 2 3 4\nf 2 5 6 3\n").encode(), "a.obj").mesh
    assert len(quads.faces) == 4
    textured = points + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3\nf 1/2 3/1 4/4\n"
    found = repaired(parsed(textured.encode(), "a.obj").mesh).mesh
    assert (len(found.vertices), len(found.faces)) == (4, 2)


def test_objects_and_materials_of_an_obj_are_one_mesh() -> None:
    text = "mtllib none.mtl\no one\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\no two\nv 5 0 0\nv 6 0 0\nv 5 1 0\n"
    found = repaired(parsed((text + "usemtl blue\nf 4 5 6\n").encode(), "a.obj").mesh).mesh
    assert (len(found.vertices), len(found.faces)) == (6, 2)
    assert found.vertices[:, 0].max() == 6.0


def test_items_of_a_3mf_are_where_they_are_put_and_in_its_unit() -> None:
    items = '<item objectid="1"/><item objectid="1" transform="0 1 0 -1 0 0 0 0 1 10 20 30"/>'
    found = parsed(archive(model(items)), "a.3mf")
    assert found.unit == "in"
    assert len(found.mesh.faces) == 2
    corners = {tuple(point) for point in found.mesh.vertices.tolist()}
    assert {(2.0, 0.0, 0.0), (10.0, 22.0, 30.0), (7.0, 20.0, 30.0)} <= corners
    assert parsed(archive(model('<item objectid="1"/>', "")), "a.3mf").unit == "mm"


def test_an_archive_that_unpacks_to_too_much_is_not_unpacked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(meshfiles, "LARGEST_TEXT", 10**6)
    store = BytesIO()
    with zipfile.ZipFile(store, "w", zipfile.ZIP_DEFLATED) as written, written.open("3D/3dmodel.model", "w") as stream:
        stream.write(b" " * (10**6 + 1))
    assert "unpacks to" in refusal(store.getvalue(), "a.3mf")


def test_entities_of_a_3mf_are_not_expanded() -> None:
    bomb = '<!DOCTYPE x [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;"><!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;">]>'
    text = model('<item objectid="1"/>').replace("?>", f"?>{bomb}", 1).replace("</build>", "&c;&c;</build>")
    assert len(parsed(archive(text), "a.3mf").mesh.faces) == 1


Damage = Callable[[bytes, np.random.Generator], bytes]


def cut_off(content: bytes, source: np.random.Generator) -> bytes:
    return content[: int(source.integers(0, len(content)))]


def flipped(content: bytes, source: np.random.Generator) -> bytes:
    damaged = bytearray(content)
    for place in source.integers(0, len(content), int(source.integers(1, 6))):
        damaged[int(place)] = int(source.integers(0, 256))
    return bytes(damaged)


def moved_about(content: bytes, source: np.random.Generator) -> bytes:
    """Return a file of which a piece is left out or doubled."""
    low, high = sorted(source.integers(0, len(content), 2).tolist())
    return content[:low] + content[high:] if source.integers(2) else content[:high] + content[low:]


@pytest.mark.parametrize("damage", [cut_off, flipped, moved_about])
@pytest.mark.parametrize("name", FILES)
def test_whatever_happens_to_a_file_it_is_read_or_refused_in_words(name: str, damage: Damage) -> None:
    file, content = FILES[name]
    source = np.random.default_rng(sum(map(ord, name + damage.__name__)))
    refused = 0
    for _ in range(25):
        try:
            mesh = parsed(damage(content, source), file).mesh
            assert np.isfinite(mesh.vertices).all()
        except MeshFileError as error:
            refused += 1
            assert error.message.startswith("a.")
    assert refused > 0 or damage is flipped


@pytest.mark.parametrize("name", sorted(set(FILES) - {"obj"}))
def test_a_file_cut_off_anywhere_is_refused(name: str) -> None:
    file, content = FILES[name]
    source = np.random.default_rng(7)
    for length in source.integers(0, len(content.rstrip()) - 12, 25):
        refusal(content[: int(length)], file)


def test_a_soup_in_single_precision_keeps_its_corners() -> None:
    found = parsed(STL, "a.stl").mesh
    assert np.array_equal(found.vertices, soup(SHEET).vertices)
