"""Random geometry for property tests: exact motions, scales, curves, patches, and specifications of every kind."""

from collections.abc import Sequence
from fractions import Fraction

from hypothesis import strategies as st

from stages.geometry.curves.curves import Curve, affine
from stages.geometry.ruled.ruled import RuledPatch, between
from tests.parts import Table, aumann

Rows = tuple[tuple[Fraction, ...], ...]
Motion = tuple[Rows, tuple[Fraction, ...]]
"""A matrix and a shift."""


def decimals(low: float, high: float, places: int = 3) -> st.SearchStrategy[Fraction]:
    """Return decimals as people type them: so many places, no more."""
    unit = 10**places
    return st.integers(round(low * unit), round(high * unit)).map(lambda n: Fraction(n, unit))


def points(low: float = -10.0, high: float = 10.0) -> st.SearchStrategy[tuple[Fraction, Fraction, Fraction]]:
    return st.tuples(*[decimals(low, high)] * 3)


def different_points(count: int) -> st.SearchStrategy[list[tuple[Fraction, ...]]]:
    return st.lists(points(), min_size=count, max_size=count, unique=True)


def directions() -> st.SearchStrategy[tuple[Fraction, Fraction, Fraction]]:
    return st.tuples(*[decimals(-1, 1, 2)] * 3).filter(any)


def rotation(q: Sequence[int]) -> Rows:
    """Return the rotation of a quaternion of whole numbers: rational entries, orthogonal without rounding."""
    w, x, y, z = (Fraction(n) for n in q)
    n = w * w + x * x + y * y + z * z
    rows = (
        (w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z),
    )
    return tuple(tuple(entry / n for entry in row) for row in rows)


def motions() -> st.SearchStrategy[Motion]:
    """Return rigid motions with rational entries: they move exact control points exactly."""
    quaternions = st.tuples(*[st.integers(-9, 9)] * 4).filter(any)
    return st.tuples(quaternions.map(rotation), points(-1000, 1000))


def scales() -> st.SearchStrategy[Fraction]:
    """Return factors that take a part of a few mm to 1 mm or to 10 m."""
    return st.sampled_from([Fraction(1, 4), Fraction(1, 3), Fraction(7), Fraction(1000), Fraction(2500)])


def moved(patch: RuledPatch, motion: Motion) -> RuledPatch:
    """Return the patch after a motion (or any affine map)."""
    return between(_image(patch.c0, motion), _image(patch.c1, motion))


def _image(curve: Curve, motion: Motion) -> Curve:
    return affine(curve, *motion)


def scaled(patch: RuledPatch, factor: Fraction) -> RuledPatch:
    zero = Fraction(0)
    return moved(patch, (((factor, zero, zero), (zero, factor, zero), (zero, zero, factor)), (zero, zero, zero)))


def texts(values: Sequence[Fraction]) -> list[str]:
    """Return exact numbers as a job file may hold them."""
    return [str(value) for value in values]


ENDS = ("0", "1", "0_hat", "1_hat")


def end_data(keys: Sequence[str]) -> st.SearchStrategy[Table]:
    """Return tangents, normals, curvatures and positive shape parameters of the ends with these suffixes."""
    entries: dict[str, st.SearchStrategy[object]] = {}
    for key in keys:
        entries |= {
            f"t{key}": directions().map(texts),
            f"n{key}": directions().map(texts),
            f"k{key}": decimals(-0.5, 0.5, 2).map(str),
            f"alpha{key}": decimals(0.1, 9, 2).map(str),
            f"beta{key}": decimals(-9, 9, 2).map(str),
        }
    return st.fixed_dictionaries(entries)


def corner_data(names: Sequence[str]) -> st.SearchStrategy[Table]:
    return different_points(len(names)).map(lambda rows: dict(zip(names, map(texts, rows), strict=True)))


def _merged(*strategies: st.SearchStrategy[Table]) -> st.SearchStrategy[Table]:
    return st.tuples(*strategies).map(lambda tables: {key: value for table in tables for key, value in table.items()})


def quintic_ruled() -> st.SearchStrategy[Table]:
    return _merged(st.just({"kind": "quintic-ruled"}), corner_data(("p0", "p1", "q0", "q1")), end_data(ENDS))


def quintic_planar() -> st.SearchStrategy[Table]:
    shapes = end_data(ENDS).map(lambda table: {k: v for k, v in table.items() if k.startswith(("alpha", "beta"))})
    return _merged(st.just({"kind": "quintic-planar"}), corner_data(("p0", "p1", "q0", "q1")), shapes)


