"""Where was a frame at a time? Recorded transforms, interpolated along the chain of frames.

With it, forces that were recorded in a link's frame are turned into the world, provided that the
log's own transforms (or joint states turned into transforms) hold that link, and odometry holds
the base. Nothing is extrapolated, and no gap is bridged: where transforms are too far apart, the
answer is "not known", and counted.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints
from dogbot_logtool.core.blocks import concatenated
from dogbot_logtool.core.clock import TimeSource, advancing
from dogbot_logtool.core.contacts import Samples
from dogbot_logtool.core.rotations import multiply, normalised, rotate, slerp

LONGEST_STEP_S: Final = 0.1
"""Transforms further apart are not interpolated between."""
LONGEST_WAIT_S: Final = 10.0
"""Transforms that are recorded later than this after the samples that need them are not used."""
_DEEPEST: Final = 100
"""A chain of more frames is a loop."""


@dataclass(frozen=True, slots=True)
class Poses:
    """Poses of a frame in another one at n times."""

    known: Flags
    """(n,) whether the rest of the row is known."""
    translation: Floats
    """(n, 3) m; NaN where not known."""
    rotation: Floats
    """(n, 4) unit quaternion x, y, z, w; NaN where not known."""


@dataclass(slots=True)
class _Frame:
    """What is recorded of one child frame in its parent."""

    parent: str
    static: bool
    time: Ints
    translation: Floats
    rotation: Floats


class TransformBuffer:
    """Recorded transforms of frames in their parents.

    Frames are named without leading slashes. Each has one parent: transforms into another one
    are refused, since which of them holds is not known.
    """

    def __init__(self, longest_step_s: float = LONGEST_STEP_S) -> None:
        self._frames: dict[str, _Frame] = {}
        self._longest_ns = round(longest_step_s * 1e9)
        self.refused = 0
        """Transforms that are not finite, step back in time, or name another parent."""

    def add(
        self,
        parent: str,
        child: str,
        time: Ints,
        translation: Floats,
        rotation: Floats,
        *,
        static: bool = False,
    ) -> None:
        """Take in transforms of one child frame, in the order of the log.

        Args:
            parent: frame id, with or without a leading slash. Also `child`.
            child: the frame whose pose it is.
            time: (n,) ns.
            translation: (n, 3) m, in the parent.
            rotation: (n, 4) quaternion x, y, z, w.
            static: whether they hold at any time; the latest one does.
        """
        parent, child = parent.lstrip("/"), child.lstrip("/")
        known = self._frames.get(child)
        if known is not None and known.parent != parent:
            self.refused += len(time)
            return
        sound = np.isfinite(translation).all(axis=1) & np.isfinite(rotation).all(axis=1)
        sound &= (rotation != 0.0).any(axis=1)
        if not static:
            latest = None if known is None or known.static else int(known.time[-1])
            sound[sound] = advancing(time[sound], latest)
        self.refused += int((~sound).sum())
        if not sound.any():
            return
        new = _Frame(parent, static, time[sound], translation[sound], normalised(rotation[sound]))
        self._frames[child] = _followed(known, new)

    def forget_before(self, time: int) -> None:
        """Drop what no lookup from a time, ns, on will need."""
        for frame in self._frames.values():
            if frame.static:
                continue
            first = max(int(np.searchsorted(frame.time, time)) - 1, 0)
            frame.time = frame.time[first:].copy()
            frame.translation = frame.translation[first:].copy()
            frame.rotation = frame.rotation[first:].copy()

    def chain(self, frame: str, ancestor: str) -> tuple[str, ...] | None:
        """Return the frames from one up to the child of an ancestor; None: not connected."""
        frames: list[str] = []
        current = frame.lstrip("/")
        while current != ancestor.lstrip("/"):
            if current not in self._frames or len(frames) > _DEEPEST:
                return None
            frames.append(current)
            current = self._frames[current].parent
        return tuple(frames)

    def decided_until(self, frame: str, ancestor: str) -> int | None:
        """Return the time, ns, up to which no later transform changes a lookup.

        None while the frames are not connected, or only by static transforms.
        """
        chain = self.chain(frame, ancestor)
        moving = [self._frames[each] for each in chain or () if not self._frames[each].static]
        return min((int(each.time[-1]) for each in moving), default=None)

    def lookup(self, frame: str, ancestor: str, time: Ints) -> Poses:
        """Interpolate the poses of a frame in an ancestor: lerp and slerp, frame by frame.

        Args:
            frame: frame id.
            ancestor: frame id of its parent, its parent's parent, and so on.
            time: (n,) ns.

        Returns:
            n poses; not known where frames are not connected, before the first and after the last
            transform, and between two that are too far apart.
        """
        chain = self.chain(frame, ancestor)
        count = len(time)
        known = np.full(count, chain is not None)
        translation, rotation = np.zeros((count, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (count, 1))
        for each in chain or ():
            here, shift, turn = self._interpolated(self._frames[each], time)
            known &= here
            translation = shift + rotate(turn, translation)
            rotation = multiply(turn, rotation)
        translation[~known] = np.nan
        rotation[~known] = np.nan
        return Poses(known, translation, rotation)

    def _interpolated(self, frame: _Frame, time: Ints) -> tuple[Flags, Floats, Floats]:
        count = len(time)
        if frame.static:
            always = np.ones(count, np.bool_)
            last = np.full(count, len(frame.time) - 1)
            return always, frame.translation[last], frame.rotation[last]
        after = np.minimum(np.searchsorted(frame.time, time), len(frame.time) - 1)
        before = np.where(frame.time[after] > time, np.maximum(after - 1, 0), after)
        step = frame.time[after] - frame.time[before]
        known = (time >= frame.time[0]) & (time <= frame.time[-1]) & (step <= self._longest_ns)
        share = (time - frame.time[before]) / np.maximum(step, 1)
        share = np.where(known, share, 0.0)
        first, second = frame.translation[before], frame.translation[after]
        shift = first + share[:, None] * (second - first)
        return known, shift, slerp(frame.rotation[before], frame.rotation[after], share)


def _followed(known: _Frame | None, new: _Frame) -> _Frame:
    if known is None or known.static or new.static:
        return new
    return _Frame(
        new.parent,
        static=False,
        time=np.concatenate([known.time, new.time]),
        translation=np.concatenate([known.translation, new.translation]),
        rotation=np.concatenate([known.rotation, new.rotation]),
    )


class ForcesToWorld:
    """Turns link-frame forces into the world while the log streams past.

    Samples wait until the transforms around them have come, so that it does not matter in which
    batch which message stands. Those that cannot be turned pass as they are, and are counted.
    """

    def __init__(
        self,
        buffer: TransformBuffer,
        links: Sequence[str | None],
        world: str,
        clock: TimeSource = TimeSource.HEADER,
    ) -> None:
        """Set up.

        Args:
            buffer: transforms from each link to the base, and from the base to the world.
            links: frame of the wrenches of each foot; None where it is not known.
            world: frame to turn forces to.
            clock: the clock of the samples; the buffer must be on the same.
        """
        self._buffer = buffer
        self._links = links
        self._world = world
        self._clock = clock
        self._waiting: list[Samples | None] = [None] * len(links)
        self.turned = 0
        """Samples whose force was turned."""
        self.not_turned = 0
        """Samples in contact for which the transforms did not tell."""

    def add(self, samples: Samples) -> list[Samples]:
        """Take in samples; return those that no later transform can change, foot by foot."""
        decided = [self._decided(foot, samples) for foot in range(len(self._links))]
        self._forget()
        return [each for each in decided if each is not None]

    def finish(self) -> list[Samples]:
        """End the log: return the samples that still wait."""
        waiting = [
            self._turned(foot, samples)
            for foot, samples in enumerate(self._waiting)
            if samples is not None
        ]
        self._waiting = [None] * len(self._links)
        return waiting

    def _decided(self, foot: int, samples: Samples) -> Samples | None:
        mine = samples.pick(np.flatnonzero(samples.foot == foot))
        waiting = self._waiting[foot]
        mine = mine if waiting is None else concatenated([waiting, mine])
        ready = self._ready(self._links[foot], self._time(mine))
        self._waiting[foot] = mine.pick(np.arange(ready, len(mine.foot)))
        return self._turned(foot, mine.pick(np.arange(ready))) if ready else None

    def _ready(self, link: str | None, time: Ints) -> int:
        """Return how many of the first samples need not wait for later transforms."""
        if link is None or len(time) == 0:
            return len(time)
        until = self._buffer.decided_until(link, self._world)
        # A sensor must not wait for ever for transforms that never come.
        soonest = int(time.max()) - round(LONGEST_WAIT_S * 1e9)
        late = np.flatnonzero(time > (soonest if until is None else max(until, soonest)))
        return int(late[0]) if len(late) else len(time)

    def _turned(self, foot: int, samples: Samples) -> Samples:
        link = self._links[foot]
        wanted = samples.in_contact & ~samples.in_world
        if link is None:
            self.not_turned += int(wanted.sum())
            return samples
        poses = self._buffer.lookup(link, self._world, self._time(samples))
        turned = wanted & poses.known
        self.turned += int(turned.sum())
        self.not_turned += int((wanted & ~turned).sum())
        force = samples.force.copy()
        force[turned] = rotate(poses.rotation[turned], samples.force[turned])
        return replace(samples, force=force, in_world=samples.in_world | turned)

    def _time(self, samples: Samples) -> Ints:
        return samples.stamp if self._clock is TimeSource.HEADER else samples.log_time

    def _forget(self) -> None:
        waiting = [self._time(each) for each in self._waiting if each is not None]
        earliest = min((int(time.min()) for time in waiting if len(time)), default=None)
        if earliest is not None:
            self._buffer.forget_before(earliest)
