"""Job files with something wrong, and the lines that say so."""

from pipeline.kinds import kind_names
from tests.pipeline.jobs import CONE, PLATE, STOCK

CYLINDER = """\
schema = 1
[[part]]
name = "shell"
  [part.surface]
  kind = "quintic-cylinder"
  p0 = [0, 0, 0]
  q0 = [0, 0, 80]
  p1 = [120, 0, 0]
  t0 = [0.6, 0.8, 0]
  t1 = [0.6, -0.8, 0]
  n0 = [0.8, -0.6, 0]
  n1 = [-0.8, -0.6, 0]
  k0 = 0.005
  k1 = "1/200 1/mm"
  alpha0 = 120
  alpha1 = 120
  s0 = 1
  s1 = 1
  g = 1
"""


def replaced(*pairs: tuple[str, str], text: str = CYLINDER) -> str:
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new, 1)
    return text


ALL_KINDS = ", ".join(f'"{name}"' for name in kind_names())
VECTOR = "an array of 3 numbers is needed"
LENGTH = 'a length such as 12.5, "12.5 mm" or "1/8 in"'
BAD: dict[str, tuple[str, list[str]]] = {
    "a missing key": (
        replaced(("  p1 = [120, 0, 0]\n", "")),
        ["job.toml:4:3: part[0].surface.p1: missing (an array of 3 lengths is needed)"],
    ),
    "an unknown key": (
        replaced(("  g = 1\n", "  g = 1\n  alhpa0 = 1\n")),
        ['job.toml:20:3: part[0].surface.alhpa0: unknown key (did you mean "alpha0"?)'],
    ),
    "a wrong type": (
        replaced(("alpha0 = 120", "alpha0 = true"), ("t0 = [0.6, 0.8, 0]", "t0 = [0.6, 0.8]")),
        [
            f"job.toml:9:8: part[0].surface.t0: an array of 2 does not fit ({VECTOR})",
            f"job.toml:15:12: part[0].surface.alpha0: true where a length belongs ({LENGTH})",
        ],
    ),
    "numbers that are not finite": (
        replaced(("[0, 0, 80]", "[0, nan, inf]")),
        [
            f"job.toml:7:12: part[0].surface.q0[1]: nan is not a finite number ({LENGTH})",
            f"job.toml:7:17: part[0].surface.q0[2]: inf is not a finite number ({LENGTH})",
        ],
    ),
    "a tangent of length zero, and another error in the same table": (
        replaced(("[0.6, -0.8, 0]", "[0, 0, 0]"), ("  g = 1\n", "")),
        [
            "job.toml:4:3: part[0].surface.g: missing (a number is needed)",
            "job.toml:10:8: part[0].surface.t1: the tangent has length 0 (give the direction of the curve at this end)",
        ],
    ),
    "points that coincide": (
        replaced(("[120, 0, 0]", "[0, 0, 0]")),
        ["job.toml:8:8: part[0].surface.p1: p1 is the same point as p0 (the two ends must differ)"],
    ),
    "a negative thickness": (
        CYLINDER + "[material]\nthickness = -2\n",
        ["job.toml:21:13: material.thickness: -2 (must be above 0)"],
    ),
    "an empty part list": (
        "schema = 1\npart = []\n",
        ["job.toml:2:8: part: an array of 0 (an array of 1 to 10000 tables is needed)"],
    ),
    "no part and no schema": (
        "",
        [
            "job.toml:1:1: schema: missing (schema = 1 is needed)",
            "job.toml:1:1: part: missing (an array of 1 to 10000 tables is needed; in TOML write [[part]] over each)",
        ],
    ),
    "duplicate names, upper and lower case alike, beside an error in another part": (
        replaced(("g = 1", "g = 0")) + PLATE[PLATE.index("[[part]]") :].replace('"plate"', '"SHELL"'),
        [
            "job.toml:19:7: part[0].surface.g: 0 (must be above 0)",
            'job.toml:21:8: part[1].name: "SHELL" is taken (upper and lower case count as the same)',
        ],
    ),
    "a name that a blank may take": (
        PLATE
        + CONE.replace('name = "cone"', 'name = "hood"\ncut = "auto"')
        + CONE.replace('name = "cone"', 'name = "Hood.2"'),
        [
            'job.toml:18:8: part[2].name: "Hood.2" may be a blank of "hood" '
            "(choose a name that does not end in a dot and a number)"
        ],
    ),
    "a plate to be divided": (
        PLATE.replace('"plate"', '"plate"\ncut = "auto"'),
        ['job.toml:6:7: part[0].cut: a plate has no rulings to be divided along (leave it out, or write "none")'],
    ),
    "duplicate stock": (
        PLATE + STOCK + STOCK,
        ['job.toml:15:6: stock[1].id: "sheet" is taken (upper and lower case count as the same)'],
    ),
    "a wrong kind": (
        replaced(('"quintic-cylinder"', '"quintic-zylinder"')),
        ['job.toml:5:10: part[0].surface.kind: unknown kind "quintic-zylinder" (did you mean "quintic-cylinder"?)'],
    ),
    "no kind": (
        replaced(('  kind = "quintic-cylinder"\n', "")),
        [
            f"job.toml:4:3: part[0].surface.kind: missing (one of {ALL_KINDS})",
        ],
    ),
    "a kind that is no text": (
        replaced(('kind = "quintic-cylinder"', "kind = 3")),
        [
            f"job.toml:5:10: part[0].surface.kind: unknown kind 3 (one of {ALL_KINDS})",
        ],
    ),
    "wrong words and ranges": (
        replaced(("schema = 1", 'schema = 2\nunits = "inch"'), ('name = "shell"', 'name = ""\nquantity = 0')),
        [
            "job.toml:1:10: schema: 2 is not allowed (only 1)",
            'job.toml:2:9: units: "inch" is not allowed (did you mean "in"?)',
            'job.toml:4:8: part[0].name: "" is out of range (a text from 1 to 80 characters is needed)',
            "job.toml:5:12: part[0].quantity: 0 is out of range (a whole number from 1 to 100000 is needed)",
        ],
    ),
    "control characters": (
        replaced(('"shell"', '"a\\u001bb"')),
        ['job.toml:3:8: part[0].name: "a?b" holds a control character (write plain text on one line)'],
    ),
    "a table where a value belongs, and the other way round": (
        "schema = 1\nmaterial = 3\n[units]\n[[part]]\nname = []\nsurface = 3\n",
        [
            "job.toml:2:12: material: 3 where a table belongs "
            "(a table with the keys name, thickness, density, bend_radius_min, max_strain, k_factor, yield_strength, "
            "youngs_modulus, grain)",
            'job.toml:3:1: units: a table is not allowed (one of "cm", "in", "m", "mm")',
            "job.toml:5:8: part[0].name: an array of 0 where a text from 1 to 80 characters belongs",
            "job.toml:6:11: part[0].surface: 3 where a table belongs (write a table with a kind)",
        ],
    ),
    "a sheet that is none": (
        PLATE + STOCK.replace("60", "0").replace("price = 12.5", 'price = -1\nkind = "skin"'),
        [
            "job.toml:12:10: stock[0].height: 0 (must be above 0)",
            "job.toml:13:9: stock[0].price: -1 (may not be negative)",
            'job.toml:14:8: stock[0].kind: "skin" is not allowed (one of "hide", "remnant", "roll", "sheet")',
        ],
    ),
    "wishes that no nest can grant": (
        PLATE + "[nest]\ngap = -1\nrotations = []\ntime_limit = 0\nseed = 1.5\n",
        [
            "job.toml:10:7: nest.gap: -1 (may not be negative)",
            'job.toml:11:13: nest.rotations: no angle is allowed (list at least one, such as [0], or write "free")',
            "job.toml:12:14: nest.time_limit: 0 (must be above 0)",
            "job.toml:13:8: nest.seed: 1.5 where a whole number from 0 to 2147483648 belongs",
        ],
    ),
    "a misspelt help": (
        PLATE + '[process]\nkerf_compensate = "offset"\n',
        ['job.toml:10:1: process.kerf_compensate: unknown key (did you mean "kerf_compensation"?)'],
    ),
    "a dotted key and an inline table": (
        'schema = 1\njob.nam = "x"\npart = [{ name = "a", surface = { kind = "cone", radius0 = 3, hight = 2 } }]\n',
        [
            'job.toml:2:1: job.nam: unknown key (did you mean "name"?)',
            'job.toml:3:63: part[0].surface.hight: unknown key (did you mean "height"?)',
        ],
    ),
    "a number of thousands of digits": (
        f"schema = 1\nx = {'9' * 5000}\n",
        ["job.toml:2:5: a number of thousands of digits"],
    ),
    "a number whose exponent explodes": (
        replaced(("alpha0 = 120", "alpha0 = 1e999999999")),
        [
            "job.toml:15:12: part[0].surface.alpha0: 1E+999999999 has absurdly many digits or an absurd exponent "
            f"({LENGTH})"
        ],
    ),
    "deep nesting": ("a = " + "[" * 5000 + "]" * 5000, ["job.toml: tables or arrays are nested too deeply"]),
}


BAD_JSON: dict[str, tuple[str, list[str]]] = {
    "a wrong value": (
        '{"schema": 1,\n "part": [{"name": "a", "quantity": -1,\n  "surface": {"kind": "cone", "radius0": NaN}}]}',
        [
            "job.json:2:37: part[0].quantity: -1 is out of range (a whole number from 1 to 100000 is needed)",
            f"job.json:3:42: part[0].surface.radius0: nan is not a finite number ({LENGTH})",
        ],
    ),
    "a key that is there twice": (
        '{"schema": 1, "part": [{"name": "a",\n"name": "b", "surface": {"kind": "cone", "radius0": 3, "radius1": 1,'
        ' "height": 2}}]}',
        ["job.json:1:25: part[0].name: the key is there twice (leave one of them out)"],
    ),
    "no table": ("[1]", ["job.json:1:1: a job file is one table"]),
    "deep nesting": ("[" * 100_000, ["job.json: tables or arrays are nested too deeply"]),
}
