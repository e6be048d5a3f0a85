"""A batch of a log as columns of poses and contacts: `convert` and `stats` begin here."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from typing import Final

import numpy as np

from dogbot_logtool.core.base.odometry import Odometry
from dogbot_logtool.core.contact.contact_rule import FootSensor
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.offsets import without_offsets
from dogbot_logtool.core.frames.recorded_transforms import (
    RecordedTransforms,
    concatenate_transforms,
    no_transforms,
)
from dogbot_logtool.core.frames.transform_buffer import LONGEST_DELAY_S, TransformBuffer
from dogbot_logtool.core.plausible import plausible_odometry
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.pipeline.frames.world_frames import BatchFrames, WorldFrames
from dogbot_logtool.pipeline.topics.selection import Selection
from dogbot_logtool.reader.containers.log import Batch, Chunk, Log, Span
from dogbot_logtool.reader.messages.bases import BasePoses, joined_poses
from dogbot_logtool.reader.messages.contact_messages import DecodedContacts, read_contacts
from dogbot_logtool.reader.messages.feet import FootChannels
from dogbot_logtool.reader.messages.messages import DecodedMessages, malformed_in
from dogbot_logtool.reader.messages.transforms import (
    decode_transforms,
    transform_columns,
)

_MOST_CHUNKS_AHEAD: Final = 256
"""Number of chunks that are looked into if they do not say when they begin."""


@dataclass(frozen=True, slots=True)
class BatchColumns:
    """A batch and its columns. It knows nothing of other batches, but for the frames ahead."""

    recorded: Batch
    """As it stands in the file."""
    batch: Batch
    """The same in the order of its log times."""
    base: tuple[BasePoses, ...]
    odometry: Odometry
    """The same as columns, also poses that cannot be used."""
    contacts: tuple[DecodedContacts, ...]
    transforms: tuple[DecodedMessages, ...]
    """The log's own transforms, where they matter."""
    frames: BatchFrames | None
    """Places feet in the world; None where that is not needed."""
    implausible: int
    """Poses and contact samples with numbers that no robot reaches; those are NaN."""
    stored_size: int
    """Bytes of the file that it was read from."""

    @property
    def samples(self) -> tuple[Samples, ...]:
        """Samples of each kind of contact messages."""
        return tuple(read.reduced.samples for read in self.contacts)

    @property
    def end_time(self) -> int | None:
        """ns, the latest log time; None: it is empty."""
        log_time = self.batch.messages.log_time
        return int(log_time.max()) if len(log_time) else None

    @property
    def malformed(self) -> Mapping[int, int]:
        """Messages that could not be decoded, by channel id."""
        contacts = [read.messages for read in self.contacts]
        messages = malformed_in([*contacts, *self.transforms])
        for poses in self.base:
            messages |= poses.malformed
        return messages


@dataclass(frozen=True, slots=True)
class BatchReader:
    """Reads and decodes batches; called in several threads or processes at once."""

    selection: Selection
    feet: FootChannels
    frames: WorldFrames | None
    """Turns forces into the world and places sensors; None where that is not needed."""
    sensors: Sequence[FootSensor]
    """How each foot's sensor reads; empty: as it is recorded."""
    limits: tuple[int | None, int | None]
    """ns, log times from which and up to which messages are taken; None: no limit."""
    reads_transforms: bool = False
    """Whether the log's own transforms matter even where feet do not need them."""

    def read(self, log: Log, span: Span) -> BatchColumns:
        """Read and decode one batch."""
        selection = self.selection
        recorded = log.read(span).cropped(*self.limits)
        batch = recorded.in_time_order()
        base = selection.read_base(batch)
        odometry, implausible = plausible_odometry(joined_poses(base))
        contacts = [
            self._without_offsets(self._only_in_world(read))
            for read in read_contacts(batch, selection.contacts, self.feet)
        ]
        transforms: Sequence[DecodedMessages] = ()
        if self.reads_transforms or self.frames is not None:
            transforms = decode_transforms(batch, selection.transforms)
        frames = None
        if self.frames is not None:
            own = self.frames.tracks(_columns(transforms), odometry)
            reduced = [
                read.reduced.samples for read in contacts if len(read.reduced.samples.log_time)
            ]
            ahead = self._frames_ahead(self.frames, log, span, own, reduced)
            log_time = batch.messages.log_time
            frames = BatchFrames(own, ahead, int(log_time.max()) if len(log_time) else None)
        return BatchColumns(
            recorded=recorded,
            batch=batch,
            base=tuple(base),
            odometry=odometry,
            contacts=tuple(contacts),
            transforms=tuple(transforms),
            frames=frames,
            implausible=implausible + sum(read.reduced.implausible for read in contacts),
            stored_size=sum(chunk.data_size for chunk in span),
        )

    def _only_in_world(self, read: DecodedContacts) -> DecodedContacts:
        """Leave out positions in the base's frame where nothing can turn them into the world."""
        if self.frames is not None or not read.source.in_base:
            return read
        samples = read.reduced.samples
        nowhere = replace(samples, position=np.full_like(samples.position, np.nan))
        return replace(read, reduced=replace(read.reduced, samples=nowhere))

    def _without_offsets(self, read: DecodedContacts) -> DecodedContacts:
        """Take the sensors' offsets off, so that what is drawn is what is measured."""
        source = read.source
        samples = without_offsets(
            read.reduced.samples,
            self.sensors,
            lists_contacts=source.lists_contacts,
            only_presses=source.is_raw or source.one_axis,
        )
        return replace(read, reduced=replace(read.reduced, samples=samples))

    def _frames_ahead(
        self,
        frames: WorldFrames,
        log: Log,
        span: Span,
        own: TransformBuffer,
        reduced: Sequence[Samples],
    ) -> TransformBuffer:
        """Look ahead of a batch, as far as its samples may need it, for what places the feet.

        Args:
            frames: what is wanted.
            log: the log.
            span: the batch's chunks.
            own: what it tells of the frames itself.
            reduced: contacts of feet in it, none of it empty.
        """
        ahead = TransformBuffer()
        if not reduced:
            return ahead
        latest = max(int(frames.clock.of(each).max()) for each in reduced)
        until = max(int(each.log_time.max()) for each in reduced) + round(LONGEST_DELAY_S * 1e9)
        for chunk in self._chunks_ahead(log, span, until):
            if frames.tell_until(own.then(ahead), latest):
                break
            later = log.read((chunk,)).cropped(*self.limits)
            poses, _ = plausible_odometry(joined_poses(self.selection.read_base(later)))
            transforms = _columns(decode_transforms(later, self.selection.transforms))
            ahead = ahead.then(frames.tracks(transforms, poses))
        return ahead

    def _chunks_ahead(self, log: Log, span: Span, until: int) -> Iterator[Chunk]:
        """Yield the chunks after a batch that may tell of frames, up to a log time, ns."""
        wanted = {c.id for c in (*self.selection.odometry, *self.selection.transforms)}
        for chunk in islice(log.after(span), _MOST_CHUNKS_AHEAD):
            if chunk.start_time is not None and chunk.start_time > until:
                break
            if chunk.counts is None or not wanted.isdisjoint(chunk.counts):
                yield chunk


def _columns(transforms: Sequence[DecodedMessages]) -> RecordedTransforms:
    return concatenate_transforms([no_transforms(), *map(transform_columns, transforms)])
