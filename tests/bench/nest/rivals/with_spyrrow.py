"""spyrrow: one call, as its documentation shows it; the number of workers is the argument.

Strips only; holes of parts are not told, for it knows none.  Its separation holds towards the edges of the strip as
well, so the strip is given higher by what the two gaps differ.
"""

import sys

import spyrrow
import wire


def main(workers: int) -> None:
    """Tell the one layout that the call returns."""
    given = wire.task()
    if given["strip"] is None:
        wire.say(unable="strips only")
        return
    try:
        wire.say(placed=layout(given, workers))
    except BaseException as error:  # a panic of the engine is no Exception
        wire.say(error=f"{type(error).__name__}: {error}")


def layout(given: dict, workers: int) -> list[wire.Table]:
    """Return where everything lies on the strip."""
    (low_y, high_y, least_x), gap = given["strip"], given["gap_mm"]
    items = [
        spyrrow.Item(one["id"], [(x, y) for x, y in one["outer"]], one["count"], one["angles"])
        for one in given["parts"]
    ]
    strip = spyrrow.StripPackingInstance("strip", high_y - low_y + 2.0 * gap, items)
    config = spyrrow.StripPackingConfig(
        early_termination=False,
        min_items_separation=gap or None,
        total_computation_time=max(1, round(given["seconds"])),
        num_workers=workers,
        seed=given["seed"],
    )
    dx, dy = least_x - gap, low_y - gap
    return [
        wire.spot(one.id, ("strip", 0), (one.translation[0] + dx, one.translation[1] + dy), one.rotation)
        for one in strip.solve(config).placed_items
    ]


if __name__ == "__main__":
    main(int(sys.argv[1]))
