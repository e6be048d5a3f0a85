"""Transforms of frames as recorded, and poses of frames at any time by the chain of frames."""

from collections.abc import Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints, all_finite, distinct
from dogbot_logtool.core.corrections.clock import TimeSource, advancing
from dogbot_logtool.core.rotations import multiply, normalised, rotate, slerp


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class RecordedTransforms:
    """Transforms as recorded: one row each, in log order."""

    channel: Ints
    """(n,) channel id."""
    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns."""
    parent: Ints
    """(n,) index into `parents`; also `child` into `children`."""
    parents: tuple[str, ...]
    """Frame ids as recorded."""
    child: Ints
    children: tuple[str, ...]
    translation: Floats
    """(n, 3) m."""
    rotation: Floats
    """(n, 4) quaternion x, y, z, w."""

    def pairs(self) -> set[tuple[str, str]]:
        """Return the different (parent, child) pairs of frames, as recorded."""
        count = max(len(self.children), 1)
        pairs = distinct(self.parent * count + self.child).tolist()
        return {(self.parents[pair // count], self.children[pair % count]) for pair in pairs}


def no_transforms() -> RecordedTransforms:
    """Return none."""
    rows: Ints = np.empty(0, np.int64)
    places, turns = np.empty((0, 3)), np.empty((0, 4))
    return RecordedTransforms(rows, rows, rows, rows, (), rows, (), places, turns)


def concatenate_transforms(parts: Sequence[RecordedTransforms]) -> RecordedTransforms:
    """Join transforms of several kinds of messages, in the order of their log times.

    Args:
        parts: at least one.
    """
    if len(parts) == 1:
        return parts[0]
    parent, parents = _one_code([(part.parent, part.parents) for part in parts])
    child, children = _one_code([(part.child, part.children) for part in parts])
    log_time = np.concatenate([part.log_time for part in parts])
    order = np.argsort(log_time, kind="stable")
    return RecordedTransforms(
        channel=np.concatenate([part.channel for part in parts])[order],
        log_time=log_time[order],
        stamp=np.concatenate([part.stamp for part in parts])[order],
        parent=parent[order],
        parents=parents,
        child=child[order],
        children=children,
        translation=np.concatenate([part.translation for part in parts])[order],
        rotation=np.concatenate([part.rotation for part in parts])[order],
    )


def _one_code(coded: Sequence[tuple[Ints, tuple[str, ...]]]) -> tuple[Ints, tuple[str, ...]]:
    """Join columns of coded names into one with a common code."""
    columns_of: dict[str, int] = {}
    columns = []
    for code, names in coded:
        common = [columns_of.setdefault(name, len(columns_of)) for name in names]
        columns.append(np.array(common, np.int64)[code])
    return np.concatenate(columns), tuple(columns_of)


LONGEST_STEP_S: Final = 0.1
"""Transforms further apart are not interpolated between."""
LONGEST_DELAY_S: Final = 2.0
"""A transform that was recorded longer before or after a sample is not used for it."""
_DEEPEST: Final = 100
"""A chain of more frames is a loop."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Poses:
    """Poses of a frame in another one at n times."""

    known: Flags
    """(n,) whether the rest of the row is known."""
    translation: Floats
    """(n, 3) m; NaN where not known."""
    rotation: Floats
    """(n, 4) unit quaternion x, y, z, w; NaN where not known."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class FrameTrack:
    """The recorded transforms of one child frame in its parent."""

    parent: str
    static: bool
    """Whether the last row holds at any time."""
    time: Ints
    """(n,) ns, the time at which each row holds; strictly increasing unless static."""
    log_time: Ints
    """(n,) ns, when it was recorded."""
    translation: Floats
    """(n, 3) m, in the parent."""
    rotation: Floats
    """(n, 4) unit quaternion x, y, z, w."""

    def pick(self, rows: Flags | slice) -> "FrameTrack":
        """Return the chosen rows."""
        time, log_time = self.time[rows], self.log_time[rows]
        shift, turn = self.translation[rows], self.rotation[rows]
        return FrameTrack(self.parent, self.static, time, log_time, shift, turn)


def frame_track(
    parent: str,
    time: Ints,
    log_time: Ints,
    translation: Floats,
    rotation: Floats,
    *,
    static: bool = False,
) -> FrameTrack | None:
    """Return what can be used of one frame's transforms; None: nothing.

    Those that are not finite are left out, and those that step back in time.

    Args:
        parent: frame id, with or without a leading slash.
        time: (n,) ns, in the order of the log.
        log_time: (n,) ns.
        translation: (n, 3) m, in the parent.
        rotation: (n, 4) quaternion x, y, z, w.
        static: whether they hold at any time; the latest one does.
    """
    sound = all_finite(translation) & all_finite(rotation)
    sound &= (rotation != 0.0).any(axis=1)
    if not static:
        sound[sound] = advancing(time[sound])
    if not sound.any():
        return None
    turned = normalised(rotation[sound])
    return FrameTrack(
        parent.lstrip("/"), static, time[sound], log_time[sound], translation[sound], turned
    )


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class TransformBuffer:
    """Transforms of frames in their parents, from one unbroken part of a log.

    Each frame has one parent: transforms into another one are left out, since which of them holds
    is not known. So are those that step back in time.
    """

    frames: Mapping[str, FrameTrack] = field(default_factory=dict)
    """By child frame, without leading slashes."""

    def then(self, later: "TransformBuffer") -> "TransformBuffer":
        """Return both together; of a frame in both, the later static transform holds."""
        own = {
            child: track
            for child, track in self.frames.items()
            if child not in later.frames or not track.static
        }
        return TransformBuffer({**later.frames, **own})

    def only(self, frames: AbstractSet[str]) -> "TransformBuffer":
        """Return what it holds of some child frames."""
        kept = {child: track for child, track in self.frames.items() if child in frames}
        return TransformBuffer(kept)

    def lookup(self, frame: str, ancestor: str, time: Ints, log_time: Ints) -> Poses:
        """Interpolate the poses of a frame in an ancestor: lerp and slerp, frame by frame.

        Args:
            frame: frame id.
            ancestor: frame id of its parent, its parent's parent, and so on.
            time: (n,) ns.
            log_time: (n,) ns, when what the poses are for was recorded.

        Returns:
            n poses; not known where frames are not connected, before the first and after the last
            transform, between two that are too far apart, and where one was recorded too long
            before or after.
        """
        parents = {child: track.parent for child, track in self.frames.items()}
        chain = chain_of_frames(parents, frame, ancestor)
        count = len(time)
        known = np.full(count, chain is not None)
        translation, rotation = np.zeros((count, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (count, 1))
        with np.errstate(over="ignore", invalid="ignore"):
            for each in chain or ():
                here, shift, turn = _interpolated(self.frames[each], time, log_time)
                known &= here
                translation = shift + rotate(turn, translation)
                rotation = multiply(turn, rotation)
        translation[~known] = np.nan
        rotation[~known] = np.nan
        return Poses(known, translation, rotation)


def chain_of_frames(
    parents: Mapping[str, str], frame: str, ancestor: str
) -> tuple[str, ...] | None:
    """Return the frames from one up to the child of an ancestor; None: not connected.

    Args:
        parents: parent by child frame, without leading slashes.
        frame: frame id; also `ancestor`.
        ancestor: where the chain ends.
    """
    frames: list[str] = []
    current = frame.lstrip("/")
    while current != ancestor.lstrip("/"):
        if current not in parents or len(frames) > _DEEPEST:
            return None
        frames.append(current)
        current = parents[current]
    return tuple(frames)


def _interpolated(track: FrameTrack, time: Ints, log_time: Ints) -> tuple[Flags, Floats, Floats]:
    count = len(time)
    if track.static:
        always = np.ones(count, np.bool_)
        last = np.full(count, len(track.time) - 1)
        return always, track.translation[last], track.rotation[last]
    after = np.minimum(np.searchsorted(track.time, time), len(track.time) - 1)
    before = np.where(track.time[after] > time, np.maximum(after - 1, 0), after)
    step = track.time[after] - track.time[before]
    known = (time >= track.time[0]) & (time <= track.time[-1]) & (step <= LONGEST_STEP_S * 1e9)
    for row in (before, after):
        known &= np.abs(track.log_time[row] - log_time) <= LONGEST_DELAY_S * 1e9
    share = (time - track.time[before]) / np.maximum(step, 1)
    share = np.where(known, share, 0.0)
    first, second = track.translation[before], track.translation[after]
    shift = first + share[:, None] * (second - first)
    return known, shift, slerp(track.rotation[before], track.rotation[after], share)


def static_tracks(recorded: RecordedTransforms, channels: AbstractSet[int]) -> TransformBuffer:
    """Return the transforms of channels whose transforms hold for ever."""
    held = np.flatnonzero(np.isin(recorded.channel, np.array([*channels], np.int64)))
    return _tracks(recorded, held, recorded.stamp, None)


def moving_tracks(
    recorded: RecordedTransforms, parents: Mapping[str, str], clock: TimeSource
) -> TransformBuffer:
    """Return the transforms of some frames.

    Args:
        recorded: transforms of any frames.
        parents: parent of each wanted frame, without leading slashes; transforms into another
            one are left out.
        clock: the clock that they are placed on.
    """
    time = clock.of(recorded)
    return _tracks(recorded, np.arange(len(time)), time, parents)


def _tracks(
    recorded: RecordedTransforms, rows: Ints, time: Ints, parents: Mapping[str, str] | None
) -> TransformBuffer:
    """Return the tracks of chosen rows: static ones where no parents are given."""
    frames: dict[str, FrameTrack] = {}
    for parent, child, own in frame_pairs(recorded, rows):
        if parents is None or parents.get(child) == parent:
            log_time, translation = recorded.log_time[own], recorded.translation[own]
            turn, is_static = recorded.rotation[own], parents is None
            track = frame_track(parent, time[own], log_time, translation, turn, static=is_static)
            if track is not None:
                frames.setdefault(child, track)
    return TransformBuffer(frames)


def frame_pairs(recorded: RecordedTransforms, rows: Ints) -> Iterator[tuple[str, str, Ints]]:
    """Yield parent and child, without leading slashes, and which of some rows have them.

    Args:
        recorded: transforms of any frames.
        rows: (n,) of them, ascending.
    """
    if not len(rows):
        return
    parent = _without_slashes(recorded.parent[rows], recorded.parents)
    child = _without_slashes(recorded.child[rows], recorded.children)
    pair = parent * max(len(recorded.children), 1) + child
    order = np.argsort(pair, kind="stable")
    numbers, starts = np.unique(pair[order], return_index=True)
    for number, chosen in zip(numbers.tolist(), np.split(order, starts[1:]), strict=False):
        one, other = divmod(number, len(recorded.children))
        yield recorded.parents[one].lstrip("/"), recorded.children[other].lstrip("/"), rows[chosen]


def _without_slashes(code: Ints, names: tuple[str, ...]) -> Ints:
    """Give names that only differ in leading slashes the same code, that of the first one."""
    first: dict[str, int] = {}
    same = [first.setdefault(name.lstrip("/"), code) for code, name in enumerate(names)]
    return np.array(same, np.int64)[code] if same else code
