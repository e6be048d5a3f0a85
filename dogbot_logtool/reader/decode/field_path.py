"""Paths to one field of a message, such as ``data[3]`` or ``legs[2].force``, and their values.

A path is checked against the log's own definition before any message is read. It ends at a number,
at a message with the numbers x, y and z, or at bits of an integer, as in ``contacts&4``.
"""

import re
from collections.abc import Iterator
from itertools import islice
from typing import Final

import numpy as np

from dogbot_logtool.core.geometry.arrays import Floats, Ints
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.decode.columns import Nested, Table
from dogbot_logtool.reader.decode.definition import (
    FieldType,
    FixedArray,
    Primitive,
    Struct,
    Text,
    VariableArray,
    short_type_name,
    type_text,
)
from dogbot_logtool.reader.decode.fields import (
    Fields,
    fixed_numbers,
    number,
    numbers,
    table,
    vector,
)
from dogbot_logtool.reader.decode.message_layout import ELEMENT

_PART: Final = r"(?a)([A-Za-z]\w*)(?:\[([0-9]{1,6})\])?"
_MASK: Final = r"(?a)(.+)&([0-9]{1,10}|0x[0-9a-fA-F]{1,8})"
_COMPONENTS: Final = ("x", "y", "z")
_MOST_LISTED: Final = 12
_MOST_FIELDS: Final = 2000
_NEAREST: Final = 3


@dataclass(frozen=True, slots=True)
class ArrayIndex:
    """One element of an array on the way to a field."""

    path: str
    """Path of the array, from the message or the element before."""
    index: int
    holds: str
    """``table``: messages; ``fixed``: numbers, as many as the definition says; ``numbers``."""


@dataclass(frozen=True, slots=True)
class FieldPath:
    """A path that fits a definition."""

    arrays: tuple[ArrayIndex, ...]
    """The elements that it leads through, from the message inwards."""
    leaf: str
    """Path of the field in the last element; empty: the element itself."""
    number: Primitive | None
    """Type of the number; None: a vector."""
    mask: int = 0
    """Bits of an integer: the value is 1 where one of them is set, else 0; 0: the number itself."""

    @property
    def width(self) -> int:
        """Numbers that the field has."""
        return 3 if self.number is None else 1

    @property
    def is_integer(self) -> bool:
        """Whether the field is an integer or a boolean."""
        return self.number is not None and self.number.dtype[0] in "iu"

    @property
    def fields(self) -> Fields:
        """The field that must be decoded."""
        inside: Fields = vector(self.leaf) if self.number is None else (number(self.leaf),)
        for array in reversed(self.arrays):
            match array.holds:
                case "fixed":
                    inside = (fixed_numbers(array.path, at_least=array.index + 1),)
                case "numbers":
                    inside = (numbers(array.path),)
                case _:
                    inside = (table(array.path, *inside),)
        return inside

    def values(self, messages: Table) -> Floats:
        """Return (n, `width`) of n messages; NaN where a message has no such element."""
        found = self._values(messages, 0)
        if not self.mask:
            return found
        known = ~np.isnan(found)
        found[known] = (found[known].astype(np.int64) & self.mask) != 0
        return found

    def _values(self, rows: Table, depth: int) -> Floats:
        if depth == len(self.arrays):
            if self.number is None:
                return rows.vectors(self.leaf, "xyz")
            return rows.numbers(self.leaf).astype(np.float64)[:, None]
        array = self.arrays[depth]
        if array.holds == "fixed":
            column = rows.numbers(array.path)
            return column[:, array.index : array.index + 1].astype(np.float64)
        nested = rows.nested(array.path)
        if array.holds == "numbers":
            elements = nested.table.numbers(ELEMENT).astype(np.float64)[:, None]
        else:
            elements = self._values(nested.table, depth + 1)
        row = _row_of_element(nested, rows.rows, array.index)
        found = np.full((rows.rows, self.width), np.nan)
        found[row >= 0] = elements[row[row >= 0]]
        return found


def _row_of_element(nested: Nested, count: int, index: int) -> Ints:
    """(count,) row of the element with an index in each message's array; -1: it has none."""
    order = np.argsort(nested.parent, kind="stable")
    parent = nested.parent[order]
    chosen = np.arange(len(parent)) - np.searchsorted(parent, parent) == index
    row = np.full(count, -1, np.int64)
    row[parent[chosen]] = order[chosen]
    return row


def parse_field_path(definition: Struct, text: str) -> FieldPath:
    """Check a path against a definition.

    Raises:
        DefinitionError: it is no path, or leads to no number or vector; with the nearest that do.
    """
    masked = re.fullmatch(_MASK, text)
    text, mask = (masked[1], int(masked[2], 0)) if masked else (text, 0)
    current: FieldType = definition
    arrays: list[ArrayIndex] = []
    names: list[str] = []
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
        names.append(name)
        done.append(part)
        if index is None:
            continue
        if not isinstance(current, FixedArray | VariableArray):
            here = ".".join([*done[:-1], name])
            raise DefinitionError(f"{here} is no array: it is {type_text(current)}")
        if isinstance(current, FixedArray) and int(index) >= current.length:
            raise DefinitionError(
                f"{'.'.join(done)}: the array has {current.length} elements, counted from 0"
            )
        arrays.append(ArrayIndex(".".join(names), int(index), _held(current)))
        current = current.element
        names = []
    if isinstance(current, FixedArray | VariableArray):
        raise DefinitionError(
            f"{text} is an array, {type_text(current)}: say which element, as in {text}[0]"
        )
    if masked and not (mask and isinstance(current, Primitive) and current.dtype[0] in "iu"):
        raise DefinitionError(
            f"{masked[0]}: {text} is {type_text(current)}; only integers have bits, counted as "
            "&1, &2, &4, &8 ..."
        )
    if not isinstance(current, Primitive) and not is_vector(current):
        raise _no_such_field(definition, text, text, f"is {type_text(current)}")
    leaf = current if isinstance(current, Primitive) else None
    return FieldPath(tuple(arrays), ".".join(names), leaf, mask)


def _held(array: FixedArray | VariableArray) -> str:
    if not isinstance(array.element, Primitive):
        return "table"
    return "fixed" if isinstance(array, FixedArray) else "numbers"


def is_vector(field_type: FieldType) -> bool:
    """Tell whether a field is a message of the numbers x, y and z, and no more."""
    return (
        isinstance(field_type, Struct)
        and tuple(name for name, _ in field_type.fields) == _COMPONENTS
        and all(isinstance(each, Primitive) for _, each in field_type.fields)
    )


def has_header(definition: Struct) -> bool:
    """Tell whether messages have a `std_msgs/Header` named header."""
    header = dict(definition.fields).get("header")
    parts = dict(header.fields) if isinstance(header, Struct) else {}
    stamp = parts.get("stamp")
    return (
        isinstance(stamp, Struct)
        and dict(stamp.fields).keys() == {"sec", "nanosec"}
        and isinstance(parts.get("frame_id"), Text)
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
