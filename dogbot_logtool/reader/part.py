"""A part of a log as columns: some neighbouring chunks, read and decoded in any process."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from dogbot_logtool.core.arrays import Ints, concatenated, header_time, rows_by_group
from dogbot_logtool.core.base.poses import Odometry
from dogbot_logtool.core.contact.contacts import Samples, no_samples, samples_by_foot
from dogbot_logtool.core.frames.transforms import (
    RecordedTransforms,
    concatenate_transforms,
    no_transforms,
)
from dogbot_logtool.core.legs.joints import MOST_JOINTS, JointSamples, JointTable
from dogbot_logtool.core.plausible import plausible_odometry
from dogbot_logtool.reader.containers.log import Batch, Log, Loss
from dogbot_logtool.reader.messages.bases import BasePoses, joined_poses
from dogbot_logtool.reader.messages.contacts import ReadContacts, read_contacts
from dogbot_logtool.reader.messages.gazebo import UNTIMED
from dogbot_logtool.reader.messages.messages import malformed_in
from dogbot_logtool.reader.messages.others import (
    ReadVectors,
    is_static,
    read_joints,
    read_transforms,
    read_vectors,
)
from dogbot_logtool.reader.wanted import Wanted, WantedVectors


@dataclass(frozen=True, slots=True)
class Stamps:
    """Times of messages with a header."""

    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns."""


@dataclass(frozen=True, slots=True)
class Lags:
    """How old contact samples are at their stamps."""

    lag: Ints
    """(n,) ns by which a sample's newest physics step is older than its stamp; `UNTIMED`: not
    known."""


@dataclass(frozen=True, slots=True)
class Part:
    """The columns of some neighbouring chunks."""

    feet: tuple[Samples, ...]
    """Of each foot."""
    lags: tuple[Lags, ...]
    """Of each foot's samples."""
    planned: tuple[Samples, ...]
    step: Ints
    """(k,) ns between neighbouring physics steps of a message."""
    links: Mapping[int, set[str]]
    base: Odometry
    world_frames: set[str]
    base_frames: set[str]
    transforms: RecordedTransforms
    joints: tuple[JointTable, ...]
    commands: ReadVectors | None
    accelerations: ReadVectors | None
    log_times: Mapping[int, Ints]
    """ns, of all messages in file order, by channel id."""
    stamps: Mapping[str, Stamps]
    """By topic, of contacts and poses with a header."""
    implausible: int
    untimed_messages: int
    foreign_states: int
    malformed: Mapping[int, int]
    losses: tuple[Loss, ...]


def read_part(wanted: Wanted, log: Log, whole: Batch) -> Part:
    """Decode some chunks that were read."""
    recorded = whole.cropped(*wanted.limits)
    batch = recorded.in_time_order()
    base = wanted.base.read(batch, wanted.base_channels) if wanted.base else []
    poses, implausible = plausible_odometry(joined_poses(base))
    contacts = read_contacts(batch, wanted.contacts, wanted.feet)
    planned: Sequence[ReadContacts] = ()
    if wanted.planned_feet is not None:
        planned = read_contacts(batch, wanted.planned, wanted.planned_feet)
    # Transforms that hold for ever do so within the limits, too, wherever they stand.
    static = [channel for channel in wanted.transforms if is_static(channel)]
    moving = [channel for channel in wanted.transforms if not is_static(channel)]
    transforms = [*read_transforms(batch, moving), *read_transforms(whole, static)]
    commands, accelerations = _read(batch, wanted.commands), _read(batch, wanted.accelerations)
    malformed = Counter(malformed_in(read.messages for read in contacts))
    for _, lost in transforms:
        malformed.update(lost)
    for each in (*base, commands, accelerations):
        malformed.update(each.malformed if each else {})
    joints = tuple(_joint_tables(batch, wanted, malformed))
    feet, lags = _by_foot(contacts, len(wanted.feet.feet))
    pairs = [read.pairs for read in contacts if read.pairs]
    return Part(
        feet=feet,
        lags=lags,
        planned=_by_foot(planned, len(wanted.feet.feet))[0],
        step=np.concatenate([np.empty(0, np.int64), *(each.step for each in pairs)]),
        links=_links(contacts),
        base=poses,
        world_frames={name for each in base for name in each.worlds},
        base_frames={name for each in base for name in each.bases},
        transforms=concatenate_transforms([no_transforms(), *(each for each, _ in transforms)]),
        joints=joints,
        commands=commands,
        accelerations=accelerations,
        log_times=_by_channel(recorded),
        stamps=_stamped(log, wanted, base, [*contacts, *planned]),
        implausible=implausible + sum(read.implausible for read in contacts),
        untimed_messages=sum(each.untimed_messages for each in pairs),
        foreign_states=sum(each.foreign_states for each in pairs),
        malformed=malformed,
        losses=batch.losses,
    )


