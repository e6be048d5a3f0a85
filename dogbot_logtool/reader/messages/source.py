"""Rows of the table, fitted to the definitions of a log: how a channel's messages are read."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.log import Batch, Channel
from dogbot_logtool.reader.decode.definition import Struct
from dogbot_logtool.reader.decode.paths import Columns, FieldPath, Want, columns_of, path_of
from dogbot_logtool.reader.messages.message_type import WANTS, MessageType, Part
from dogbot_logtool.reader.messages.messages import (
    DecodedMessages,
    decode_channels,
    described,
    without_sender,
)
from dogbot_logtool.reader.messages.table import rows_of

Paths = Mapping[str, tuple[FieldPath, ...]]
"""By the row's field; a path a leg where the row has a path a leg."""


@dataclass(frozen=True, slots=True, eq=False)
class Source:
    """A row of the table that is fitted to a definition."""

    row: MessageType
    paths: Paths
    columns: Columns
    """What is decoded of each message."""
    fault: str = ""
    """Why messages cannot be read; empty: they can."""
    own_definition: str = ""
    """Why this program's definition is used, not the log's; empty: the log's is."""

    @property
    def has_header(self) -> bool:
        """Without one, log time is the only time."""
        return "stamp" in self.paths

    @property
    def has_force(self) -> bool:
        """Without, it only tells whether a foot touches."""
        return bool(self.row.force or self.row.pairs)

    @property
    def has_points(self) -> bool:
        """Whether it tells where the foot touches."""
        return "point" in self.paths or self.row.pairs is not None

    @property
    def has_flags(self) -> bool:
        """Whether its messages have contact flags, which decide contact whatever the force."""
        return bool(self.row.flag) and not self.row.words

    @property
    def in_base(self) -> bool:
        """Whether its points are in the base's frame."""
        return "point" in self.paths and self.row.points_in == "base"

    @property
    def tells_all_feet(self) -> bool:
        """Whether one message tells of all feet."""
        return bool(self.row.legs or self.row.label or self.row.by_place)

    @property
    def is_transform(self) -> bool:
        """Whether its poses are transforms of the log's own frame tree."""
        return len(self.row.choose) > 1

    @property
    def has_one_stamp(self) -> bool:
        """Whether each message has a stamp, and one pose at most."""
        return self.has_header and not self.row.choose and not self._lists("position")

    def _lists(self, field: str) -> bool:
        return field in self.paths and self.paths[field][0].is_array_of_elements

    def stamps(self, messages: DecodedMessages) -> Ints:
        """Return (n,) ns, the stamps of n messages; 0: none."""
        if not self.has_header or self._lists("stamp"):
            return np.zeros(len(messages.log_time), np.int64)
        return self.paths["stamp"][0].times(messages.table)


class Topic(NamedTuple):
    """A topic that tells of a part of a walk, and how its messages are read."""

    source: Source
    channels: tuple[Channel, ...]
    """At least one, all of one definition."""
    element: str = ""
    """Which of the poses in a message: a model, a link, a pair of frames; empty: the only one."""

    @property
    def topic(self) -> str:
        """The topic."""
        return self.channels[0].topic

    @property
    def name(self) -> str:
        """The topic with the element, as ``--odom-topic`` takes them."""
        return f"{self.topic}:{self.element}" if self.element else self.topic


def decoded_by(
    batch: Batch, sources: Iterable[tuple[Channel, Source | None]]
) -> Iterator[tuple[Source, DecodedMessages]]:
    """Yield the messages of channels and how they are read, one entry a definition.

    Args:
        batch: messages.
        sources: channels and how each is read; None, or one with a fault: it is not.
    """
    groups: dict[Source, list[Channel]] = {}
    for channel, source in sources:
        if source is not None and not source.fault:
            groups.setdefault(source, []).append(channel)
    for source, own in groups.items():
        yield from ((source, each) for each in decode_channels(batch, own, source.columns))


def source_of(channel: Channel, part: Part) -> Source | None:
    """Return how a part of a channel's messages is read; None: they do not tell of it.

    A type is known by its name and its fields. Where the fields of a type's own package differ,
    the source says why it cannot be read.
    """
    if part == "feet" and not any(
        channel.topic.rstrip("/").endswith(row.topic_end)
        for row in rows_of(channel.type_name, part)
    ):
        return None
    return _source_of(without_sender(channel), part)


@lru_cache(maxsize=1024)
def _source_of(channel: Channel, part: Part) -> Source | None:
    rows = rows_of(channel.type_name, part)
    found = first_fitting(channel, rows, part) if rows else None
    return None if found and found.fault and rows[0].name != channel.type_name else found


def first_fitting(channel: Channel, rows: Iterable[MessageType], part: Part) -> Source:
    """Return the first row that fits a channel's definition; if none does, why the first does not.

    Args:
        channel: the channel.
        rows: at least one.
        part: what is read of it.
    """
    faulty: list[Source] = []
    for row in rows:
        try:
            return _fitted(row, part, channel)
        except DefinitionError as error:
            faulty.append(Source(row, {}, (), fault=str(error)))
    return faulty[0]


def _fitted(row: MessageType, part: Part, channel: Channel) -> Source:
    """Return a row with the paths that a channel's definition has.

    Raises:
        DefinitionError: it lacks one.
    """
    definition, own_because = described(channel)
    wants = dict(WANTS[part])
    if part == "feet" and row.axes is not WrenchFrame.LINK:
        del wants["frame"]
    if part == "feet" and row.by_place:
        wants |= {field: WANTS["base"][field] for field in ("position", "orientation")}
    found: dict[str, tuple[FieldPath, ...]] = {}
    for field, want in wants.items():
        chosen = [chosen_path(text, want, definition) for text in row.paths(field)]
        if paths := tuple(path for path in chosen if path is not None):
            found[field] = paths
    declared = [path for paths in found.values() for path in paths]
    if part == "joints" and any(each.is_fixed for path in declared for each in path.arrays):
        raise DefinitionError("its joints stand in arrays of a fixed length")
    if part == "feet" and row.pairs is not None:
        declared += [path_of(text, want, definition) for text, want in row.pairs.paths.items()]
    return Source(row, found, columns_of(declared), own_definition=own_because)


def chosen_path(text: str, want: Want, definition: Struct) -> FieldPath | None:
    """Return the first of some alternatives that a definition has; None: it need not have one.

    Raises:
        DefinitionError: it has none.
    """
    faults: list[DefinitionError] = []
    alternatives = text.split("|")
    for each in filter(None, alternatives):
        try:
            return path_of(each, want, definition)
        except DefinitionError as error:
            faults.append(error)
    if "" in alternatives:
        return None
    raise faults[0]
