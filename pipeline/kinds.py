"""What a job file may hold, for people (`planish kinds`, `planish init`) and for editors (`planish schema`).

All three come from the same structs that the decoder walks over.
"""

import json
from collections.abc import Sequence
from importlib.resources import files

import msgspec
from msgspec import inspect

from pipeline.decode import suggestion
from pipeline.jobfile import JobFile
from pipeline.typenames import type_name
from stages.errors import BadInputError, Problem
from stages.model.part import KINDS
from stages.model.scalars import Angle, Coordinate, Curvature, Length, Number

PATTERNS = {
    Length: "a length: a number in the units of the job, or a text with its unit such as '1/8 in'",
    Coordinate: "a length as above; two of them are the pure numbers u, v in places on a curved part",
    Curvature: "a curvature: a number in 1/units of the job, or a text with its unit such as '0.02 1/mm'",
    Number: "a number, or a text such as '1/3'",
    Angle: "an angle in degrees, or a text such as '0.5 rad'",
}


def kind_names() -> list[str]:
    """Return the kinds of surface in the order of the documentation."""
    return [str(kind.__struct_config__.tag) for kind in KINDS]


def template(kind: str) -> str:
    """Return a commented job file for a kind of surface; `BadInputError` for an unknown one."""
    if kind not in kind_names():
        raise BadInputError(Problem(f'unknown kind "{kind}"', path="KIND", hint=suggestion(kind, kind_names())))
    return files("pipeline").joinpath("data", "init", f"{kind}.toml").read_text("utf-8")


def listing() -> str:
    """Return the kinds with their keys, those that may be left out in brackets."""
    return "\n".join(line for kind in KINDS for line in _kind_lines(kind))


def _kind_lines(kind: type[msgspec.Struct]) -> list[str]:
    described = inspect.type_info(kind)
    if not isinstance(described, inspect.StructType):
        raise ValueError(f"{kind} is no struct")
    summary = (kind.__doc__ or "").split("\n")[0]
    return [f"{described.tag}: {summary}", *(f"  {line}" for line in _key_lines(described.fields))]


def _key_lines(fields: Sequence[inspect.Field]) -> list[str]:
    """Return the keys, those of the same sort on one line."""
    by_sort: dict[str, list[str]] = {}
    for entry in fields:
        key = entry.encode_name if entry.required else f"[{entry.encode_name}]"
        by_sort.setdefault(type_name(entry.type), []).append(key)
    return [f"{' '.join(keys)}: {sort}" for sort, keys in by_sort.items()]


def json_schema() -> str:
    """Return the JSON Schema of a job file."""
    schema = msgspec.json.schema(JobFile, schema_hook=_quantity_schema)
    schema = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "planish job file", **schema}
    return json.dumps(schema, indent=1)


def _quantity_schema(sort: type) -> dict[str, object]:
    if sort in PATTERNS:
        return {"anyOf": [{"type": "number"}, {"type": "string"}], "description": PATTERNS[sort]}
    raise NotImplementedError(sort)
