"""The work of `stats` on one batch: read it and decode the columns of its figures."""

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from dogbot_logtool.core.base.odometry import Odometry
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.geometry.arrays import Ints, rows_by_group
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.pipeline.batches import BatchColumns, BatchReader
from dogbot_logtool.pipeline.frames.world_frames import BatchFrames
from dogbot_logtool.reader.containers.log import Batch, Log, Loss, Span
from dogbot_logtool.reader.messages.bases.source import BasePoses
from dogbot_logtool.reader.messages.messages import DecodedMessages

# Loaded for logs that have such topics.
if TYPE_CHECKING:
    from dogbot_logtool.pipeline.measuring.legs import LegColumns, LegReader
    from dogbot_logtool.pipeline.measuring.side_topics import SideTopic, SideTopics
    from dogbot_logtool.reader.messages.vectors import ReadVectors


@dataclass(frozen=True, slots=True)
class MessageTimes:
    """Times of a topic's messages in a batch, for its quality."""

    topic: str
    log_time: Ints
    stamp: Ints | None
    frame_ids: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class MeasuredBatch:
    """The columns of a batch that figures need."""

    samples: Sequence[Samples]
    odometry: Odometry
    frames: BatchFrames | None
    """Poses of the links; None if no force must be turned into the world."""
    times: Sequence[MessageTimes]
    malformed: Mapping[int, int]
    implausible: int
    """Poses and contact samples with numbers that no robot reaches."""
    out_of_order: int
    """Messages that were logged earlier than the one before on their channel."""
    losses: Sequence[Loss]
    counts: Mapping[int, int]
    """Messages by channel id."""
    stored_size: int
    commands: "ReadVectors | None" = None
    """Velocity commands; None: the log has none. Likewise `inertial`."""
    inertial: "ReadVectors | None" = None
    legs: "LegColumns | None" = None
    """Columns of the legs; None: nothing in this log."""


@dataclass(frozen=True, slots=True)
class BatchMeasurer:
    """Measures batches; called in several threads or processes at once."""

    reader: BatchReader
    side: "SideTopics | None" = None
    """Topics beside feet and base; None: nothing."""
    legs: "LegReader | None" = None
    """Reads what is told of the legs; None: nothing is."""

    def __call__(self, log: Log, span: Span) -> MeasuredBatch:
        """Read and decode one batch."""
        columns = self.reader.read(log, span)
        with_header = [read.messages for read in columns.contacts if read.source.has_header]
        stamped: dict[str, MessageTimes] = {}
        source = self.reader.selection.base
        if source is not None and source.source.has_header and source.source.has_one_pose:
            for poses in columns.base:
                stamped.update(_pose_times(log, poses))
        for messages in with_header:
            stamped.update(_stamped_times(log, messages))
        commands = _read(self.side.commands, columns) if self.side else None
        inertial = _read(self.side.inertial, columns) if self.side else None
        malformed = dict(columns.malformed)
        for read in (commands, inertial):
            malformed |= read.malformed if read else {}
        legs = self.legs.read(columns.batch, columns.transforms) if self.legs else None
        return MeasuredBatch(
            samples=columns.samples,
            odometry=columns.odometry,
            frames=columns.frames,
            times=list((_log_times(log, columns.batch) | stamped).values()),
            malformed=malformed,
            implausible=columns.implausible,
            out_of_order=columns.batch.out_of_order,
            losses=columns.batch.losses,
            counts=columns.batch.counts,
            stored_size=columns.stored_size,
            commands=commands,
            inertial=inertial,
            legs=legs,
        )


def _read(topic: "SideTopic | None", columns: BatchColumns) -> "ReadVectors | None":
    return topic.read(columns.batch) if topic else None


def _log_times(log: Log, batch: Batch) -> dict[str, MessageTimes]:
    """Return the log times of every topic in a batch."""
    log_time = batch.messages.log_time
    return {
        topic: MessageTimes(topic, log_time[rows], None, ())
        for topic, rows in _by_topic(log, batch.messages.channel)
    }


def _stamped_times(log: Log, messages: DecodedMessages) -> dict[str, MessageTimes]:
    """Return log times, stamps and frames of the topics of decoded messages."""
    stamp = messages.table.nanoseconds("header.stamp")
    frame = messages.table.texts("header.frame_id")
    topics = {}
    for topic, rows in _by_topic(log, messages.channel):
        _, frames = frame.pick(rows).encode()
        topics[topic] = MessageTimes(topic, messages.log_time[rows], stamp[rows], frames)
    return topics


def _pose_times(log: Log, base: BasePoses) -> dict[str, MessageTimes]:
    """Return log times, stamps and frames of the base's poses, which are of one topic."""
    poses = base.poses
    return {
        topic: MessageTimes(topic, poses.log_time[rows], poses.stamp[rows], base.worlds)
        for topic, rows in _by_topic(log, base.channel)
    }


def _by_topic(log: Log, channel: Ints) -> Iterator[tuple[str, Ints]]:
    """Yield each topic, of all its senders, with the rows of its messages in their order."""
    topics = sorted({each.topic for each in log.channels.values()})
    number = {topic: row for row, topic in enumerate(topics)}
    ids = sorted(log.channels)
    numbers = np.array([number[log.channels[each].topic] for each in ids], np.int64)
    for row, rows in rows_by_group(numbers[np.searchsorted(ids, channel)]):
        yield topics[row], rows
