"""A part of a log as columns: some neighbouring chunks, read and decoded in any process."""

from collections import Counter, defaultdict
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Ints, rows_by_group
from dogbot_logtool.core.contact.contacts import Contacts, Samples, samples_by_foot
from dogbot_logtool.core.recording import Times, plausible
from dogbot_logtool.reader.containers.log import Batch, Channel, Log
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.messages.bases import BasePoses, read_base
from dogbot_logtool.reader.messages.contacts import ReadContacts, read_contacts
from dogbot_logtool.reader.messages.feet import FootChannels
from dogbot_logtool.reader.messages.gazebo import UNTIMED
from dogbot_logtool.reader.messages.message_type import Part as MessagePart
from dogbot_logtool.reader.messages.messages import malformed_in
from dogbot_logtool.reader.messages.others import (
    is_static,
    read_joints,
    read_transforms,
    read_vectors,
)
from dogbot_logtool.reader.messages.source import Topic

TimeLimits = tuple[int | None, int | None]
"""ns, log times from which and up to which messages are taken; None: no limit."""


class Wanted(NamedTuple):
    """The channels of a log that are read, by what they tell."""

    feet: FootChannels
    base: Topic | None = None
    """How the base's poses are read; None: there are none."""
    transforms: tuple[Channel, ...] = ()
    joints: tuple[Channel, ...] = ()
    """Of joint states, the best first."""
    commands: tuple[Channel, ...] = ()
    """All of one topic and type; so are `accelerations`."""
    accelerations: tuple[Channel, ...] = ()
    planned: FootChannels | None = None
    """Channels of contacts that a plan has for the same feet."""
    draws_states: bool = False
    """Whether arrows are made of contact states as they are recorded."""
    limits: TimeLimits = (None, None)


