"""Rows of the table, fitted to the definitions of a log: how a channel's messages are read."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.contents import Channel
from dogbot_logtool.reader.decode.definition import Struct
from dogbot_logtool.reader.decode.fields import Fields, check_fields
from dogbot_logtool.reader.decode.paths import FieldPath, Want, merged, path_of
from dogbot_logtool.reader.messages.message_type import (
    BASE,
    FEET,
    MessageType,
    is_named_as_planned,
)
from dogbot_logtool.reader.messages.messages import DecodedMessages, check_channel, definition_of
from dogbot_logtool.reader.messages.table import TABLE, rows_of

_FRAMES: Final = {
    "unknown": WrenchFrame.UNKNOWN,
    "by evidence": None,
    "world": WrenchFrame.WORLD,
    "sensor": WrenchFrame.LINK,
}


@dataclass(frozen=True, slots=True)
class Source:
    """A row of the table that is fitted to a definition."""

    row: MessageType
    paths: Mapping[str, tuple[FieldPath, ...]]
    """By the row's field; a path a leg where the row has a path a leg."""
    fields: Fields
    """What is decoded of each message."""
    uses_flags: bool = True
    """Whether flags decide contact; else forces do, which contradict them."""

    @property
    def type_name(self) -> str:
        """``package/Name``."""
        return self.row.name

    @property
    def has_header(self) -> bool:
        """Without one, log time is the only time."""
        return "stamp" in self.paths

    @property
    def anything(self) -> bool:
        """Such messages can be about anything: only topics that name a foot or base are taken."""
        return self.row.anything

    @property
    def frame(self) -> WrenchFrame | None:
        """Frame of the forces; None: to be decided by evidence."""
        return _FRAMES[self.row.axes]

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
        """Whether its messages have contact flags; these decide contact, whatever the force."""
        return bool(self.row.flag) and not self.row.words and self.uses_flags

    @property
    def in_base(self) -> bool:
        """Whether its positions are in the base's frame."""
        return "point" in self.paths and self.row.points_in == "base"

    @property
    def is_raw(self) -> bool:
        """Its forces are counts that only the robot's file can turn into newtons."""
        return self.row.unit == "counts"

    @property
    def one_axis(self) -> bool:
        """Its sensors have one axis, along which a foot can only press."""
        return self.row.one_axis

    @property
    def silent_in_swing(self) -> bool:
        """It is published only while in contact, so that absence is swing."""
        return self.row.silent_in_swing

    @property
    def lists_contacts(self) -> bool:
        """Whether its messages say what touches, apart from any force."""
        return self.has_flags or not self.has_force or self.row.pairs is not None

    @property
    def legs(self) -> tuple[str, ...]:
        """Names of the feet in the order of the message, where its type says them."""
        return () if self.row.maybe_without_legs else self.row.legs

    @property
    def tells_all_feet(self) -> bool:
        """Whether one message tells of all feet."""
        return bool(self.row.legs or self.row.label or self.row.by_place)

    def is_planned(self, topic: str) -> bool:
        """Tell whether a topic of this type tells what is planned and not what was measured."""
        by_name = self.row.planned == "by name" and is_named_as_planned(topic)
        return self.row.planned == "always" or by_name

    @property
    def lists_poses(self) -> bool:
        """Whether its messages hold poses of several things, of which one is chosen by name."""
        return bool(self.row.choose)

    @property
    def is_transform(self) -> bool:
        """Whether its poses are transforms of the log's own frame tree."""
        return len(self.row.choose) > 1

    @property
    def has_one_pose(self) -> bool:
        """Whether each message has one pose and one stamp."""
        return not self.lists_poses and not self._lists("position")

    def _lists(self, field: str) -> bool:
        return field in self.paths and self.paths[field][0].is_array_of_elements

    def stamps(self, messages: DecodedMessages) -> Ints:
        """Return (n,) ns, the stamps of n messages; 0: none."""
        if not self.has_header or self._lists("stamp"):
            return np.zeros(len(messages.log_time), np.int64)
        return self.paths["stamp"][0].times(messages.table)


