"""What a report says of its job, apart from its parts: whose it is, its sheet, its process, tolerances and drawings."""

from dataclasses import asdict

from pipeline.job import Job
from stages.model.cutfile import Machine

Document = dict[str, object]


def job_entry(job: Job) -> Document:
    """Return a job: whose it is, its material, its process, its tolerances, its drawings."""
    material, tol = job.material, job.tolerances
    return {
        "name": job.name,
        "customer": job.customer,
        "revision": job.revision,
        "digest": job.digest,
        "units": job.units,
        "material": {
            "name": material.name,
            "thickness_mm": material.thickness_mm,
            "density_kg_m3": material.density_kg_m3,
            "bend_radius_min_mm": material.bend_radius_min_mm,
            "max_strain": material.max_strain,
        },
        "process": {
            "type": job.process.type or None,
            "kerf_mm": job.process.kerf_mm,
            "min_hole_mm": job.process.min_hole_mm,
            "min_web_mm": job.process.min_web_mm,
            "on_narrow": "refuse" if job.process.refuses_narrow else "warn",
            "slat_pitch_mm": job.process.slat_pitch_mm,
            "kerf_compensation": "offset" if job.process.compensated else "none",
        },
        "tolerance": {
            "accept": tol.accept,
            "chord_mm": tol.chord_mm,
            "join_mm": tol.join_mm,
            "normalise": tol.normalise,
        },
        "dxf": _drawings(job.machine),
        "formats": list(job.formats),
        "notes": list(job.notes),
    }


def _drawings(machine: Machine) -> Document:
    """Return how the drawings are written, and how they call their layers."""
    return {
        "flavour": machine.flavour,
        "version": machine.version,
        "layers": {meaning: {"name": layer.name, "colour": layer.colour} for meaning, layer in machine.layers.items()},
        "side": machine.side,
        "text": machine.text,
        "one_file_per": machine.file_per,
        "name": machine.file_name,
        "also": machine.also,
        "paper": machine.paper,
        "size": machine.style.size,
        "helps": asdict(machine.helps),
    }
