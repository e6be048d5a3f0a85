"""What is read of a log, and as what."""

from dataclasses import dataclass

from dogbot_logtool.reader.containers.contents import Channel
from dogbot_logtool.reader.messages.bases import Base
from dogbot_logtool.reader.messages.feet import FootChannels
from dogbot_logtool.reader.messages.message_type import Part

TimeLimits = tuple[int | None, int | None]
"""ns, log times from which and up to which messages are taken; None: no limit."""


@dataclass(frozen=True, slots=True)
class WantedVectors:
    """A topic of vectors, with all of its senders."""

    topic: str
    channels: tuple[Channel, ...]
    """All of one type."""
    part: Part
    """What is read of its messages."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """The channels of a log that are read, by what they tell."""

    contacts: tuple[Channel, ...]
    feet: FootChannels
    base: Base | None = None
    """How the base's poses are read; None: there are none."""
    base_channels: tuple[Channel, ...] = ()
    transforms: tuple[Channel, ...] = ()
    joints: tuple[Channel, ...] = ()
    """Of joint states, the best first."""
    commands: WantedVectors | None = None
    accelerations: WantedVectors | None = None
    planned: tuple[Channel, ...] = ()
    """Channels of contacts that a plan has for the same feet."""
    planned_feet: FootChannels | None = None
    limits: TimeLimits = (None, None)
