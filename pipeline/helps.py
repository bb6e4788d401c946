"""The helps for the process under `[process]`: what of a job they do not go with, and what the write stage is told.

Widths of tabs where the job gives none follow the thickness t: 0.2 t, from 0.2 to 0.5 mm; of aluminium, which breaks
off more easily, 0.3 t, from 0.3 to 0.8 mm; the least of these where no thickness is known.  Both are estimates.
"""

from collections.abc import Iterator, Mapping, Sequence

from pipeline.dxftables import DxfTable, alone_troubles, machine_of
from pipeline.processes import limits
from pipeline.processtables import STEEPEST_DEG, LeadTable, ProcessTable, TabsTable
from pipeline.stocktables import NestTable, StockTable
from stages.model.curves import Trouble
from stages.model.cutfile import Layer, Version, offset_layers
from stages.model.helps import Helps, Lead, Tabs
from stages.model.material import Material

TAB_SHARE, TAB_LEAST_MM, TAB_MOST_MM = 0.2, 0.2, 0.5
SOFT_TAB_SHARE, SOFT_TAB_LEAST_MM, SOFT_TAB_MOST_MM = 0.3, 0.3, 0.8
SOFT = "aluminium"
TAB_COUNT = 3


def helps_of(table: ProcessTable, kerf_mm: float | None, material: Material) -> Helps:
    """Return the helps that a job asks for."""
    return Helps(
        beam_mm=kerf_mm or 0.0,
        compensated=table.kerf_compensation == "offset",
        mitred=table.kerf_corners == "mitre",
        start=table.start,
        lead_in=_lead(table.lead_in),
        lead_out=_lead(table.lead_out),
        tabs=None if table.tabs is None else _tabs(table.tabs, material),
    )


def help_notes(helps: Helps, kerf_mm: float | None, stock: Sequence[object]) -> tuple[str, ...]:
    """Return the note that helps do nothing, where there is no stock to cut from, or that they leave out the kerf."""
    if not helps.any:
        return ()
    if not stock:
        return (
            "without [[stock]] nothing is written to cut/: offset contours, start points, leads and tabs are left out",
        )
    if kerf_mm is None and (helps.leads or helps.tabs is not None):
        how = "tabs are narrower by it, leads come nearer to contours by half of it"
        return (f"the width of the cut is not known: {how}; give process.kerf or process.type",)
    return ()


def _lead(table: LeadTable | None) -> Lead | None:
    size = None if table is None else table.length or table.radius
    if table is None or size is None:
        return None
    return Lead(table.kind, float(size), STEEPEST_DEG if table.angle is None else float(table.angle))


def _tabs(table: TabsTable, material: Material) -> Tabs:
    spacing, below = (None if value is None else float(value) for value in (table.spacing, table.below))
    width = tab_width_mm(material.name, material.thickness_mm) if table.width is None else float(table.width)
    count = (table.count or TAB_COUNT) if spacing is None else None
    return Tabs(width, count, spacing, table.holes, below)


def tab_width_mm(material: str, thickness_mm: float | None) -> float:
    """Return how wide a tab is where the job does not say, mm."""
    soft = SOFT in material.casefold()
    share, least, most = (
        (SOFT_TAB_SHARE, SOFT_TAB_LEAST_MM, SOFT_TAB_MOST_MM) if soft else (TAB_SHARE, TAB_LEAST_MM, TAB_MOST_MM)
    )
    return min(max(share * (thickness_mm or 0.0), least), most)


def help_troubles(
    process: ProcessTable, dxf: DxfTable, nest: NestTable, stock: Sequence[StockTable], thickness_mm: float | None
) -> Iterator[Trouble]:
    """Yield helps that do not go together with the rest of a job, by their keys from its top."""
    machine = machine_of(dxf)
    if nest.common_line and process.kerf is None and process.type is None:
        hint = "give process.kerf or process.type: neighbours lie one kerf apart"
        yield Trouble("nest.common_line", "the width of the cut is not known", hint)
    yield from alone_troubles(dxf, common_line=nest.common_line)
    if process.kerf_compensation == "offset":
        kerf = limits(process, thickness_mm).get("kerf")
        yield from _offset_troubles(None if kerf is None else kerf.value, nest, stock)
        yield from _layer_names(offset_layers(machine.layers), machine.version)
    if dxf.flavour == "aama" and helps_of(process, None, Material()).any:
        message = "pattern files have no start points, leads, tabs or offset contours"
        yield Trouble("dxf.flavour", message, "take another flavour, or leave these helps out of [process]")


def _offset_troubles(kerf_mm: float | None, nest: NestTable, stock: Sequence[StockTable]) -> Iterator[Trouble]:
    """Yield a kerf that is not known or nothing, and what is too near for contours that are offset by half of it."""
    if kerf_mm is None:
        hint = "give process.kerf or process.type: contours are offset by half of it"
        yield Trouble("process.kerf_compensation", "the width of the cut is not known", hint)
        return
    if kerf_mm == 0.0:
        yield Trouble("process.kerf_compensation", "a cut of no width", 'write "none", or give process.kerf')
    if stock and float(nest.gap) < kerf_mm:
        hint = f"at least the kerf, {kerf_mm:g} mm: cuts would run into neighbours"
        yield Trouble("nest.gap", f"{float(nest.gap):g} mm", hint)
    for number, row in enumerate(stock):
        if float(row.edge_gap) < kerf_mm / 2.0:
            hint = f"at least half the kerf, {kerf_mm / 2.0:g} mm: the cut would leave the sheet"
            yield Trouble(f"stock[{number}].edge_gap", f"{float(row.edge_gap):g} mm", hint)


LONGEST: dict[Version, int] = {"R12": 31}
MOST_LETTERS = 255
"""Letters of a layer's name, in all versions but R12."""


def _layer_names(layers: Mapping[str, Layer], version: Version) -> Iterator[Trouble]:
    """Yield layers whose names have no room for what says that contours are offset, or are another layer's with it."""
    for meaning in ("CUT_OUTER", "CUT_INNER"):
        name = layers[meaning].name
        others = {layer.name.casefold() for other, layer in layers.items() if other not in ("CUT_OUTER", "CUT_INNER")}
        if len(name) > LONGEST.get(version, MOST_LETTERS):
            yield Trouble(f"dxf.layers.{meaning}.name", f'"{name}" is too long for {version}', "choose a shorter one")
        elif name.casefold() in others:
            yield Trouble(f"dxf.layers.{meaning}.name", f'"{name}" is another layer too', "choose another one")
