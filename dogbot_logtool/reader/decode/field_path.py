"""Paths that users name, such as ``data[3]`` or ``legs[2].force``, checked against a definition.

Such a path ends at a number, at a message with the numbers x, y and z, or at bits of an integer, as
in ``contacts&4``. What does not fit is refused with the nearest fields that there are.
"""

import re
from collections.abc import Iterator, Mapping
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
from dogbot_logtool.reader.decode.paths import FieldPath, path_of

_NAME: Final = r"[A-Za-z]\w*(?:\[[0-9]{1,6}\])?"
_PATH: Final = rf"(?a)({_NAME}(?:\.{_NAME})*)(?:&([0-9]{{1,10}}|0x[0-9a-fA-F]{{1,8}}))?"
_COMPONENTS: Final = ("x", "y", "z")
_MOST_LISTED: Final = 12
_MOST_FIELDS: Final = 2000
_NEAREST: Final = 3


def parse_field_path(definition: Struct, whole: str) -> FieldPath:
    """Check a path against a definition.

    Raises:
        DefinitionError: it is no path, or leads to no number or vector; with the nearest that do.
    """
    match = re.fullmatch(_PATH, whole)
    if match is None:
        raise DefinitionError(
            f"{whole!r} is no path of a field; such are data, data[3], legs[2].force, and "
            "data&4 for a bit of an integer"
        )
    text, mask = match.groups()
    fields = dict(islice(readable_fields(definition), _MOST_FIELDS))
    found = fields.get(_any_element(text))
    if found is None:
        raise _no_such_field(definition, text, fields)
    path = path_of(whole, "number" if isinstance(found, Primitive) else "xyz", definition)
    if mask and not (path.mask and path.is_integer):
        raise DefinitionError(
            f"{whole}: {text} is {type_text(found)}; only integers have bits, counted as "
            "&1, &2, &4, &8 ..."
        )
    return path


def _any_element(path: str) -> str:
    return re.sub(r"\[[0-9]+\]", "[]", path)


def is_vector(field_type: FieldType | None) -> bool:
    """Tell whether a field is a message of the numbers x, y and z, and no more."""
    return (
        isinstance(field_type, Struct)
        and tuple(name for name, _ in field_type.fields) == _COMPONENTS
        and all(isinstance(each, Primitive) for _, each in field_type.fields)
    )


def every_field(kind: FieldType, path: str = "") -> Iterator[tuple[str, FieldType]]:
    """Yield the paths of all that is in a message; ``[]`` stands for an index."""
    if path:
        yield path, kind
    match kind:
        case FixedArray(element) | VariableArray(element):
            yield from every_field(element, f"{path}[]")
        case Struct(_, fields):
            for name, inner in fields:
                yield from every_field(inner, f"{path}.{name}" if path else name)


def readable_fields(definition: Struct) -> Iterator[tuple[str, FieldType]]:
    """Yield the paths of all numbers and vectors; arrays have ``[]`` for the index."""
    for path, kind in every_field(definition):
        if isinstance(kind, Primitive) or is_vector(kind):
            yield path, kind


def _no_such_field(
    definition: Struct, text: str, fields: Mapping[str, FieldType]
) -> DefinitionError:
    from difflib import get_close_matches  # noqa: PLC0415 - for wrong calls only

    wanted = _any_element(text)
    close = [path for path in fields if path.startswith((f"{wanted}.", f"{wanted}["))]
    close = close or get_close_matches(wanted, fields, n=_NEAREST, cutoff=0.5)
    shown = close[:_NEAREST] or [*fields][:_MOST_LISTED]
    listed = ", ".join(f"{path} ({type_text(fields[path])})" for path in shown)
    more = len(fields) - len(shown)
    rest = f" and {more} more" if more and not close else ""
    return DefinitionError(
        f"{short_type_name(definition.name)} has no number or vector {text}; "
        f"{'nearest are' if close else 'it has'} {listed or 'no number'}{rest}"
    )
