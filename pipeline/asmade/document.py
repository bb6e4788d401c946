"""A comparison as a document, schema planish-compare/1, and as a table for a terminal.

The table holds no number that is not in the document; it shows them rounded, to a digit more than the uncertainty has.
The worst stands first: what failed, then by the share of the tolerance that is used up.
"""

from collections.abc import Iterator, Sequence
from fractions import Fraction
from importlib.resources import files
from math import degrees, floor, isfinite, log10
from typing import TYPE_CHECKING

from pipeline import __version__
from pipeline.asmade.compare import SCHEMA, Compared, Comparison
from pipeline.asmade.fits import Offer, Outlier, Tell, places_for
from pipeline.asmade.points import Cloud, PointResult
from pipeline.report.document import Document

if TYPE_CHECKING:
    from stages.geometry.ruled.bestfit import BestFit

WIDEST_NAME = 40
MOST_POINTS = 5
"""Points of a copy shown, the worst ones; the document has all."""
MARKS = {True: "pass", False: "FAIL", None: "-"}


def compare_schema() -> str:
    """Return the JSON Schema of the document."""
    return files("pipeline").joinpath("data", "compare-schema.json").read_text("utf-8").rstrip("\n")


# The document


def compare_document(made: Comparison) -> Document:
    """Return a comparison as a document: the same bytes for the same readings."""
    nominal = made.nominal
    return {
        "schema": SCHEMA,
        "version": __version__,
        "job": {"name": nominal.job, "digest": nominal.digest, "report_sha256": nominal.report_sha256},
        "units": {"length": "mm", "angle": "deg"},
        "summary": {"measured": made.count, "failed": made.failed, "not_measured": made.left},
        "dimensions": [_dimension(one) for one in made.dimensions],
        "points": [_cloud(cloud) for cloud in made.clouds],
        "fits": [_offer(offer) for offer in made.offers],
    }


def _dimension(one: Compared) -> Document:
    reading = one.reading
    return {
        "part": reading.of.part,
        "copy": reading.copy,
        "what": reading.of.what,
        "state": reading.of.state,
        "unit": reading.of.unit,
        "nominal": reading.of.nominal,
        "measured": float(reading.measured),
        "difference": float(one.difference),
        "tolerance": _or_none(reading.tolerance),
        "tolerance_by": None if reading.tolerance is None else reading.by,
        "uncertainty": float(reading.uncertainty),
        "pass": one.passed,
        "sure": one.sure,
        "looks_like": one.slip or None,
        "line": reading.line,
    }


def _cloud(cloud: Cloud) -> Document:
    return {
        "part": cloud.part,
        "copy": cloud.copy,
        "evidence": "sampled",
        "best_fit": None if cloud.fit is None else _best_fit(cloud.fit),
        "rms_mm": cloud.rms_mm,
        "worst": _point(cloud.worst),
        "points": [_point(point) for point in cloud.points],
    }


def _best_fit(fit: "BestFit") -> Document:
    return {
        "turn": fit.motion.turn.tolist(),
        "shift_mm": fit.motion.shift.tolist(),
        "angle_deg": degrees(fit.motion.angle_rad),
        "free": fit.free,
        "alone": fit.alone,
        "last_step_mm": fit.last_step_mm,
    }


def _point(one: PointResult) -> Document:
    reading = one.reading
    return {
        "face": reading.face,
        "at": list(reading.at),
        "off_mm": one.off_mm,
        "u": one.u,
        "v": one.v,
        "beyond_edge": one.beyond,
        "tolerance": _or_none(one.tolerance),
        "tolerance_by": None if one.tolerance is None else one.by,
        "uncertainty": float(reading.uncertainty),
        "pass": one.passed,
        "line": reading.line,
    }


def _offer(offer: Offer) -> Document:
    told = isfinite(offer.value)
    return {
        "name": offer.name,
        "unit": offer.unit,
        "offered": not offer.reason,
        "reason": offer.reason or None,
        "value": offer.value if told else None,
        "interval_95": [offer.value - offer.half, offer.value + offer.half] if told else None,
        "readings": offer.used,
        "chance": offer.chance,
        "outliers": [_outlier(one) for one in offer.outliers],
        "toml": offer.toml or None,
        "notes": list(offer.notes),
    }


def _outlier(one: Outlier) -> Document:
    tell = one.tell
    return {
        "part": tell.part, "copy": tell.copy, "what": tell.what, "lines": list(tell.lines),
        "deviations": one.deviations,
    }  # fmt: skip


def _or_none(value: Fraction | None) -> float | None:
    return None if value is None else float(value)


# The table


def compare_lines(made: Comparison) -> Iterator[str]:
    """Yield the lines of the table."""
    if made.dimensions:
        yield from _table(sorted(made.dimensions, key=_worst_first))
    for cloud in made.clouds:
        yield ""
        yield from _cloud_lines(cloud)
    yield ""
    yield "What the readings say for the job file (nothing is applied; 95 % intervals from the stated uncertainties)"
    for offer in made.offers:
        yield from _offer_lines(offer)
    yield ""
    yield verdict_line(made)


