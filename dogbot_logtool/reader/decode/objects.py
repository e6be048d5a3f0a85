"""Messages of protobuf and JSON, which a library decodes one by one.

The definitions of such messages are the library's; `foxglove.` types are known. Each is written
anew as ROS 1 writes messages, which are decoded like all others. They come some hundred times a
second, not thousands.
"""

import json
import math
import struct
from functools import lru_cache
from importlib import import_module
from typing import Any, Final

from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.decode.definition import (
    FieldType,
    Primitive,
    Struct,
    Text,
    VariableArray,
    clock,
)

OBJECT_ENCODINGS: Final = frozenset({"protobuf", "json"})
_PACKAGE: Final = "foxglove."
_LARGEST: Final = 1 << 20
"""Bytes of a message, some ten thousand transforms; decoded, a hostile one takes much more."""
_LAST_SECOND: Final = (1 << 32) - 1
_FAULTS: Final = (ValueError, TypeError, KeyError, AttributeError, OverflowError, RecursionError)
_NUMBER: Final = Primitive("f8", "float64")
_OPTIONAL: Final = Primitive("f8", "optional float64")
"""A number that a message may lack, and which then is NaN."""
_TIME: Final = clock("time", "u4", "u4")
_TIMES: Final = ("google.protobuf.Timestamp", "google.protobuf.Duration")


@lru_cache
def object_definition(type_name: str, encoding: str) -> Struct:
    """Return the definition of a type whose messages are objects.

    Raises:
        DefinitionError: it is not known.
    """
    if not type_name.startswith(_PACKAGE):
        raise DefinitionError(
            f"messages encoded as {encoding!r} are not read, only ROS 1's, CDR and foxglove's"
        )
    return _struct(_message_class(type_name).DESCRIPTOR)


@lru_cache
def _message_class(type_name: str) -> Any:  # noqa: ANN401 - made by protobuf
    """Return the class that decodes a type."""
    name = type_name.removeprefix(_PACKAGE)
    try:
        return getattr(import_module(f"foxglove_schemas_protobuf.{name}_pb2"), name)
    except (ImportError, AttributeError) as error:
        raise DefinitionError(f"the installed schemas do not have {type_name}") from error


def _struct(descriptor: Any) -> Struct:  # noqa: ANN401 - protobuf's
    if descriptor.full_name in _TIMES:
        return _TIME
    return Struct(descriptor.full_name, tuple((f.name, _type(f)) for f in descriptor.fields))


def _type(field: Any) -> FieldType:  # noqa: ANN401
    kind: FieldType = _OPTIONAL if field.has_presence else _NUMBER
    if field.message_type is not None:
        kind = _struct(field.message_type)
    elif field.type in {field.TYPE_STRING, field.TYPE_BYTES}:
        kind = Text()
    # Versions of protobuf name repeated fields differently.
    return VariableArray(kind) if field.default_value == [] else kind


def as_ros1(type_name: str, encoding: str, payload: bytes, definition: FieldType) -> bytes | None:
    """Return a message as ROS 1 would write it; None if it cannot be decoded.

    Args:
        type_name: of the message.
        encoding: one of `OBJECT_ENCODINGS`.
        payload: the message.
        definition: of the message.
    """
    if len(payload) > _LARGEST:
        return None
    # Imported late: other logs need no protobuf.
    from google.protobuf.message import DecodeError  # noqa: PLC0415

    try:
        if encoding == "json":
            return _written(json.loads(payload), definition)
        return _written(_message_class(type_name).FromString(payload), definition)
    except (DecodeError, *_FAULTS):
        return None


def _written(value: Any, kind: FieldType) -> bytes:  # noqa: ANN401 - a message, a dict, a number
    match kind:
        case Struct() if kind is _TIME:
            return struct.pack("<II", *_time(value))
        case Struct(_, fields):
            return b"".join(_written(_member(value, name, inner), inner) for name, inner in fields)
        case VariableArray(element):
            elements = [_written(each, element) for each in value]
            return struct.pack("<I", len(elements)) + b"".join(elements)
        case Text():
            text: bytes = value.encode("utf-8", "replace")
            return struct.pack("<I", len(text)) + text
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError
    return struct.pack("<d", float(value))


def _member(value: Any, name: str, kind: FieldType) -> Any:  # noqa: ANN401
    """Return a field; of one that is not there the number is NaN, and text and array are empty."""
    if isinstance(value, dict):
        return value.get(name, _absent(kind))
    return math.nan if kind is _OPTIONAL and not value.HasField(name) else getattr(value, name)


def _absent(kind: FieldType) -> Any:  # noqa: ANN401
    match kind:
        case Struct():
            return {}
        case Text() | VariableArray():
            return ""
    return math.nan


def _time(value: Any) -> tuple[int, int]:  # noqa: ANN401
    """Return seconds and nanoseconds; 0, which is no stamp, outside what ROS 1's times hold."""
    is_dict = isinstance(value, dict)
    parts = (value.get("sec", 0), value.get("nsec", 0)) if is_dict else (value.seconds, value.nanos)
    seconds, nanoseconds = map(int, parts)
    inside = 0 <= seconds <= _LAST_SECOND and 0 <= nanoseconds < 1_000_000_000
    return (seconds, nanoseconds) if inside else (0, 0)
