"""Decoded messages, turned back from columns into one value a message."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Flags
from dogbot_logtool.reader.decode.columns import Table
from dogbot_logtool.reader.decode.decode import decode
from dogbot_logtool.reader.decode.message_layout import Layout
from tests.reader.decode.generated_definitions import ROOT, Definition, Field
from tests.reader.decode.messages_by_rosbags import comparable


def messages_of(definition: Definition, table: Table) -> list[Any]:
    """Convert a table to one nested value a row."""
    return struct_rows(definition, ROOT, table, "")


def struct_rows(definition: Definition, name: str, table: Table, prefix: str) -> list[Any]:
    fields = definition.messages[name]
    values = [field_rows(definition, field, table, prefix + field.name) for field in fields]
    names = [field.name for field in fields]
    return [dict(zip(names, row, strict=True)) for row in zip(*values, strict=True)] or [
        {} for _ in range(table.rows)
    ]


def field_rows(definition: Definition, field: Field, table: Table, path: str) -> list[Any]:
    if field.array is None:
        if field.message is not None:
            return struct_rows(definition, field.message, table, f"{path}.")
        return single_rows(field, table, path)
    if field.is_number and field.array != "variable":
        matrix = table.numbers(path)
        assert matrix.shape == (table.rows, field.array)
        return [[comparable(number, field.kind) for number in row] for row in matrix]
    nested = table.nested(path)
    assert len(nested.parent) == nested.table.rows
    if field.message is not None:
        elements = struct_rows(definition, field.message, nested.table, "")
    else:
        elements = single_rows(field, nested.table, "value")
    rows: list[list[Any]] = [[] for _ in range(table.rows)]
    for parent, element in zip(nested.parent.tolist(), elements, strict=True):
        rows[parent].append(element)
    return rows


def single_rows(field: Field, table: Table, path: str) -> list[Any]:
    if field.kind == "string":
        texts = table.texts(path)
        return [texts.text(row) for row in range(table.rows)]
    numbers = table.numbers(path)
    assert numbers.shape == (table.rows,)
    return [comparable(number, field.kind) for number in numbers]


class Decoded(NamedTuple):
    """What `decode` returns."""

    table: Table
    sound: Flags


def decode_messages(layout: Layout, messages: Sequence[bytes], seed: int = 0) -> Decoded:
    """Decode messages that stand in a buffer in any order, with rubbish between them."""
    random = np.random.default_rng(seed)
    start = np.zeros(len(messages), np.int64)
    buffer = bytearray()
    for row in random.permutation(len(messages)):
        buffer += b"\xff" * int(random.integers(0, 9))
        start[row] = len(buffer)
        buffer += messages[row]
    return decode_at(layout, bytes(buffer), start, [len(message) for message in messages])


def decode_alone(layout: Layout, message: bytes) -> Decoded:
    """Decode a message that is all there is in the buffer."""
    return decode_at(layout, message, np.zeros(1, np.int64), [len(message)])


def decode_at(layout: Layout, buffer: bytes, start: Any, length: Sequence[int]) -> Decoded:
    end = start + np.array(length, np.int64)
    return Decoded(*decode(layout, np.frombuffer(buffer, np.uint8), start, end))