def verdict_line(made: Comparison) -> str:
    """Return the outcome in one line."""
    unsure = sum(one.sure is False for one in made.dimensions)
    parts = [f"{made.count} measured", *_judged(made)]
    parts += [f"{made.unjudged} without a tolerance"] if made.unjudged else []
    parts += [f"{unsure} nearer to the limit than the instrument can tell (?)"] if unsure else []
    parts += [f"{made.left} lines left empty"] if made.left else []
    return "; ".join(parts)


def _judged(made: Comparison) -> Iterator[str]:
    """Yield how what has a tolerance keeps it."""
    if made.failed:
        yield f"{made.failed} out of tolerance"
    elif made.unjudged < made.count:
        yield f"all {'others ' if made.unjudged else ''}within tolerance"


def _worst_first(one: Compared) -> tuple[bool, float, int]:
    limit = one.reading.tolerance
    used = 0.0 if not limit else float(abs(one.difference) / limit)
    return one.passed is not False, -used, one.reading.line


HEAD = ("part", "copy", "what", "nominal", "measured", "differs", "tolerance", "+-", "unit", "verdict")
RIGHT = frozenset({"copy", "nominal", "measured", "differs", "tolerance", "+-"})


def _table(rows: Sequence[Compared]) -> Iterator[str]:
    cells = [HEAD, *(_cells(one) for one in rows)]
    widths = [max(len(row[i]) for row in cells) for i in range(len(HEAD))]
    for row in cells:
        padded = (
            cell.rjust(width) if name in RIGHT else cell.ljust(width)
            for name, cell, width in zip(HEAD, row, widths, strict=True)
        )
        yield "  ".join(padded).rstrip()


def _cells(one: Compared) -> tuple[str, ...]:
    reading = one.reading
    places = _places(float(reading.uncertainty))
    limit = "" if reading.tolerance is None else f"{float(reading.tolerance):.4g}"
    verdict = MARKS[one.passed] + ("?" if one.sure is False else "")
    verdict += f"  digits exchanged? {one.slip}" if one.slip else ""
    return (
        _name(reading.of.part), str(reading.copy), _name(reading.of.what),
        f"{reading.of.nominal:.{places}f}", f"{float(reading.measured):.{places}f}",
        f"{float(one.difference):+.{places}f}", limit, f"{float(reading.uncertainty):.3g}", reading.of.unit, verdict,
    )  # fmt: skip


def _places(uncertainty: float) -> int:
    """Return the decimals that show a digit more than the uncertainty has."""
    return min(max(1 - floor(log10(uncertainty)), 0), 6)


def _name(text: str) -> str:
    """Return a name as a terminal may show it: no control characters, not too long."""
    safe = "".join(letter if letter.isprintable() else "?" for letter in text)
    return safe if len(safe) <= WIDEST_NAME else f"{safe[: WIDEST_NAME - 3]}..."


def _cloud_lines(cloud: Cloud) -> Iterator[str]:
    worst = cloud.worst
    failed = sum(point.passed is False for point in cloud.points)
    yield (
        f"{_name(cloud.part)}  copy {cloud.copy}  {len(cloud.points)} points, {failed} out of tolerance, "
        f"rms {cloud.rms_mm:.3g} mm, worst {worst.off_mm:+.3g} mm on line {worst.reading.line} (sampled)"
    )
    if cloud.fit is not None:
        yield from _fit_lines(cloud.fit)
    for point in sorted(cloud.points, key=lambda one: (one.passed is not False, -abs(one.off_mm)))[:MOST_POINTS]:
        limit = "" if point.tolerance is None else f"  tolerance {float(point.tolerance):.4g}"
        beyond = "  beyond the edge" if point.beyond else ""
        yield (
            f"  line {point.reading.line}  {point.off_mm:+.4f} mm{limit}  +-{float(point.reading.uncertainty):.3g}"
            f"  at u {point.u:.3f} v {point.v:.3f}{beyond}  {MARKS[point.passed]}"
        )


def _fit_lines(fit: "BestFit") -> Iterator[str]:
    x, y, z = fit.motion.shift
    yield f"  best fit: turned by {degrees(fit.motion.angle_rad):.4g} deg, then moved by ({x:.6g}, {y:.6g}, {z:.6g}) mm"
    if fit.free:
        yield f"    note: {fit.free} of 6 motions are not told by these points"
    if not fit.alone:
        yield "    note: the points fit as well elsewhere on the part"


def _offer_lines(offer: Offer) -> Iterator[str]:
    told = ""
    if isfinite(offer.value):
        places = places_for(offer.half)
        told = f"{offer.value:.{places}f} +- {offer.half:.{places}f} {offer.unit}".rstrip()
        told += f", from {offer.used} readings"
    yield f"  {offer.name}: " + "; ".join(
        text for text in (told, offer.reason and f"not offered: {offer.reason}") if text
    )
    for line in offer.toml.splitlines():
        yield f"      {line}"
    for one in offer.outliers:
        yield f"    set aside: {_told(one.tell)}, {one.deviations:+.1f} standard deviations off"
    for note in offer.notes:
        yield f"    note: {note}"


def _told(tell: Tell) -> str:
    lines = f"line {tell.lines[0]}" if len(tell.lines) == 1 else f"lines {', '.join(map(str, tell.lines))}"
    return f"{_name(tell.part)}, copy {tell.copy}, {_name(tell.what)} ({lines})"
