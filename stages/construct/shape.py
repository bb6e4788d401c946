"""Shape parameters that a job leaves to the program (`alpha = "auto"`), put in the place of the numbers left out.

What comes back is the same specification with numbers: everything after that is as if they had been typed.  They are
the doubles found, taken as the fractions they are, so that a surface that is exactly developable stays so.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction

from msgspec.structs import replace

from stages.construct.energy import LEAST_ALPHA, Shape, least_energy
from stages.construct.quintic import End, cone_ends, cylinder_ends, ends_of, planar_ends
from stages.model.quintics import SHAPE_KEYS, QuinticCone, QuinticCylinder, QuinticPlanar, QuinticRuled
from stages.model.report import Finding
from stages.model.scalars import Length, Number

Patch = QuinticRuled | QuinticPlanar | QuinticCylinder | QuinticCone
NO_SHAPE = (Fraction(0),) * 4


@dataclass(frozen=True, slots=True)
class Settled:
    """A specification with all its numbers, what an engineer should know of those found, and the numbers by name."""

    spec: Patch
    findings: tuple[Finding, ...] = ()
    detail: dict[str, object] = field(default_factory=dict)


def settled(spec: Patch, *, normalise: bool) -> Settled:
    """Return the specification with every `alpha = "auto"` replaced by the shape parameters of least strain energy."""
    match spec:
        case QuinticRuled():
            return _settled_each(spec, lambda suffix: ends_of(spec, suffix, normalise=normalise))
        case QuinticPlanar():
            return _settled_each(spec, lambda suffix: planar_ends(spec)[bool(suffix)])
        case QuinticCylinder() if spec.alpha:
            shape = least_energy(*cylinder_ends(spec, normalise=normalise)[0])
            rates = Fraction(shape.beta0) / Fraction(shape.alpha0), Fraction(shape.beta1) / Fraction(shape.alpha1)
            made = replace(spec, alpha=None, alpha0=Length(shape.alpha0), alpha1=Length(shape.alpha1),
                           s0=Number(rates[0]), s1=Number(rates[1]))  # fmt: skip
            return Settled(made, bound_findings(shape), shape_detail(shape))
        case QuinticCone() if spec.alpha:
            shape = least_energy(*cone_ends(spec, NO_SHAPE, normalise=normalise))
            return Settled(_with(spec, shape, ""), bound_findings(shape), shape_detail(shape))
    return Settled(spec)


def _settled_each(spec: QuinticRuled | QuinticPlanar, ends: Callable[[str], tuple[End, End]]) -> Settled:
    """Return the specification with each directrix settled by itself; ends: of the directrix with that suffix."""
    made: Patch = spec
    findings: tuple[Finding, ...] = ()
    detail: dict[str, object] = {}
    for asked, suffix in ((spec.alpha, ""), (spec.alpha_hat, "_hat")):
        if asked:
            shape = least_energy(*ends(suffix))
            made = _with(made, shape, suffix)
            findings += bound_findings(shape, suffix)
            detail |= shape_detail(shape, suffix)
    return Settled(made, findings, detail)


def _with(spec: Patch, shape: Shape, suffix: str) -> Patch:
    numbers = {f"{key}{suffix}": Length(getattr(shape, key)) for key in SHAPE_KEYS}
    made: Patch = replace(spec, **{f"alpha{suffix}": None}, **numbers)
    return made


def bound_findings(shape: Shape, suffix: str = "", where: str = "") -> tuple[Finding, ...]:
    """Return a finding if the energy would fall further with an alpha below its least value."""
    if not shape.at_bound:
        return ()
    names = " and ".join(f"{name}{suffix}" for name in shape.at_bound)
    message = (
        f"{where}{names} of least strain energy would be below the {LEAST_ALPHA:g} chord lengths that are kept: the "
        "tangent there points far off the chord; give the shape parameters, or a point between"
    )
    return (Finding("alpha-at-bound", message),)


def shape_detail(shape: Shape, suffix: str = "") -> dict[str, object]:
    """Return the shape parameters found and their strain energy, by name."""
    numbers = {f"{key}{suffix}": getattr(shape, key) for key in SHAPE_KEYS}
    return {f"shape{suffix}": numbers, f"strain_energy{suffix}_mm2": shape.energy_mm2}
