"""What `stats` does with one batch: read it and decode what figures are worked out of."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dogbot_logtool.core.arrays import Ints, rows_by_group
from dogbot_logtool.core.contacts import Samples
from dogbot_logtool.core.odometry import Odometry
from dogbot_logtool.reader.columns import Texts
from dogbot_logtool.reader.contact_sources.registry import read_contacts
from dogbot_logtool.reader.contact_sources.source import FootChannels
from dogbot_logtool.reader.log import Batch, Log, Loss, Span
from dogbot_logtool.reader.messages import DecodedMessages, malformed_in
from dogbot_logtool.reader.odometry import decode_odometry, joined_odometry
from dogbot_logtool.reader.transforms import decode_transforms
from dogbot_logtool.selection import Selection
from dogbot_logtool.world_frames import BatchFrames, WorldFrames, look_around


@dataclass(frozen=True, slots=True)
class MessageTimes:
    """Times of a topic's messages in a batch, for its quality."""

    topic: str
    log_time: Ints
    stamp: Ints | None
    frame_ids: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class MeasuredBatch:
    """What a batch holds of use."""

    samples: Sequence[Samples]
    odometry: Odometry
    frames: BatchFrames | None
    """What it tells of the links; None where no force must be turned into the world."""
    times: Sequence[MessageTimes]
    malformed: Mapping[int, int]
    losses: Sequence[Loss]
    messages: int
    stored_size: int


@dataclass(frozen=True, slots=True)
class BatchMeasurer:
    """Reads batches; called in several threads or processes at once."""

    selection: Selection
    feet: FootChannels
    frames: WorldFrames | None
    """What turns forces into the world; None where none must be."""
    limits: tuple[int | None, int | None]
    """ns, log times from which and up to which messages are taken; None: no limit."""

    def __call__(self, log: Log, span: Span) -> MeasuredBatch:
        """Read and decode one batch."""
        batch = log.read(span).cropped(*self.limits)
        decoded = decode_odometry(batch, self.selection.odometry)
        odometry = joined_odometry(decoded)
        contacts = read_contacts(batch, self.selection.contacts, self.feet)
        samples = [read.felt.samples for read in contacts]
        transforms: Sequence[DecodedMessages] = ()
        frames = None
        if self.frames is not None:
            transforms = decode_transforms(batch, self.selection.transforms)
            own = self.frames.tracks(transforms, odometry)
            frames = look_around(
                log, self.selection, self.frames, span, batch, own, samples, self.limits
            )
        with_header = [read.messages for read in contacts if read.source.has_header]
        stamped: dict[str, MessageTimes] = {}
        for messages in (*decoded, *with_header):
            stamped.update(_stamped_times(log, messages))
        return MeasuredBatch(
            samples=samples,
            odometry=odometry,
            frames=frames,
            times=list((_log_times(log, batch) | stamped).values()),
            malformed=malformed_in([*decoded, *(read.messages for read in contacts), *transforms]),
            losses=batch.losses,
            messages=len(batch.messages),
            stored_size=sum(chunk.data_size for chunk in span),
        )


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
        _, frames = Texts(frame.buffer, frame.start[rows], frame.length[rows]).encode()
        topics[topic] = MessageTimes(topic, messages.log_time[rows], stamp[rows], frames)
    return topics


def _by_topic(log: Log, channel: Ints) -> Iterator[tuple[str, Ints]]:
    """Yield each topic, whoever sends on it, with the rows of its messages in their order."""
    topics = sorted({each.topic for each in log.channels.values()})
    number = {topic: row for row, topic in enumerate(topics)}
    ids = sorted(log.channels)
    numbers = np.array([number[log.channels[each].topic] for each in ids], np.int64)
    for row, rows in rows_by_group(numbers[np.searchsorted(ids, channel)]):
        yield topics[row], rows