def fitted(
    row: MessageType,
    part: Mapping[str, Want],
    definition: Struct | None,
    given: Mapping[str, tuple[FieldPath, ...]] | None = None,
) -> Source:
    """Return a row with the paths that a definition has.

    Where it lacks one, the source has that path nevertheless: `check_channel` tells which.

    Args:
        row: the row.
        part: `FEET`, `BASE` ..., what is read of it.
        definition: None: it is not known, or that of a library.
        given: paths that are fitted already, by field.
    """
    wants = dict(part)
    if part is FEET and row.axes != "sensor":
        del wants["frame"]
    if part is FEET and row.by_place:
        wants |= {field: BASE[field] for field in ("position", "orientation")}
    found = dict(given or {})
    for field, want in wants.items():
        if field in found:
            continue
        chosen = [_chosen(text, want, definition) for text in row.paths(field)]
        if paths := tuple(path for path in chosen if path is not None):
            found[field] = paths
    declared = [field for paths in found.values() for path in paths for field in path.fields]
    if part is FEET and row.pairs is not None:
        inside = (path_of(text, want) for text, want in row.pairs.paths.items())
        declared += [field for path in inside for field in path.fields]
    return Source(row, found, merged(declared))


def _chosen(text: str, want: Want, definition: Struct | None) -> FieldPath | None:
    """Return the first of some alternatives that a definition has; None: it need not have one."""
    alternatives = text.split("|")
    paths = [path_of(each, want, definition) for each in alternatives if each]
    for path in paths:
        if definition is None or _has(definition, path.fields):
            return path
    return None if "" in alternatives else paths[0]


def _has(definition: Struct, fields: Fields) -> bool:
    try:
        check_fields(definition, fields, "")
    except DefinitionError:
        return False
    return True


def fitting(channel: Channel, rows: Iterator[MessageType], part: Mapping[str, Want]) -> Source:
    """Return the first row that fits a channel's definition.

    Raises:
        DefinitionError: none does; why the first one does not.
    """
    definition = known_definition_of(channel)
    reason = DefinitionError("it tells of nothing that is read")
    for number, row in enumerate(rows):
        source = fitted(row, part, definition)
        try:
            check_channel(channel, source.fields)
        except DefinitionError as error:
            reason = reason if number else error
        else:
            return source
    raise reason


def known_definition_of(channel: Channel) -> Struct | None:
    """Return the definition of a channel's messages; None: there is none that can be read."""
    try:
        return definition_of(channel)
    except DefinitionError:
        return None


BASE_TYPES: Final = tuple(dict.fromkeys(row.name for row in TABLE if row.tells_base))
"""Types with poses of a base; the best types come first."""
FOOT_TYPES: Final = tuple(dict.fromkeys(row.name for row in TABLE if row.tells_feet))
"""Types that tell of feet. Where feet are found by type, the first one that a log has is taken."""


@lru_cache(maxsize=1024)
def foot_source_by_type(channel: Channel) -> Source | None:
    """Return how a channel's feet are read; None: it tells of none.

    A type is known by its name and its fields. Some are known in any package, since drivers copy
    them into packages of their own.
    """
    ends = (row.topic_end for row in rows_of(channel.type_name) if row.tells_feet)
    if not any(channel.topic.rstrip("/").endswith(end) for end in ends):
        return None
    # The senders of one definition share a source.
    schema = channel.schema and replace(channel.schema, id=0)
    return _foot_source(replace(channel, id=0, topic="", schema=schema, metadata={}))


@lru_cache(maxsize=1024)
def _foot_source(channel: Channel) -> Source | None:
    rows = [row for row in rows_of(channel.type_name) if row.tells_feet]
    try:
        return fitting(channel, iter(rows), FEET)
    except DefinitionError:
        is_known = rows[0].name == channel.type_name
        return fitted(rows[0], FEET, known_definition_of(channel)) if is_known else None


def base_source(channel: Channel) -> Source:
    """Return how a channel's poses are read.

    Raises:
        DefinitionError: there are none; why.
    """
    source = _base_source(channel)
    if isinstance(source, str):
        raise DefinitionError(source)
    return source


@lru_cache(maxsize=1024)
def _base_source(channel: Channel) -> Source | str:
    known = base_type(channel.type_name)
    if not known:
        return "it holds no poses that are known"
    try:
        return fitting(
            channel, (row for row in TABLE if row.name == known and row.tells_base), BASE
        )
    except DefinitionError as error:
        return str(error)


def lists_poses(type_name: str) -> bool:
    """Tell whether messages of a type hold poses of several things, to choose by name."""
    return any(row.choose for row in rows_of(type_name))


@lru_cache(maxsize=1024)
def base_type(type_name: str) -> str:
    """Return the known type as which messages of a type are read; empty: as none.

    Robots' states are known in any package, since drivers copy them into packages of their own.
    Whether the fields are there, `base_source` tells.
    """
    return next((row.name for row in rows_of(type_name) if row.tells_base), "")
