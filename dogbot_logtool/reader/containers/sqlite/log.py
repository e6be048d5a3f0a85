"""ROS 2 bags in SQLite (.db3): rows become topics and messages, runs of rows become chunks."""

from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Ints, rows_by_group
from dogbot_logtool.errors import LogError
from dogbot_logtool.io.storage import name_of
from dogbot_logtool.reader.containers.compression import unpacked
from dogbot_logtool.reader.containers.log import (
    Batch,
    Channel,
    Chunk,
    LoadedChunk,
    Log,
    Messages,
    Schema,
    Span,
    counts_by_channel,
    time_range,
)
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.source import ByteSource
from dogbot_logtool.reader.containers.sqlite.journals import with_journals
from dogbot_logtool.reader.containers.sqlite.pages import Damage, Pages
from dogbot_logtool.reader.containers.sqlite.tables import (
    MessageTable,
    find_tables,
    small_rows,
)
from dogbot_logtool.reader.decode.definition import known_definition, long_type_name

_CHUNK_SIZE: Final = 1 << 20
"""Bytes of messages from which a chunk is full."""
_LARGEST_ID: Final = 0xFFFF
"""Of a channel of an MCAP; topics are numbered from 1 on."""
_COLUMNS: Final = {
    "topics": ("id", "name", "type"),
    "messages": ("id", "topic_id", "timestamp", "data"),
    "message_definitions": ("id", "topic_type", "encoding", "encoded_message_definition"),
    "schema": ("schema_version", "ros_distro"),
}
"""With which the tables of all recorders begin; only newer recorders write the latter two."""
_NEEDED: Final = ("topics", "messages")


class SqliteLog(Log):
    """A .db3 file."""

    container = "ROS 2 bag (sqlite3)"
    profile = "ros2"

    def __init__(self, source: ByteSource, table: MessageTable) -> None:
        super().__init__(source)
        self._table = table

    def _read(self, span: Span) -> Batch:
        """See `Log.read`."""
        bounds = [(chunk.data_offset, chunk.end) for chunk in span]
        leaf, messages, buffer = self._table.between(*bounds)
        losses: list[Loss] = []
        loaded: list[LoadedChunk] = []
        for chunk in span:
            rows = slice(*np.searchsorted(leaf, (chunk.data_offset, chunk.end + 1)).tolist())
            loaded.append(LoadedChunk(chunk, memoryview(b""), rows, whole=False))
            if lost := (chunk.messages or 0) - (rows.stop - rows.start):
                what = f"the database is damaged: {lost} messages cannot be read"
                losses.append(Loss(0, what, 0, lost))
        return unpacked(Batch(buffer, messages, tuple(loaded), tuple(losses)))


def open_log(source: ByteSource, distribution: str) -> SqliteLog:
    """Open a .db3 file whose magic has been seen, with the journal beside it.

    Args:
        source: the file.
        distribution: ROS 2 distribution that recorded it, if metadata tells; the file's own
            word goes first.

    Raises:
        LogError: it is no ROS 2 bag, or nothing of it can be read.
    """
    with ExitStack() as opened:
        source = source.nearby()
        opened.callback(source.close)
        source, losses = with_journals(source)
        opened.callback(source.close)
        pages = Pages(source)
        if cut := pages.cut_off():
            losses.append(cut)
        damage = Damage()
        tables = find_tables(pages, _COLUMNS, damage)
        for name in _NEEDED:
            if name not in tables:
                met = damage.loss(pages.size)
                lacks = f"no ROS 2 bag: no table {name!r} with {', '.join(_COLUMNS[name])}"
                what = lacks if met is None else met.what
                raise LogError(f"{name_of(source.path)}: is a SQLite database, but {what}")
        channels = read_topics(tables, pages, damage, distribution)
        table = MessageTable(pages, tables["messages"], [*channels], damage)
        log = SqliteLog(source, table)
        log.chunks = [*_chunks(table)]
        opened.pop_all()
    counts: Counter[int] = Counter(dict.fromkeys(channels, 0))
    for chunk in log.chunks:
        counts.update(chunk.counts or {})
    log.channels, log.counts = channels, counts
    log.start_time, log.end_time = time_range(log.chunks)
    log.losses = [*losses, *_losses(table, damage)]
    return log


def _chunks(table: MessageTable) -> Iterator[Chunk]:
    """Cut the rows into chunks of whole leaf pages, of about `_CHUNK_SIZE` bytes."""
    number = 0
    for leaf, messages, _ in table.rows():
        full = np.cumsum(messages.end - messages.start + 1) // _CHUNK_SIZE
        # A page belongs to the chunk that its first row does.
        for _, rows in rows_by_group(full[np.searchsorted(leaf, leaf)]):
            yield _chunk(number, leaf[rows], messages.pick(rows), table.pages.size)
            number += 1


def _losses(table: MessageTable, damage: Damage) -> Iterator[Loss]:
    if met := damage.loss(table.pages.size, table.times_around):
        yield met
    for count, what in (
        (damage.undescribed, "messages of topics that are nowhere described"),
        (damage.unsound, "rows that are no messages"),
    ):
        if count:
            yield Loss(0, f"the database holds {count} {what}", 0, count)


def _chunk(number: int, leaf: Ints, messages: Messages, page_size: int) -> Chunk:
    size = int((messages.end - messages.start).sum())
    first, last = int(leaf[0]), int(leaf[-1])
    return Chunk(
        offset=number,
        data_offset=first,
        data_size=size,
        end=last,
        index_end=last,
        compression="",
        size=max(size, (last - first + 1) * page_size),
        start_time=int(messages.log_time.min()),
        end_time=int(messages.log_time.max()),
        counts=counts_by_channel(messages),
    )


def read_topics(
    tables: Mapping[str, int], pages: Pages, damage: Damage, distribution: str
) -> dict[int, Channel]:
    """Return the topics; definitions of their types that the log has itself go first."""
    definitions: dict[str, tuple[str, str]] = {}
    definitions_root = tables.get("message_definitions")
    for name, encoding, text in small_rows(pages, definitions_root, (1, 2, 3), damage):
        if encoding in {"ros2msg", "ros2idl"} and text:
            definitions.setdefault(long_type_name(str(name)), (str(encoding), str(text)))
    for (own,) in small_rows(pages, tables.get("schema"), (1,), damage):
        distribution = own if isinstance(own, str) else distribution
    topics: dict[int, tuple[str, str, str, str]] = {}
    # Those that have more columns have the format and the profiles as fourth and fifth.
    for number, name, kind, form, profiles in small_rows(pages, tables["topics"], range(5), damage):
        if not (isinstance(number, int) and isinstance(name, str) and isinstance(kind, str)):
            continue
        if 0 <= number <= _LARGEST_ID:
            encoding = "cdr" if form is None else str(form)
            topics.setdefault(number, (name, long_type_name(kind), encoding, str(profiles or "")))
    schemas: dict[str, Schema] = {}
    channels: dict[int, Channel] = {}
    for id_, (name, kind, encoding, profiles) in sorted(topics.items()):
        if kind not in schemas:
            known = known_definition(kind, distribution)
            shipped = ("", "") if known is None else ("ros2msg", known)
            form, text = definitions.get(kind, shipped)
            schemas[kind] = Schema(len(schemas) + 1, kind, form, text.encode())
        metadata = {"offered_qos_profiles": profiles} if profiles else {}
        channels[id_] = Channel(id_, name, encoding, schemas[kind], metadata)
    return channels
