"""One batch on its way to finished chunks: read, compute, stamp out, copy, compress."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from dogbot_logtool.core.frames.link_frames import FrameCounts
from dogbot_logtool.core.scene.arrows import ArrowCounts
from dogbot_logtool.pipeline.conversion.carried import Carried
from dogbot_logtool.pipeline.conversion.copying import copied_chunks
from dogbot_logtool.pipeline.conversion.drawing import Drawn, draw
from dogbot_logtool.pipeline.conversion.reading import ReadBatch, read_batch
from dogbot_logtool.pipeline.plan import Plan
from dogbot_logtool.reader.containers.log import Batch, Log, Loss, Span
from dogbot_logtool.reader.messages.transforms import frame_pairs
from dogbot_logtool.run.relay import Baton
from dogbot_logtool.writer.annotations import Annotations
from dogbot_logtool.writer.chunks import FinishedChunk, finish_chunks


@dataclass(frozen=True, slots=True)
class Counts:
    """What happened to the messages of a batch, or of the whole log."""

    arrows: ArrowCounts = field(default_factory=ArrowCounts)
    bad_poses: int = 0
    """Odometry messages with a zero quaternion or a number that is not finite."""
    implausible: int = 0
    """Poses and contact samples with numbers that no robot reaches."""
    untimed_messages: int = 0
    """Contact messages of several states that tell no time of their physics step."""
    foreign_states: int = 0
    """Contact states of pairs that the foot is not one body of."""
    frames: FrameCounts = field(default_factory=FrameCounts)
    support_unknown: int = 0
    """Support messages at whose time it was not known which feet are down, or where."""
    support_unweighed: int = 0
    """Support messages without a centre of pressure for want of a vertical force."""

    def __add__(self, other: "Counts") -> "Counts":
        return Counts(
            self.arrows + other.arrows,
            self.bad_poses + other.bad_poses,
            self.implausible + other.implausible,
            self.untimed_messages + other.untimed_messages,
            self.foreign_states + other.foreign_states,
            self.frames + other.frames,
            self.support_unknown + other.support_unknown,
            self.support_unweighed + other.support_unweighed,
        )


@dataclass(frozen=True, slots=True)
class ConvertedBatch:
    """What a batch became."""

    chunks: tuple[FinishedChunk, ...]
    counts: Counts
    malformed: Mapping[int, int]
    """Messages that could not be decoded, by channel id."""
    recorded: Mapping[int, int]
    """Messages that were read, by channel id."""
    losses: tuple[Loss, ...]
    other_parent: str | None
    """A parent other than ours that the log's own transforms give the base, if any."""
    stored_size: int
    """Bytes of the file that it was read from."""


class BatchConverter:
    """Converts batches; called in several threads or processes at once."""

    def __init__(self, log: Log, plan: Plan, annotations: Annotations) -> None:
        self._log = log
        self._plan = plan
        self._annotations = annotations

    def __call__(self, span: Span, baton: Baton[Carried]) -> ConvertedBatch:
        """Convert one batch."""
        # What was decoded is let go of before the copies take their memory.
        batch, annotated = self._annotated(span, baton)
        return replace(annotated, chunks=(*self._copied(batch), *annotated.chunks))

    def _annotated(self, span: Span, baton: Baton[Carried]) -> tuple[Batch, ConvertedBatch]:
        """Read a batch; return it, and what it becomes without the recorded messages."""
        read = read_batch(self._log, self._plan, span)
        carried = baton.take()
        placed = read.placed(carried.transforms, self._plan)
        footings = carried.footings(placed.samples, self._plan)
        baton.pass_on(carried.past(read, footings))
        drawn = draw(read, placed.samples, footings, carried, self._plan)
        stamped_out = self._annotations.outgoing(drawn.columns)
        compression = self._plan.options.compression or "zstd"
        return read.columns.batch, ConvertedBatch(
            chunks=tuple(
                chunk for messages in stamped_out for chunk in finish_chunks(messages, compression)
            ),
            counts=_counts(read, drawn, placed.counts),
            malformed=read.columns.malformed,
            recorded=read.columns.batch.counts,
            losses=read.columns.batch.losses,
            other_parent=self._other_parent(read),
            stored_size=read.columns.stored_size,
        )

    def _copied(self, batch: Batch) -> tuple[FinishedChunk, ...]:
        options = self._plan.options
        if not options.copy:
            return ()
        return tuple(
            copied_chunks(batch, options.compression, as_they_stand=self._log.copies_chunks)
        )

    def _other_parent(self, read: ReadBatch) -> str | None:
        plan = self._plan
        if not plan.base_may_have_parent:
            return None
        for messages in read.columns.transforms:
            for parent, child in sorted(frame_pairs(messages)):
                names = parent.lstrip("/"), child.lstrip("/")
                if names[1] == plan.base_frame and names[0] != plan.world_frame:
                    return names[0]
        return None


def _counts(read: ReadBatch, drawn: Drawn, frames: FrameCounts) -> Counts:
    contacts, support = read.columns.contacts, drawn.columns.support
    return Counts(
        arrows=drawn.skipped,
        bad_poses=read.bad_poses,
        implausible=read.columns.implausible,
        untimed_messages=sum(each.felt.untimed_messages for each in contacts),
        foreign_states=sum(each.felt.foreign_states for each in contacts),
        frames=frames,
        support_unknown=support.unknown if support else 0,
        support_unweighed=support.unweighed if support else 0,
    )
