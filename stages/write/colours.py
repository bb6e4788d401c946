"""Colours of layers outside of DXF: AutoCAD's colour index as red, green, blue.

Pictures for screens and machines have the very colour, since cutting programs tell cuts from marks by it; on paper it
is darkened as far as a line needs to be seen on white, its hue kept.  White, which AutoCAD shows on black, is black.
"""

from ezdxf.colors import aci2rgb

Colour = tuple[int, int, int]

FULL = 255
BLACK: Colour = (0, 0, 0)
WEIGHTS = 0.2126, 0.7152, 0.0722
"""How bright red, green and blue look (ITU-R BT.709)."""

BRIGHTEST_ON_PAPER = 0.45
"""Of the brightness of white: what is above is hard to see as a thin line, as yellow (0.93) and cyan (0.79) are."""


def rgb(index: int) -> Colour:
    """Return the colour of an index, white as black."""
    red, green, blue = aci2rgb(index)
    return BLACK if (red, green, blue) == (FULL, FULL, FULL) else (int(red), int(green), int(blue))


def on_paper(index: int) -> Colour:
    """Return the colour of an index, darkened until it can be seen on white paper."""
    colour = rgb(index)
    share = sum(weight * part for weight, part in zip(WEIGHTS, colour, strict=True)) / FULL
    dim = min(1.0, BRIGHTEST_ON_PAPER / share) if share > 0.0 else 1.0
    red, green, blue = (round(dim * part) for part in colour)
    return red, green, blue


def web(colour: Colour) -> str:
    """Return a colour as SVG writes it: #rrggbb."""
    return "#{:02x}{:02x}{:02x}".format(*colour)
