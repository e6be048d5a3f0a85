"""Names of feet that messages of any type give in a string beside each element of an array."""

from collections.abc import Iterator

from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.decode.definition import (
    FieldType,
    FixedArray,
    Struct,
    Text,
    VariableArray,
)
from dogbot_logtool.reader.decode.paths import path_of
from dogbot_logtool.reader.messages.messages import definition_of
from dogbot_logtool.robot.first_messages import first_messages


def array_labels(log: Log, topic: str, array: str) -> tuple[str, ...]:
    """Return the strings beside the elements of an array.

    They are the same in all of the first messages, and each element has another one; else none.
    """
    for channel in log.channels_by_topic.get(topic, ()):
        try:
            definition = definition_of(channel)
        except DefinitionError:
            continue
        for path in _label_paths(definition, array):
            rows = _rows(log, channel, path)
            labels = next(iter(rows)) if len(rows) == 1 else ()
            if labels and all(labels) and len(labels) == len(set(labels)):
                return labels
    return ()


def _label_paths(definition: Struct, array: str) -> Iterator[str]:
    """Yield strings in the elements of an array, then arrays of strings beside it."""
    holder: FieldType = definition
    *outer, name = array.split(".")
    for part in outer:
        holder = dict(holder.fields)[part] if isinstance(holder, Struct) else holder
    if not isinstance(holder, Struct):
        return
    own = dict(holder.fields)[name]
    if isinstance(own, FixedArray | VariableArray) and isinstance(own.element, Struct):
        yield from _strings(f"{array}[]", own.element)
    for sibling, kind in holder.fields:
        if isinstance(kind, VariableArray) and isinstance(kind.element, Text):
            yield ".".join([*outer, f"{sibling}[]"])


def _strings(path: str, struct: Struct) -> Iterator[str]:
    """Yield the paths of all strings that are in no further array."""
    for name, kind in struct.fields:
        if isinstance(kind, Text):
            yield f"{path}.{name}"
        elif isinstance(kind, Struct):
            yield from _strings(f"{path}.{name}", kind)


def _rows(log: Log, channel: Channel, text: str) -> set[tuple[str, ...]]:
    """Return the different rows of strings of a channel's first messages."""
    path = path_of(text, "text")
    found: set[tuple[str, ...]] = set()
    for messages in first_messages(log, channel, path.fields):
        message, texts = path.texts(messages.table)
        code, names = texts.encode()
        rows: dict[int, list[str]] = {}
        for row, each in zip(message.tolist(), code.tolist(), strict=True):
            rows.setdefault(row, []).append(names[each])
        found |= set(map(tuple, rows.values()))
    return found
