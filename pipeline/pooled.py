"""`planish nest OUT...`: the patterns of finished jobs nested together, by material and thickness.

    output folders -> finished jobs -> groups of one material and thickness -> each nested, certified, written

A part goes by `<job>/<part>`, jobs of one name told apart by a number, so that every copy on every sheet says whose it
is, on the drawing too.  Copies count as in their job.  Groups stand by themselves: one that does not fit its stock
leaves the others to be cut.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from pipeline.finished import Finished
from pipeline.job import Job
from pipeline.run import EXIT_CODES, JobResult, Listener, PartRun, Runner, Status, finish, silent
from pipeline.store import REPORT, safe_name
from pipeline.supply import Row, Supply
from stages.errors import BadInputError, Problem
from stages.model.curves import CurveSpec
from stages.model.cutfile import Machine
from stages.model.material import Material, Part
from stages.model.part import Flat, PartSpec
from stages.model.sheet import Sheet

if TYPE_CHECKING:
    from stages.model.pattern import FlatPattern

NO_SOLUTION = EXIT_CODES["no-solution"]
NO_NAME = "unnamed"

CHORDED = frozenset({"polylines", "aama"})
"""Flavours whose drawings hold no arcs, and tell nothing of those that they stand for."""

ARCS_ARE_HAD = 'run such a job with [dxf] flavour = "polyline-arcs" and pool that, to have its arcs'


@dataclass(frozen=True, slots=True)
class Order:
    """Where a pooled part comes from: its job and its name there.  job: the job's name, made unique."""

    job: str
    finished: Finished
    part: str


@dataclass(frozen=True, slots=True)
class Group:
    """The parts of one material and thickness by their pooled names, whose they are, and what they are cut from."""

    name: str
    material: Material
    patterns: "tuple[FlatPattern, ...]"
    orders: Mapping[str, Order]
    supply: Supply
    notes: tuple[str, ...] = ()

    @property
    def stock(self) -> tuple[Sheet, ...]:
        """The stock that is of its material and thickness."""
        return self.supply.serving(self.material.name, self.material.thickness_mm)


@dataclass(frozen=True, slots=True)
class Pool:
    """Finished jobs nested together: a result for each group."""

    jobs: Mapping[str, Finished]
    results: tuple[tuple[Group, JobResult], ...]
    inputs: tuple[tuple[str, str], ...]
    seconds: dict[str, float]

    @property
    def status(self) -> Status:
        """Made if every group was."""
        return "made" if all(result.status == "made" for _, result in self.results) else "no-solution"

    @property
    def exit_code(self) -> int:
        """That of an interruption if nothing worse has happened."""
        codes = {result.exit_code for _, result in self.results}
        return NO_SOLUTION if NO_SOLUTION in codes else max(codes)


def pool(jobs: Sequence[Finished], supply: Supply | None, listener: Listener = silent) -> Pool:
    """Return the jobs nested together; `BadInputError` where a group has no stock or no grain to lie along."""
    named = dict(zip(told_apart(job.job.name for job in jobs), jobs, strict=True))
    groups = groups_of(named, supply)
    problems = [problem for group in groups for problem in troubles(group)]
    if problems:
        raise BadInputError(*problems)
    runner = Runner(listener)
    results = tuple((group, run_group(runner, group)) for group in groups)
    inputs = tuple((str(job.folder / REPORT), job.report_digest) for job in jobs)
    return Pool(named, results, inputs + (supply.inputs if supply else ()), runner.seconds)


def told_apart(names: Iterable[str]) -> list[str]:
    """Return the names, the second of a name with a 2 behind it; upper and lower case count as the same."""
    taken: set[str] = set()
    apart: list[str] = []
    for name in names:
        candidate, count = name, 1
        while candidate.casefold() in taken:
            count += 1
            candidate = f"{name}-{count}"
        taken.add(candidate.casefold())
        apart.append(candidate)
    return apart


def groups_of(jobs: Mapping[str, Finished], supply: Supply | None) -> list[Group]:
    """Return the parts of all jobs by material and thickness, in the order in which these first come."""
    keys: dict[tuple[str, float | None], dict[str, Finished]] = {}
    for name, job in jobs.items():
        material = job.job.material
        keys.setdefault(((material.name or NO_NAME).casefold(), material.thickness_mm), {})[name] = job
    _, *titles = told_apart([REPORT, *(safe_name(_title(*key)) for key in keys)])
    groups = [_group(title, members, supply) for title, members in zip(titles, keys.values(), strict=True)]
    told = [] if supply is None or len(groups) == 1 else [_shared(name) for name in supply.doubled()]
    return [replace(group, notes=(*group.notes, *told)) for group in groups]


