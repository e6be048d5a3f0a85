"""Contact messages of a batch, read by whatever row of the table fits them."""

from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import NamedTuple

from dogbot_logtool.core.arrays import distinct, rows_by_group
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.recording import plausible
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.log import Batch, Channel
from dogbot_logtool.reader.decode.paths import FieldPath, columns_of, parse_field_path
from dogbot_logtool.reader.foot import Foot, FootField
from dogbot_logtool.reader.messages.feet import FootChannels, read_feet
from dogbot_logtool.reader.messages.gazebo import PairStates, read_pairs
from dogbot_logtool.reader.messages.message_type import MessageType
from dogbot_logtool.reader.messages.messages import DecodedMessages, described, without_sender
from dogbot_logtool.reader.messages.source import (
    Source,
    chosen_path,
    decoded_by,
    source_of,
)


def foot_source(channel: Channel, feet: Iterable[Foot] = ()) -> Source | None:
    """Return how a channel's contacts are read; None: it has none.

    Where the channel's feet are fields, these are read instead of what its type tells.

    Raises:
        DefinitionError: a field of a foot does not exist.
    """
    fields = tuple(foot.field for foot in feet if foot.field is not None)
    if not fields:
        return source_of(channel, "feet")
    return _source_of_words(without_sender(channel), fields)


@lru_cache(maxsize=256)
def _source_of_words(channel: Channel, fields: tuple[FootField, ...]) -> Source:
    """Return how the fields are read that a user names as feet.

    Raises:
        DefinitionError: a field does not exist, or some are forces and others contacts.
    """
    definition, own_because = described(channel)
    paths = {field: parse_field_path(definition, field.path) for field in fields}
    kinds = {_kind(field, path) for field, path in paths.items()}
    if len(kinds) > 1:
        raise DefinitionError("some of its feet are forces and others contacts; `kind` says which")
    words = tuple(field.path for field in paths)
    row = MessageType(
        channel.type_name,
        stamp="header.stamp|",
        force=words if kinds == {"force"} else "",
        flag=words if kinds == {"contact"} else "",
        words=words,
        one_axis=all(path.width == 1 or field.axis for field, path in paths.items()),
    )
    told = {"force" if row.force else "flag": tuple(paths.values())}
    if stamp := chosen_path(row.stamp, "time", definition):
        told["stamp"] = (stamp,)
    columns = columns_of(path for own in told.values() for path in own)
    return Source(row, told, columns, own_definition=own_because)


def _kind(field: FootField, path: FieldPath) -> str:
    """Return ``force`` or ``contact``; a fitting one where the user did not say."""
    if path.width == 1:
        if field.axis:
            raise DefinitionError(f"{field.path} is a number and has no axis {field.axis!r}")
        return field.kind or ("contact" if path.is_integer else "force")
    if field.kind == "contact":
        raise DefinitionError(f"{field.path} is a vector: a force, not a contact")
    return "force"


class ReadContacts(NamedTuple):
    """Contact messages of one definition, and what they tell."""

    source: Source
    messages: DecodedMessages
    samples: Samples
    implausible: int
    """Samples with numbers that no robot reaches; those are NaN."""
    links: Mapping[int, set[str]]
    """Frames that the forces may be in, by foot."""
    pairs: PairStates | None = None
    """The contact states that the samples were made of; None: messages have none."""


def read_contacts(batch: Batch, feet: FootChannels) -> list[ReadContacts]:
    """Read the contact messages of a batch; one entry a definition, nearly always one."""
    sources = ((channel, foot_source(channel, feet.of(channel))) for channel in feet.of_channel)
    return [_read(source, messages, feet) for source, messages in decoded_by(batch, sources)]


def _read(source: Source, messages: DecodedMessages, feet: FootChannels) -> ReadContacts:
    pairs: PairStates | None = None
    links: Mapping[int, set[str]] = {}
    if source.row.pairs is None:
        samples = read_feet(source, messages, feet)
    else:
        samples, pairs = read_pairs(source.row.pairs, messages, source.stamps(messages), feet)
        links = pairs.links if source.row.axes is not WrenchFrame.WORLD else {}
    if source.row.axes is WrenchFrame.LINK:
        links = _sensor_frames(source, messages, feet)
    return ReadContacts(source, messages, *plausible(samples), links, pairs)


def _sensor_frames(
    source: Source, messages: DecodedMessages, feet: FootChannels
) -> Mapping[int, set[str]]:
    """Return the frames that the sensors' headers name, by foot."""
    code, names = source.paths["frame"][0].texts(messages.table)[1].encode()
    frames: dict[int, set[str]] = {}
    for foot, rows in rows_by_group(feet.single(messages.channel)):
        own = {names[number].lstrip("/") for number in distinct(code[rows]).tolist()} - {""}
        if own:
            frames[foot] = own
    return frames
