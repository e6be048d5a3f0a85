"""The way of each foot in the base's frame, at a low rate: 20 bytes a row, 14 MB a foot and hour.

It is told by transforms as they stream past, or by joints that were kept (`joint_track.py`) with
their robot description.
"""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.frames.kinematics import Joint, link_poses
from dogbot_logtool.core.frames.transform_buffer import (
    LONGEST_DELAY_S,
    TransformBuffer,
    chain_of_frames,
)
from dogbot_logtool.core.geometry.arrays import Float32s, Floats, Ints
from dogbot_logtool.core.geometry.clock import first_at_each_tick
from dogbot_logtool.core.geometry.rotations import rotate
from dogbot_logtool.core.legs.joint_track import JointTrack
from dogbot_logtool.core.legs.silences import silent_before
from dogbot_logtool.dataclass import dataclass

PATH_RATE_HZ: Final = 200.0
_DELAY_NS: Final = round(LONGEST_DELAY_S * 1e9)


@dataclass(frozen=True, slots=True)
class LegChain:
    """How a foot hangs on the base."""

    frames: tuple[str, ...]
    """From the foot's frame up to the child of the base, without leading slashes."""
    base: str
    point: tuple[float, float, float]
    """m, of the foot, in its frame."""
    touches: bool
    """Whether the point is where the foot touches the ground, as contacts or the robot's file tell;
    else it is the frame's origin, perhaps the middle of a ball."""
    joints: tuple[Joint, ...] = ()
    """Joints of a robot description, like `frames`; empty: transforms tell."""


@dataclass(frozen=True, slots=True)
class FootPath:
    """The point of a foot in the base's frame."""

    time: Ints
    """(n,) ns, strictly increasing."""
    position: Float32s
    """(n, 3) m."""


class FootPathRecorder:
    """Makes a `FootPath` of transforms that stream past; the same however they are split."""

    def __init__(self, chain: LegChain, statics: TransformBuffer) -> None:
        self._chain, self._statics = chain, statics
        self._moving = [frame for frame in chain.frames if frame not in statics.frames]
        self._waiting = np.empty((0, 2), np.int64)
        """ns, times and log times at which the foot's last moving frame is told, not yet used."""
        self._end: int | None = None
        self._kept: list[tuple[Ints, Float32s]] = []

    @property
    def frames(self) -> Sequence[str]:
        """The frames that move."""
        return self._moving

    def add(self, own: TransformBuffer, around: TransformBuffer) -> None:
        """Take in what a batch tells of the frames.

        Args:
            own: the batch's own.
            around: the same behind what was known before, as far as this foot still needs it.
        """
        if not self._moving:
            return
        told = own.frames.get(self._moving[0])
        if told is not None:
            rows = np.column_stack([told.time, told.log_time])
            rows = rows[rows[:, 0] > self._latest]
            chosen = first_at_each_tick(rows[:, 0], PATH_RATE_HZ, self._end)
            self._end = int(rows[-1, 0]) if len(rows) else self._end
            self._waiting = np.concatenate([self._waiting, rows[chosen]])
        known = [around.frames[each].time[-1] for each in self._moving if each in around.frames]
        if len(known) == len(self._moving):
            ready = int(np.searchsorted(self._waiting[:, 0], min(known), side="right"))
            self._look_up(around, ready)

    @property
    def _latest(self) -> int:
        return np.iinfo(np.int64).min if self._end is None else self._end

    def drop_before(self, log_time: int) -> None:
        """Give up times that no transform recorded from now on may tell of, ns."""
        late = self._waiting[:, 1] >= log_time - _DELAY_NS
        self._waiting = self._waiting[late]

    def _look_up(self, around: TransformBuffer, count: int) -> None:
        """Place the foot at the first times that wait."""
        if count == 0:
            return
        rows, self._waiting = self._waiting[:count], self._waiting[count:]
        buffer = self._statics.then(around)
        poses = buffer.lookup(self._chain.frames[0], self._chain.base, rows[:, 0], rows[:, 1])
        known = poses.known
        turned = rotate(poses.rotation[known], np.array([self._chain.point]))
        position = poses.translation[known] + turned
        self._kept.append((rows[known, 0], position.astype(np.float32)))

    def finish(self) -> FootPath:
        """End the log."""
        time = np.concatenate([np.empty(0, np.int64), *(time for time, _ in self._kept)])
        position = np.concatenate([np.empty((0, 3), np.float32), *(each for _, each in self._kept)])
        return FootPath(time, position)


