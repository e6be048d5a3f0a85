"""The fields that are read of a message, and their check against its definition.

A path is dotted, from the message, or inside a table from its element. `check_fields` compares the
fields with the recorded definition once, before any message is decoded, so that reading the columns
cannot fail.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Final, assert_never

from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.decode.definition import (
    FieldType,
    FixedArray,
    Primitive,
    Struct,
    Text,
    VariableArray,
    type_text,
)

_TIME_PARTS: Final = ("sec", "nanosec")
_WIDEST_TIME_PART: Final = 4
"""Bytes; wider seconds would not fit as nanoseconds into 64 bits."""


class Kind(Enum):
    """Content of a field."""

    NUMBER = "a single number"
    TEXT = "a single string"
    TIME = "a single time"
    FIXED_NUMBERS = "a fixed array of at least {length} numbers"
    NUMBERS = "a sequence of numbers"
    TEXTS = "a sequence of strings"
    TABLE = "an array of at least {length} messages"


@dataclass(frozen=True, slots=True, eq=False)
class Field:
    """A field that is read. It is a key of caches, by its identity: that takes no time."""

    path: str
    kind: Kind
    length: int = 0
    """Fewest elements of a fixed array."""
    inside: tuple["Field", ...] = ()
    """Fields that are read of each element of a table."""
    optional: bool = False
    """Whether a message of protobuf or JSON may lack the number, which then is NaN."""


Fields = tuple[Field, ...]


def column_paths(fields: Fields) -> tuple[str, ...]:
    """Return the paths of all columns that are read, as `compile_layout` wants them."""
    return tuple(_column_paths(fields))


def _column_paths(fields: Fields) -> Iterator[str]:
    for field in fields:
        match field.kind:
            case Kind.TABLE:
                yield from (f"{field.path}.{inner}" for inner in _column_paths(field.inside))
            case Kind.TIME:
                yield from (f"{field.path}.{part}" for part in _TIME_PARTS)
            case _:
                yield field.path


def check_fields(definition: Struct, fields: Fields, type_name: str) -> None:
    """Check that a definition has all fields as they are declared.

    Raises:
        DefinitionError: it lacks one, or has one of another kind or shape.
    """
    _check_inside(definition, fields, type_name, "")


def _check_inside(struct: Struct, fields: Fields, type_name: str, prefix: str) -> None:
    for field in fields:
        found, path = _found(struct, field.path, type_name, prefix)
        if not _fits(found, field):
            expected = field.kind.value.format(length=field.length).replace("at least 0 ", "")
            raise _mismatch(type_name, path, expected, f"has {type_text(found)}")
        if field.kind is Kind.TABLE:
            element = _element(found)
            if isinstance(element, Struct):
                _check_inside(element, field.inside, type_name, f"{path}.")


def _found(struct: Struct, path: str, type_name: str, prefix: str) -> tuple[FieldType, str]:
    """Follow a path through messages; return the field and its path from the root."""
    current: FieldType = struct
    done: list[str] = []
    for name in path.split("."):
        if not isinstance(current, Struct):
            here = prefix + ".".join(done)
            raise _mismatch(type_name, here, "a single message", f"has {type_text(current)}")
        done.append(name)
        fields: Mapping[str, FieldType] = dict(current.fields)
        if name not in fields:
            here = prefix + ".".join(done)
            raise DefinitionError(
                f"the log's definition of {type_name} has no field {here!r}, which is needed"
            )
        current = fields[name]
    return current, prefix + path


def _mismatch(type_name: str, path: str, expected: str, found: str) -> DefinitionError:
    return DefinitionError(
        f"field {path!r} of {type_name} must be {expected}, but the log's definition {found}"
    )


def _fits(found: FieldType, field: Field) -> bool:
    match field.kind:
        case Kind.NUMBER:
            return isinstance(found, Primitive)
        case Kind.TEXT:
            return isinstance(found, Text)
        case Kind.TIME:
            return _is_time(found)
        case Kind.FIXED_NUMBERS:
            return (
                isinstance(found, FixedArray)
                and isinstance(found.element, Primitive)
                and found.length >= field.length
            )
        case Kind.NUMBERS | Kind.TEXTS:
            element = Primitive if field.kind is Kind.NUMBERS else Text
            return isinstance(found, VariableArray) and isinstance(found.element, element)
        case Kind.TABLE:
            is_short = isinstance(found, FixedArray) and found.length < field.length
            return isinstance(_element(found), Struct) and not is_short
        case _:
            assert_never(field.kind)


def _element(found: FieldType) -> FieldType | None:
    return found.element if isinstance(found, FixedArray | VariableArray) else None


def _is_time(found: FieldType) -> bool:
    if not isinstance(found, Struct):
        return False
    parts = dict(found.fields)
    return all(_is_time_part(parts.get(name)) for name in _TIME_PARTS)


def _is_time_part(found: FieldType | None) -> bool:
    return (
        isinstance(found, Primitive) and found.dtype[0] in "iu" and found.size <= _WIDEST_TIME_PART
    )
