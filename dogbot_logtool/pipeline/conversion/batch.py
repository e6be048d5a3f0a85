"""Convert one batch: read it, compute its annotations, write them as chunks, copy its messages."""

from collections.abc import Iterator, Mapping
from dataclasses import field, replace

from dogbot_logtool.core.base.odometry import usable_poses
from dogbot_logtool.core.contact.foot_tracker import follow_feet
from dogbot_logtool.core.frames.link_frames import FrameCounts
from dogbot_logtool.core.load.silences import follow_silences
from dogbot_logtool.core.scene.arrows import ArrowCounts
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.pipeline.batches import BatchColumns
from dogbot_logtool.pipeline.conversion.annotating import compute_annotations, links_at_ticks
from dogbot_logtool.pipeline.conversion.batch_state import BatchState
from dogbot_logtool.pipeline.conversion.copying import copied_chunks
from dogbot_logtool.pipeline.conversion.plan import ConversionPlan
from dogbot_logtool.pipeline.frames.world_frames import Placed
from dogbot_logtool.reader.containers.log import Batch, Log, Loss, Span
from dogbot_logtool.reader.messages.transforms import frame_pairs
from dogbot_logtool.run.in_order import StateExchange
from dogbot_logtool.writer.annotations import AnnotationColumns, Annotations
from dogbot_logtool.writer.chunks import FinishedChunk, finish_chunks


@dataclass(frozen=True, slots=True)
class Counts:
    """Messages of a batch, or of the whole log, that could not be used as recorded."""

    arrows: ArrowCounts = field(default_factory=ArrowCounts)
    bad_poses: int = 0
    """Odometry messages with a zero quaternion or a number that is not finite."""
    implausible: int = 0
    """Poses and contact samples with numbers that no robot reaches."""
    untimed_messages: int = 0
    """Contact messages of several states without the time of their physics step."""
    foreign_states: int = 0
    """Contact states between other bodies than the foot."""
    frames: FrameCounts = field(default_factory=FrameCounts)
    support_unknown: int = 0
    """Support messages without a polygon: contact or contact point of some foot unknown."""
    support_unweighed: int = 0
    """Support messages with a polygon, but a vertical force unknown."""
    out_of_order: int = 0
    """Messages that were logged earlier than the one before on their channel."""

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
            self.out_of_order + other.out_of_order,
        )


@dataclass(frozen=True, slots=True)
class ConvertedBatch:
    """The result of converting a batch."""

    chunks: tuple[FinishedChunk, ...]
    counts: Counts
    malformed: Mapping[int, int]
    """Messages that could not be decoded, by channel id."""
    recorded: Mapping[int, int]
    """Messages that were read, by channel id."""
    losses: tuple[Loss, ...]
    second_parent: str | None
    """Another parent than ours that the log's own transforms give the base, if any."""
    stored_size: int
    """Bytes of the file that it was read from."""


class BatchConverter:
    """Converts batches; called in several threads or processes at once."""

    def __init__(self, log: Log, plan: ConversionPlan, annotations: Annotations) -> None:
        self._log = log
        self._plan = plan
        self._annotations = annotations

    def __call__(self, span: Span, exchange: StateExchange[BatchState]) -> ConvertedBatch:
        """Convert one batch."""
        # The decoded columns are freed before the copies are made, so the two never add up.
        batch, annotated = self._annotated(span, exchange)
        return replace(annotated, chunks=(*self._copied(batch), *annotated.chunks))

    def _annotated(
        self, span: Span, exchange: StateExchange[BatchState]
    ) -> tuple[Batch, ConvertedBatch]:
        """Return a batch as recorded, and its annotations in finished chunks."""
        plan = self._plan
        columns = plan.reader.read(self._log, span)
        poses = columns.odometry.pick(usable_poses(columns.odometry))
        state = exchange.receive()
        placed = _in_world(columns, state, plan)
        trackers = follow_feet(
            placed.samples, state.feet, plan.sensors, force_in_world=plan.force_in_world
        )
        silences, last = follow_silences(
            columns.samples, state.contacts, plan.rates, plan.opening_time or 0, columns.end_time
        )
        links = list(plan.motion.read(columns.batch)) if plan.motion else []
        exchange.send(state.after(columns, poses, trackers, last, plan.silent, links))
        written, skipped = compute_annotations(
            columns.contacts, placed.samples, poses, trackers, silences, state, plan
        )
        written = replace(written, links=links_at_ticks(links, state, plan))
        contacts, support = columns.contacts, written.support
        return columns.recorded, ConvertedBatch(
            chunks=tuple(self._finished(written)),
            counts=Counts(
                arrows=skipped,
                bad_poses=len(columns.odometry.log_time) - len(poses.log_time),
                implausible=columns.implausible,
                untimed_messages=sum(each.reduced.untimed_messages for each in contacts),
                foreign_states=sum(each.reduced.foreign_states for each in contacts),
                frames=placed.counts,
                support_unknown=sum(scene.unknown for scene in support),
                support_unweighed=sum(scene.unweighed for scene in support),
                out_of_order=columns.batch.out_of_order,
            ),
            malformed=columns.malformed,
            recorded=columns.batch.counts,
            losses=columns.batch.losses,
            second_parent=_second_parent(columns, plan),
            stored_size=columns.stored_size,
        )

    def _finished(self, written: AnnotationColumns) -> Iterator[FinishedChunk]:
        compression = self._plan.options.compression or "zstd"
        for messages in self._annotations.messages(written):
            yield from finish_chunks(messages, compression)

    def _copied(self, batch: Batch) -> Iterator[FinishedChunk]:
        options = self._plan.options
        if options.copy:
            batch = batch.without(self._plan.left_out) if self._plan.left_out else batch
            verbatim = self._log.copies_chunks
            yield from copied_chunks(batch, options.compression, verbatim=verbatim)


def _in_world(columns: BatchColumns, state: BatchState, plan: ConversionPlan) -> Placed:
    """Return a batch's samples in the world, as far as that is needed and frames are known."""
    if plan.frames is None or columns.frames is None:
        return Placed(columns.samples)
    return plan.frames.place(columns.samples, columns.frames.around(state.transforms))


def _second_parent(columns: BatchColumns, plan: ConversionPlan) -> str | None:
    """Return another parent than ours that the log's own transforms give the base, if any."""
    if not plan.base_may_have_parent:
        return None
    for messages in columns.transforms:
        for parent, child in sorted(frame_pairs(messages)):
            names = parent.lstrip("/"), child.lstrip("/")
            if names[1] == plan.base_frame and names[0] != plan.world_frame:
                return names[0]
    return None
