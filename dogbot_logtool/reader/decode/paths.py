"""Paths to fields of a message, and their values for all messages at once.

    mode                            a number of the message
    wrench.force                    a message of x, y, z (or x, y, z, w)
    contacts[].state                that field of every element
    legs[2].force, poses[-1].pose   of one element; -1 is the last
    position[0:3 by 3]              numbers 0 to 3 of an array, three of them a vector
    input.value[0:12 by 3 of 24]    the same, where the array has 24 numbers (``of 18+``: at least)
    mode&8                          a bit of an integer: 1 or 0
    joints[].effort?                a number that a message of protobuf or JSON may lack

Values are (n, k, w): n messages, k elements, w numbers each; NaN where a message lacks an element.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.reader.decode.columns import Nested, Table, Texts
from dogbot_logtool.reader.decode.definition import (
    FieldType,
    FixedArray,
    Struct,
    VariableArray,
)
from dogbot_logtool.reader.decode.fields import Field, Fields, Kind
from dogbot_logtool.reader.decode.message_layout import ELEMENT

Want = Literal["number", "xyz", "xyzw", "text", "time"]
"""What a path leads to; a vector may also be an array of numbers."""
MOST_ELEMENTS: Final = 16
"""Elements of an array that are read side by side: of a hostile one, memory holds no more."""
_PART: Final = (
    r"(?a)([A-Za-z]\w*)(\[(-1|\d{0,6})(?::(\d{1,6}))?(?: by (\d))?(?: of (\d{1,6})(\+?))?\])?"
)
_KINDS: Final = {"text": Kind.TEXT, "time": Kind.TIME}


@dataclass(frozen=True, slots=True)
class ArrayPart:
    """An array on the way to a field, and which of its elements are wanted."""

    path: str
    """From the message or the element before."""
    kind: Kind
    """TABLE, FIXED_NUMBERS, NUMBERS or TEXTS."""
    first: int = 0
    """-1: the last element."""
    last: int | None = None
    """The element behind the last one that is wanted; None: all are."""
    width: int = 1
    """Numbers a vector."""
    length: int = 0
    """Elements that the array must have; 0: any number."""
    or_more: bool = False


@dataclass(frozen=True, slots=True)
class FieldPath:
    """A path, ready to read."""

    arrays: tuple[ArrayPart, ...]
    """Those that it leads through, from the message inwards."""
    leaf: str
    """Path of the field in the last element; empty: the element itself."""
    kind: Kind
    """NUMBER, TEXT or TIME."""
    components: str = ""
    """Of a vector."""
    mask: int = 0
    """Bits of an integer: the value is 1 where one of them is set; 0: the number itself."""
    optional: bool = False
    is_integer: bool = False
    """Whether the field is an integer or a boolean, as far as `parse_field_path` looked."""

    @property
    def width(self) -> int:
        """Numbers that the field has."""
        return len(self.components) or (self.arrays[-1].width if self.arrays else 1)

    @property
    def is_array_of_elements(self) -> bool:
        """Whether it leads through elements, of which a message may have none."""
        return bool(self.arrays) and self.arrays[0].kind is Kind.TABLE

    @property
    def fields(self) -> Fields:
        """What must be decoded."""
        inside: Fields = (Field(self.leaf, self.kind, optional=self.optional),)
        if self.components:
            before = f"{self.leaf}." if self.leaf else ""
            inside = tuple(Field(f"{before}{each}", Kind.NUMBER) for each in self.components)
        for array in reversed(self.arrays):
            kept = inside if array.kind is Kind.TABLE else ()
            inside = (Field(array.path, array.kind, array.last or 0, kept),)
        return inside

    def values(self, table: Table) -> Floats:
        """Return (n, k, w) numbers of n messages."""
        found = _elements(self, table, 0)
        if self.mask:
            known = ~np.isnan(found)
            found[known] = (found[known].astype(np.int64) & self.mask) != 0
        return found

    def first_values(self, table: Table) -> Floats:
        """Return (n, w) numbers of the only, or the first, wanted element of n messages."""
        return self.values(table)[:, 0]

    def texts(self, table: Table) -> tuple[Ints, Texts]:
        """Return the message of each text, (m,), and the texts."""
        if not self.arrays:
            return np.arange(table.rows), table.texts(self.leaf)
        nested = table.nested(self.arrays[0].path)
        return nested.parent, nested.table.texts(self.leaf or ELEMENT)

    def times(self, table: Table) -> Ints:
        """Return (m,) ns of every element."""
        return self._innermost(table).nanoseconds(self.leaf)

    def all_values(self, table: Table) -> Floats:
        """Return (m, w) numbers of every element."""
        return _leaf(self, self._innermost(table))

    def rows_beside(self, table: Table, other: "FieldPath") -> Ints | None:
        """Return the elements that stand beside those of another path's array.

        Returns:
            (m,) rows of `all_values`, -1 where there is none; None: they are the same elements.
        """
        if [each.path for each in self.arrays] == [each.path for each in other.arrays]:
            return None
        own, theirs = (table.nested(each.arrays[0].path) for each in (self, other))
        rows, exist = own.rows_at(theirs.parent, theirs.index)
        return np.where(exist, rows, -1)

    def beside(self, table: Table, other: "FieldPath") -> Floats:
        """Return (m, w) numbers beside each element of another path's array; NaN: none."""
        values, rows = self.all_values(table), self.rows_beside(table, other)
        return values if rows is None else _picked(values, rows)

    def _innermost(self, table: Table) -> Table:
        return table.nested(self.arrays[0].path).table if self.arrays else table


