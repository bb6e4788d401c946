"""compas_nest, either engine: `collision` or `nfp` is the argument.

A set of angles can be told only as so many equal steps of a turn: the most that are all allowed are told (on several
sheets the collision engine was seen to turn parts by others all the same, which the certifier then refuses).  The
collision engine fills copies of its first sheet whatever it is given, so it is asked for equal sheets only.  Strips are
filled by bisection on the width.
"""

import sys
from math import degrees

import wire
from compas.geometry import Polyline
from compas_nest import nest_geo, nest_sheets, opennest, opennest_collision

FREE_STEPS = {"collision": 360, "nfp": 24}
"""Angles where any is allowed; the second tries each of them, so it gets fewer."""


def main(engine: str) -> None:
    """Tell every layout found."""
    given = wire.task()
    try:
        if given["strip"] is not None:
            wire.narrowest(given, lambda width, seconds: on_strip(given, engine, width, seconds))
        elif engine == "collision" and len(given["beds"]) > 1:
            wire.say(unable="equal sheets only")
        else:
            on_beds(given, engine)
    except Exception as error:
        wire.say(error=f"{type(error).__name__}: {error}")


def on_strip(given: dict, engine: str, width: float, seconds: float) -> list[wire.Table]:
    """Return the copies placed on a strip of that width."""
    low_y, high_y, least_x = given["strip"]
    ring = [(least_x, low_y), (least_x + width, low_y), (least_x + width, high_y), (least_x, high_y)]
    bed = {"stock": "strip", "outer": ring, "blocked": []}
    return solved(given, engine, [(bed, 0)], seconds)


def on_beds(given: dict, engine: str) -> None:
    """Tell the layout on sheets."""
    beds = [(bed, number) for bed in given["beds"] for number in range(wire.sheets_enough(given, bed))]
    placed = solved(given, engine, beds, given["seconds"])
    if len(placed) < sum(one["count"] for one in given["parts"]):
        wire.say(error=f"{len(placed)} copies placed")
    else:
        wire.say(placed=placed)


def solved(given: dict, engine: str, beds: list[tuple[dict, int]], seconds: float) -> list[wire.Table]:
    """Return the copies that the engine placed."""
    parts, sheets = nest_geo(), nest_sheets()
    for one in given["parts"]:
        holes = [closed(hole) for hole in one["holes"]]
        parts.add_part(closed(one["outer"]), holes, one["count"], rotations=steps(one, engine))
    for bed, _ in beds:
        sheets.add_sheet(closed(bed["outer"]), [closed(hole) for hole in bed["blocked"]])
    with wire.quiet():
        result = solver(engine, given, seconds).solve(parts, sheets)
    return [copy(given, beds, result.sheet_origins, one) for one in result.placed]


def steps(part: dict, engine: str) -> int:
    """Return how many equal steps of a turn a part may take."""
    return FREE_STEPS[engine] if part["angles"] is None else wire.equal_steps(part["angles"])


def solver(engine: str, given: dict, seconds: float) -> opennest | opennest_collision:
    """Return the engine, as it comes but for gap, seed, time and the most steps that any part may take."""
    most = max(steps(one, engine) for one in given["parts"])
    common = {"spacing": given["gap_mm"], "seed": given["seed"], "time_budget_secs": seconds, "verbose": False}
    if engine == "nfp":
        return opennest(rotations=most, curve_tolerance=0.0, **common)
    return opennest_collision(num_rotations=most, fit_mode=0, **common)


def copy(given: dict, beds: list[tuple[dict, int]], origins: list[tuple[float, float]], one: dict) -> wire.Table:
    """Return one placed copy."""
    bed, number = beds[one["sheet_id"]]
    x, y = origins[one["sheet_id"]]
    part = given["parts"][one["part_index"]]["id"]
    return wire.spot(part, (bed["stock"], number), (one["tx"] + x, one["ty"] + y), degrees(one["angle"]))


def closed(ring: wire.Ring) -> Polyline:
    """Return a polygon as COMPAS wants it."""
    return Polyline([[x, y, 0.0] for x, y in [*ring, ring[0]]])


if __name__ == "__main__":
    main(sys.argv[1])
