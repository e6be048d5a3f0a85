"""The JSON Schema of the document, made of the table of figures."""

from typing import Any, Final

from dogbot_logtool.report.figures.document import DOCUMENT
from dogbot_logtool.report.figures.figure import STATISTICS, Figure, Json, Kind, Scope, Shape

_NUMBER: Final = {"type": "number"}
_COUNT: Final = {"type": "integer", "minimum": 0}
_FRACTION: Final = {"type": "number", "minimum": 0, "maximum": 1}
_KINDS: Final[dict[Kind, Json]] = {
    Kind.NUMBER: _NUMBER,
    Kind.AMOUNT: {"type": "number", "minimum": 0},
    Kind.FRACTION: _FRACTION,
    Kind.INTEGER: {"type": "integer"},
    Kind.COUNT: _COUNT,
    Kind.FLAG: {"type": "boolean"},
    Kind.TEXT: {"type": "string"},
    Kind.AGGREGATE: {"$ref": "#/$defs/aggregate"},
    Kind.NUMBERS: {"type": "array", "items": _NUMBER},
    Kind.TEXTS: {"type": "array", "items": {"type": "string"}},
    Kind.COUNTS_BY_NAME: {"type": "object", "additionalProperties": _COUNT},
    Kind.NUMBERS_BY_NAME: {"type": "object", "additionalProperties": _NUMBER},
    Kind.FRACTIONS_BY_NAME: {"type": "object", "additionalProperties": _FRACTION},
}


def schema() -> Json:
    """Return the JSON Schema of the document."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "dogbot-logtool stats",
        **_scope(DOCUMENT),
        "$defs": {"aggregate": _aggregate()},
    }


def _aggregate() -> Json:
    properties: Json = {
        name: {**_NUMBER, "description": words} for name, words in STATISTICS.items()
    }
    properties["n"] = {**_COUNT, "minimum": 1, "description": STATISTICS["n"]}
    properties["std"] = _or_null(properties["std"])
    return _object(properties)


def _object(properties: Json) -> Json:
    return {
        "type": "object",
        "properties": properties,
        "required": list(properties),
        "additionalProperties": False,
    }


def _scope(scope: Scope) -> Json:
    one = _object({member.key: _member(member) for member in scope.members})
    if scope.shape is Shape.BY_NAME:
        items = _or_null(one) if scope.null_items else one
        one = {"type": "object", "additionalProperties": items}
    elif scope.shape is Shape.LIST:
        one = {"type": "array", "items": one}
    return {"description": scope.definition, **(_or_null(one) if scope.null else one)}


def _member(member: "Figure[Any] | Scope") -> Json:
    return _scope(member) if isinstance(member, Scope) else _figure(member)


def _figure(figure: Figure[Any]) -> Json:
    value = dict(_KINDS[figure.kind])
    if figure.choices:
        value["enum"] = list(figure.choices)
    unit = f"{figure.unit}: " if figure.unit else ""
    return {
        "description": unit + figure.definition,
        **(_or_null(value) if figure.null else value),
    }


def _or_null(value: Json) -> Json:
    """Return the schema of a value that may be null."""
    if "type" not in value:
        return {"anyOf": [value, {"type": "null"}]}
    choices = {"enum": [*value["enum"], None]} if "enum" in value else {}
    return {**value, "type": [value["type"], "null"], **choices}