def _picked(values: Floats, rows: Ints) -> Floats:
    """(m, ...) the chosen rows; NaN where a number is negative."""
    found = np.full((len(rows), *values.shape[1:]), np.nan)
    found[rows >= 0] = values[rows[rows >= 0]]
    return found


def _leaf(path: FieldPath, table: Table) -> Floats:
    if path.components:
        return table.vectors(path.leaf, path.components)
    return table.numbers(path.leaf or ELEMENT).astype(np.float64)[:, None]


def _elements(path: FieldPath, table: Table, depth: int) -> Floats:
    if depth == len(path.arrays):
        return _leaf(path, table)[:, None]
    array = path.arrays[depth]
    if array.kind is Kind.FIXED_NUMBERS:
        column = table.numbers(array.path).astype(np.float64)[:, array.first : array.last]
        return column.reshape(table.rows, column.shape[1] // array.width, array.width)
    nested = table.nested(array.path)
    if array.kind is Kind.NUMBERS:
        numbers = nested.table.numbers(ELEMENT).astype(np.float64)
        found = side_by_side(nested, numbers, table.rows, array)
        return found.reshape(table.rows, found.shape[1] // array.width, array.width)
    inside = _elements(path, nested.table, depth + 1)
    found = side_by_side(nested, inside, table.rows, array)
    return found.reshape(table.rows, found.shape[1] * found.shape[2], found.shape[3])


def side_by_side(nested: Nested, values: Floats, rows: int, array: ArrayPart) -> Floats:
    """Return the wanted elements of every message's array.

    Args:
        nested: the array field.
        values: (m, ...) of each element.
        rows: n, the number of messages.
        array: which elements.

    Returns:
        (n, k, ...); NaN where a message has fewer.
    """
    count = np.bincount(nested.parent, minlength=rows)
    most = int(count.max(initial=0))
    fits = count >= array.length if array.or_more else count == (array.length or count)
    if array.width > 1 and array.last:
        fits &= count >= array.last
    last = min(most, array.first + MOST_ELEMENTS) if array.last is None else array.last
    if array.first >= 0 and last <= most and fits.all() and (count == most).all():
        whole = _as_matrix(nested, values, rows, most)
        if whole is not None:
            return whole[:, array.first : last]
    wanted = np.arange(array.first, max(array.first + (array.first < 0), last))
    index = count[:, None] - 1 if array.first < 0 else np.broadcast_to(wanted, (rows, len(wanted)))
    message = np.repeat(np.arange(rows), index.shape[1])
    row = _element_rows(nested, count, message, index.ravel())
    row[~fits[message]] = -1
    return _picked(values, row).reshape(*index.shape, *values.shape[1:])


def _as_matrix(nested: Nested, values: Floats, rows: int, count: int) -> Floats | None:
    """(rows, count, ...) of arrays that are all as long; None: their elements stand in no order."""
    if np.array_equal(nested.parent, np.repeat(np.arange(rows), count)):
        return values.reshape(rows, count, *values.shape[1:])
    if np.array_equal(nested.parent, np.tile(np.arange(rows), count)):
        return values.reshape(count, rows, *values.shape[1:]).swapaxes(0, 1)
    return None


def _element_rows(nested: Nested, count: Ints, message: Ints, index: Ints) -> Ints:
    """(m,) row of the element with an index in a message's array; -1: it has none.

    Args:
        nested: the array field.
        count: (n,) elements of each message.
        message: (m,).
        index: (m,).
    """
    order = np.argsort(nested.parent, kind="stable")
    there = (index >= 0) & (index < count[message])
    found = np.full(len(message), -1, np.int64)
    found[there] = order[(np.cumsum(count) - count)[message[there]] + index[there]]
    return found


def path_of(text: str, want: Want, definition: Struct | None = None) -> FieldPath:
    """Return the path that a text says.

    Whether a definition has such a field, `check_fields` tells; the definition is only asked for
    the lengths of arrays of numbers.

    Args:
        text: in the language of this module.
        want: what the path leads to.
        definition: None: no array has a fixed length.

    Raises:
        ValueError: it is no path.
    """
    plain, _, mask = text.partition("&")
    current: FieldType | None = definition
    names: list[str] = []
    arrays: list[ArrayPart] = []
    parts = plain.removesuffix("?").split(".") if plain else []
    for number, part in enumerate(parts, start=1):
        match = re.fullmatch(_PART, part)
        if match is None:
            raise ValueError(f"{text!r} is no path of a field")
        current = dict(current.fields).get(match[1]) if isinstance(current, Struct) else None
        names.append(match[1])
        if match[2] is None:
            continue
        is_last = number == len(parts)
        arrays.append(_array(match, ".".join(names), want if is_last else None, current))
        current = current.element if isinstance(current, FixedArray | VariableArray) else None
        names = []
    of_numbers = bool(arrays) and not names and arrays[-1].kind is not Kind.TABLE
    return FieldPath(
        tuple(arrays),
        ".".join(names),
        _KINDS.get(want, Kind.NUMBER),
        want if want in {"xyz", "xyzw"} and not of_numbers else "",
        int(mask or "0", 0),
        optional=plain.endswith("?"),
    )


def _array(
    match: re.Match[str], path: str, want: Want | None, found: FieldType | None
) -> ArrayPart:
    """Return a part of a path with brackets; the want is None where the path goes on behind it."""
    _, _, first, last, width, length, or_more = match.groups()
    begin = int(first or 0)
    end = int(last) if last else begin + 1 if first and begin >= 0 else None
    if want == "text":
        kind = Kind.TEXTS
    elif want is None or (want != "number" and not last):
        kind = Kind.TABLE
    else:
        kind = Kind.FIXED_NUMBERS if isinstance(found, FixedArray) else Kind.NUMBERS
    return ArrayPart(path, kind, begin, end, int(width or 1), int(length or 0), bool(or_more))


def merged(fields: Iterable[Field]) -> Fields:
    """Return fields with those inside one array together, each once."""
    found: dict[str, Field] = {}
    for each in fields:
        known = found.get(each.path)
        kept = each
        if known is not None and each.kind is Kind.TABLE:
            inside = merged((*known.inside, *each.inside))
            kept = Field(each.path, each.kind, max(known.length, each.length), inside)
        elif known is not None:
            kept = max(known, each, key=lambda field: field.length)
        found[each.path] = kept
    return tuple(found.values())
