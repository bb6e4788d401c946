"""From the rails of a job file to the best developable strip between them, or the reason why there is none.

A refusal names the fold that no strip avoids (a lower bound, taken on two lattices), where that is, and the strip with
the fewest folds that there is.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np

from stages.construct.built import Built
from stages.construct.curves import Chain, chain, ends
from stages.construct.rails import Piece, pieces, rows
from stages.geometry.arrays import Values, norm, unit
from stages.geometry.numeric.extremum import maximum
from stages.geometry.rails.bound import Bound
from stages.geometry.rails.folds import ROUNDS
from stages.geometry.rails.graph import SMOOTH, Rules
from stages.geometry.rails.hairpin import hairpin
from stages.geometry.rails.strip import Rail, Strip, bounds, closed_bounds, closed_strip, open_strip
from stages.geometry.rails.zeros import angles
from stages.geometry.ruled.joins import join
from stages.geometry.ruled.ruled import RuledPatch, curvature
from stages.model.rails import Rails
from stages.model.report import Finding
from stages.model.tolerances import Tolerances

ANY_FOLD = np.pi
STILL_SMOOTH_DEG = 1e-6
"""A fold of less is none: what exact corners leave to rounding is 1e-12."""


def rail_strip(spec: Rails, tol: Tolerances) -> Built:
    """Return the strip with its pieces and what was found; no patches if there is no strip."""
    a, b = chain(spec.rail_a), chain(spec.rail_b)
    closed = [_is_closed(rail, tol) for rail in (a, b)]
    if closed[0] != closed[1]:
        return Built((), findings=(Finding("open-and-closed", "one rail is open and the other is closed", True),))
    doubled = [*_doubled(a.curves, "a"), *_doubled(b.curves, "b")]
    if doubled:
        return Built((), findings=tuple(doubled))
    fold = ANY_FOLD if spec.folds == "allow" else float(np.radians(float(spec.max_warp)))
    found = None
    if spec.min_radius > 0:
        found = best_strip(a.curves, b.curves, Rules(fold, cones=False), closed=closed[0])
    found = found or best_strip(a.curves, b.curves, Rules(fold), closed=closed[0])
    if found is None:
        return Built((), findings=(_refusal(a.curves, b.curves, closed=closed[0]),))
    made = pieces(found)
    patches = tuple(piece.patch for piece in made)
    findings = (*_folds(patches), *_smaller(patches, a.curves, b.curves, closed=closed[0]), *_apexes(made))
    findings = (*findings, *_unsettled(found), *_too_sharp(made, spec))
    return Built(patches, findings=findings, detail={"pieces": rows(found, made)})


def best_strip(rail_a: Rail, rail_b: Rail, rules: Rules, *, closed: bool) -> Strip | None:
    """Return a strip without folds if there is one, else the best that the rules allow."""
    search = closed_strip if closed else open_strip
    smooth = search(rail_a, rail_b, replace(rules, fold_rad=0.0))
    return search(rail_a, rail_b, rules) if smooth is None and rules.fold_rad > 0.0 else smooth


def _doubled(rail: Rail, name: str) -> Iterator[Finding]:
    """Yield what is wrong with a rail that runs along a straight line and back without a corner between."""
    found = ((number, hairpin(piece)) for number, piece in enumerate(rail))
    for number, turn in found:
        if turn is None:
            continue
        at = number + turn.v
        message = (
            f"rail {name} turns back at {name} = {at:.3g}, within {turn.off_mm:.3g} mm of a straight line of "
            f"{turn.long_mm:.6g} mm: it has no width, and no tangent there; give it as a polyline there and back"
        )
        yield Finding("rail-doubled", message, True, {name: at})


def _is_closed(rail: Chain, tol: Tolerances) -> bool:
    first, last = ends(rail.curves[0])[0], ends(rail.curves[-1])[1]
    return float(norm(first - last)) <= tol.join_mm


def _refusal(rail_a: Rail, rail_b: Rail, *, closed: bool) -> Finding:
    """Return why there is no strip: the fold that none avoids, its place, and what would help."""
    folded = best_strip(rail_a, rail_b, Rules(ANY_FOLD), closed=closed)
    least = f"; with folds the best strip has {_described(folded, closed=closed)}" if folded is not None else ""
    coarse, fine = (closed_bounds if closed else bounds)(rail_a, rail_b)
    if fine.fold_rad > 0.0:
        bound = f"every strip folds by at least {np.degrees(fine.fold_rad):.6g} deg somewhere"
        check = f"(lower bound; {np.degrees(coarse.fold_rad):.6g} deg on half the lattice)"
    else:
        bound, check = "none was found", "(no lower bound on its folds is known)"
    help_ = _help(fine, rail_a, rail_b, closed=closed)
    message = f"no tangent-continuous strip: {bound} {check}{least}; {help_}"
    return Finding("no-smooth-strip", message, True, {"a": fine.t, "b": fine.s})


def _help(at: Bound, rail_a: Rail, rail_b: Rail, *, closed: bool) -> str:
    """Return what would help: open rails can be cut elsewhere, closed ones rounded or reshaped, skew lines folded."""
    folds = 'set folds = "allow"'
    if _is_straight(rail_a) and _is_straight(rail_b):
        return (
            f"no part of two skew straight lines has a smooth strip: {folds} for two plane triangles along a diagonal"
        )
    if closed:
        corners = [name for name, rail, x in (("a", rail_a, at.t), ("b", rail_b, at.s)) if _has_corner(rail, x)]
        what = f"round the corners of rail {' or '.join(corners)}, as" if corners else "make the rails turn alike"
        return f"{what} at a = {at.t:.3g}, b = {at.s:.3g}, or {folds}"
    return f"trim or extend the rails at {_place(at.t, at.s, len(rail_a), len(rail_b))}, or {folds}"


def _has_corner(rail: Rail, x: float) -> bool:
    """Return whether a closed rail turns sharply at a parameter."""
    if x != round(x):
        return False
    number = round(x) % len(rail)
    before, after = (rail[k].jet(np.array([v]), 1)[1, 0] for k, v in ((number - 1, 1.0), (number, 0.0)))
    return float(angles(before, after)) > SMOOTH


def _is_straight(rail: Rail) -> bool:
    """Return whether the tangents of a rail all look one way, but for rounding."""
    v = np.linspace(0.0, 1.0, TANGENTS)
    tangents = np.concatenate([unit(piece.jet(v, 1)[1]) for piece in rail])
    return float(norm(tangents - tangents[0]).max()) <= ONE_WAY


TANGENTS = 9
"""To a piece: a cubic's are the same at three places only if they are everywhere."""
ONE_WAY = 1e-12
"""Of a unit vector: some thousand roundings, and a micrometre of lift per thousand kilometres."""


