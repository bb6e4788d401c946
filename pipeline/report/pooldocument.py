"""The report of finished jobs that were nested together, schema planish-pool/1.

Each group of a material and thickness has its parts, its nest and its files as the report of a job has them; every part
and every placement says whose it is.  Everything but `run` is the same for the same jobs and the same stock.
"""

from collections.abc import Mapping

from pipeline import __version__
from pipeline.files import drawings
from pipeline.outputs import pictures, stored, views, with_formats
from pipeline.pooled import Group, Order, Pool
from pipeline.provenance import code_digest, environment
from pipeline.report.costs import cost_lines
from pipeline.report.document import Document, encoded, figures_entry, measured, nest_entry, write_entry
from pipeline.report.nestentries import wish_entry
from pipeline.report.traveller.numbers import counted
from pipeline.run import JobResult
from pipeline.sidefiles import side_files
from pipeline.store import POOL_SCHEMA

SCHEMA = f"{POOL_SCHEMA}1"


def pool_outputs(pool: Pool) -> tuple[Document, dict[str, bytes]]:
    """Return the report, and every file by its path below the output folder."""
    drawn = {group.name: drawings(result) for group, result in pool.results}
    report = pool_document(pool, drawn)
    files: dict[str, bytes] = {}
    for group, result in pool.results:
        sides = side_files(result, drawn[group.name])
        every = {**stored(result), **drawn[group.name], **sides, **pictures(result), **views(result)}
        files |= {f"{group.name}/{path}": content for path, content in every.items()}
    return report, with_formats(encoded(report), files)


def pool_document(pool: Pool, drawn: Mapping[str, Mapping[str, bytes]]) -> Document:
    """Return the report; drawn: the drawings of each group by their paths in its folder."""
    return {
        "schema": SCHEMA,
        "status": pool.status,
        "jobs": [
            {
                "name": name,
                "job": job.job.name,
                "customer": job.job.customer,
                "revision": job.job.revision,
                "digest": job.job.digest,
            }
            for name, job in pool.jobs.items()
        ],
        "provenance": {"code": {"version": __version__, "sha256": code_digest()}},
        "groups": [_group(group, result, drawn[group.name]) for group, result in pool.results],
        "run": {
            "version": __version__,
            "seconds": dict(pool.seconds),
            "inputs": [{"name": name, "sha256": found} for name, found in pool.inputs],
            "environment": environment(name for name, _ in pool.inputs),
        },
    }


def _group(group: Group, result: JobResult, files: Mapping[str, bytes]) -> Document:
    figures = measured(result)
    return {
        "name": group.name,
        "status": result.status,
        "material": group.material.name,
        "thickness_mm": group.material.thickness_mm,
        "notes": list(group.notes),
        "formats": list(result.job.formats),
        "parts": [
            {
                "name": pattern.part,
                "order": _order(group.orders[pattern.part]),
                "quantity": pattern.quantity,
                **figures_entry(figures[pattern.part]),
                "nest": wish_entry(pattern),
            }
            for pattern in group.patterns
        ],
        "nest": _traced(nest_entry(result, figures), group),
        "write": write_entry(result, files),
    }


def _traced(nest: Document, group: Group) -> Document:
    """Return the nest with the order of every placement."""
    sheets = nest["sheets"]
    if not isinstance(sheets, list):
        raise ValueError("the sheets of a nest are a list")
    return {**nest, "sheets": [{**sheet, "placements": _placements(sheet["placements"], group)} for sheet in sheets]}


def _placements(placements: list[Document], group: Group) -> list[Document]:
    return [{**one, "order": {**_order(group.orders[str(one["part"])]), "copy": one["copy"]}} for one in placements]


def _order(order: Order) -> Document:
    """Return whose a part is."""
    return {"job": order.job, "customer": order.finished.job.customer, "part": order.part}


def pool_lines(pool: Pool, out: str) -> list[str]:
    """Return what the terminal says at the end: the cost of each group, and what was made."""
    lines = [f"{group.name}  note: {note}" for group, _ in pool.results for note in group.notes]
    lines += [f"{group.name}  {line}" for group, result in pool.results for line in cost_lines(result)]
    failed = [group.name for group, result in pool.results if result.status != "made"]
    if failed:
        return [
            *lines,
            f"no-solution: {', '.join(failed)} could not be nested and written; the rest and report.json in {out}",
        ]
    copies = sum(pattern.quantity for group, _ in pool.results for pattern in group.patterns)
    sheets = sum(len(result.nest.product.layouts) for _, result in pool.results if result.nest.product is not None)
    made = f"{counted(copies, 'piece')} of {counted(len(pool.jobs), 'job')} on {counted(sheets, 'sheet')}"
    return [*lines, f"made: {made} and report.json in {out}"]
