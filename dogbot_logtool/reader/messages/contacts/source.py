"""Interface of contact sources."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Final, Literal

import numpy as np

from dogbot_logtool.core.contact.contacts import Contacts, Samples
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.geometry.arrays import Flags, Floats, Ints
from dogbot_logtool.core.geometry.blocks import concatenated
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.reader.decode.columns import Table
from dogbot_logtool.reader.decode.fields import Fields
from dogbot_logtool.reader.messages.messages import DecodedMessages
from dogbot_logtool.robot import Foot


@dataclass(frozen=True, slots=True)
class FootChannels:
    """Which feet speak on which channels."""

    feet: Sequence[Foot]
    """The robot's feet."""
    of_channel: Mapping[int, tuple[int, ...]]
    """Indices in `feet` by channel id; several where one message tells of several feet."""
    contact_on_counts: float | None = None
    """Counts from which a raw sensor without a scale touches; None: it cannot be told."""
    ignores_flags: bool = False
    """Whether forces decide contact although messages have flags, which forces contradict."""

    def of(self, channel: int) -> tuple[Foot, ...]:
        """Return the feet of a channel, by its id."""
        return tuple(self.feet[index] for index in self.of_channel.get(channel, ()))

    def single(self, channel: Ints) -> Ints:
        """(n,) foot index of messages that tell of one foot each."""
        ids = np.array(sorted(self.of_channel), np.int64)
        feet = np.array([self.of_channel[number][0] for number in ids.tolist()], np.int64)
        return feet[np.searchsorted(ids, channel)]

    def sent(self, foot: int, channel: Ints, known: Flags) -> Ints:
        """Return the rows of messages that tell of a foot, as far as they are known, (n,)."""
        channels = [number for number, told in self.of_channel.items() if foot in told]
        return np.flatnonzero(np.isin(channel, channels) & known)


@dataclass(frozen=True, slots=True)
class ContactSamples:
    """Contact samples that a source makes of messages."""

    samples: Samples
    contacts: Contacts | None = None
    """The states that the samples were made of; None for a source that has none."""
    untimed_messages: int = 0
    """Messages of several states whose `info` tells no time: read as one physics step."""
    foreign_states: int = 0
    """States of pairs in which not exactly one body is the foot, or both are of one robot."""
    implausible: int = 0
    """Samples with numbers that no robot reaches; those are NaN."""


FootLinks = Mapping[int, set[str]]
"""Frames of the wrenches of each foot, by its index."""


UNTIMED: Final = int(np.iinfo(np.int64).min)
"""The lag of a message that tells no physics step."""


@dataclass(frozen=True, slots=True)
class StepTiming:
    """How the physics steps of n messages lie to their stamps."""

    lag: Ints
    """(n,) ns by which a message's newest step is older than its stamp; `UNTIMED`: not known."""
    step: Ints
    """(k,) ns between neighbouring steps of one message."""


@dataclass(frozen=True, slots=True)
class FootValues:
    """Values of k feet in n messages."""

    stamp: Ints
    """(n,) ns; 0: none."""
    contact: Floats | None = None
    """(n, k) 1 in contact, 0 not, NaN not known; None: messages have no contact flags."""
    force: Floats | None = None
    """(n, k, 3) N on the foot, NaN where a message lacks it; None: messages have no forces."""
    position: Floats | None = None
    """(n, k, 3) m, in the world or in the base's frame; None: messages have no positions."""
    normal: Floats | None = None
    """(n, k, 3) normal of the ground, into the foot; None: messages have none."""


ToValues = Callable[[DecodedMessages, Sequence[Foot]], FootValues]
"""Takes the values out of decoded messages; the feet say which label is which element's."""


@dataclass(frozen=True, slots=True)
class MessageFoot:
    """A foot that messages tell of."""

    label: str = ""
    """Its name in the messages; empty: its index in their arrays tells."""
    name: str = ""
    """Name of the leg, such as ``front_left``; empty: the label tells it."""


_PLANNED_WORDS: Final = (
    r"(?<![a-z])(ref|reference|des|desired|plan|planned|planner|cmd|command|commanded|control|"
    r"target|trajectory|traj|setpoint|mpc)(?![a-z])"
)
"""Words in the names of topics that tell what shall be."""


def is_named_as_planned(topic: str) -> bool:
    """Tell whether a topic's name says that it is a plan or a command."""
    return re.search(_PLANNED_WORDS, topic.lower()) is not None


