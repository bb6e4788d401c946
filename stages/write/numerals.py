"""Numbers as SVG and PDF write them: in full, to the decimals of a DXF file, without an exponent (PDF has none)."""

from stages.geometry.arrays import Array
from stages.write.entities import DECIMALS, rounded


def numerals(values: Array) -> list[str]:
    """Return the numbers of an array, row by row, without zeros at their ends; ValueError where one is not finite."""
    return [f"{value:.{DECIMALS}f}".rstrip("0").rstrip(".") for value in rounded(values.ravel(), DECIMALS)]
