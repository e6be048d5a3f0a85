"""All contact sources, and the seam through which every command reads them."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Final

from dogbot_logtool.core.plausible import plausible_samples
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.log import Batch, Channel
from dogbot_logtool.reader.messages.contacts import (
    anymal,
    champ,
    dwl,
    flags,
    gazebo,
    gazebo_classic,
    hrpsys,
    joint_foot,
    ocs2,
    pronto,
    quad_sdk,
    spot,
    syropod,
    unitree,
    whole_body,
    wrench,
    xpp,
)
from dogbot_logtool.reader.messages.contacts.field_path import field_source
from dogbot_logtool.reader.messages.contacts.source import (
    ContactSamples,
    ContactSource,
    FootChannels,
    FootLinks,
    StepTiming,
)
from dogbot_logtool.reader.messages.contacts.whole_robot import by_type, read_messages
from dogbot_logtool.reader.messages.messages import DecodedMessages, check_channel, decode_channels
from dogbot_logtool.robot import Foot

SOURCES: Final[Mapping[str, ContactSource]] = by_type(
    (
        gazebo_classic.SOURCE,
        gazebo.SOURCE,
        anymal.SOURCE,
        quad_sdk.SOURCE,
        *whole_body.SOURCES,
        *dwl.SOURCES,
        *unitree.SOURCES,
        joint_foot.SOURCE,
        wrench.SOURCE,
        pronto.SOURCE,
        syropod.SOURCE,
        *spot.SOURCES,
        champ.SOURCE,
        *flags.SOURCES,
        hrpsys.SOURCE,
        *xpp.SOURCES,
        ocs2.SOURCE,
    )
)
"""By type name. Where feet are found by type, the first one that a log has is taken."""


def source_of(channel: Channel, feet: Iterable[Foot] = ()) -> ContactSource | None:
    """Return how a channel's contacts are read; None: it has none.

    A type is known by its name and its fields. Some are known in any package, since drivers copy
    them into packages of their own. Where the channel's feet are fields, these are read instead.

    Raises:
        DefinitionError: a field of a foot does not exist.
    """
    paths = tuple(foot.field for foot in feet if foot.field is not None)
    return field_source(channel, paths) if paths else _source_by_type(channel)


@lru_cache(maxsize=1024)
def _source_by_type(channel: Channel) -> ContactSource | None:
    known = SOURCES.get(channel.type_name)
    if known is not None and not channel.topic.rstrip("/").endswith(known.topic_end):
        return None
    if known is not None:
        fitting = (one for one in (known, *known.variants) if _fits(channel, one))
        return next(fitting, known)
    _, _, name = channel.type_name.rpartition("/")
    for one in SOURCES.values():
        if one.any_package and one.type_name.rpartition("/")[2] == name:
            for each in (one, *one.variants):
                if _fits(channel, each):
                    return each
    return None


def _fits(channel: Channel, source: ContactSource) -> bool:
    try:
        check_channel(channel, source.fields)
    except DefinitionError:
        return False
    return True


def contact_types(channels: Iterable[Channel]) -> frozenset[str]:
    """Return the types of those channels that have contacts."""
    return frozenset(channel.type_name for channel in channels if source_of(channel))


@dataclass(frozen=True, slots=True)
class DecodedContacts:
    """Contact messages of one definition, and what they tell."""

    source: ContactSource
    messages: DecodedMessages
    reduced: ContactSamples
    feet: FootChannels

    @property
    def links(self) -> FootLinks:
        """Frames that the forces may be in, by foot."""
        find = self.source.links
        return find(self.messages, self.feet, self.reduced.contacts) if find else {}

    @property
    def timing(self) -> StepTiming | None:
        """How physics steps lie to stamps; None: a message holds one moment."""
        return self.source.timing(self.messages) if self.source.timing else None


def check_contacts(channel: Channel) -> str:
    """Check that a channel's messages can be decoded; see `check_channel`.

    Args:
        channel: one with a contact source.
    """
    source = source_of(channel)
    return check_channel(channel, source.fields) if source else ""


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
            found.append(
                DecodedContacts(
                    without_flags(source, ignores=feet.ignores_flags), messages, reduced, feet
                )
            )
    return found


def _by_source(
    channels: Sequence[Channel], feet: FootChannels
) -> list[tuple[ContactSource, list[Channel]]]:
    """Group channels by their source, in the order of `SOURCES`; fields of other types last."""
    groups: dict[int, tuple[ContactSource, list[Channel]]] = {}
    order = {name: index for index, name in enumerate(SOURCES)}
    for channel in channels:
        source = source_of(channel, feet.of(channel.id))
        if source is not None:
            groups.setdefault(id(source), (source, []))[1].append(channel)
    last = len(order)
    return sorted(groups.values(), key=lambda group: order.get(group[0].type_name, last))


def without_flags(source: ContactSource, *, ignores: bool) -> ContactSource:
    """Return a source as its flags are used: forces decide contact where it ignores flags."""
    return replace(source, has_flags=False) if ignores else source
