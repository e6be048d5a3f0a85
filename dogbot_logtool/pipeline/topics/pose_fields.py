"""Poses inside messages of types that are not known: fields that a user may name as the base."""

from collections.abc import Iterator
from typing import Final

from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.pipeline.topics.readable import why_no_poses
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.decode.definition import Primitive, Struct
from dogbot_logtool.reader.messages.bases.registry import base_type
from dogbot_logtool.reader.messages.messages import definition_of
from dogbot_logtool.reader.messages.transforms import TRANSFORM_TYPES

_FORMS: Final = (("position", "orientation"), ("translation", "rotation"))
_DEEPEST: Final = 4
"""Messages within messages that are looked into."""
_MOST_TYPES: Final = 500


def pose_fields(log: Log) -> Iterator[tuple[str, Channel]]:
    """Yield the paths of single poses in messages of unknown types, with their channels."""
    seen: set[str] = set()
    for channel in log.channels.values():
        name = channel.type_name
        is_known = base_type(name) and not why_no_poses(channel)
        if is_known or name in TRANSFORM_TYPES or channel.topic in seen:
            continue
        if len(seen) == _MOST_TYPES:
            return
        seen.add(channel.topic)
        try:
            definition = definition_of(channel)
        except DefinitionError:
            continue
        yield from ((path, channel) for path in _poses("", definition, _DEEPEST) if path)


def _poses(path: str, struct: Struct, depth: int) -> Iterator[str]:
    if _is_pose(struct):
        yield path
        return
    for name, kind in struct.fields:
        if depth and isinstance(kind, Struct):
            yield from _poses(f"{path}.{name}" if path else name, kind, depth - 1)


def _is_pose(struct: Struct) -> bool:
    parts = dict(struct.fields)
    return any(
        _numbers(parts.get(position)) == ("x", "y", "z")
        and _numbers(parts.get(orientation)) == ("x", "y", "z", "w")
        for position, orientation in _FORMS
    )


def _numbers(field: object) -> tuple[str, ...]:
    """Return the names of a message's fields if all are numbers."""
    if not isinstance(field, Struct) or not all(isinstance(f, Primitive) for _, f in field.fields):
        return ()
    return tuple(name for name, _ in field.fields)