@dataclass(frozen=True, slots=True)
class ContactSource:
    """One type of contact messages."""

    type_name: str
    """``package/Name``."""
    fields: Fields
    """Fields that are read of each message."""
    read: Callable[[DecodedMessages, FootChannels], ContactSamples] | None = None
    """Reduces decoded messages to samples; None: `values` are reduced."""
    links: Callable[[DecodedMessages, FootChannels, Contacts | None], FootLinks] | None = None
    """Finds the links in whose frames the forces are; None: they are in no link's. The contacts are
    those that `read` made of the messages."""
    timing: Callable[[DecodedMessages], StepTiming] | None = None
    """Finds the physics steps of messages; None: a message holds one moment."""
    elements: tuple[str, ...] = ()
    """Names of the feet in the order of the message, where one message tells of all feet."""
    feet_in: Callable[[DecodedMessages], Sequence[MessageFoot]] | None = None
    """Finds the feet in messages, where one message tells of all feet but its type does not say
    which; returns none where the messages are not about feet."""
    values: ToValues | None = None
    """Takes flags, forces and positions of all feet out of messages that tell of all feet."""
    variants: tuple["ContactSource", ...] = ()
    """The same type by other definitions, tried in order where its fields are not the log's."""
    any_package: bool = False
    """Whether messages of this name and fields are taken from any package."""
    topic_end: str = ""
    """End of the names of topics that are about feet, where others of this type are not."""
    plans: Literal["never", "by_name", "always"] = "never"
    """Whether it tells what is planned and not what was; by name: where the topic's name does."""
    frame: WrenchFrame | None = None
    """Frame of the forces; None: to be decided by evidence."""
    has_header: bool = True
    """Without one, log time is the only time."""
    has_force: bool = True
    """Without, it only tells whether a foot touches."""
    has_points: bool = True
    """Whether it tells where the foot touches."""
    has_flags: bool = False
    """Whether its messages have contact flags; these decide contact, whatever the force."""
    in_base: bool = False
    """Whether its positions are in the base's frame."""
    is_raw: bool = False
    """Its forces are counts that only the robot's file can turn into newtons."""
    one_axis: bool = False
    """Its sensors have one axis, along which a foot can only press."""
    anything: bool = False
    """Such messages can be about anything: only topics that name a foot are taken for one's."""
    silent_in_swing: bool = False
    """It is published only while in contact, so that absence is swing."""

    @property
    def lists_contacts(self) -> bool:
        """Whether its messages say what touches, apart from any force."""
        if self.has_flags or not self.has_force:
            return True
        # Where the feet are is told of those in the air, too.
        return self.has_points and self.values is None and not self.is_raw

    def is_planned(self, topic: str) -> bool:
        """Tell whether a topic of this type tells what is planned and not what was."""
        return self.plans == "always" or (self.plans == "by_name" and is_named_as_planned(topic))

    @property
    def tells_all_feet(self) -> bool:
        """Whether one message tells of all feet."""
        return bool(self.elements) or self.feet_in is not None


def vectors_inside(table: Table, path: str) -> tuple[Ints, Floats]:
    """Return the row that each element of an array of Vector3 belongs to, (m,), and (m, 3)."""
    nested = table.nested(path)
    return nested.parent, nested.table.vectors("", "xyz")


def flat_samples(log_time: Ints, foot: Ints, stamp: Ints, force: Floats) -> Samples:
    """Return samples of a sensor that tells no contact point.

    Args:
        log_time: (n,) ns.
        foot: (n,) index of the foot.
        stamp: (n,) ns; 0: none.
        force: (n, 3) N; 0 without contact, NaN where only the contact is known.
    """
    count = len(foot)
    return Samples(
        foot=foot,
        log_time=log_time,
        stamp=stamp,
        in_contact=(force != 0.0).any(axis=1),
        force=force,
        in_world=np.zeros(count, np.bool_),
        points=np.zeros(count, np.int64),
        position=np.full((count, 3), np.nan),
        normal=np.full((count, 3), np.nan),
    )


def foot_samples(
    messages: DecodedMessages, rows: Ints, foot: int, stamp: Ints, force: Floats
) -> Samples:
    """Return samples of one foot from rows of messages that tell of several; see `flat_samples`.

    Args:
        messages: n messages.
        rows: (m,).
        foot: index of the foot.
        stamp: (n,) ns.
        force: (m, 3) N.
    """
    return flat_samples(messages.log_time[rows], np.full(len(rows), foot), stamp[rows], force)


def of_all_feet(parts: Iterable[Samples]) -> ContactSamples:
    """Return the samples of all feet, of which there may be none."""
    nothing = flat_samples(*(np.empty(0, np.int64),) * 3, np.empty((0, 3)))
    return ContactSamples(concatenated([nothing, *parts]))
