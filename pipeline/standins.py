"""Values that take the place of wrong ones, so that the rules of a table can still be asked about the right ones.

A stand-in keeps the rules that its table has: lengths are positive and large, no two are equal, angles are small,
curvatures are 0.  No stand-in leaves the decoder: one complaint anywhere and there is no job.
"""

from fractions import Fraction

from msgspec import inspect

from stages.model.scalars import Angle, Coordinate, Curvature, Length, Number, coordinate

LARGE_MM = 10**6
"""Larger than any gap or edge that is held against a sheet."""
SMALL_DEG = Angle("0.001")


def stand_in(sort: inspect.Type, serial: int) -> object:
    """Return a value of that type; different for different serial numbers where the type has enough values."""
    match sort:
        case inspect.CustomType():
            return _quantity(sort.cls, serial)
        case inspect.UnionType():
            members = [item for item in sort.types if not isinstance(item, inspect.NoneType)]
            return stand_in(members[0], serial)
        case inspect.StructType():
            required = [entry for entry in sort.fields if entry.required]
            return sort.cls(**{entry.name: stand_in(entry.type, 31 * serial + i) for i, entry in enumerate(required)})
        case inspect.TupleType():
            return tuple(stand_in(item, 31 * serial + i) for i, item in enumerate(sort.item_types))
        case inspect.VarTupleType():
            return tuple(stand_in(sort.item_type, 31 * serial + i) for i in range(sort.min_length or 0))
        case inspect.LiteralType():
            return sort.values[0]
        case inspect.StrType():
            return f"stand-in {serial}"
        case inspect.IntType():
            return sort.ge or 1
        case _:
            return False


def _quantity(sort: type, serial: int) -> object:
    if sort is Length:
        return Length(LARGE_MM + serial)
    if sort is Coordinate:
        # as a u or v it is on the surface
        return coordinate(Fraction(LARGE_MM + serial), Fraction(1, 2 + serial))
    if sort is Curvature:
        return Curvature(0)
    return SMALL_DEG * (1 + serial) if sort is Angle else Number(1 + serial)
