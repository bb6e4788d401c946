"""The list of what a job leaves over, for the next job to take as stock: `remnant.json`, schema planish-remnant/1.

One entry for each sheet with a usable offcut, none dropped; without any there is no file, and neither is there one
where nothing is cut.  An entry is a rectangle in its own frame, not turned against the sheet that it came from, so that
the grain keeps its direction.  Its drawing is `remnants/<id>.dxf`.
"""

from typing import TYPE_CHECKING

from pipeline.files import file_names
from pipeline.report.document import Document
from pipeline.run import JobResult

if TYPE_CHECKING:
    from stages.model.sheet import Rectangle, SheetLayout

SCHEMA = "planish-remnant/1"
REMNANTS = "remnant.json"


def remnant_document(result: JobResult) -> Document | None:
    """Return the list of remnants, or None if the job leaves none."""
    if result.status != "made" or result.nest.product is None:
        return None
    names = file_names(result.parts, result.job)
    entries = [
        _entry(result, layout, layout.offcut, names.stock[layout.sheet.id])
        for layout in result.nest.product.layouts
        if layout.offcut is not None
    ]
    return {"schema": SCHEMA, "remnants": entries} if entries else None


def _entry(result: JobResult, layout: "SheetLayout", piece: "Rectangle", stock: str) -> Document:
    material = result.job.material
    return {
        "id": f"{stock}-{layout.index}",
        "width_mm": piece.width_mm,
        "height_mm": piece.height_mm,
        "material": material.name,
        "thickness_mm": material.thickness_mm,
        "grain_deg": layout.sheet.grain_deg,
        "from": {
            "job": result.job.name,
            "stock": layout.sheet.id,
            "sheet": layout.index,
            "x": piece.x,
            "y": piece.y,
        },
    }