def _shared(stock: str) -> str:
    return f'"{stock}" may be of every material and thickness: each group counts on all of it'


def _title(material: str, thickness_mm: float | None) -> str:
    """Return what a group is called: its material, and its thickness as far as that is known."""
    return material if thickness_mm is None else f"{material}-{repr(thickness_mm).removesuffix('.0')}mm"


def _group(title: str, jobs: Mapping[str, Finished], supply: Supply | None) -> Group:
    """Return the group of some jobs of one material and thickness."""
    first = next(iter(jobs.values())).job.material
    material = Material(first.name, first.thickness_mm, first.density_kg_m3)
    found = [(Order(name, job, one.part), one) for name, job in jobs.items() for one in job.patterns]
    names = told_apart(f"{order.job}/{order.part}" for order, _ in found)
    given = supply or _of_first(jobs)
    return Group(
        title,
        material,
        tuple(_named(pattern, name, given.machine) for name, (_, pattern) in zip(names, found, strict=True)),
        {name: order for name, (order, _) in zip(names, found, strict=True)},
        given,
        tuple(_notes(material, jobs, given)),
    )


def _named(pattern: "FlatPattern", name: str, machine: Machine) -> "FlatPattern":
    """Return a pattern under its pooled name, as a machine takes it."""
    from pipeline.drawnout import drawn_out

    made = pattern.replace(part=name)
    return made if machine.flavour == "aama" else drawn_out(made)


def _of_first(jobs: Mapping[str, Finished]) -> Supply:
    """Return stock and wishes of the first job that has stock; no stock if none has."""
    name, job = next(((name, job) for name, job in jobs.items() if job.stock), next(iter(jobs.items())))
    rows = tuple(Row(sheet) for sheet in job.stock)
    return Supply(f'job "{name}"', rows, job.options, job.machine, job.rates, job.job.formats)


def _notes(material: Material, jobs: Mapping[str, Finished], supply: Supply) -> Iterator[str]:
    """Yield what had to be assumed."""
    yield f"stock and wishes for the nest are those of {supply.origin}"
    if len(jobs) > 1 and not material.name:
        yield "no material is stated: the parts are taken to be of one"
    if len(jobs) > 1 and material.thickness_mm is None:
        yield "no thickness is stated: the parts are taken to be of one"
    chorded = ", ".join(f'"{name}"' for name, job in jobs.items() if job.machine.flavour in CHORDED)
    if chorded:
        yield f"parts of {chorded} are nested and written as the chords that their drawings hold: {ARCS_ARE_HAD}"
    unknown = ", ".join(f'"{name}/{part}"' for name, job in jobs.items() for part in job.unrecalled)
    if unknown:
        yield f"no side file tells notches and what holes are for of {unknown}: they are cut as drawn"
    yield from supply.notes


def troubles(group: Group) -> Iterator[Problem]:
    """Yield a group without stock, and parts with a direction where some of its stock has none."""
    if not group.stock:
        message = f'no stock for "{group.name}" in {group.supply.origin}'
        yield Problem(message, hint="give a file of stock with --stock, or [[stock]] in the first of the jobs")
    blind = [sheet.id for sheet in group.stock if sheet.grain_deg is None]
    for pattern in group.patterns if blind else ():
        if pattern.axis_deg is not None:
            message = f'"{pattern.part}" lies along the grain, that of the stock "{blind[0]}" is not known'
            yield Problem(message, hint="give grain under [[stock]]")


def run_group(runner: Runner, group: Group) -> JobResult:
    """Return what becomes of a group: it is nested and written as one job of plates."""
    supply = group.supply
    job = Job(
        name=group.name,
        parts=(),
        material=group.material,
        stock=group.stock,
        options=supply.options,
        machine=supply.machine,
        formats=supply.formats,
        repairs=supply.repairs,
        notes=group.notes,
        rates=supply.rates,
    )
    return finish(runner, job, tuple(_as_drawn(group, pattern) for pattern in group.patterns))


def _as_drawn(group: Group, pattern: "FlatPattern") -> PartRun:
    """Return a part that is as its drawing has it: no stage before the nest has anything to do."""
    order = group.orders[pattern.part]
    file = str(order.finished.folder / order.finished.paths[order.part])
    outline = CurveSpec(file=file, layer="CUT_OUTER")
    spec = PartSpec(name=pattern.part, surface=Flat(outline=outline), quantity=pattern.quantity)
    return PartRun(Part(spec, group.material), (), None, pattern)
