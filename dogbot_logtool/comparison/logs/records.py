"""The contents of a log beside its messages, as a tree: profile, metadata, attachments."""

import hashlib
import struct
from collections.abc import Mapping
from io import BytesIO
from typing import Final

from mcap import records
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode

from dogbot_logtool.comparison.fields import Tree
from dogbot_logtool.reader.containers.log import Extra, Log

OWN_VERSION: Final = "metadata:dogbot_logtool.version"
"""The version of this program that wrote a file says nothing of what is in it."""
_HEAD_SIZE: Final = 9
_PIECE: Final = 1 << 20
_LARGEST_METADATA: Final = 64 << 20


def records_tree(log: Log) -> Mapping[str, Tree]:
    """Return a log's records beside its messages, by the names that patterns know them by.

    Attachments are compared by type, size and the hash of their content, which bounds the memory.
    Their times are not compared: they say when a file was attached, not what it holds.
    """
    metadata: dict[str, Tree] = {}
    attachments: dict[str, Tree] = {}
    for extra in log.extras:
        if extra.opcode == Opcode.METADATA:
            name, value = _metadata(log, extra)
            _add(metadata, f"metadata:{name}", value)
        else:
            name, value = _attachment(log, extra)
            _add(attachments, f"attachment:{name}", value)
    return {"profile": log.profile, **metadata, **attachments}


def _add(named: dict[str, Tree], name: str, value: Tree) -> None:
    """Add a value; a second of the same name gets a number."""
    number = 1
    unique = name
    while unique in named:
        number += 1
        unique = f"{name} ({number})"
    named[unique] = value


def _metadata(log: Log, extra: Extra) -> tuple[str, Tree]:
    size = min(extra.size - _HEAD_SIZE, _LARGEST_METADATA)
    body = log.source_of(extra).read(extra.offset + _HEAD_SIZE, size)
    try:
        record = records.Metadata.read(ReadDataStream(BytesIO(body)))
    except (McapError, struct.error, ValueError, OverflowError):
        return "(damaged)", body[:_PIECE]
    return record.name, dict(record.metadata)


def _attachment(log: Log, extra: Extra) -> tuple[str, Tree]:
    """Describe an attachment: log and create time, name, media type, then size and content."""
    offset = extra.offset + _HEAD_SIZE
    end = extra.offset + extra.size
    head = log.source_of(extra).read(offset, min(_PIECE, end - offset))
    try:
        at, texts = 16, []
        for _ in range(2):
            (length,) = struct.unpack_from("<I", head, at)
            texts.append(str(head[at + 4 : at + 4 + length], "utf-8", "replace"))
            at += 4 + length
        (size,) = struct.unpack_from("<Q", head, at)
    except struct.error:
        return "(damaged)", head
    start = offset + at + 8
    content = hashlib.sha256()
    for piece in range(start, min(start + size, end), _PIECE):
        content.update(log.source_of(extra).read(piece, min(_PIECE, start + size - piece)))
    return texts[0], {"media_type": texts[1], "size": size, "sha256": content.hexdigest()}