def quintic_cylinder() -> st.SearchStrategy[Table]:
    shares = st.fixed_dictionaries({key: decimals(0.1, 3, 2).map(str) for key in ("s0", "s1", "g")})
    ends = end_data(("0", "1")).map(lambda table: {k: v for k, v in table.items() if not k.startswith("beta")})
    return _merged(st.just({"kind": "quintic-cylinder"}), corner_data(("p0", "p1", "q0")), ends, shares)


def quintic_cone(*, given: bool) -> st.SearchStrategy[Table]:
    """Return cones over quintics, shape parameters given or to be found."""

    def fitted(table: Table) -> Table:
        made = {k: str(abs(Fraction(str(v))) + Fraction(1, 100)) if k.startswith("beta") else v
                for k, v in table.items()}  # fmt: skip
        return made if given else {k: v for k, v in made.items() if not k.startswith(("alpha", "beta"))}

    fraction = st.sampled_from([["0", "1"], ["0", "0.5"], ["0.25", "0.9"]]).map(lambda f: {"fraction": f})
    corners = corner_data(("p0", "p1", "apex"))
    return _merged(st.just({"kind": "quintic-cone"}), corners, end_data(("0", "1")).map(fitted), fraction)


def quintic_strip() -> st.SearchStrategy[Table]:
    def joined(first: Table, end: Table, point: list[str]) -> Table:
        following = {k: v for k, v in end.items() if k != "beta1"} | {"p1": point, "s1": "0.5", "g": "1.5"}
        return {"kind": "quintic-strip", "first": first, "next": [following]}

    return st.builds(joined, quintic_cylinder(), end_data(("1",)), points().map(texts))


def curves() -> st.SearchStrategy[Table]:
    """Return curve tables of every sort but files."""
    rows = different_points(4).map(lambda found: [texts(row) for row in found])
    radius = decimals(0.5, 9, 2).map(str)
    centre = points().map(texts)
    spline = st.builds(
        lambda found, weights: {"degree": 2, "knots": [0, 0, 0, 1, 2, 2, 2], "points": found, "weights": weights},
        rows,
        st.one_of(st.none(), st.lists(decimals(0.2, 4, 1).map(str), min_size=4, max_size=4)),
    )
    arc = st.fixed_dictionaries(
        {"center": centre, "radius": radius, "normal": directions().map(texts),
         "start": st.integers(0, 90).map(str), "end": st.integers(91, 400).map(str)}
    )  # fmt: skip
    ellipse = st.fixed_dictionaries(
        {"center": centre, "major": directions().map(texts), "minor": directions().map(texts)}
    )
    helix = st.fixed_dictionaries({"radius": radius, "pitch": radius, "turns": decimals(0.1, 1.5, 1).map(str)})
    return st.one_of(
        rows.map(lambda found: {"bezier": found}),
        spline.map(lambda table: {"bspline": {k: v for k, v in table.items() if v is not None}}),
        rows.map(lambda found: {"points": found}),
        rows.map(lambda found: {"polyline": found}),
        rows.map(lambda found: {"line": found[:2]}),
        arc.filter(lambda table: int(table["end"]) - int(table["start"]) <= 360).map(lambda table: {"arc": table}),
        st.fixed_dictionaries({"center": centre, "radius": radius}).map(lambda table: {"circle": table}),
        ellipse.map(lambda table: {"ellipse": table}),
        helix.map(lambda table: {"helix": table}),
        rows.map(lambda found: {"chain": [{"line": found[:2]}, {"bezier": found[1:]}]}),
    )


def ruled() -> st.SearchStrategy[Table]:
    pairs = st.tuples(curves(), curves()).filter(lambda pair: pair[0] != pair[1])
    return pairs.map(lambda pair: {"kind": "ruled", "c0": pair[0], "c1": pair[1]})


def aumann_pairs() -> st.SearchStrategy[Table]:
    """Return developable Bezier pairs, their edge of regression anywhere."""
    shares = st.sampled_from(["1.8", "2.3", "0.5", "1", "0", "-1", "-0.25", "3"])
    return st.builds(aumann, different_points(4).map(list), points(), shares, shares.filter(lambda mu: mu != "0"))


