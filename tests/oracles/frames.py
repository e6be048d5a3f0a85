"""Where links are, the slow way: one time, one frame, and rotation matrices."""

from bisect import bisect_left
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]
LONGEST_STEP_NS = 100_000_000


def numbers_of(place: Any, turn: Any) -> tuple[float, ...]:
    """x, y, z and the quaternion's x, y, z, w of a pose in any message."""
    numbers = place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w
    return tuple(map(float, numbers))


def matrix_of(quaternion: Any) -> Matrix:
    """Rotation matrix of a message's quaternion of any norm."""
    return turn_of([quaternion.x, quaternion.y, quaternion.z, quaternion.w])


def turn_of(quaternion: Sequence[float]) -> Matrix:
    """Rotation matrix of a quaternion x, y, z, w of any norm."""
    x, y, z, w = quaternion
    s = 2.0 / (x * x + y * y + z * z + w * w)
    return np.array(
        [
            [1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)],
            [s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)],
            [s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)],
        ]
    )


def part_of(turn: Matrix, share: float) -> Matrix:
    """A share of a rotation: the same axis, by Rodrigues' formula."""
    axis = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    sine = np.linalg.norm(axis) / 2
    if sine < 1e-15:
        return np.eye(3)
    angle = share * np.arctan2(sine, (np.trace(turn) - 1) / 2)
    x, y, z = axis / (2 * sine)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    whole: Matrix = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return whole


@dataclass
class Frames:
    """Poses of frames in their parents, message by message."""

    parents: dict[str, str] = field(default_factory=dict)
    times: dict[str, list[int]] = field(default_factory=lambda: defaultdict(list))
    poses: dict[str, list[tuple[Matrix, Matrix]]] = field(default_factory=lambda: defaultdict(list))

    def add(self, parent: str, child: str, time: int, numbers: Sequence[float]) -> None:
        child = child.lstrip("/")
        if not np.isfinite(numbers).all() or not any(numbers[3:]):
            return
        if self.times[child] and time <= self.times[child][-1]:
            return
        self.parents[child] = parent.lstrip("/")
        self.times[child].append(time)
        self.poses[child].append((np.array(numbers[:3]), turn_of(numbers[3:])))

    def in_parent(self, child: str, time: int) -> tuple[Matrix, Matrix] | None:
        times, poses = self.times[child], self.poses[child]
        after = bisect_left(times, time)
        if after == len(times) or (after == 0 and times[0] != time):
            return None
        if times[after] == time:
            return poses[after]
        step = times[after] - times[after - 1]
        if step > LONGEST_STEP_NS:
            return None
        share = (time - times[after - 1]) / step
        (place, turn), (next_place, next_turn) = poses[after - 1], poses[after]
        return place + share * (next_place - place), turn @ part_of(turn.T @ next_turn, share)

    def in_world(self, frame: str, time: int, world: str) -> tuple[Matrix, Matrix] | None:
        place, turn = np.zeros(3), np.eye(3)
        while frame != world:
            pose = self.in_parent(frame, time) if frame in self.parents else None
            if pose is None:
                return None
            place, turn = pose[0] + pose[1] @ place, pose[1] @ turn
            frame = self.parents[frame]
        return place, turn


def stamp_ns(header: Any) -> int:
    return int(header.stamp.sec) * 1_000_000_000 + int(header.stamp.nanosec)


def frames_of(odometry: Iterable[Any], transforms: Iterable[Any], *, log_time: bool) -> Frames:
    """Build frames from decoded messages, each with `log_time` and `message`.

    The base is where odometry says, whatever the transforms say.
    """
    frames = Frames()
    base = ""
    for one in odometry:
        header, pose = one.message.header, one.message.pose.pose
        base = one.message.child_frame_id.lstrip("/") or "base_link"
        time = one.log_time if log_time else stamp_ns(header)
        frames.add(header.frame_id, base, time, numbers_of(pose.position, pose.orientation))
    for one in transforms:
        for each in one.message.transforms:
            if each.child_frame_id.lstrip("/") != base:
                time = one.log_time if log_time else stamp_ns(each.header)
                numbers = numbers_of(each.transform.translation, each.transform.rotation)
                frames.add(each.header.frame_id, each.child_frame_id, time, numbers)
    return frames
