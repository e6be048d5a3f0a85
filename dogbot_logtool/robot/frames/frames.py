"""The frame tree of a whole log: `info --frames`, what view_frames shows of a live system."""

from collections import Counter
from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from functools import partial

from dogbot_logtool.core.frames.frame_tree import FrameEdge, RecordedFrames, recorded_frames
from dogbot_logtool.core.frames.transforms import (
    RecordedTransforms,
    concatenate_transforms,
    no_transforms,
)
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.reader.containers.log import Channel, Log, Loss, Span
from dogbot_logtool.reader.containers.salvage.losses import malformed_messages
from dogbot_logtool.reader.decode.objects import OBJECT_ENCODINGS
from dogbot_logtool.reader.messages.messages import malformed_in
from dogbot_logtool.reader.messages.transforms import (
    FOXGLOVE_TYPES,
    decode_transforms,
    is_static,
    transform_columns,
)
from dogbot_logtool.reader.workers import in_order
from dogbot_logtool.run.runner import OnProgress


@dataclass(frozen=True, slots=True)
class Frames:
    """All transforms of a log, and their senders."""

    recorded: RecordedFrames
    channels: Mapping[int, Channel]
    """The channels that carry transforms, by id."""
    unread: tuple[Channel, ...]
    """Channels that carry transforms in an encoding that is not read."""
    losses: tuple[Loss, ...]
    """Damage that was met on the way, beside what opening the log found."""

    def senders(self, edge: FrameEdge) -> list[str]:
        """Return the topics of an edge, each with the node that sent it where that is known."""
        senders = set()
        for channel in (self.channels[number] for number in edge.channels):
            node = channel.metadata.get("callerid")
            senders.add(f"{channel.topic} ({node})" if node else channel.topic)
        return sorted(senders)

    def parents(
        self, *, ros_only: bool = False, without: AbstractSet[int] = frozenset()
    ) -> dict[str, frozenset[str]]:
        """Return the parents of each frame.

        Args:
            ros_only: by ROS messages, the only ones that `convert` heeds.
            without: ids of channels that do not count.
        """
        parents: dict[str, set[str]] = {}
        for edge in self.recorded.edges:
            numbers = [number for number in edge.channels if number not in without]
            if not numbers:
                continue
            types = {self.channels[number].type_name for number in numbers}
            if not (ros_only and types <= FOXGLOVE_TYPES):
                parents.setdefault(edge.child, set()).add(edge.parent)
        return {child: frozenset(names) for child, names in sorted(parents.items())}


@dataclass(frozen=True, slots=True)
class _ReadBatch:
    transforms: RecordedTransforms
    malformed: Mapping[int, int]
    losses: Sequence[Loss]
    stored_size: int


def read_frames(
    log: Log, ros_channels: Sequence[Channel], jobs: int, progress: OnProgress | None
) -> Frames:
    """Read every transform of a log.

    Args:
        log: the log.
        ros_channels: the channels of tf2 and tf messages that can be read.
        jobs: how many batches are read at once.
        progress: called with bytes done and bytes in all.
    """
    foxglove = [c for c in log.channels.values() if c.type_name in FOXGLOVE_TYPES]
    readable = [channel for channel in foxglove if channel.message_encoding in OBJECT_ENCODINGS]
    channels = {channel.id: channel for channel in (*ros_channels, *readable)}
    spans = useful_spans(log, channels)
    total, done = sum(chunk.data_size for span in spans for chunk in span), 0
    work = partial(_read_batch, ros_channels, readable)
    parts = [no_transforms()]
    losses: list[Loss] = []
    malformed: Counter[int] = Counter()
    for batch in in_order(work, log, spans, jobs):
        parts.append(batch.transforms)
        losses.extend(batch.losses)
        malformed.update(batch.malformed)
        done += batch.stored_size
        if progress is not None:
            progress(done, total)
    losses.extend(malformed_messages(channels, malformed))
    unread = tuple(channel for channel in foxglove if channel.id not in channels)
    static = {number for number, one in channels.items() if is_static(one)}
    recorded = recorded_frames(concatenate_transforms(parts), static)
    return Frames(recorded, channels, unread, tuple(losses))


def useful_spans(log: Log, channels: Mapping[int, Channel]) -> list[Span]:
    """Return the batches, without the chunks that have nothing of some channels by their index."""
    if not channels:
        return []
    spans = [
        tuple(c for c in span if c.counts is None or not channels.keys().isdisjoint(c.counts))
        for span in log.spans()
    ]
    return [span for span in spans if span]


def _read_batch(
    ros_channels: Sequence[Channel], foxglove: Sequence[Channel], log: Log, span: Span
) -> _ReadBatch:
    batch = log.read(span)
    ours, ros = (decode_transforms(batch, channels) for channels in (foxglove, ros_channels))
    of_foxglove = concatenate_transforms([*map(transform_columns, ours)] or [no_transforms()])
    return _ReadBatch(
        transforms=concatenate_transforms([of_foxglove, *map(transform_columns, ros)]),
        malformed=malformed_in([*ours, *ros]),
        losses=batch.losses,
        stored_size=sum(chunk.data_size for chunk in span),
    )
