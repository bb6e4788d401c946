"""Numbers as people read them on pages and in lines: to what a tape or a protractor shows."""

FINE_MM = 100.0
"""Below this two decimals of a mm are written, above one: a calliper's and a tape's."""

DASH = "\N{EN DASH}"
GRAMS = 1000.0
SQUARE_M = 1e6
SQUARE_MM = "mm\N{SUPERSCRIPT TWO}"


def millimetres(value: float | None, unit: str = "") -> str:
    """Return a length; a dash where there is none."""
    if value is None:
        return DASH
    text = f"{value:.2f}" if abs(value) < FINE_MM else f"{value:.1f}"
    text = text.replace("-0.00", "0.00") if text == "-0.00" else text
    return f"{text} {unit}".rstrip()


def degrees(value: float | None) -> str:
    """Return an angle in degrees; a dash where there is none."""
    text = DASH if value is None else f"{value:.1f}"
    return "0.0" if text == "-0.0" else text


def kilograms(value: float | None) -> str:
    """Return a mass: grams where it is less than a kilogram."""
    if value is None:
        return "not known"
    return f"{GRAMS * value:.3g} g" if value < 1.0 else f"{value:.3f} kg"


def square(value: float) -> str:
    """Return an area in mm2, or m2 where it is large."""
    return f"{value / SQUARE_M:.4f} m\N{SUPERSCRIPT TWO}" if value >= SQUARE_M / 10.0 else f"{value:.1f} {SQUARE_MM}"


def plain(value: float | bool | None, unit: str = "") -> str:
    """Return the value of a metric to four digits."""
    if value is None or isinstance(value, bool):
        return {None: "not defined", True: "yes", False: "no"}[value]
    return f"{value:.4g} {unit.replace('mm2', SQUARE_MM)}".rstrip()


def counted(count: int | None, thing: str) -> str:
    """Return how many there are of a thing, as far as it is known."""
    if count is None:
        return f"{thing}s not known"
    return f"{count} {thing}" if count == 1 else f"{count} {thing}s"


def share(value: float) -> str:
    """Return a share in percent."""
    return f"{100.0 * value:.1f} %"
