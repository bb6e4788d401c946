"""A job of many parts, no two alike, in families as the samples have them: for the report at size.

Frustums and sectors of cones with a roll schedule, oblique cones, mitred pipes with bend lines, plates with bolt holes.
"""

from collections.abc import Callable, Iterator

HEAD = """\
schema = 1
[job]
name = "many"
[material]
name = "mild steel"
thickness = 2
[report]
formats = [{formats}]
"""
HOLES = 8
"""In every plate, beside the one in its middle."""


def job_text(count: int, formats: str = '"json"') -> str:
    """Return a job file of so many different parts, without stock."""
    return "".join([HEAD.format(formats=formats), *(_part(number, count) for number in range(count))])


def _part(number: int, count: int) -> str:
    family = FAMILIES[number % len(FAMILIES)]
    size = 1.0 + number / count
    name, lines = family(size)
    return f'[[part]]\nname = "{name}-{number:04d}"\nquantity = {1 + number % 7}\n' + "\n".join(lines) + "\n"


Family = tuple[str, Iterator[str]]


def _frustum(size: float) -> Family:
    return "frustum", iter((
        "[[part.mark]]", 'kind = "rulings"', "max_angle = 15", "[part.surface]", 'kind = "cone"',
        f"radius0 = {200.0 * size}", f"radius1 = {90.0 * size}", "height = 260",
    ))  # fmt: skip


def _sector(size: float) -> Family:
    return "sector", iter((
        "[[part.bend]]", "max_angle = 10", "[part.surface]", 'kind = "cone"',
        f"radius0 = {120.0 * size}", "radius1 = 60", "height = 150", f"sweep = {100.0 + 40.0 * size}",
    ))  # fmt: skip


def _oblique(size: float) -> Family:
    return "oblique", iter((
        "[part.surface]", 'kind = "cone"',
        f"directrix = {{ circle = {{ center = [0, 0, 0], radius = {100.0 * size} }} }}",
        "apex = [75, 0, 350]", "fraction = [0, 0.5]",
    ))  # fmt: skip


def _pipe(size: float) -> Family:
    return "pipe", iter((
        "[[part.bend]]", "max_angle = 12", "[part.surface]", 'kind = "cylinder"',
        f"directrix = {{ circle = {{ center = [0, 0, 0], radius = {60.0 * size} }} }}",
        "direction = [0, 0, 1]", f"end_plane = {{ point = [0, 0, {180.0 * size}], normal = [-0.4, 0, 1] }}",
    ))  # fmt: skip


def _plate(size: float) -> Family:
    wide, high = 160.0 * size, 90.0
    bolts = (
        f"{{ circle = {{ center = [{wide * (i + 1) / (HOLES + 1)}, 12], radius = {2.0 + size} }} }}"
        for i in range(HOLES)
    )
    return "plate", iter((
        "[part.surface]", 'kind = "flat"',
        f"outline = {{ polyline = [[0, 0], [{wide}, 0], [{wide}, {high}], [20, {high}], [0, 60], [0, 0]] }}",
        f"holes = [{{ circle = {{ center = [{wide / 2.0}, 50], radius = {14.0 * size} }} }}, {', '.join(bolts)}]",
    ))  # fmt: skip


FAMILIES: tuple[Callable[[float], Family], ...] = (_frustum, _sector, _oblique, _pipe, _plate)
