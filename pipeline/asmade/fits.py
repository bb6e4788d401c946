"""Kerf, K-factor and springback fitted to measurements: offered as lines for a job file, or refused with the reason.

Each is one value, fitted by least squares to all readings that tell it (`stages.unroll.asmade`), gross errors named and
set aside (`geometry.numeric.leastsquares`).  Its interval at 95 % follows from the stated uncertainties of the
instruments, taken as 1.96 standard ones.  Nothing is offered where fewer than `FEWEST` readings are left, where more
than a third of them would have to be set aside, where the residuals are larger than the stated uncertainties explain,
or where the interval is too wide to be of use.

Nothing is ever applied: what is offered is text to paste.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import floor, isfinite, log10, nan, radians

import numpy as np

from pipeline.asmade.nominal import Nominal
from pipeline.asmade.rows import Measured, Reading, exact
from pipeline.materials import look_up
from stages.geometry.arrays import Values
from stages.geometry.numeric.leastsquares import FALSE_ALARM, Snooped, UndefinedError, snooped
from stages.unroll.asmade import Estimate, Folded, k_factor_of, yield_share

COVER = 1.959963984540054
"""Standard uncertainties in half of an interval at 95 %."""
FEWEST = 3
"""Of two that differ nobody can say which is wrong."""
MOST_ASIDE = 1.0 / 3.0
"""Share of the readings that may be set aside."""
LEAST_RATE = 1e-3
"""A size that changes by less than this share of the kerf does not tell it."""
WIDEST_K = 0.1
"""Half an interval of K: all metals lie within 0.25 to 0.5."""
MPA_PER_GPA = 1e3


@dataclass(frozen=True, slots=True)
class Tell:
    """One observation y = rate x: what tells the value, from which lines of the sheet."""

    part: str
    copy: int
    what: str
    lines: tuple[int, ...]
    rate: float
    y: Estimate


@dataclass(frozen=True, slots=True)
class Outlier:
    """An observation that was set aside, its residual in standard deviations."""

    tell: Tell
    deviations: float


@dataclass(frozen=True, slots=True)
class Offer:
    """What was fitted.  reason: why nothing is offered; empty: `toml` may be pasted.

    value, half: half the interval at 95 %; nan where nothing could be fitted.  chance: see `leastsquares.Fit`.
    """

    name: str
    unit: str
    reason: str = ""
    value: float = nan
    half: float = nan
    used: int = 0
    chance: float | None = None
    outliers: tuple[Outlier, ...] = ()
    toml: str = ""
    notes: tuple[str, ...] = ()


def offers(measured: Measured, nominal: Nominal) -> tuple[Offer, ...]:
    """Return what the readings say of kerf, K-factor and springback."""
    return kerf_offer(measured, nominal), k_offer(measured, nominal), springback_offer(measured, nominal)


def fit(name: str, unit: str, tells: Sequence[Tell], few: str) -> Offer:
    """Return the fit of one value; refused where it cannot be told.  few: what to measure if there is too little."""
    if len(tells) < FEWEST:
        return Offer(name, unit, f"{len(tells)} of at least {FEWEST} readings that tell it: {few}", used=len(tells))
    matrix = np.array([[tell.rate] for tell in tells])
    y, u = (np.array([getattr(tell.y, key) for tell in tells]) for key in ("value", "uncertainty"))
    try:
        found = snooped(matrix, y, u)
    except UndefinedError as error:
        return Offer(name, unit, f"the readings do not tell it ({error})", used=len(tells))
    return _judged(name, unit, tells, found, u)


def _judged(name: str, unit: str, tells: Sequence[Tell], found: Snooped, u: Values) -> Offer:
    """Return a fit with its outliers; refused if they are too many or the residuals too large."""
    matrix = np.array([tell.rate for tell in tells])
    y = np.array([tell.y.value for tell in tells])
    value, half = float(found.fit.values[0]), COVER * float(found.fit.covariance[0, 0]) ** 0.5
    outliers = tuple(Outlier(tells[i], float((y[i] - matrix[i] * value) / u[i])) for i in found.aside)
    reason = ""
    if found.aside.size > MOST_ASIDE * len(tells):
        reason = f"{found.aside.size} of {len(tells)} readings contradict the others: one value does not describe them"
    elif found.fit.chance < FALSE_ALARM:
        kept = found.kept
        scatter = float(np.sqrt(((y[kept] - matrix[kept] * value) ** 2 / u[kept] ** 2).mean()))
        reason = (
            f"the readings scatter {scatter:.2g} times as widely as their stated uncertainties: state what they "
            "really repeat to, or part what was not cut or bent alike"
        )
    return Offer(name, unit, reason, value, half, int(found.kept.size), found.fit.chance, outliers)


def _line(key: str, value: float, half: float, unit: str = "") -> str:
    """Return a line of a job file, its interval as a comment."""
    places = places_for(half)
    low, high = (f"{value + way * half:.{places}f}" for way in (-1.0, 1.0))
    return f"{key} = {value:.{places}f}  # {low} to {high}{unit} at 95 %"


def places_for(half: float) -> int:
    """Return the decimals that show a digit more than an interval has."""
    return min(max(1 - floor(log10(half)), 1), 9)


# Kerf


def kerf_offer(measured: Measured, nominal: Nominal) -> Offer:
    """Return the kerf that the sizes of the blanks tell."""
    written = (nominal.kerf_mm or 0.0) if nominal.compensated else 0.0
    tells = [
        Tell(one.of.part, one.copy, one.of.what, (one.line,), one.of.rate, _departure(one, one.of.rate * written))
        for one in measured.readings
        if one.of.rate is not None and abs(one.of.rate) >= LEAST_RATE
    ]
    offer = fit("kerf", "mm", tells, "width, height, sides and diagonals of straight blanks, round holes")
    if offer.reason:
        return offer
    notes = [COMPENSATED if nominal.compensated else UNCOMPENSATED]
    if len({tell.rate > 0.0 for tell in tells}) == 1:
        notes.append("outsides only, or holes only: an instrument that reads too long looks the same; measure both")
    offer = replace(offer, notes=tuple(notes))
    if offer.value - offer.half <= 0.0:
        return replace(
            offer, reason="not told from 0: either the controller already takes the kerf off, or measure more finely"
        )
    return replace(offer, toml="[process]\n" + _line("kerf", offer.value, offer.half, " mm"))


UNCOMPENSATED = "the drawings are nominal: if the controller compensates, this is what it leaves; add its own value"
COMPENSATED = "the drawings are compensated; their own kerf has been added"


def _departure(one: Reading, written: float) -> Estimate:
    """Return how far a size departs from nominal, mm, as if it had been cut along the nominal contour."""
    return Estimate(float(one.measured - exact(one.of.nominal)) + written, float(one.uncertainty) / COVER)


# K-factor


def k_offer(measured: Measured, nominal: Nominal) -> Offer:
    """Return the K-factor that blanks and flanges tell, one observation a copy."""
    by_copy: dict[tuple[str, int], dict[str, Reading]] = defaultdict(dict)
    for one in measured.readings:
        by_copy[one.of.part, one.copy][one.of.what] = one
    tells, missing = [], set[str]()
    for (part, copy), there in by_copy.items():
        needed = _needed(nominal, part)
        if not needed or not any(what.startswith("flange ") for what in there):
            continue
        lacks = [what for what in needed if what not in there]
        missing.update(lacks)
        if not lacks:
            lines = tuple(there[what].line for what in needed)
            tells.append(Tell(part, copy, "as bent", lines, 1.0, k_factor_of(_folded(nominal, part, there))))
    also = f"; not measured: {', '.join(sorted(missing))}" if missing else ""
    few = f"of each bent copy height before bending, thickness, all flanges, angles and inside radii{also}"
    offer = fit("k_factor", "", tells, few)
    if offer.reason:
        return offer
    if offer.half > WIDEST_K:
        return replace(
            offer, reason=f"told to +-{offer.half:.2g} only, and all metals lie within 0.25 to 0.5: measure more finely"
        )
    if not 0.0 <= offer.value <= 1.0:
        return replace(offer, reason="the neutral line would lie outside the sheet: look at the readings")
    return replace(offer, toml="[material]\n" + _line("k_factor", offer.value, offer.half))


def _needed(nominal: Nominal, part: str) -> list[str]:
    """Return what must be measured of a part so that it tells K; nothing of one that has no flanges."""
    whats = [one.what for one in nominal.dimensions if one.part == part]
    flanges = [what for what in whats if what.startswith("flange ")]
    if not flanges:
        return []
    bends = [f"bend {name} {sort}" for sort in ("angle", "radius") for name in nominal.bends[part]]
    return ["height", "thickness", *flanges, *bends]


def _folded(nominal: Nominal, part: str, there: dict[str, Reading]) -> Folded:
    flanges = [what for what in _needed(nominal, part) if what.startswith("flange ")]
    names = nominal.bends[part]
    return Folded(
        _standard(there["height"]),
        _standard(there["thickness"]),
        tuple(_standard(there[what]) for what in flanges),
        tuple(_in_rad(_standard(there[f"bend {name} angle"])) for name in names),
        tuple(_standard(there[f"bend {name} radius"]) for name in names),
    )


def _standard(one: Reading) -> Estimate:
    """Return a reading with its standard uncertainty."""
    return Estimate(float(one.measured), float(one.uncertainty) / COVER)


def _in_rad(one: Estimate) -> Estimate:
    return Estimate(radians(one.value), radians(one.uncertainty))


# Springback


def springback_offer(measured: Measured, nominal: Nominal) -> Offer:
    """Return the yield strength that explains what radii were left of those bent to."""
    thickness = nominal.thickness_mm
    tells = [
        Tell(one.of.part, one.copy, one.of.what, (one.line,), 1.0, share)
        for one in measured.readings
        if thickness is not None and one.of.what.split()[0] in ("bend", "roll") and one.tool is not None
        if one.of.unit == "mm" and isfinite((share := _share(one, thickness)).uncertainty)
    ]
    offer = fit("springback", "sigma_y / E", tells, "inside radii as left, each with the radius of its tool")
    if offer.reason:
        return offer
    offer = replace(offer, notes=("lines without a tool radius were taken as bent to that of the roll schedule",))
    if offer.value - offer.half <= 0.0:
        return replace(
            offer, reason="not told from 0: bend to larger radii, which spring back more, or measure more finely"
        )
    row = look_up(nominal.material)[0]
    modulus = None if row is None else row.youngs_modulus
    if modulus is None:
        return replace(offer, notes=(*offer.notes, "times the sheet's modulus of elasticity it is the yield strength"))
    mpa = modulus.value * MPA_PER_GPA
    strength = _line("yield_strength", offer.value * mpa, offer.half * mpa, " MPa")
    return replace(
        offer, toml=f"[material]\n{strength}\nyoungs_modulus = {modulus.value:.1f}  # only their ratio is told"
    )


def _share(one: Reading, thickness_mm: float) -> Estimate:
    return yield_share(Estimate(float(one.tool or 0), 0.0), _standard(one), thickness_mm)
