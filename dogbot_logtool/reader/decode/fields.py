"""The fields that are read of a message, and their check against its definition.

A path is dotted, from the message, or inside a table from its element. `check_fields` compares the
fields with the recorded definition once, before any message is decoded, so that reading the columns
cannot fail.
"""

from collections.abc import Mapping
from dataclasses import astuple, dataclass
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


def are_alike(fields: Fields, others: Fields) -> bool:
    """Tell whether the same is declared twice; fields themselves are equal by identity only."""
    return list(map(astuple, fields)) == list(map(astuple, others))


def column_paths(fields: Fields) -> tuple[str, ...]:
    """Return the paths of all columns that are read, as `compile_layout` wants them."""
    paths: list[str] = []
    for field in fields:
        inside = _TIME_PARTS if field.kind is Kind.TIME else column_paths(field.inside)
        paths += [f"{field.path}.{inner}" for inner in inside] or [field.path]
    return tuple(paths)


def check_fields(definition: Struct, fields: Fields, type_name: str, prefix: str = "") -> None:
    """Check that a definition has all fields as they are declared.

    Args:
        definition: of a message, or of an element of its arrays.
        fields: inside of that.
        type_name: of the message, for errors.
        prefix: path that leads to the definition, with a dot behind it.

    Raises:
        DefinitionError: it lacks one, or has one of another kind or shape.
    """
    for field in fields:
        found, path = _found(definition, field.path, type_name, prefix)
        if not _fits(found, field):
            expected = field.kind.value.format(length=field.length).replace("at least 0 ", "")
            raise _mismatch(type_name, path, expected, f"has {type_text(found)}")
        element = _element(found)
        if field.kind is Kind.TABLE and isinstance(element, Struct):
            check_fields(element, field.inside, type_name, f"{path}.")


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
    is_long_enough = not isinstance(found, FixedArray) or found.length >= field.length
    match field.kind:
        case Kind.NUMBER:
            return isinstance(found, Primitive)
        case Kind.TEXT:
            return isinstance(found, Text)
        case Kind.TIME:
            return _is_time(found)
        case Kind.TABLE:
            return isinstance(_element(found), Struct) and is_long_enough
        case Kind.FIXED_NUMBERS:
            is_fixed = isinstance(found, FixedArray) and isinstance(found.element, Primitive)
            return is_fixed and is_long_enough
        case Kind.NUMBERS | Kind.TEXTS:
            element = Primitive if field.kind is Kind.NUMBERS else Text
            return isinstance(found, VariableArray) and isinstance(found.element, element)
        case _:
            assert_never(field.kind)


def _element(found: FieldType) -> FieldType | None:
    return found.element if isinstance(found, FixedArray | VariableArray) else None


def _is_time(found: FieldType) -> bool:
    parts = dict(found.fields) if isinstance(found, Struct) else {}
    numbers = [part for name in _TIME_PARTS if isinstance(part := parts.get(name), Primitive)]
    return len(numbers) == len(_TIME_PARTS) and all(
        part.dtype[0] in "iu" and part.size <= _WIDEST_TIME_PART for part in numbers
    )
