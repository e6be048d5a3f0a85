"""The frame tree of a whole log: `info --frames`, what view_frames shows of a live system."""

from collections.abc import Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass

from dogbot_logtool.core.frames.frame_tree import FrameEdge, RecordedFrames, recorded_frames
from dogbot_logtool.reader.containers.log import Channel, Chunk, Log, Loss
from dogbot_logtool.reader.decode.objects import OBJECT_ENCODINGS
from dogbot_logtool.reader.losses import malformed_messages
from dogbot_logtool.reader.messages.feet import FootChannels
from dogbot_logtool.reader.messages.others import FOXGLOVE_TYPES, is_static
from dogbot_logtool.reader.recording import read_recording
from dogbot_logtool.reader.wanted import Wanted
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


def read_frames(
    log: Log, ros_channels: Sequence[Channel], jobs: int, progress: OnProgress | None
) -> Frames:
    """Read every transform of a log.

    Args:
        log: the log.
        ros_channels: the channels of tf2 and tf messages that can be read.
        jobs: how many parts are read at once.
        progress: called with bytes done and bytes in all.
    """
    foxglove = [c for c in log.channels.values() if c.type_name in FOXGLOVE_TYPES]
    readable = [channel for channel in foxglove if channel.message_encoding in OBJECT_ENCODINGS]
    channels = {channel.id: channel for channel in (*ros_channels, *readable)}
    wanted = Wanted((), FootChannels((), {}), transforms=tuple(channels.values()))
    read = read_recording(log, wanted, jobs, progress, log.grouped(_useful(log, channels)))
    losses = (*read.losses, *malformed_messages(channels, read.malformed))
    unread = tuple(channel for channel in foxglove if channel.id not in channels)
    static = {number for number, one in channels.items() if is_static(one)}
    recorded = recorded_frames(read.recording.transforms, static)
    return Frames(recorded, channels, unread, losses)


def _useful(log: Log, channels: Mapping[int, Channel]) -> Iterator[Chunk]:
    """Yield the chunks that may have something of some channels, by their index."""
    for chunk in log.chunks if channels else ():
        if chunk.counts is None or not channels.keys().isdisjoint(chunk.counts):
            yield chunk
