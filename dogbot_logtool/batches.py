"""What `convert` does with one batch: read, decode, compute, stamp out, compress.

Batches are worked on in parallel and know nothing of each other, but for one thing: which
odometry message came last, since `/tf` takes the first one at each tick of a clock. That is
handed from batch to batch in order.
"""

from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import Future
from dataclasses import dataclass, field

from dogbot_logtool.core.arrows import (
    ArrowCounts,
    Arrows,
    classic_arrows,
    force_arrows,
    no_arrows,
    pressure_arrows,
)
from dogbot_logtool.core.loads import Loads, foot_loads
from dogbot_logtool.core.odometry import (
    Odometry,
    Transforms,
    base_transforms,
    concatenate_odometry,
    first_at_each_tick,
    usable_poses,
)
from dogbot_logtool.core.silent_swing import LastHeard, last_heard, with_swings
from dogbot_logtool.plan import Plan
from dogbot_logtool.reader.contact_sources.registry import ContactsRead, read_contacts
from dogbot_logtool.reader.log import Batch, LoadedChunk, Log, Loss, Messages, Span
from dogbot_logtool.reader.messages import DecodedMessages
from dogbot_logtool.reader.odometry import decode_odometry, odometry_columns
from dogbot_logtool.reader.transforms import decode_transforms, frame_pairs
from dogbot_logtool.writer.annotations import AnnotationColumns, Annotations
from dogbot_logtool.writer.chunks import FinishedChunk, finish_chunks, indexed_chunk
from dogbot_logtool.writer.outgoing import MESSAGE_HEAD, recorded


@dataclass(frozen=True, slots=True)
class Counts:
    """What happened to the messages of a batch, or of the whole log."""

    messages: int = 0
    """Recorded messages that were read."""
    arrows: ArrowCounts = field(default_factory=ArrowCounts)
    bad_poses: int = 0
    """Odometry messages with a zero quaternion or a number that is not finite."""
    untimed_messages: int = 0
    """Contact messages of several states that tell no time of their physics step."""
    foreign_states: int = 0
    """Contact states of pairs that the foot is not one body of."""

    def __add__(self, other: "Counts") -> "Counts":
        return Counts(
            self.messages + other.messages,
            self.arrows + other.arrows,
            self.bad_poses + other.bad_poses,
            self.untimed_messages + other.untimed_messages,
            self.foreign_states + other.foreign_states,
        )


@dataclass(frozen=True, slots=True)
class ConvertedBatch:
    """What a batch became."""

    chunks: tuple[FinishedChunk, ...]
    counts: Counts
    malformed: Mapping[int, int]
    """Messages that could not be decoded, by channel id."""
    losses: tuple[Loss, ...]
    other_parent: str | None
    """A parent other than ours that the log's own transforms give the base, if any."""
    stored_size: int
    """Bytes of the file that it was read from."""


@dataclass(frozen=True, slots=True)
class Carried:
    """What a batch must know of all earlier ones."""

    odometry: int | None = None
    """ns, time of the last usable odometry message."""
    contacts: LastHeard = field(default_factory=dict)
    """When the feet that are silent in swing were last heard."""


Handover = Future[Carried]


@dataclass(frozen=True, slots=True)
class Work:
    """A batch to be converted."""

    span: Span
    previous: Handover
    next: Handover


def chained(spans: Iterable[Span]) -> Iterator[Work]:
    """Tie every batch to the one before it."""
    previous: Handover = Future()
    previous.set_result(Carried())
    for span in spans:
        following: Handover = Future()
        yield Work(span, previous, following)
        previous = following


