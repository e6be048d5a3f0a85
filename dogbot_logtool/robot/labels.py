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
from dogbot_logtool.robot.topics import first_messages


def array_labels(log: Log, topic: str, path: str) -> tuple[str, ...]:
    """Return the strings beside the elements of an array, in them or in an array beside it.

    They are the same in all of the first messages, and each element has another one; else none.
    """
    if path.count("[]") != 1:
        return ()
    array = path.partition("[]")[0]
    for channel in log.channels_by_topic.get(topic, ()):
        try:
            texts = [each for each in _text_paths("", definition_of(channel)) if "[]" in each]
        except DefinitionError:
            continue
        holder = array.rpartition(".")[0]
        own = [each for each in texts if each.startswith(f"{array}[].")]
        beside = [each for each in texts if each.rpartition(".")[0] == holder and each[-1] == "]"]
        for each in (*own, *beside):
            rows = _rows_of_texts(log, channel, each) if each.count("[]") == 1 else set()
            labels = next(iter(rows)) if len(rows) == 1 else ()
            if labels and all(labels) and len(labels) == len(set(labels)):
                return labels
    return ()


def _text_paths(path: str, kind: FieldType) -> Iterator[str]:
    """Yield the paths of all strings, with ``[]`` for an index."""
    if isinstance(kind, Text):
        yield path
    elif isinstance(kind, FixedArray | VariableArray):
        yield from _text_paths(f"{path}[]", kind.element)
    elif isinstance(kind, Struct):
        for name, inner in kind.fields:
            yield from _text_paths(f"{path}.{name}".lstrip("."), inner)


def _rows_of_texts(log: Log, channel: Channel, text: str) -> set[tuple[str, ...]]:
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
