"""Messages that a library decodes one by one, protobuf's and JSON's, as columns.

The definitions of such messages are the library's; `foxglove.` types are known. They come some
hundred times a second, not thousands.
"""

import json
from collections.abc import Sequence
from functools import lru_cache
from importlib import import_module
from typing import Any, Final

import numpy as np

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.decode.columns import Nested, Table, Texts
from dogbot_logtool.reader.decode.fields import Field, Fields, Kind

OBJECT_ENCODINGS: Final = frozenset({"protobuf", "json"})
_PACKAGE: Final = "foxglove."
_LARGEST: Final = 1 << 20
"""Bytes of a message, some ten thousand transforms; decoded, a hostile one takes much more."""
_LAST_SECOND: Final = (1 << 63) // 1_000_000_000 - 1
_FAULTS: Final = (ValueError, TypeError, KeyError, AttributeError, OverflowError, RecursionError)
Row = list[Any]
"""A value of each field: a number, a string, seconds and nanoseconds, or the rows of a table."""


def check_object_type(type_name: str, encoding: str) -> None:
    """Check that messages of a type can be decoded.

    Raises:
        DefinitionError: they cannot.
    """
    if not type_name.startswith(_PACKAGE):
        raise DefinitionError(
            f"messages encoded as {encoding!r} are not read, only ROS 1's, CDR and foxglove's"
        )
    if encoding == "protobuf":
        _message_class(type_name)


@lru_cache
def _message_class(type_name: str) -> Any:  # noqa: ANN401 - made by protobuf
    """Return the class that decodes a type."""
    name = type_name.removeprefix(_PACKAGE)
    try:
        return getattr(import_module(f"foxglove_schemas_protobuf.{name}_pb2"), name)
    except (ImportError, AttributeError) as error:
        raise DefinitionError(f"the installed schemas do not have {type_name}") from error


def decode_object(type_name: str, encoding: str, payload: bytes, fields: Fields) -> Row | None:
    """Return the values of a message's fields; None if it cannot be decoded."""
    if len(payload) > _LARGEST:
        return None
    # Imported late: other logs need no protobuf.
    from google.protobuf.message import DecodeError  # noqa: PLC0415

    try:
        if encoding == "json":
            return _row(json.loads(payload), fields)
        return _row(_message_class(type_name).FromString(payload), fields)
    except (DecodeError, *_FAULTS):
        return None


def table_of_rows(rows: Sequence[Row], fields: Fields) -> Table:
    """Return the columns of decoded messages, as those of ROS messages come."""
    numbers: dict[str, Sequence[float]] = {}
    times: dict[str, Sequence[int]] = {}
    columns: dict[str, Texts | Nested] = {}
    for index, field in enumerate(fields):
        values = [row[index] for row in rows]
        match field.kind:
            case Kind.TEXT:
                columns[field.path] = _texts(values)
            case Kind.TIME:
                times[f"{field.path}.sec"] = [seconds for seconds, _ in values]
                times[f"{field.path}.nanosec"] = [rest for _, rest in values]
            case Kind.TABLE:
                parent = np.repeat(np.arange(len(rows)), [len(each) for each in values])
                inner = [row for each in values for row in each]
                columns[field.path] = Nested(parent, table_of_rows(inner, field.inside))
            case _:
                numbers[field.path] = values
    runs = (_run(numbers, "<f8", len(rows)), _run(times, "<i8", len(rows)))
    return Table(len(rows), runs, columns)


def _run(columns: dict[str, Sequence[Any]], dtype: str, rows: int) -> np.ndarray[Any, Any]:
    run = np.zeros(rows, [(path, dtype) for path in columns])
    for path, values in columns.items():
        run[path] = values
    return run


def _texts(values: Sequence[str]) -> Texts:
    encoded = [value.encode("utf-8", "replace") for value in values]
    length: Ints = np.array([len(each) for each in encoded], np.int64)
    buffer = np.frombuffer(b"".join(encoded), np.uint8)
    return Texts(buffer, np.cumsum(length) - length, length)


def _row(message: Any, fields: Fields) -> Row:  # noqa: ANN401 - a message or a dict
    return [_value(message, field) for field in fields]


def _value(message: Any, field: Field) -> Any:  # noqa: ANN401
    value = message
    *outer, last = field.path.split(".")
    for name in outer:
        value = _member(value, name)
    if field.optional and not (last in value if isinstance(value, dict) else value.HasField(last)):
        return np.nan
    value = _member(value, last)
    match field.kind:
        case Kind.TEXT:
            if not isinstance(value, str):
                raise TypeError(field.path)
            return value
        case Kind.TIME:
            return _time(value)
        case Kind.TABLE:
            return [_row(each, field.inside) for each in value]
        case _:
            if isinstance(value, bool) or not isinstance(value, int | float):
                raise TypeError(field.path)
            return float(value)


def _member(value: Any, name: str) -> Any:  # noqa: ANN401
    return value[name] if isinstance(value, dict) else getattr(value, name)


def _time(value: Any) -> tuple[int, int]:  # noqa: ANN401
    """Return seconds and nanoseconds; 0, which is no stamp, outside what 64 bits hold."""
    names = ("sec", "nsec") if isinstance(value, dict) else ("seconds", "nanos")
    seconds, nanoseconds = (int(_member(value, name)) for name in names)
    inside = 0 <= seconds <= _LAST_SECOND and 0 <= nanoseconds < 1_000_000_000
    return (seconds, nanoseconds) if inside else (0, 0)
