"""The table `[dxf]`: what it stands for, and what it refuses with place and remedy."""

from pathlib import Path

import pytest

from pipeline.dxftables import DxfTable, LayersTable, LayerTable, alone_troubles, machine_of
from pipeline.files import file_names
from pipeline.job import Job
from pipeline.jobfile import read
from stages.errors import BadInputError
from stages.model.cutfile import LAYER_COLOURS, Layer
from stages.model.material import Material
from stages.model.patternlayers import STANDARD
from stages.model.sheet import Sheet
from tests.pipeline.jobs import PLATE, write_job


def refused(**keys: object) -> list[str]:
    return [trouble.key for trouble in DxfTable(**keys).troubles()]


def test_defaults_are_r2000_and_for_old_polylines_r12() -> None:
    assert (machine_of(DxfTable()).version, machine_of(DxfTable(flavour="r12")).version) == ("R2000", "R12")
    assert {meaning: layer.colour for meaning, layer in machine_of(DxfTable()).layers.items()} == LAYER_COLOURS


def test_pattern_files_are_r12_on_the_layers_of_the_standard() -> None:
    machine = machine_of(DxfTable(flavour="aama", size="38"))
    assert (machine.version, machine.style.size) == ("R12", "38")
    assert {layer.name for layer in machine.layers.values()} <= STANDARD
    assert machine.layers["CUT_OUTER"].name == "1"


def test_own_layers_replace_only_what_they_name() -> None:
    layers = machine_of(
        DxfTable(layers=LayersTable(cut_outer=LayerTable(name="CUT"), mark=LayerTable(colour=7)))
    ).layers
    assert layers["CUT_OUTER"] == Layer("CUT", 1)
    assert layers["MARK"] == Layer("MARK", 7)
    assert layers["LABEL"] == Layer("LABEL", 2)


@pytest.mark.parametrize(
    "keys",
    [
        {},
        {"flavour": "lines-arcs", "version": "R12", "layers": "inventor"},
        {"flavour": "r12", "version": "R12"},
        {"flavour": "polylines", "side": "outside"},
        {"flavour": "aama", "version": "R12", "size": "38-L", "one_file_per": "material"},
        {"one_file_per": "part", "name": "{part}_{revision}"},
        {"one_file_per": "material", "name": "{material}-{thickness}"},
        {"name": "{job}{index}_{stock}"},
        {"also": ("svg", "pdf"), "paper": "A3"},
        {"layers": LayersTable(cut_outer=LayerTable(name="CUT"), cut_inner=LayerTable(name="CUT"))},
    ],
)
def test_what_can_be_written_is_accepted(keys: dict[str, object]) -> None:
    assert refused(**keys) == []


@pytest.mark.parametrize(
    ("keys", "wrong"),
    [
        ({"version": "R12"}, ["version"]),
        ({"also": ("svg", "pdf", "svg")}, ["also[2]"]),
        ({"also": ("svg",), "paper": "A4"}, ["paper"]),
        ({"flavour": "r12", "version": "R2000"}, ["version"]),
        ({"flavour": "aama", "version": "R2000"}, ["version"]),
        ({"flavour": "aama", "layers": "inventor"}, ["layers"]),
        ({"flavour": "aama", "text": "strokes"}, ["text"]),
        ({"flavour": "aama", "side": "outside"}, ["side"]),
        ({"flavour": "aama", "also": ("svg",)}, ["also"]),
        ({"flavour": "aama", "size": "XL/2"}, ["size"]),
        ({"size": "XL"}, ["size"]),
        ({"name": "{stock}{index}"}, ["name"]),
        ({"name": "{stock}7{index}"}, ["name"]),
        ({"name": "{stock}"}, ["name"]),
        ({"name": "{date}-{stock}-{index}"}, ["name"]),
        ({"name": "{part}-{stock}-{index}"}, ["name"]),
        ({"name": "a/b-{stock}-{index}"}, ["name"]),
        ({"name": "\u00e4-{stock}-{index}"}, ["name"]),
        ({"name": "{stock-{index}"}, ["name", "name"]),
        ({"one_file_per": "part"}, []),
        ({"one_file_per": "part", "name": "{job}"}, ["name"]),
        ({"one_file_per": "material", "name": "{stock}"}, ["name"]),
        ({"layers": LayersTable(mark=LayerTable(name="0"))}, ["layers.MARK.name"]),
        ({"layers": LayersTable(mark=LayerTable(name="a/b"))}, ["layers.MARK.name"]),
        ({"layers": LayersTable(mark=LayerTable(name="Etch")), "flavour": "r12"}, ["layers.MARK.name"]),
        ({"layers": LayersTable(mark=LayerTable(name="M" * 32)), "flavour": "r12"}, ["layers.MARK.name"]),
        (
            {"layers": LayersTable(mark=LayerTable(name="X", colour=9), roll=LayerTable(name="X", colour=9))},
            ["layers.MARK", "layers.ROLL"],
        ),
        ({"layers": LayersTable(mark=LayerTable(name="X"), roll=LayerTable(name="x"))}, ["layers.MARK.name"]),
    ],
)
def test_what_cannot_be_written_is_refused_in_its_place(keys: dict[str, object], wrong: list[str]) -> None:
    assert refused(**keys) == wrong


def test_parts_by_themselves_share_no_cuts() -> None:
    assert [trouble.key for trouble in alone_troubles(DxfTable(one_file_per="part"), common_line=True)] == [
        "dxf.one_file_per"
    ]
    assert list(alone_troubles(DxfTable(one_file_per="part"), common_line=False)) == []
    assert list(alone_troubles(DxfTable(), common_line=True)) == []
    assert [one.key for one in alone_troubles(DxfTable(flavour="aama"), common_line=True)] == ["dxf.flavour"]


def test_fields_are_filled_with_ascii_and_absent_values_said() -> None:
    table = DxfTable(name="{job}_{customer}_{material}_{thickness}_{stock}-{index}")
    job = Job(
        "H\u00e4user & Co", (), Material("DC01 {index}", 1.5), (Sheet("s/1", 10.0, 10.0),), machine=machine_of(table)
    )
    names = file_names((), job)
    assert names.machine.path(names.stock["s/1"], 3) == "cut/Hauser-Co_no-customer_DC01-index_1.5_s-1-3.dxf"


def test_a_style_is_the_job_in_ascii() -> None:
    job = Job("H\u00e4user & Co", (), Material("veg-tan cow", 1.5), (), machine=machine_of(DxfTable(flavour="aama")))
    style = file_names((), job).machine.style
    assert (style.name, style.size, style.material) == ("Hauser-Co", "ONE", "veg-tan-cow")


def test_the_side_is_what_the_job_says_and_nothing_else(tmp_path: Path) -> None:
    assert machine_of(DxfTable(side="outside")).side == "outside"
    job = write_job(tmp_path, PLATE + '[dxf]\nside = "inside"\n')
    with pytest.raises(BadInputError) as caught:
        read(job)
    (problem,) = caught.value.problems
    assert problem.path == "dxf.side"
    assert "outside" in f"{problem.message} {problem.hint}"
    misspelt = write_job(tmp_path, PLATE + '[dxf]\nsides = "outside"\n')
    with pytest.raises(BadInputError, match="side"):
        read(misspelt)