Key = tuple[str, Any]
"""What something is of: a kind, and which of that kind: a foot, a topic, a channel's id."""
ONLY = 0
"""Which one of a kind that there is one of."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Part:
    """What is in some neighbouring chunks."""

    columns: dict[Key, list[Any]] = field(default_factory=lambda: defaultdict(list))
    """Tables by what they are of. `Samples` of ``feet`` and ``planned`` feet; numbers of each
    foot's ``lags``, ns by which the newest physics step is older than the stamp (`UNTIMED`: not
    known), of ``steps``, ns between neighbouring physics steps of a message, and of ``times``, ns,
    log times of all messages of a channel in file order; `Odometry` of the ``base``;
    `Arrows` of contact states; `VectorSamples` of ``commands`` and ``accelerations``; `Times` of a
    topic's ``stamps``; `Transforms` of a parent and child's ``transforms``; `JointSamples` of the
    ``joints`` of a topic with some names."""
    names: dict[Key, set[str]] = field(default_factory=lambda: defaultdict(set))
    """Names of frames: ``links`` of a foot, ``worlds`` and ``bases`` of poses, ``slashed`` ones of
    transforms, those of ``commands`` and ``accelerations``."""
    counts: Counter[Key] = field(default_factory=Counter)
    """``malformed`` messages of a channel; messages ``without_arrow``, by why; see `Recording` for
    the others."""
    losses: tuple[Loss, ...] = ()


def read_part(wanted: Wanted, log: Log, whole: Batch) -> Part:
    """Decode some chunks that were read."""
    batch = whole.cropped(*wanted.limits)
    part = Part(losses=batch.losses)
    for channel, rows in rows_by_group(batch.messages.channel):
        part.columns["times", channel].append(batch.messages.log_time[rows])
    for poses in read_base(wanted.base, batch) if wanted.base else ():
        _add_poses(part, log, poses)
    for kind, feet in (("feet", wanted.feet), ("planned", wanted.planned)):
        for read in read_contacts(batch, feet) if feet else ():
            _add_samples(part, kind, read.samples, len(wanted.feet.feet))
            if read.source.has_header:
                stamps = read.source.stamps(read.messages)
                _add_stamps(part, log, read.messages.channel, read.messages.log_time, stamps)
            if kind == "feet":
                _add_contacts(part, read, wanted)
    _add_transforms(part, wanted, batch, whole)
    _add_vectors(part, wanted, batch)
    _add_joints(part, wanted, batch)
    malformed = malformed_in(batch) | malformed_in(whole)
    part.counts.update({("malformed", number): count for number, count in malformed.items()})
    return part


def _add_stamps(part: Part, log: Log, channel: Ints, log_time: Ints, stamp: Ints) -> None:
    """Add the times of messages with a header, by topic."""
    for number, rows in rows_by_group(channel):
        topic = log.channels[number].topic
        part.columns["stamps", topic].append(Times(log_time[rows], stamp[rows]))


def _add_poses(part: Part, log: Log, read: BasePoses) -> None:
    poses, implausible = plausible(read.poses)
    part.columns["base", ONLY].append(poses)
    part.counts["implausible", ONLY] += implausible
    part.names["worlds", ONLY].update(read.worlds)
    part.names["bases", ONLY].update(read.bases)
    if read.has_stamps:
        _add_stamps(part, log, read.channel, poses.log_time, poses.stamp)


def _add_contacts(part: Part, read: ReadContacts, wanted: Wanted) -> None:
    """Add what is read of measured contacts beside their samples."""
    samples, pairs = read.samples, read.pairs
    lag = np.full(len(samples.foot), UNTIMED) if pairs is None else pairs.lag
    for foot in range(len(wanted.feet.feet)):
        part.columns["lags", foot].append(lag[samples.foot == foot])
    for foot, names in read.links.items():
        part.names["links", foot].update(names)
    part.counts["implausible", ONLY] += read.implausible
    if pairs is not None:
        part.columns["steps", ONLY].append(pairs.step)
        part.counts["untimed_messages", ONLY] += pairs.untimed_messages
        part.counts["foreign_states", ONLY] += pairs.foreign_states
        if wanted.draws_states:
            _add_arrows(part, pairs.contacts)


def _add_arrows(part: Part, contacts: Contacts) -> None:
    from dogbot_logtool.core.scene.arrows import classic_arrows  # noqa: PLC0415 - few logs need it

    arrows, skipped = classic_arrows(contacts)
    part.columns["arrows", ONLY].append(arrows)
    part.counts.update({("without_arrow", why): count for why, count in skipped.items()})


def _add_samples(part: Part, kind: str, samples: Samples, feet: int) -> None:
    """Add the samples of each foot in half the memory: places need all digits, others do not."""
    for foot, own in enumerate(samples_by_foot(samples, feet)):
        compact = replace(
            own,
            foot=own.foot.astype(np.uint8),
            force=own.force.astype(np.float32),
            normal=own.normal.astype(np.float32),
            points=np.minimum(own.points, np.iinfo(np.uint8).max).astype(np.uint8),
        )
        part.columns[kind, foot].append(compact)


def _add_transforms(part: Part, wanted: Wanted, batch: Batch, whole: Batch) -> None:
    """Add transforms; those that hold for ever do so within the limits, too, wherever they are."""
    static = [channel for channel in wanted.transforms if is_static(channel)]
    moving = [channel for channel in wanted.transforms if not is_static(channel)]
    for found, slashed in (
        *read_transforms(batch, moving, static=False),
        *read_transforms(whole, static, static=True),
    ):
        for edge, transforms in found.items():
            part.columns["transforms", edge].append(transforms)
        part.names["slashed", ONLY].update(slashed)


def _add_vectors(part: Part, wanted: Wanted, batch: Batch) -> None:
    kinds: tuple[MessagePart, ...] = ("commands", "accelerations")
    for kind, channels in zip(kinds, (wanted.commands, wanted.accelerations), strict=True):
        for samples, frames in read_vectors(batch, channels, kind):
            part.columns[kind, ONLY].append(samples)
            part.names[kind, ONLY].update(frames)


def _add_joints(part: Part, wanted: Wanted, batch: Batch) -> None:
    for channel in wanted.joints:
        for read in read_joints(batch, channel):
            if read.names and len(read.samples.log_time):
                part.columns["joints", (read.topic, read.names)].append(read.samples)
