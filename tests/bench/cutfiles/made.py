"""Every sample as it is made: its files as text, its side files, its patterns as drawings call them."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from pipeline.files import FileNames, file_names
from pipeline.outputs import outputs
from pipeline.run import JobResult, PartRun, cut_patterns
from stages.model.cutfile import Machine
from stages.model.pattern import FlatPattern
from stages.model.sheet import SheetLayout
from tests.samples import SAMPLES, SHORT_SEARCH, result_of

Side = dict[str, list[dict]]


@dataclass(frozen=True)
class Made:
    """A sample: its result, the DXF texts and side files by the path of the drawing, the patterns by their names there.

    bare: whether its drawings hold whole, nominal contours: no helps, no common lines.
    """

    name: str
    result: JobResult
    names: FileNames
    texts: dict[str, str]
    sides: dict[str, Side]
    patterns: dict[str, FlatPattern]

    @property
    def machine(self) -> Machine:
        """What its drawings are like."""
        return self.names.machine

    @property
    def bare(self) -> bool:
        """Whether its sheets hold whole, nominal contours."""
        return not self.machine.helps.any and not self.result.job.options.common_line

    def flat(self) -> Iterator[tuple[str, FlatPattern, PartRun]]:
        """Yield path, pattern and run of every part that has a drawing of its own."""
        runs = {self.names.parts[run.part.name]: run for run in self.result.parts}
        for part, pattern in self.patterns.items():
            if f"flat/{part}.dxf" in self.texts:
                yield f"flat/{part}.dxf", pattern, runs[part]

    def sheets(self) -> Iterator[tuple[str, SheetLayout]]:
        """Yield path and layout of every sheet that has a drawing of its own, parts as drawings call them."""
        nesting = self.names.nesting(self.result.nest.product)
        for layout in nesting.layouts if nesting else ():
            path = self.machine.path(layout.sheet.id, layout.index)
            if self.machine.file_per == "sheet" and path in self.texts:
                yield path, layout

    def where(self, path: str) -> str:
        """Return what a table calls a file."""
        return f"{self.name}: {path}"


@cache
def samples() -> tuple[Made, ...]:
    """Return all samples, each nested by a short search."""
    return tuple(made(file) for file in sorted(SAMPLES.glob("*/*.toml")))


def made(file: Path) -> Made:
    """Return a sample."""
    result = result_of(str(file.relative_to(SAMPLES)), SHORT_SEARCH)
    _, files = outputs(result)
    texts = {path: content.decode("ascii") for path, content in files.items() if path.endswith(".dxf")}
    sides = {path: json.loads(files[side]) for path in texts if (side := f"{path[:-4]}.json") in files}
    names = file_names(result.parts, result.job)
    patterns = {one.part: one for one in names.patterns(cut_patterns(result.parts, result.job))}
    return Made(f"{file.parent.name}/{file.stem}", result, names, texts, sides, patterns)


def drawings() -> Iterator[tuple[Made, str, str]]:
    """Yield every drawing of parts and sheets: its sample, its path and its text; of remnants none."""
    for one in samples():
        for path, text in one.texts.items():
            if path.startswith(("flat/", "cut/")):
                yield one, path, text
