"""Messages decoded by their formats' official libraries, from the definitions in the log.

Decoding is for the few messages whose bytes differ, so it is done one by one. The result is
a tree as `fields` compares it.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from dogbot_logtool.comparison.fields import Tree
from dogbot_logtool.reader.containers.log import Channel, Schema
from dogbot_logtool.reader.decode.definition import long_type_name, parse_types

if TYPE_CHECKING:
    from google.protobuf.descriptor_pb2 import FileDescriptorProto
    from google.protobuf.message import Message
    from rosbags.typesys.store import Typestore

Decoder = Callable[[bytes], Tree]
"""Raises whatever its library does."""
ROS_DEFINITIONS: Final = ("ros1msg", "ros2msg", "ros2idl")


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
    try:
        return decoder(data)
    except Exception as error:  # a library's, on bytes that may be anything
        raise Undecodable(f"not a {channel.type_name or 'message'}: {error}") from error


@lru_cache(maxsize=256)
def _decoder(encoding: str, schema: Schema | None) -> Decoder | str:
    """Return a decoder, or why there is none, which takes as long to find out."""
    if encoding == "json":
        return json.loads
    if schema is None:
        return "there is no message definition"
    try:
        if encoding in {"ros1", "cdr"} and schema.encoding in ROS_DEFINITIONS:
            return _ros_decoder(encoding, schema)
        if encoding == "protobuf" and schema.encoding == "protobuf":
            return _protobuf_decoder(schema)
    except Exception:  # noqa: BLE001 - a library's, on a definition that may be anything
        return f"the definition of {schema.name} cannot be used"
    return f"the encoding {encoding!r} is not known"


def ros_store(schema: Schema) -> "tuple[Typestore, str]":
    """Return rosbags' types of a definition, and the name of the one that it defines."""
    # Imported late, here and below: slow to import, and rarely needed.
    from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415

    store, name = get_typestore(Stores.EMPTY), long_type_name(schema.name)
    store.register(parse_types(name, schema.data.decode("utf-8", "replace"), schema.encoding))
    return store, name


def _ros_decoder(encoding: str, schema: Schema) -> Decoder:
    store, name = ros_store(schema)
    store.get_msgdef(name)
    deserialize = store.deserialize_ros1 if encoding == "ros1" else store.deserialize_cdr

    return lambda data: _ros_tree(deserialize(data, name))


def _ros_tree(value: Any) -> Tree:  # noqa: ANN401 - a message, a list or a leaf
    if hasattr(value, "__msgtype__"):
        return {n: _ros_tree(each) for n, each in vars(value).items() if n != "__msgtype__"}
    return [_ros_tree(each) for each in value] if isinstance(value, list) else value


def descriptor_files(schema: Schema) -> "Sequence[FileDescriptorProto]":
    """Return the files of a protobuf schema."""
    from google.protobuf.descriptor_pb2 import FileDescriptorSet  # noqa: PLC0415

    return FileDescriptorSet.FromString(schema.data).file


def _protobuf_decoder(schema: Schema) -> Decoder:
    from google.protobuf.message_factory import GetMessages  # noqa: PLC0415

    kind = GetMessages(descriptor_files(schema))[schema.name]
    return lambda data: _protobuf_tree(kind.FromString(data))


def _protobuf_tree(message: "Message") -> dict[str, Tree]:
    """Turn a message into a tree; a field that is unset, though presence is tracked, is None."""
    tree: dict[str, Tree] = {
        field.name: None
        if field.has_presence and not message.HasField(field.name)
        else _protobuf_value(getattr(message, field.name))
        for field in message.DESCRIPTOR.fields
    }
    rest = type(message)()
    rest.CopyFrom(message)
    for field, _ in message.ListFields():
        rest.ClearField(field.name)
    if unknown := rest.SerializeToString():
        tree["(unknown fields)"] = unknown
    return tree


def _protobuf_value(value: Any) -> Tree:  # noqa: ANN401 - of any kind
    if hasattr(value, "DESCRIPTOR"):
        return _protobuf_tree(value)
    if isinstance(value, bool | int | float | str | bytes):
        return value
    if isinstance(value, Mapping):
        return {str(key): _protobuf_value(value[key]) for key in sorted(value)}
    elements = [_protobuf_value(element) for element in value]
    return np.array(elements) if elements and isinstance(elements[0], float) else elements
