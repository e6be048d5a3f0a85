"""Messages decoded by their formats' official libraries, from the definitions in the log.

Decoding is for the few messages whose bytes differ, so it is done one by one. The result is
a tree as `fields` compares it.
"""

import json
import struct
from collections.abc import Callable, Mapping
from dataclasses import asdict
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from dogbot_logtool.comparison.fields import Tree
from dogbot_logtool.reader.containers.log import Channel, Schema
from dogbot_logtool.reader.decode.definition import short_type_name

if TYPE_CHECKING:
    from google.protobuf.descriptor_pb2 import FileDescriptorProto
    from google.protobuf.message import Message
    from rosbags.typesys.store import Typestore

Decoder = Callable[[bytes], Tree]
"""Raises `Undecodable`."""
_ROS_ENCODINGS: Final = ("ros1", "cdr")
_ROS_DEFINITIONS: Final = ("ros1msg", "ros2msg", "ros2idl")
_UNKNOWN_FIELDS: Final = "(unknown fields)"
_FAULTS: Final = (ValueError, KeyError, IndexError, AssertionError, RecursionError)
"""Raised by libraries, beside errors of their own."""


class Undecodable(Exception):  # noqa: N818 - it never reaches a user
    """A message or a definition that its library refuses; the text says why."""


def decoded(channel: Channel, data: bytes) -> Tree:
    """Decode a message of a channel.

    Raises:
        Undecodable: it is none, or the encoding is not known, or the definition broken.
    """
    decoder = _decoder(channel.message_encoding, channel.schema)
    if isinstance(decoder, str):
        raise Undecodable(decoder)
    return decoder(data)


@lru_cache(maxsize=256)
def _decoder(encoding: str, schema: Schema | None) -> Decoder | str:
    """Return a decoder, or why there is none, which takes as long to find out."""
    try:
        if encoding == "json":
            return decode_json
        if schema is None:
            return "there is no message definition"
        if encoding in _ROS_ENCODINGS and schema.encoding in _ROS_DEFINITIONS:
            return _ros_decoder(encoding, schema)
        if encoding == "protobuf" and schema.encoding == "protobuf":
            return _protobuf_decoder(schema)
    except Undecodable as error:
        return str(error)
    return f"the encoding {encoding!r} is not known"


def decode_json(data: bytes) -> Tree:
    """Decode JSON text.

    Raises:
        Undecodable: it is none.
    """
    try:
        return json.loads(data)
    except (ValueError, RecursionError) as error:
        raise Undecodable(f"not JSON: {error}") from error


def ros_store(schema: Schema) -> "tuple[Typestore, str]":
    """Return rosbags' types of a definition, and the name of the one that it defines.

    Raises:
        Undecodable: it cannot be used.
    """
    # Imported late, here and below: slow to import, and rarely needed.
    from rosbags.typesys import (  # noqa: PLC0415
        Stores,
        TypesysError,
        get_types_from_idl,
        get_types_from_msg,
        get_typestore,
    )

    text = schema.data.decode("utf-8", "replace").replace("\r\n", "\n")
    package, _, name = short_type_name(schema.name).rpartition("/")
    store, type_name = get_typestore(Stores.EMPTY), f"{package}/msg/{name}"
    try:
        is_idl = schema.encoding == "ros2idl"
        store.register(get_types_from_idl(text) if is_idl else get_types_from_msg(text, type_name))
        store.get_msgdef(type_name)
    except (TypesysError, SyntaxError, *_FAULTS) as error:
        raise Undecodable(f"the definition of {schema.name} cannot be used") from error
    return store, type_name


def _ros_decoder(encoding: str, schema: Schema) -> Decoder:
    from rosbags.serde import SerdeError  # noqa: PLC0415

    store, type_name = ros_store(schema)
    deserialize = store.deserialize_ros1 if encoding == "ros1" else store.deserialize_cdr

    def decode(data: bytes) -> Tree:
        try:
            message: Any = deserialize(data, type_name)
            return asdict(message, dict_factory=_ros_struct)
        except (SerdeError, struct.error, MemoryError, *_FAULTS) as error:
            raise Undecodable(f"not a {schema.name}: {error}") from error

    return decode


def _ros_struct(fields: list[tuple[str, Tree]]) -> dict[str, Tree]:
    return {name: value for name, value in fields if name != "__msgtype__"}


def descriptor_files(schema: Schema) -> "list[FileDescriptorProto]":
    """Return the files of a protobuf schema.

    Raises:
        Undecodable: it is not a FileDescriptorSet.
    """
    from google.protobuf.descriptor_pb2 import FileDescriptorSet  # noqa: PLC0415
    from google.protobuf.message import DecodeError  # noqa: PLC0415

    try:
        return list(FileDescriptorSet.FromString(schema.data).file)
    except DecodeError as error:
        raise Undecodable(f"the definition of {schema.name} is no FileDescriptorSet") from error


def _protobuf_decoder(schema: Schema) -> Decoder:
    from google.protobuf.message import DecodeError  # noqa: PLC0415
    from google.protobuf.message_factory import GetMessages  # noqa: PLC0415

    try:
        kind = GetMessages(descriptor_files(schema))[schema.name]
    except (TypeError, *_FAULTS) as error:
        raise Undecodable(f"the definition of {schema.name} cannot be used") from error

    def decode(data: bytes) -> Tree:
        try:
            return protobuf_tree(kind.FromString(data))
        except (DecodeError, RecursionError) as error:
            raise Undecodable(f"not a {schema.name}: {error}") from error

    return decode


def protobuf_tree(message: "Message") -> dict[str, Tree]:
    """Turn a message into a tree; a field that is unset, though presence is tracked, is None."""
    from google.protobuf.unknown_fields import UnknownFieldSet  # noqa: PLC0415

    tree: dict[str, Tree] = {
        field.name: None
        if field.has_presence and not message.HasField(field.name)
        else _protobuf_value(getattr(message, field.name))
        for field in message.DESCRIPTOR.fields
    }
    if unknown := _unknown(UnknownFieldSet(message)):
        tree[_UNKNOWN_FIELDS] = unknown
    return tree


def _protobuf_value(value: Any) -> Tree:  # noqa: ANN401 - of any kind
    if hasattr(value, "DESCRIPTOR"):
        return protobuf_tree(value)
    if isinstance(value, bool | int | float | str | bytes):
        return value
    if isinstance(value, Mapping):
        return {str(key): _protobuf_value(value[key]) for key in sorted(value)}
    elements = [_protobuf_value(element) for element in value]
    return np.array(elements) if elements and isinstance(elements[0], float) else elements


def _unknown(fields: Any) -> list[Tree]:  # noqa: ANN401 - iterable, which its type hides
    return [
        {
            "number": field.field_number,
            "wire_type": field.wire_type,
            "data": field.data if isinstance(field.data, int | bytes) else _unknown(field.data),
        }
        for field in fields
    ]