class BatchConverter:
    """Converts batches; called from several threads at once."""

    def __init__(self, log: Log, plan: Plan, annotations: Annotations) -> None:
        self._log = log
        self._plan = plan
        self._annotations = annotations

    def __call__(self, work: Work) -> ConvertedBatch:
        """Convert one batch."""
        try:
            return self._convert(work)
        finally:
            if not work.next.done():
                # Whoever waits for it must not wait for ever; the error reaches the user from here.
                work.next.cancel()

    def _convert(self, work: Work) -> ConvertedBatch:
        batch = self._log.read(work.span).cropped(self._plan.start_time, self._plan.end_time)
        selection = self._plan.selection
        decoded = decode_odometry(batch, selection.odometry)
        odometry = concatenate_odometry([odometry_columns(messages) for messages in decoded])
        poses = odometry.pick(usable_poses(odometry))
        contacts = read_contacts(batch, selection.contacts, selection.foot_channels())
        previous = self._hand_over(work, poses, contacts)
        transforms = self._transforms(poses, previous)

        bad_poses = len(odometry.log_time) - len(poses.log_time)
        counts = Counts(messages=len(batch.messages), bad_poses=bad_poses)
        arrows: list[Arrows] = []
        loads: list[Loads] = []
        malformed = _malformed(decoded)
        for read in contacts:
            drawn, skipped, load = self._draw(read, previous.contacts)
            arrows.append(drawn)
            loads.append(load)
            malformed = {**malformed, **read.messages.malformed}
            counts += Counts(
                arrows=skipped,
                untimed_messages=read.felt.untimed_messages,
                foreign_states=read.felt.foreign_states,
            )
        outgoing = self._annotations.outgoing(AnnotationColumns(transforms, arrows, loads))
        compression = self._plan.options.compression or "zstd"
        return ConvertedBatch(
            chunks=(*self._copied(batch), *finish_chunks(outgoing, compression)),
            counts=counts,
            malformed=malformed,
            losses=batch.losses,
            other_parent=self._other_parent(batch),
            stored_size=sum(chunk.data_size for chunk in work.span),
        )

    def _hand_over(self, work: Work, poses: Odometry, contacts: list[ContactsRead]) -> Carried:
        """Tell the next batch what it must know; return what the one before told."""
        previous = work.previous.result()
        time = poses.time
        heard = previous.contacts
        for read in contacts:
            if read.source.silent_in_swing:
                heard = last_heard(read.felt.samples, heard)
        odometry = int(time[-1]) if len(time) else previous.odometry
        work.next.set_result(Carried(odometry, heard))
        return previous

    def _transforms(self, poses: Odometry, previous: Carried) -> Transforms:
        """Return the base's transforms at the ticks of the clock."""
        rate_hz = self._plan.options.tf_rate_hz
        return base_transforms(
            poses.pick(first_at_each_tick(poses.time, rate_hz, previous.odometry))
        )

    def _draw(self, read: ContactsRead, heard: LastHeard) -> tuple[Arrows, ArrowCounts, Loads]:
        plan = self._plan
        samples = read.felt.samples
        if read.source.silent_in_swing:
            start = None if plan.start_time is not None else self._log.start_time
            samples = with_swings(samples, plan.swing_intervals, heard, start)
        loads = foot_loads(samples, plan.body_weight_n)
        newtons_per_metre = plan.selection.robot.newtons_per_metre
        if not read.source.has_force:
            return no_arrows(), ArrowCounts(), loads
        match plan.options.style:
            case "classic":
                contacts = read.felt.contacts
                drawn = (
                    (no_arrows(), ArrowCounts()) if contacts is None else classic_arrows(contacts)
                )
                return *drawn, loads
            case "pressure":
                return *pressure_arrows(samples, newtons_per_metre), loads
            case "force":
                arrows, counts = force_arrows(
                    samples,
                    force_in_world=plan.force_in_world,
                    body_weight_n=plan.body_weight_n,
                    newtons_per_metre=newtons_per_metre,
                )
                return arrows, counts, loads

    def _other_parent(self, batch: Batch) -> str | None:
        plan = self._plan
        if not plan.write_tf or not plan.options.copy or plan.options.tf == "always":
            return None
        for messages in decode_transforms(batch, plan.selection.transforms):
            for parent, child in sorted(frame_pairs(messages)):
                names = parent.lstrip("/"), child.lstrip("/")
                if names[1] == plan.base_frame and names[0] != plan.world_frame:
                    return names[0]
        return None

    def _copied(self, batch: Batch) -> Iterator[FinishedChunk]:
        """Yield the recorded messages: whole chunks as they stand, others laid out anew."""
        if not self._plan.options.copy:
            return
        torn: list[slice] = []
        for loaded in batch.chunks:
            if self._stays(loaded):
                yield from self._laid_out_anew(batch, torn)
                torn = []
                yield _verbatim(batch.messages, loaded)
            else:
                torn.append(loaded.rows)
        yield from self._laid_out_anew(batch, torn)

    def _stays(self, loaded: LoadedChunk) -> bool:
        wanted = self._plan.options.compression
        same = wanted is None or wanted == (loaded.chunk.compression or "none")
        return self._log.copies_chunks and loaded.whole and same

    def _laid_out_anew(self, batch: Batch, rows: list[slice]) -> Iterator[FinishedChunk]:
        if not rows:
            return
        messages = batch.messages.pick(slice(rows[0].start, rows[-1].stop))
        outgoing = recorded(
            messages.channel,
            messages.sequence,
            messages.log_time,
            messages.publish_time,
            batch.buffer,
            messages.start,
            messages.end,
        )
        yield from finish_chunks(outgoing, self._plan.options.compression or "zstd")


def _malformed(decoded: list[DecodedMessages]) -> dict[int, int]:
    return {channel: count for one in decoded for channel, count in one.malformed.items()}


def _verbatim(messages: Messages, loaded: LoadedChunk) -> FinishedChunk:
    """Return a recorded chunk as it stands, with a message index of what was found in it."""
    chunk = loaded.chunk
    rows = messages.pick(loaded.rows)
    return indexed_chunk(
        loaded.stored[: chunk.end - chunk.offset],
        rows.channel,
        rows.log_time,
        rows.start - MESSAGE_HEAD.itemsize - loaded.base,
        chunk.compression,
        chunk.data_size,
        chunk.size,
    )
