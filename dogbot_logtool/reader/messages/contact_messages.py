"""Contact messages of a batch, read by whatever row of the table fits them."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

from dogbot_logtool.core.arrays import distinct
from dogbot_logtool.core.plausible import plausible_samples
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.batch import Batch
from dogbot_logtool.reader.containers.contents import Channel
from dogbot_logtool.reader.decode.definition import Struct
from dogbot_logtool.reader.decode.field_path import parse_field_path
from dogbot_logtool.reader.decode.paths import FieldPath
from dogbot_logtool.reader.foot import Foot, FootField
from dogbot_logtool.reader.messages.feet import ContactSamples, FootChannels, read_feet
from dogbot_logtool.reader.messages.gazebo import StepTiming, read_pairs, step_timing
from dogbot_logtool.reader.messages.message_type import FEET, MessageType
from dogbot_logtool.reader.messages.messages import (
    DecodedMessages,
    check_channel,
    decode_channels,
    definition_of,
)
from dogbot_logtool.reader.messages.source import (
    FOOT_TYPES,
    Source,
    fitted,
    foot_source_by_type,
)


def source_of(channel: Channel, feet: Iterable[Foot] = ()) -> Source | None:
    """Return how a channel's contacts are read; None: it has none.

    Where the channel's feet are fields, these are read instead of what its type tells.

    Raises:
        DefinitionError: a field of a foot does not exist.
    """
    fields = tuple(foot.field for foot in feet if foot.field is not None)
    if not fields:
        return foot_source_by_type(channel)
    source = _source_of_words(definition_of(channel), channel.type_name, fields)
    check_channel(channel, source.fields)
    return source


@lru_cache(maxsize=256)
def _source_of_words(definition: Struct, type_name: str, fields: tuple[FootField, ...]) -> Source:
    """Return the row that reads the fields that a user names as feet.

    Raises:
        DefinitionError: a field does not exist, or some are forces and others contacts.
    """
    paths = {field: parse_field_path(definition, field.path) for field in fields}
    kinds = {_kind(field, path) for field, path in paths.items()}
    if len(kinds) > 1:
        raise DefinitionError("some of its feet are forces and others contacts; `kind` says which")
    words = tuple(field.path for field in paths)
    row = MessageType(
        type_name,
        stamp="header.stamp|",
        force=words if kinds == {"force"} else "",
        flag=words if kinds == {"contact"} else "",
        words=words,
        one_axis=all(path.width == 1 or field.axis for field, path in paths.items()),
    )
    told = {"force" if row.force else "flag": tuple(paths.values())}
    return fitted(row, FEET, definition, told)


def _kind(field: FootField, path: FieldPath) -> str:
    """Return ``force`` or ``contact``; a fitting one where the user did not say."""
    if path.width == 1:
        if field.axis:
            raise DefinitionError(f"{field.path} is a number and has no axis {field.axis!r}")
        return field.kind or ("contact" if path.is_integer else "force")
    if field.kind == "contact":
        raise DefinitionError(f"{field.path} is a vector: a force, not a contact")
    return "force"


def contact_types(channels: Iterable[Channel]) -> frozenset[str]:
    """Return the types of those channels that have contacts."""
    return frozenset(channel.type_name for channel in channels if source_of(channel))


@dataclass(frozen=True, slots=True)
class DecodedContacts:
    """Contact messages of one definition, and what they tell."""

    source: Source
    messages: DecodedMessages
    reduced: ContactSamples
    feet: FootChannels

    @property
    def links(self) -> Mapping[int, set[str]]:
        """Frames that the forces may be in, by foot."""
        if self.source.row.axes == "sensor":
            return _sensor_frames(self.source, self.messages, self.feet)
        return {} if self.source.row.axes == "world" else self.reduced.links

    @property
    def timing(self) -> StepTiming | None:
        """How physics steps lie to stamps; None: a message holds one moment."""
        pairs = self.source.row.pairs
        if pairs is None or not pairs.info:
            return None
        return step_timing(pairs, self.messages, self.source.stamps(self.messages))


def _sensor_frames(
    source: Source, messages: DecodedMessages, feet: FootChannels
) -> dict[int, set[str]]:
    """Return the frames that the sensors' headers name, by foot."""
    code, names = source.paths["frame"][0].texts(messages.table)[1].encode()
    pairs = feet.single(messages.channel) * len(names) + code
    frames: dict[int, set[str]] = {}
    for pair in distinct(pairs).tolist():
        frame = names[pair % len(names)].lstrip("/")
        if frame:
            frames.setdefault(pair // len(names), set()).add(frame)
    return frames


def read_messages(source: Source, messages: DecodedMessages, feet: FootChannels) -> ContactSamples:
    """Reduce messages to samples."""
    if source.row.pairs is not None:
        return read_pairs(source.row.pairs, messages, source.stamps(messages), feet)
    return ContactSamples(read_feet(source, messages, feet))


def read_contacts(
    batch: Batch, channels: Sequence[Channel], feet: FootChannels
) -> list[DecodedContacts]:
    """Read the contact messages of a batch; one entry a definition, nearly always one."""
    found = []
    for source, of_source in _by_source(channels, feet):
        for messages in decode_channels(batch, of_source, source.fields):
            reduced = read_messages(source, messages, feet)
            samples, implausible = plausible_samples(reduced.samples)
            reduced = replace(reduced, samples=samples, implausible=implausible)
            used = without_flags(source, ignores=feet.ignores_flags)
            found.append(DecodedContacts(used, messages, reduced, feet))
    return found


def _by_source(
    channels: Sequence[Channel], feet: FootChannels
) -> list[tuple[Source, list[Channel]]]:
    """Group channels by their source, in the order of the table; fields of other types last."""
    groups: dict[int, tuple[Source, list[Channel]]] = {}
    for channel in channels:
        source = source_of(channel, feet.of(channel.id))
        if source is not None:
            groups.setdefault(id(source), (source, []))[1].append(channel)
    order = {name: index for index, name in enumerate(FOOT_TYPES)}
    return sorted(groups.values(), key=lambda group: order.get(group[0].type_name, len(order)))


def without_flags(source: Source, *, ignores: bool) -> Source:
    """Return a source as its flags are used: forces decide contact where it ignores flags."""
    return replace(source, uses_flags=False) if ignores else source