def bezier_pairs() -> st.SearchStrategy[Table]:
    """Return pairs of any degree by their keys, most with the edge of regression outside."""
    shares = st.sampled_from(["1.8", "2.3", "1", "0", "-1", "-0.25", "0.5"])
    return st.builds(
        lambda rows, first, lam, mu, elevate: {
            "kind": "bezier-pair", "points": [texts(row) for row in rows], "first": texts(first), "lambda": lam,
            "mu": mu, "elevate": elevate,
        },
        st.integers(2, 6).flatmap(different_points), points(), shares, shares, st.integers(0, 2),
    )  # fmt: skip


def tangents() -> st.SearchStrategy[Table]:
    reach = st.sampled_from([("0", "3"), ("0.5", "2"), ("-4", "-1"), ("20", "10")])
    return st.builds(
        lambda edge, distances: {"kind": "tangent", "edge": edge, "from": distances[0], "to": distances[1]},
        curves(), reach,
    )  # fmt: skip


def slopes() -> st.SearchStrategy[Table]:
    """Return slopes over any curve, half of them over level ones."""
    level = st.builds(
        lambda rows, key: {key: [[str(x), str(y), "3"] for x, y, _ in rows]},
        different_points(4), st.sampled_from(["bezier", "points", "polyline"]),
    )  # fmt: skip
    return st.builds(
        lambda curve, angle, side, length: {
            "kind": "slope", "curve": curve, "angle": str(angle), "side": side, "length": str(length),
        },
        st.one_of(level, curves()), st.integers(-90, 90), st.sampled_from(["in", "out"]), decimals(0.1, 9, 1),
    )  # fmt: skip


def cones() -> st.SearchStrategy[Table]:
    fraction = st.sampled_from([["0", "1"], ["0", "0.5"], ["0.25", "0.9"]])
    return st.builds(
        lambda curve, apex, share: {"kind": "cone", "apex": texts(apex), "directrix": curve, "fraction": share},
        curves(), points(), fraction,
    )  # fmt: skip


def frusta() -> st.SearchStrategy[Table]:
    size = decimals(0, 9, 1).map(str)
    return st.fixed_dictionaries(
        {"kind": st.just("cone"), "radius0": size, "radius1": size, "height": size,
         "sweep": st.integers(1, 360).map(str)}
    ).filter(
        lambda t: t["radius0"] != t["radius1"] or (t["height"] != "0" and t["radius0"] != "0")
    )  # fmt: skip


def cylinders() -> st.SearchStrategy[Table]:
    def cut(curve: Table, direction: list[str], point: list[str], normal: list[str], length: str | None) -> Table:
        end = {"length": length} if length else {"end_plane": {"point": point, "normal": normal}}
        return {"kind": "cylinder", "directrix": curve, "direction": direction} | end

    def meets(table: Table) -> bool:
        plane = table.get("end_plane")
        normal = plane["normal"] if isinstance(plane, dict) else ["1"] * 3
        direction = table["direction"]
        assert isinstance(direction, list)
        return plane is None or sum(Fraction(a) * Fraction(b) for a, b in zip(normal, direction, strict=True)) != 0

    size = st.one_of(st.none(), decimals(0.1, 9, 1).map(str))
    vectors = directions().map(texts)
    return st.builds(cut, curves(), vectors, points().map(texts), vectors, size).filter(meets)


def plates() -> st.SearchStrategy[Table]:
    """Return closed polygons, most of them crossing themselves or not planar."""
    level = st.one_of(st.just(["0"] * 5), st.lists(decimals(-1, 1, 1).map(str), min_size=5, max_size=5))
    flat = different_points(5)
    return st.builds(
        lambda rows, z: {
            "kind": "flat",
            "outline": {
                "polyline": [[str(r[0]), str(r[1]), h] for r, h in zip(rows, z, strict=True)]
                + [[str(rows[0][0]), str(rows[0][1]), z[0]]]
            },
        },
        flat.filter(lambda rows: len({(r[0], r[1]) for r in rows}) == 5), level,
    )  # fmt: skip


def surfaces() -> st.SearchStrategy[Table]:
    """Return a specification of any kind, developable or not."""
    return st.one_of(
        quintic_ruled(), quintic_planar(), quintic_cylinder(), quintic_cone(given=True), quintic_strip(), ruled(),
        aumann_pairs(), cones(), frusta(), cylinders(), plates(), bezier_pairs(), tangents(), slopes(),
    )  # fmt: skip
