"""Paths that users name, such as ``data[3]`` or ``legs[2].force``, checked against a definition.

Such a path ends at a number, at a message with the numbers x, y and z, or at bits of an integer, as
in ``contacts&4``. What does not fit is refused with the nearest fields that there are.
"""

import re
from collections.abc import Iterator
from dataclasses import replace
from itertools import islice
from typing import Final

from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.decode.definition import (
    FieldType,
    FixedArray,
    Primitive,
    Struct,
    VariableArray,
    short_type_name,
    type_text,
)
from dogbot_logtool.reader.decode.paths import FieldPath, Want, path_of

_PART: Final = r"(?a)([A-Za-z]\w*)(?:\[([0-9]{1,6})\])?"
_MASK: Final = r"(?a)(.+)&([0-9]{1,10}|0x[0-9a-fA-F]{1,8})"
_COMPONENTS: Final = ("x", "y", "z")
_MOST_LISTED: Final = 12
_MOST_FIELDS: Final = 2000
_NEAREST: Final = 3


def parse_field_path(definition: Struct, whole: str) -> FieldPath:
    """Check a path against a definition.

    Raises:
        DefinitionError: it is no path, or leads to no number or vector; with the nearest that do.
    """
    masked = re.fullmatch(_MASK, whole)
    text = masked[1] if masked else whole
    current: FieldType = definition
    done: list[str] = []
    for part in text.split("."):
        match = re.fullmatch(_PART, part)
        if match is None:
            raise DefinitionError(
                f"{text!r} is no path of a field; such are data, data[3], legs[2].force, and "
                "data&4 for a bit of an integer"
            )
        name, index = match.groups()
        if not isinstance(current, Struct) or name not in dict(current.fields):
            raise _no_such_field(definition, text, ".".join([*done, name]))
        current = dict(current.fields)[name]
        if index is not None:
            current = _element(current, int(index), ".".join([*done, name]))
        done.append(part)
    if isinstance(current, FixedArray | VariableArray):
        raise DefinitionError(
            f"{text} is an array, {type_text(current)}: say which element, as in {text}[0]"
        )
    is_integer = isinstance(current, Primitive) and current.dtype[0] in "iu"
    if masked and not (int(masked[2], 0) and is_integer):
        raise DefinitionError(
            f"{masked[0]}: {text} is {type_text(current)}; only integers have bits, counted as "
            "&1, &2, &4, &8 ..."
        )
    if not isinstance(current, Primitive) and not is_vector(current):
        raise _no_such_field(definition, text, text, f"is {type_text(current)}")
    want: Want = "number" if isinstance(current, Primitive) else "xyz"
    return replace(path_of(whole, want, definition), is_integer=is_integer)


def _element(array: FieldType, index: int, path: str) -> FieldType:
    """Return the type of an array's elements; a fixed array must have the index."""
    if not isinstance(array, FixedArray | VariableArray):
        raise DefinitionError(f"{path} is no array: it is {type_text(array)}")
    if isinstance(array, FixedArray) and index >= array.length:
        raise DefinitionError(
            f"{path}[{index}]: the array has {array.length} elements, counted from 0"
        )
    return array.element


def is_vector(field_type: FieldType) -> bool:
    """Tell whether a field is a message of the numbers x, y and z, and no more."""
    return (
        isinstance(field_type, Struct)
        and tuple(name for name, _ in field_type.fields) == _COMPONENTS
        and all(isinstance(each, Primitive) for _, each in field_type.fields)
    )


def readable_fields(definition: Struct) -> Iterator[tuple[str, FieldType]]:
    """Yield the paths of all numbers and vectors; arrays have ``[]`` for the index."""
    yield from _readable("", definition)


def _readable(path: str, field_type: FieldType) -> Iterator[tuple[str, FieldType]]:
    match field_type:
        case Primitive():
            yield path, field_type
        case FixedArray(element) | VariableArray(element):
            yield from _readable(f"{path}[]", element)
        case Struct(_, fields):
            if is_vector(field_type):
                yield path, field_type
            for name, inner in fields:
                yield from _readable(f"{path}.{name}" if path else name, inner)
        case _:
            return


def _no_such_field(
    definition: Struct, text: str, where: str, what: str = "does not exist"
) -> DefinitionError:
    from difflib import get_close_matches  # noqa: PLC0415 - for wrong calls only

    fields = dict(islice(readable_fields(definition), _MOST_FIELDS))
    wanted = re.sub(r"\[[0-9]+\]", "[]", text)
    close = [path for path in fields if path.startswith(f"{wanted}.")]
    close = close or get_close_matches(wanted, fields, n=_NEAREST, cutoff=0.5)
    shown = close[:_NEAREST] or [*fields][:_MOST_LISTED]
    listed = ", ".join(f"{path} ({type_text(fields[path])})" for path in shown)
    lead = "nearest are" if close else "it has"
    more = len(fields) - len(shown)
    rest = f" and {more} more" if more and not close else ""
    return DefinitionError(
        f"field {where} of {short_type_name(definition.name)} {what}; "
        f"{lead} {listed or 'no number'}{rest}"
    )
