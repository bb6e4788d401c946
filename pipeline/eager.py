"""Packages loaded with all that is in them, by a process that others are forked from.

A job by itself loads what its kinds of surface need, where it is called.  Children that did so would each take the time
and the memory for it; what is there before they are forked they share.
"""

from importlib import import_module
from pkgutil import walk_packages

STAGES = ("stages.geometry", "stages.construct", "stages.verify", "stages.unroll")
"""What parts go through; which modules of it depends on their kinds."""

BESIDES = ("scipy.interpolate", "scipy.optimize")
"""What most kinds of surface import where they call it."""


def load_parts() -> None:
    """Load what parts of any kind go through."""
    load(STAGES)
    for name in BESIDES:
        import_module(name)


def load(packages: tuple[str, ...]) -> None:
    """Load packages and every module in them."""
    for package in packages:
        for module in walk_packages(import_module(package).__path__, f"{package}."):
            import_module(module.name)