def _read(batch: Batch, topic: WantedVectors | None) -> ReadVectors | None:
    return read_vectors(batch, topic.channels, topic.part) if topic else None


def _by_foot(
    contacts: Sequence[ReadContacts], feet: int
) -> tuple[tuple[Samples, ...], tuple[Lags, ...]]:
    """Return the contact samples of each foot, small enough to keep them all, and their lags."""
    lags = (
        read.pairs.lag if read.pairs else np.full(len(read.samples.foot), UNTIMED)
        for read in contacts
    )
    lag = np.concatenate([np.empty(0, np.int64), *lags])
    samples = concatenated([no_samples(), *(read.samples for read in contacts)])
    return (
        tuple(_compact(each) for each in samples_by_foot(samples, feet)),
        tuple(Lags(lag[samples.foot == foot]) for foot in range(feet)),
    )


def _compact(samples: Samples) -> Samples:
    """Return samples in half the memory: places need all digits, forces and counts do not."""
    few = np.minimum(samples.points, np.iinfo(np.uint8).max)
    return replace(
        samples,
        foot=samples.foot.astype(np.uint8),
        force=samples.force.astype(np.float32),
        normal=samples.normal.astype(np.float32),
        points=few.astype(np.uint8),
    )


def _links(contacts: Sequence[ReadContacts]) -> dict[int, set[str]]:
    found: dict[int, set[str]] = {}
    for read in contacts:
        for foot, names in read.links.items():
            found.setdefault(foot, set()).update(names)
    return found


def _joint_tables(batch: Batch, wanted: Wanted, malformed: Counter[int]) -> Iterator[JointTable]:
    """Yield the joint states of each channel; count malformed messages by channel id."""
    for joints in wanted.joints:
        for read in read_joints(batch, joints.channel):
            malformed.update(read.malformed)
            columns = [
                column for column, name in enumerate(read.names) if name not in joints.left_out
            ][:MOST_JOINTS]
            if columns and len(read.log_time):
                stamp = header_time(read.stamp, read.log_time)
                values = read.position, read.velocity, read.effort
                samples = JointSamples(read.log_time, stamp, *values).only(np.array(columns))
                names = tuple(read.names[column] for column in columns)
                yield JointTable(joints.channel.topic, names, samples)


def _by_channel(batch: Batch) -> dict[int, Ints]:
    """Return the log times of the messages of each channel, by its id."""
    messages = batch.messages
    return {channel: messages.log_time[rows] for channel, rows in rows_by_group(messages.channel)}


def _stamped(
    log: Log, wanted: Wanted, base: Sequence[BasePoses], contacts: Sequence[ReadContacts]
) -> dict[str, Stamps]:
    """Return the times of messages with a header, by topic."""
    stamps: dict[str, list[Stamps]] = {}
    source = wanted.base.source if wanted.base else None
    if source is not None and source.has_header and source.has_one_pose:
        for each in base:
            for channel, rows in rows_by_group(each.channel):
                topic = log.channels[channel].topic
                times = Stamps(each.poses.log_time[rows], each.poses.stamp[rows])
                stamps.setdefault(topic, []).append(times)
    for read in contacts:
        if not read.source.has_header:
            continue
        messages = read.messages
        stamp = read.source.stamps(messages)
        for channel, rows in rows_by_group(messages.channel):
            topic = log.channels[channel].topic
            times = Stamps(messages.log_time[rows], stamp[rows])
            stamps.setdefault(topic, []).append(times)
    return {topic: concatenated(parts) for topic, parts in stamps.items()}