class PathRecorder:
    """Makes the `FootPath` of every foot that transforms place."""

    def __init__(self, chains: Sequence[LegChain | None], statics: TransformBuffer) -> None:
        self._feet = [None if each is None else FootPathRecorder(each, statics) for each in chains]
        self._before = TransformBuffer()

    def add(self, own: TransformBuffer, end: int | None) -> None:
        """Take in what a batch tells of the frames, and its latest log time, ns."""
        around = self._before.then(own)
        for foot in self._feet:
            if foot is not None:
                foot.add(own, around)
                if end is not None:
                    foot.drop_before(end)
        self._before = around if end is None else around.tail(end - _DELAY_NS)

    def finish(self) -> tuple[FootPath | None, ...]:
        """End the log; None of feet that nothing tells of."""
        paths = (None if foot is None else foot.finish() for foot in self._feet)
        return tuple(path if path is not None and len(path.time) else None for path in paths)


def moving_parents(
    chains: Sequence[LegChain | None], parents: Mapping[str, str], statics: TransformBuffer
) -> dict[str, str]:
    """Return the parents of the frames of legs that transforms move."""
    frames = {frame for chain in chains if chain for frame in chain.frames}
    return {frame: parents[frame] for frame in sorted(frames - statics.frames.keys())}


def path_by_joints(chain: LegChain, tracks: Mapping[str, JointTrack | float]) -> FootPath | None:
    """Return the way of a foot by its joints.

    Args:
        chain: of the foot, with joints.
        tracks: by name of a joint; the position, rad or m, of one that never moves.

    Returns:
        None where a joint is missing, or none moves.
    """
    moving = [joint for joint in chain.joints if joint.kind != "fixed"]
    told = {joint.measured: tracks[joint.measured] for joint in moving if joint.measured in tracks}
    if len(told) < len({joint.measured for joint in moving}):
        return None
    times = [track.time for track in told.values() if isinstance(track, JointTrack)]
    if not times or not all(map(len, times)):
        return None
    time = max(times, key=len)
    time = time[(time >= max(t[0] for t in times)) & (time <= min(t[-1] for t in times))]
    positions = np.zeros((len(time), len(chain.joints)))
    known = np.ones(len(time), np.bool_)
    for column, joint in enumerate(chain.joints):
        track = told.get(joint.measured) if joint.kind != "fixed" else None
        if isinstance(track, JointTrack):
            positions[:, column] = np.interp(
                (time - time[:1]).astype(np.float64),
                (track.time - time[:1]).astype(np.float64),
                track.position.astype(np.float64),
            )
            after = np.searchsorted(track.time, time)
            known &= ~(silent_before(track.time)[after] & (track.time[after] > time))
        elif track is not None:
            positions[:, column] = track
    time, positions = time[known], positions[known]
    return FootPath(time, _placed(chain, positions).astype(np.float32))


def _placed(chain: LegChain, positions: Floats) -> Floats:
    """(n, 3) m, the point in the base's frame, joint by joint from the foot upwards."""
    poses = link_poses(chain.joints, positions)
    point = np.tile(np.array(chain.point), (len(positions), 1))
    for column in range(len(chain.joints)):
        point = poses.translation[:, column] + rotate(poses.rotation[:, column], point)
    return point


def chain_to(
    parents: Mapping[str, str],
    frame: str,
    base: str,
    point: tuple[float, float, float],
    *,
    touches: bool,
    joints: Mapping[str, Joint] | None = None,
) -> LegChain | None:
    """Return how a foot hangs on the base; None: nothing connects them.

    Args:
        parents: parent of each frame.
        frame: of the foot.
        base: the base's frame.
        point: m, of the foot in its frame.
        touches: whether that is where it touches the ground.
        joints: of a robot description by child; None: transforms tell.
    """
    frames = chain_of_frames(parents, frame, base)
    if not frames:
        return None
    held = () if joints is None else tuple(joints[each] for each in frames)
    return LegChain(frames, base.lstrip("/"), point, touches, held)
