"""The frame tree of a whole log, and what is wrong with it: `info --frames`."""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Final, NamedTuple

from dogbot_logtool.core.frames.transforms import (
    Edge,
    FrameEdge,
    frame_edge,
    loops,
    roots,
    second_parents,
    trees,
)
from dogbot_logtool.finding import Finding, found
from dogbot_logtool.io.printable import listed
from dogbot_logtool.reader.containers.log import Channel, Log, malformed_messages
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.decode.objects import OBJECT_ENCODINGS
from dogbot_logtool.reader.messages.feet import FootChannels
from dogbot_logtool.reader.messages.others import FOXGLOVE_TYPES
from dogbot_logtool.reader.part import Wanted
from dogbot_logtool.reader.recording import read_recording
from dogbot_logtool.run.runner import OnProgress

MOST_EDGES: Final = 2_000
"""Pairs of frames that are told apart; no robot has as many, and no viewer draws them."""


class Frames(NamedTuple):
    """All transforms of a log, and their senders."""

    edges: tuple[FrameEdge, ...]
    """Sorted by parent, then child."""
    slashed: frozenset[str]
    """Frame ids that begin with a slash, as recorded."""
    unnamed: int
    """Transforms without the name of a parent or of a child; left out."""
    left_out: int
    """Transforms of further pairs of frames, when there were `MOST_EDGES`."""
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

    def parents(self, channels: Collection[int]) -> dict[str, frozenset[str]]:
        """Return the parents that some channels, by id, give each frame."""
        parents: dict[str, set[str]] = {}
        for edge in self.edges:
            if any(number in channels for number in edge.channels):
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
    wanted = Wanted(FootChannels((), {}), transforms=tuple(channels.values()))
    spans = log.grouped(log.chunks_of(channels.keys()))
    read = read_recording(log, wanted, jobs, progress, spans)
    losses = (*read.losses, *malformed_messages(channels, read.malformed))
    unread = tuple(channel for channel in foxglove if channel.id not in channels)
    transforms = read.recording.transforms
    named = sorted(pair for pair in transforms if all(pair))
    return Frames(
        edges=tuple(frame_edge(*pair, transforms[pair]) for pair in named[:MOST_EDGES]),
        slashed=read.recording.slashed_frames,
        unnamed=sum(len(own.stamp) for pair, own in transforms.items() if not all(pair)),
        left_out=sum(len(transforms[pair].stamp) for pair in named[MOST_EDGES:]),
        channels=channels,
        unread=unread,
        losses=losses,
    )


_NAMED: Final = 5
"""Frames that a finding names."""


def frame_findings(frames: Frames, added: tuple[str, str] | None) -> Iterator[Finding]:
    """Yield what is wrong with a log's frames.

    Args:
        frames: all frames.
        added: parent and child of the transform that `convert` adds.
    """
    pairs = [(edge.parent, edge.child) for edge in frames.edges]
    yield from _of_tree(frames.edges, [*pairs, added] if added else pairs)
    yield from _of_transforms(frames.edges)
    if frames.unnamed:
        yield found("FRAME_NAMES", say="unnamed", count=frames.unnamed)
    if frames.left_out:
        yield found("FRAME_NAMES", say="left_out", count=frames.left_out, most=MOST_EDGES)
    for channel in frames.unread:
        encoding, topic = channel.message_encoding, channel.topic
        yield found("UNREADABLE", "one_topic", say="transforms", topic=topic, encoding=encoding)


def _of_tree(edges: Sequence[FrameEdge], pairs: Sequence[Edge]) -> Iterator[Finding]:
    for loop in loops(pairs):
        more = ["..."] if len(loop) > _NAMED else []
        path = " -> ".join([*loop[:_NAMED], *more, loop[0]])
        yield found("FRAME_TREE", say="loop", path=path)
    for second in second_parents(edges):
        cases = () if second.at_once else ("new_parent",)
        parents = listed(second.parents, _NAMED)
        say = "" if cases else "second"
        yield found("FRAME_TREE", *cases, say=say, child=second.child, parents=parents)
    parts = trees(pairs)
    if len(parts) > 1:
        highest = roots(pairs)
        tops = [next((root for root in highest if root in part), part[0]) for part in parts]
        yield found("FRAME_TREE", say="trees", number=len(parts), tops=listed(tops, _NAMED))
    both = [edge for edge in edges if 0 < edge.static < edge.transforms]
    if both:
        yield found("FRAME_TREE", say="both", edges=_named(both))


def _of_transforms(edges: Sequence[FrameEdge]) -> Iterator[Finding]:
    for code, say, counts in (
        ("NOT_FINITE", "transforms", [edge.not_finite for edge in edges]),
        ("BAD_TRANSFORMS", "zero", [edge.zero_rotations for edge in edges]),
        ("BAD_TRANSFORMS", "not_normalised", [edge.not_normalised for edge in edges]),
    ):
        if any(counts):
            affected = _named(edge for edge, count in zip(edges, counts, strict=True) if count)
            yield found(code, say=say, count=sum(counts), edges=affected)
    moving = [(edge, edge.timing) for edge in edges if edge.timing is not None]
    unstamped = [edge for edge, timing in moving if timing.zero_stamps]
    twice = [edge for edge, t in moving if t.duplicate_stamps and not t.zero_stamps]
    backward = [edge for edge, timing in moving if timing.backward_stamps]
    if backward:
        yield found("BAD_TRANSFORMS", say="backward", edges=_named(backward))
    if unstamped:
        yield found("BAD_TRANSFORMS", say="unstamped", edges=_named(unstamped))
    if twice:
        yield found("BAD_TRANSFORMS", "repeated", say="repeated", edges=_named(twice))
    if gaps := [edge for edge, timing in moving if timing.gaps]:
        longest = max(timing.longest_gap_s for _, timing in moving if timing.gaps)
        yield found("BAD_TRANSFORMS", say="gaps", longest=longest, edges=_named(gaps))


def _named(edges: Iterable[FrameEdge]) -> str:
    return listed([f"{edge.parent} -> {edge.child}" for edge in edges], _NAMED)