def _described(strip: Strip, *, closed: bool) -> str:
    """Return number and size of the folds of a strip, that between its ends aside."""
    patches = tuple(piece.patch for piece in pieces(strip))
    found = _fold_angles(patches)
    count = f"{len(found)} fold{'s' * (len(found) > 1)}, the largest {max(found):.6g} deg" if found else ""
    seam = _fold_angles((patches[-1], patches[0])) if closed else []
    at_seam = f"{seam[0]:.6g} deg at its seam" if seam else ""
    return ", and ".join(part for part in (count, at_seam) if part) or "none to be measured"


def _fold_angles(patches: tuple[RuledPatch, ...]) -> list[float]:
    folds = [float(np.degrees(join(a, b).normal_rad)) for a, b in pairwise(patches)]
    return [fold for fold in folds if fold > STILL_SMOOTH_DEG]


def _place(t: float, s: float, most_t: int, most_s: int) -> str:
    """Return the place of a ruling in words."""
    if min(t, s) <= 0.0:
        return f"their beginning (a = {t:.3g}, b = {s:.3g})"
    if t >= most_t or s >= most_s:
        return f"their end (a = {t:.3g}, b = {s:.3g})"
    return f"a = {t:.3g}, b = {s:.3g}"


def _folds(patches: tuple[RuledPatch, ...]) -> tuple[Finding, ...]:
    found = _fold_angles(patches)
    if not found:
        return ()
    message = f"the strip folds along {len(found)} ruling{'s' * (len(found) > 1)}, by at most {max(found):.6g} deg"
    return (Finding("folds", message),)


def _unsettled(strip: Strip) -> tuple[Finding, ...]:
    """Say that the search for the least folds ended before they had settled, and what it had come to."""
    if strip.unsettled_rad == 0.0:
        return ()
    change = np.degrees(strip.unsettled_rad)
    message = (
        f"the search for the least folds ended after {ROUNDS} ever finer lattices, the last of which changed them by "
        f"{change:.3g} deg: they are as stated, and may not be the least"
    )
    return (Finding("folds-unsettled", message, where={"change_deg": float(change)}),)


def _smaller(patches: tuple[RuledPatch, ...], rail_a: Rail, rail_b: Rail, *, closed: bool) -> tuple[Finding, ...]:
    """Say how more folds would each be far smaller, and which key takes them."""
    largest = max(_fold_angles(patches), default=0.0)
    least = (closed_bounds if closed else bounds)(rail_a, rail_b)[-1].fold_rad if largest > 0.0 else 0.0
    if least == 0.0 or largest <= FAR_LARGER * np.degrees(least):
        return ()
    more = best_strip(rail_a, rail_b, Rules(MORE_FOLDS * least), closed=closed)
    if more is None:
        return ()
    most = np.ceil(MORE_FOLDS * np.degrees(least) * 1e3) / 1e3
    message = f'another strip has {_described(more, closed=closed)}: set folds = "forbid" and max_warp = {most:g}'
    return (Finding("smaller-folds", message),)


FAR_LARGER = 5.0
"""So many times what no strip avoids is a fold that several smaller ones may replace."""
MORE_FOLDS = 2.0
"""How many times what no strip avoids the largest of several folds may be."""


def _apexes(made: tuple[Piece, ...]) -> tuple[Finding, ...]:
    """Say where cones bend infinitely sharply; plane triangles do not."""
    bent = [i for i, piece in enumerate(made) if piece.kind == "cone"]
    if not bent:
        return ()
    message = f"{len(bent)} of {len(made)} pieces are cones with their apex on a rail, where they bend to nothing"
    return (Finding("apex-on-rail", message, where={"v": bent[0]}),)


def _too_sharp(made: tuple[Piece, ...], spec: Rails) -> tuple[Finding, ...]:
    """Refuse a strip that bends more sharply than `min_radius`."""
    least = float(spec.min_radius)
    if least == 0.0:
        return ()
    for i, piece in enumerate(made):
        if piece.kind == "cone":
            message = (
                f"the best strip has a cone with its apex on a rail, which bends to nothing; min_radius is {least:g} mm"
            )
            return (Finding("min-radius", message, True, {"v": i}),)
        for u in (0.0, 1.0):
            sharpest, v = maximum(partial(_bend, piece.patch, u))
            if sharpest > 1.0 / least:
                message = f"the strip bends to a radius of {1.0 / sharpest:.4g} mm, min_radius is {least:g} mm"
                return (Finding("min-radius", message, True, {"v": i + v, "u": u}),)
    return ()


def _bend(patch: RuledPatch, u: float, v: Values) -> Values:
    bend: Values = np.abs(curvature(patch, v, u))
    return bend
