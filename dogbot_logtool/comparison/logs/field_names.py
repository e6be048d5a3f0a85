"""The names of all fields, for telling which patterns fit nothing.

Messages whose bytes are equal are never decoded, so the names come from the definitions.
"""

from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Any, Final

from dogbot_logtool.comparison.fields import Tree, join
from dogbot_logtool.comparison.logs.decoders import Undecodable, protobuf_class, ros_store
from dogbot_logtool.reader.containers.log import Channel, Schema

ALWAYS: Final = ("publish_time", "payload")
"""Fields that every message has besides its own."""
_MOST_NAMES: Final = 10_000
"""Definitions that hold one another many times over have more than anybody would count."""


def message_fields(channel: Channel) -> Sequence[str] | None:
    """Return the names of all fields of a channel's messages; None where no definition tells."""
    try:
        names = list(islice(_defined_fields(channel.schema), _MOST_NAMES))
    except (Undecodable, RecursionError):
        return None
    return names if len(names) < _MOST_NAMES else None


def _defined_fields(schema: Schema | None) -> Iterator[str]:
    if schema is None:
        raise Undecodable("there is no message definition")
    if schema.encoding == "protobuf":
        yield from _protobuf_fields(protobuf_class(schema).DESCRIPTOR, "", ())
    elif schema.encoding.startswith("ros"):
        store, type_name = ros_store(schema)
        yield from _ros_fields(store.fielddefs, type_name, "")
    else:
        raise Undecodable("the definition is of an unknown kind")


def tree_names(value: Tree, name: str = "") -> Iterator[str]:
    """Yield the names of all values of a JSON document; elements of a list share one."""
    if isinstance(value, dict):
        for key, inner in value.items():
            below = join(name, key)
            yield below
            yield from tree_names(inner, below)
    elif isinstance(value, list):
        for inner in value:
            yield from tree_names(inner, name)


def _ros_fields(types: Any, type_name: str, name: str) -> Iterator[str]:  # noqa: ANN401
    from rosbags.interfaces import Nodetype  # noqa: PLC0415 - slow to import

    for field, kind in types[type_name][1]:
        below = join(name, field)
        yield below
        node, inner = kind
        if node in {Nodetype.ARRAY, Nodetype.SEQUENCE}:
            node, inner = inner[0]
        if node == Nodetype.NAME:
            yield from _ros_fields(types, inner, below)


def _protobuf_fields(kind: Any, name: str, above: tuple[str, ...]) -> Iterator[str]:  # noqa: ANN401
    for field in kind.fields:
        below = join(name, field.name)
        yield below
        inner = field.message_type
        # A type within itself goes on for ever.
        if inner is not None and inner.full_name not in above:
            yield from _protobuf_fields(inner, below, (*above, kind.full_name))
