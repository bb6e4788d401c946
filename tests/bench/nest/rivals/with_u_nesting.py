"""u-nesting, strategy alns: the best of its searches on the strips tried.

It wants a list of angles: parts that may be turned freely get steps of 15 degrees.  Equal sheets without holes only.
Strips are filled by bisection on the width.
"""

from math import degrees

import u_nesting
import wire

FREE = [15.0 * k for k in range(24)]


def main() -> None:
    """Tell every layout found."""
    given = wire.task()
    try:
        if given["strip"] is not None:
            wire.narrowest(given, lambda width, seconds: on_strip(given, width, seconds))
        elif len(given["beds"]) > 1 or given["beds"][0]["blocked"]:
            wire.say(unable="equal sheets without holes only")
        else:
            on_beds(given)
    except BaseException as error:  # a panic of the engine is no Exception
        wire.say(error=f"{type(error).__name__}: {error}")


def on_strip(given: dict, width: float, seconds: float) -> list[wire.Table]:
    """Return the copies placed on a strip of that width."""
    low_y, high_y, least_x = given["strip"]
    result = solved(given, {"width": width, "height": high_y - low_y}, seconds, many=False)
    return [copy(one, "strip", least_x, low_y) for one in result["placements"]]


def on_beds(given: dict) -> None:
    """Tell the layout on sheets."""
    bed = given["beds"][0]
    x, y = (min(corner[k] for corner in bed["outer"]) for k in range(2))
    ring = [[a - x, b - y] for a, b in bed["outer"]]
    result = solved(given, {"polygon": ring}, given["seconds"], many=True)
    if not result["all_placed"]:
        wire.say(error=f"{len(result['placements'])} copies placed")
    else:
        wire.say(placed=[copy(one, bed["stock"], x, y) for one in result["placements"]])


def solved(given: dict, boundary: dict, seconds: float, *, many: bool) -> dict:
    """Return what the engine says; a refusal is an error."""
    parts = [
        {
            "id": one["id"],
            "polygon": one["outer"],
            "holes": one["holes"],
            "quantity": one["count"],
            "rotations": FREE if one["angles"] is None else one["angles"],
        }
        for one in given["parts"]
    ]
    config = {
        "strategy": "alns",
        "spacing": given["gap_mm"],
        "time_limit_ms": round(1000.0 * seconds),
        "seed": given["seed"],
        "multi_sheet": many,
    }
    with wire.quiet():
        result = u_nesting.solve_2d(parts, boundary, config)
    if not result["success"]:
        raise ValueError(result["error"])
    return result


def copy(one: dict, stock: str, x: float, y: float) -> wire.Table:
    """Return one placed copy."""
    at = one["position"][0] + x, one["position"][1] + y
    return wire.spot(one["geometry_id"], (stock, one["boundary_index"]), at, degrees(one["rotation"][0]))


if __name__ == "__main__":
    main()
