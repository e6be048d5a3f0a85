"""Whether the contact flags of messages are used: they are compared with the forces beside them."""

from collections.abc import Iterator, Sequence
from dataclasses import field
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, norms
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.printable import listed
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.messages.contact_messages import source_of
from dogbot_logtool.reader.messages.feet import contact_flags
from dogbot_logtool.robot.feet.message_feet import sampled_messages
from dogbot_logtool.robot.robot import Robot

_LOAD_SHARE: Final = 0.2
"""Share of all feet's load from which a foot cannot be in the air."""
_CONTRADICTED: Final = 0.2
"""Share of contradicted flags from which constant flags are taken for not filled in."""
_DOUBTFUL: Final = 0.05
"""Share of contradicted flags from which it is said."""


@dataclass(frozen=True, slots=True)
class FlagCheck:
    """How contact flags agree with the forces beside them."""

    samples: int = 0
    """Feet in messages that have both."""
    touching: int = 0
    """Flagged as in contact."""
    contradicted: int = 0
    """Flagged as in contact without any force, or not although they carry a share of the load."""

    def __add__(self, other: "FlagCheck") -> "FlagCheck":
        return FlagCheck(
            self.samples + other.samples,
            self.touching + other.touching,
            self.contradicted + other.contradicted,
        )

    @property
    def constant(self) -> bool:
        """Whether all flags are the same."""
        return self.touching in {0, self.samples}


@dataclass(frozen=True, slots=True)
class FlagUse:
    """Whether the contact flags of a log are used."""

    topics: tuple[str, ...] = ()
    check: FlagCheck = field(default_factory=FlagCheck)

    @property
    def contradicted(self) -> float:
        """Share of flags that forces contradict."""
        return self.check.contradicted / self.check.samples if self.check.samples else 0.0

    @property
    def are_useless(self) -> bool:
        """Whether the flags never change although forces do: they are not filled in."""
        return self.check.constant and self.contradicted > _CONTRADICTED


def compare_flags(log: Log, contacts: Sequence[Channel], robot: Robot) -> FlagUse:
    """Compare contact flags with the forces beside them, in a few messages of each topic."""
    check, topics = FlagCheck(), []
    for channel in contacts:
        source = source_of(channel, robot.feet_of(channel.topic))
        if source is None or not source.has_flags:
            continue
        topics.append(channel.topic)
        for messages in sampled_messages(log, channel, source) if source.has_force else ():
            check += _check(*contact_flags(source, messages, robot.feet))
    return FlagUse(tuple(topics), check)


def _check(flag: Floats, force: Floats) -> FlagCheck:
    """Compare flags, (n, k), 1 in contact and 0 not, with forces, (n, k, 3) N."""
    load = norms(force.reshape(-1, 3)).reshape(flag.shape)
    known = np.isfinite(flag) & np.isfinite(load)
    total = np.where(known, load, 0.0).sum(axis=1, keepdims=True)
    touching = flag > 0.0
    wrong = np.where(touching, load == 0.0, load > _LOAD_SHARE * total)
    # Without any load, as before a simulation begins, forces tell nothing.
    wrong = wrong & (total > 0.0)
    return FlagCheck(int(known.sum()), int((touching & known).sum()), int((wrong & known).sum()))


def flag_findings(use: FlagUse) -> Iterator[Finding]:
    """Say where flags and forces disagree, and which of them decides."""
    share = f"{use.contradicted:.0%} of the contact flags of {listed(use.topics)}"
    if use.are_useless:
        text = f"{share} contradict the forces, and no flag ever changes: forces decide contact"
        yield Finding("FLAGS_CONTRADICTED", text)
    elif use.contradicted > _DOUBTFUL:
        yield Finding("FLAGS_CONTRADICTED", f"{share} contradict the forces; flags decide contact")
