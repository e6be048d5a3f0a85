"""The JSON Schema of records."""

from collections.abc import Mapping
from dataclasses import is_dataclass
from typing import Any, Final

from dogbot_logtool.core.records import Field, definitions, fields_of

Json = dict[str, Any]
_PRIMITIVES: Final[Mapping[Any, str]] = {
    float: "number",
    int: "integer",
    str: "string",
    bool: "boolean",
}


def schema(record: type) -> Json:
    """Return the JSON Schema of a record."""
    defs: dict[str, Json] = {}
    root = _reference(record, defs)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **root, "$defs": defs}


def _reference(kind: Any, defs: dict[str, Json]) -> Json:  # noqa: ANN401 - any record
    if kind.__name__ not in defs:
        defs[kind.__name__] = {}
        own, words = fields_of(kind), definitions(kind)
        defs[kind.__name__] = {
            "type": "object",
            "description": kind.__doc__,
            "additionalProperties": False,
            "properties": {
                field.name: _described(_field_schema(field, defs), field, words) for field in own
            },
            "required": [field.name for field in own if not field.is_detail],
        }
    return {"$ref": f"#/$defs/{kind.__name__}"}


def _described(made: Json, field: Field, words: Mapping[str, str]) -> Json:
    description = {"description": words[field.name]} if field.name in words else {}
    return made | description | ({"unit": field.of.unit} if field.of.unit else {})


def _field_schema(field: Field, defs: dict[str, Json]) -> Json:
    made = _item_schema(field.inner, defs)
    if field.kind == "map":
        made = {"type": "object", "additionalProperties": made}
    elif field.kind in {"list", "records"}:
        made = {"type": "array", "items": made}
    return {"anyOf": [made, {"type": "null"}]} if field.nullable else made


def _item_schema(kind: Any, defs: dict[str, Json]) -> Json:  # noqa: ANN401 - any type
    if is_dataclass(kind):
        return _reference(kind, defs)
    return {"type": _PRIMITIVES[kind]}
