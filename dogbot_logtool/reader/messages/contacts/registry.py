"""All contact sources, and the seam through which every command reads them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

from dogbot_logtool.core.plausible import plausible_samples
from dogbot_logtool.reader.containers.log import Batch, Channel
from dogbot_logtool.reader.decode.fields import without
from dogbot_logtool.reader.messages.contacts import (
    champ,
    gazebo,
    gazebo_classic,
    spot,
    unitree,
    wrench,
)
from dogbot_logtool.reader.messages.contacts.source import (
    ContactSource,
    Felt,
    FootChannels,
    FootLinks,
    StepTiming,
)
from dogbot_logtool.reader.messages.messages import (
    DecodedMessages,
    check_channel,
    decode_channels,
)

_SOURCES: Final = (
    gazebo_classic.SOURCE,
    gazebo.SOURCE,
    *unitree.SOURCES,
    wrench.SOURCE,
    spot.SOURCE,
    champ.SOURCE,
)
SOURCES: Final[Mapping[str, ContactSource]] = {one.type_name: one for one in _SOURCES}
"""By type name. Where feet are found by type, the first one that a log has is taken."""


@dataclass(frozen=True, slots=True)
class ContactsRead:
    """Contact messages of one definition, and what they tell."""

    source: ContactSource
    messages: DecodedMessages
    felt: Felt
    feet: FootChannels

    @property
    def links(self) -> FootLinks:
        """Frames that the forces may be in, by foot."""
        return self.source.links(self.messages, self.feet)

    @property
    def timing(self) -> StepTiming:
        """How physics steps lie to stamps."""
        return self.source.timing(self.messages)


def check_contacts(channel: Channel) -> str:
    """Check that a channel's messages can be decoded; see `check_channel`."""
    return check_channel(channel, SOURCES[channel.type_name].fields)


def read_contacts(
    batch: Batch, channels: Sequence[Channel], feet: FootChannels
) -> list[ContactsRead]:
    """Read the contact messages of a batch; one entry a definition, nearly always one."""
    return list(_read(batch, channels, feet))


def _read(batch: Batch, channels: Sequence[Channel], feet: FootChannels) -> Iterator[ContactsRead]:
    for type_name, source in SOURCES.items():
        of_type = [channel for channel in channels if channel.type_name == type_name]
        fields = source.fields if feet.normals else without(source.fields, source.normals)
        for messages in decode_channels(batch, of_type, fields):
            felt = source.read(messages, feet)
            samples, implausible = plausible_samples(felt.samples)
            felt = replace(felt, samples=samples, implausible=implausible)
            yield ContactsRead(source, messages, felt, feet)
