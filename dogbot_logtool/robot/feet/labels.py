"""Names of feet that messages of any type give in a string beside each element of an array."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.decode.columns import Nested
from dogbot_logtool.reader.decode.definition import (
    FieldType,
    FixedArray,
    Struct,
    Text,
    VariableArray,
)
from dogbot_logtool.reader.decode.fields import Field, table, text, texts
from dogbot_logtool.reader.decode.message_layout import ELEMENT
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.reader.messages.messages import decode_channels, definition_of
from dogbot_logtool.robot.chunks import spread_chunks
from dogbot_logtool.robot.feet.names import label_names


@dataclass(frozen=True, slots=True)
class _Labels:
    """A field that may name the elements of an array."""

    field: Field
    array: str
    inner: str
    """Path of the string inside an element."""


def with_labels(log: Log, feet: Sequence[Foot]) -> tuple[tuple[Foot, ...], tuple[str, ...]]:
    """Name feet that are elements of one array by the strings beside them.

    Args:
        log: the log.
        feet: their fields are the first elements of an array, in its order.

    Returns:
        the feet, and what messages call them; nothing where they do not name them, or not all
        messages in the same order.
    """
    field = feet[0].field
    if field is None or "[" not in field.path:
        return tuple(feet), ()
    called = labels_of_array(log, feet[0].topic, field.path.partition("[")[0])
    return (_named(feet, called), called) if len(called) == len(feet) else (tuple(feet), ())


def labels_of_array(log: Log, topic: str, array: str) -> tuple[str, ...]:
    """Return the strings beside the elements of an array, the same in all messages; else none."""
    for channel in log.channels_by_topic.get(topic, ()):
        try:
            definition = definition_of(channel)
        except DefinitionError:
            continue
        for labels in _label_fields(definition, array):
            if called := _constant(log, channel.id, labels):
                return called
    return ()


def _named(feet: Sequence[Foot], called: Sequence[str]) -> tuple[Foot, ...]:
    named = label_names(called)
    if len({each.name for each in named}) < len(named):
        return tuple(feet)
    return tuple(
        replace(foot, name=each.name, leg_position=each.position)
        for foot, each in zip(feet, named, strict=True)
    )


def _label_fields(definition: Struct, array: str) -> Iterator[_Labels]:
    """Yield strings in the elements of an array, then arrays of strings beside it."""
    holder: FieldType = definition
    *outer, name = array.split(".")
    for part in outer:
        holder = dict(holder.fields)[part] if isinstance(holder, Struct) else holder
    if not isinstance(holder, Struct):
        return
    own = dict(holder.fields)[name]
    element = own.element if isinstance(own, FixedArray | VariableArray) else None
    if isinstance(element, Struct):
        for inner in _strings("", element):
            yield _Labels(table(array, text(inner)), array, inner)
    for sibling, kind in holder.fields:
        if isinstance(kind, VariableArray) and isinstance(kind.element, Text):
            path = ".".join([*outer, sibling])
            yield _Labels(texts(path), path, ELEMENT)


def _strings(path: str, struct: Struct) -> Iterator[str]:
    """Yield the paths of all strings that are in no further array."""
    for name, kind in struct.fields:
        inner = f"{path}.{name}" if path else name
        if isinstance(kind, Text):
            yield inner
        elif isinstance(kind, Struct):
            yield from _strings(inner, kind)


def _constant(log: Log, channel: int, labels: _Labels) -> tuple[str, ...]:
    """Return the strings of the elements, if all messages have the same; else nothing."""
    channels = [log.channels[channel]]
    found: set[tuple[str, ...]] = set()
    for span in log.grouped(spread_chunks(log, {channel})):
        for messages in decode_channels(log.read(span), channels, (labels.field,)):
            found |= _rows(messages.table.nested(labels.array), labels.inner)
    called = next(iter(found)) if len(found) == 1 else ()
    distinct = len(called) == len(set(called)) and all(called)
    return called if distinct else ()


def _rows(nested: Nested, inner: str) -> set[tuple[str, ...]]:
    """Return the different rows of strings of all messages."""
    code, names = nested.table.texts(inner).encode()
    rows: dict[int, list[int]] = {}
    for parent, each in zip(nested.parent.tolist(), code.tolist(), strict=True):
        rows.setdefault(parent, []).append(each)
    return {tuple(names[each] for each in row) for row in map(tuple, rows.values())}
