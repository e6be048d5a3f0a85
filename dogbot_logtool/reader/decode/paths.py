"""Paths to fields of a message, and their values for all messages at once.

    mode                            a number of the message
    wrench.force                    a message of x, y, z (or x, y, z, w)
    contacts[].state                that field of every element
    legs[2].force, poses[-1].pose   of one element; -1 is the last
    position[0:3 by 3]              numbers 0 to 3 of an array, three of them a vector
    input.value[0:12 by 3 of 24]    the same, where the array has 24 numbers (``of 18+``: at least)
    mode&8                          a bit of an integer: 1 or 0

Values are (n, k, w): n messages, k elements, w numbers each; NaN where a message lacks an element.

Users name such as ``data[3]``, ``legs[2].force`` and ``contacts&4``, which end at a number, at a
message with the numbers x, y and z, or at bits of an integer. What does not fit is refused with the
nearest fields that there are.
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from itertools import islice
from typing import Final, Literal, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.decode.columns import Nested, Table, Texts
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
from dogbot_logtool.reader.decode.message_layout import ELEMENT

Want = Literal["number", "xyz", "xyzw", "text", "time"]
"""What a path leads to; a vector may also be an array of numbers."""
Columns = tuple[str, ...]
"""Dotted paths of what is decoded of a message, as `compile_layout` takes them."""
MOST_ELEMENTS: Final = 16
"""Elements of an array that are read side by side: of a hostile one, memory holds no more."""
_PART: Final = (
    r"(?a)([A-Za-z]\w*)(\[(-1|\d{0,6})(?::(\d{1,6}))?(?: by (\d))?(?: of (\d{1,6})(\+?))?\])?"
)
_NAME: Final = r"[A-Za-z]\w*(?:\[[0-9]{1,6}\])?"
_GIVEN_PATH: Final = rf"(?a)({_NAME}(?:\.{_NAME})*)(?:&([0-9]{{1,10}}|0x[0-9a-fA-F]{{1,8}}))?"
_COMPONENTS: Final = ("x", "y", "z")
_MOST_LISTED: Final = 12
_MOST_FIELDS: Final = 2000
_NEAREST: Final = 3
_TIME_TYPES: Final = tuple(Primitive(dtype) for dtype in ("i1", "u1", "i2", "u2", "i4", "u4"))
"""Of seconds and nanoseconds: wider seconds would not fit as nanoseconds into 64 bits."""


class ArrayPart(NamedTuple):
    """An array on the way to a field, and which of its elements are wanted."""

    path: str
    """From the message or the element before."""
    is_fixed: bool
    """Whether its elements are numbers that stand in the message itself."""
    first: int = 0
    """-1: the last element."""
    last: int | None = None
    """The element behind the last one that is wanted; None: all are."""
    width: int = 1
    """Numbers a vector."""
    length: int = 0
    """Elements that the array must have; 0: any number."""
    or_more: bool = False


class FieldPath(NamedTuple):
    """A path that a definition has."""

    arrays: tuple[ArrayPart, ...]
    """Those that it leads through, from the message inwards."""
    leaf: str
    """Path of the field in the last element; empty: the element itself."""
    columns: Columns
    """What must be decoded."""
    components: str = ""
    """Of a vector."""
    mask: int = 0
    """Bits of an integer: the value is 1 where one of them is set; 0: the number itself."""
    is_integer: bool = False
    """Whether the field is an integer or a boolean."""

    @property
    def width(self) -> int:
        """Numbers that the field has."""
        return len(self.components) or (self.arrays[-1].width if self.arrays else 1)

    @property
    def is_array_of_elements(self) -> bool:
        """Whether it leads through elements, of which a message may have none."""
        return len(self.arrays) > 1 or bool(self.arrays and (self.leaf or self.components))

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

    def rows_beside(self, table: Table, other: "FieldPath") -> Ints:
        """(m,) rows of `all_values` beside the elements of another path's array; -1: none."""
        own, theirs = (table.nested(each.arrays[0].path) for each in (self, other))
        if np.array_equal(own.parent, theirs.parent):
            return np.arange(len(own.parent))
        return own.rows_at(theirs.parent, theirs.index)

    def beside(self, table: Table, other: "FieldPath") -> Floats:
        """Return (m, w) numbers beside each element of another path's array; NaN: none."""
        return _picked(self.all_values(table), self.rows_beside(table, other))

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
    if array.is_fixed:
        column = table.numbers(array.path).astype(np.float64)[:, array.first : array.last]
        found = column[:, :, None, None]
    else:
        nested = table.nested(array.path)
        inside = _elements(path, nested.table, depth + 1)
        found = side_by_side(nested, inside, table.rows, array)
    _, elements, inner, width = found.shape
    return found.reshape(table.rows, elements * inner // array.width, array.width * width)


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
        return values.reshape(rows, most, *values.shape[1:])[:, array.first : last]
    wanted = np.arange(array.first, max(array.first + (array.first < 0), last))
    index = count[:, None] - 1 if array.first < 0 else np.broadcast_to(wanted, (rows, len(wanted)))
    message = np.repeat(np.arange(rows), index.shape[1])
    row = nested.rows_at(message, index.ravel())
    row[~fits[message]] = -1
    return _picked(values, row).reshape(*index.shape, *values.shape[1:])


def path_of(text: str, want: Want, definition: Struct) -> FieldPath:
    """Return the path that a text says, in the language of this module.

    Raises:
        ValueError: it is no path.
        DefinitionError: the definition has no such field, or one of another kind or shape.
    """
    plain, _, mask = text.partition("&")
    found: FieldType = definition
    path, leaf, last, arrays = "", "", "", list[ArrayPart]()
    for part in plain.split("."):
        match = re.fullmatch(_PART, part)
        if match is None:
            raise ValueError(f"{text!r} is no path of a field")
        name, brackets, first, last, width, length, or_more = match.groups()
        path, leaf = (f"{each}.{name}".lstrip(".") for each in (path, leaf))
        fields = dict(found.fields) if isinstance(found, Struct) else {}
        if name not in fields:
            raise DefinitionError(
                f"the log's definition of {short_type_name(definition.name)} has no field "
                f"{path!r}, which is needed"
            )
        found = fields[name]
        if brackets:
            begin = int(first or 0)
            end = int(last) if last else begin + 1 if first and begin >= 0 else None
            if isinstance(found, FixedArray) and found.length >= (end or 0):
                is_fixed = isinstance(found.element, Primitive)
            elif isinstance(found, VariableArray):
                is_fixed = False
            else:
                raise _unfit(definition, path, part, found)
            limits = begin, end, int(width or 1), int(length or 0), bool(or_more)
            arrays.append(ArrayPart(leaf, is_fixed, *limits))
            found, leaf = found.element, ""
    components: str = ""
    columns: Columns = (path,)
    if arrays and not leaf and isinstance(found, Primitive):
        fits = want == "number" or (want in {"xyz", "xyzw"} and bool(last))
    elif want in {"xyz", "xyzw"}:
        components, columns = want, tuple(f"{path}.{each}" for each in want)
        inner = dict(found.fields) if isinstance(found, Struct) else {}
        fits = all(isinstance(inner.get(each), Primitive) for each in want)
    else:
        fits = _is_single(found, want)
    if not fits:
        raise _unfit(definition, path, want, found)
    is_integer = isinstance(found, Primitive) and found.dtype[0] in "iu"
    return FieldPath(tuple(arrays), leaf, columns, components, int(mask or "0", 0), is_integer)


def _unfit(definition: Struct, path: str, wanted: str, found: FieldType) -> DefinitionError:
    return DefinitionError(
        f"field {path!r} of {short_type_name(definition.name)} must be readable as {wanted}, but "
        f"the log's definition has {type_text(found)}"
    )


def _is_single(found: FieldType, want: Want) -> bool:
    if want != "time":
        return isinstance(found, Text if want == "text" else Primitive)
    parts = dict(found.fields) if isinstance(found, Struct) else {}
    return all(parts.get(name) in _TIME_TYPES for name in ("sec", "nanosec"))


def columns_of(paths: Iterable[FieldPath]) -> Columns:
    """Return all that must be decoded, each once."""
    return tuple(dict.fromkeys(column for path in paths for column in path.columns))


def parse_field_path(definition: Struct, whole: str) -> FieldPath:
    """Check a path against a definition.

    Raises:
        DefinitionError: it is no path, or leads to no number or vector; with the nearest that do.
    """
    match = re.fullmatch(_GIVEN_PATH, whole)
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
