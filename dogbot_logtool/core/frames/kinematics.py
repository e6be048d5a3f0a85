"""Forward kinematics: poses of links from positions of joints."""

from collections.abc import Sequence
from typing import Final, Literal

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints
from dogbot_logtool.core.rotations import multiply, rotate
from dogbot_logtool.dataclass import dataclass

Kind = Literal["revolute", "prismatic", "fixed"]
Triple = tuple[float, float, float]
_UPRIGHT: Final = (0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Joint:
    """One joint of a robot's model, as URDF defines it."""

    name: str
    parent: str
    """Name of a link; also `child`."""
    child: str
    kind: Kind
    translation: Triple = (0.0, 0.0, 0.0)
    """m, the joint's origin in the parent."""
    rotation: tuple[float, float, float, float] = _UPRIGHT
    """Unit quaternion x, y, z, w of the joint's frame in the parent, at position 0."""
    axis: Triple = (1.0, 0.0, 0.0)
    """Unit vector in the joint's frame, about or along which it moves."""
    source: str = ""
    """Name of the joint whose position it follows (``mimic``); empty: its own."""
    multiplier: float = 1.0
    """Factor of the source's position; then `offset`, rad or m, is added."""
    offset: float = 0.0

    @property
    def measured(self) -> str:
        """The joint whose recorded position moves it."""
        return self.source or self.name


@dataclass(frozen=True, slots=True)
class LinkPoses:
    """Poses of links in their parents at n times."""

    translation: Floats
    """(n, joints, 3) m."""
    rotation: Floats
    """(n, joints, 4) unit quaternion x, y, z, w."""


@dataclass(frozen=True, slots=True)
class LinkTransforms:
    """Poses of links at the times of some messages."""

    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns, when the poses hold."""
    poses: LinkPoses

    def pick(self, rows: Flags | slice) -> "LinkTransforms":
        """Return the chosen rows."""
        poses = LinkPoses(self.poses.translation[rows], self.poses.rotation[rows])
        return LinkTransforms(self.log_time[rows], self.stamp[rows], poses)

    def from_opening(self, opening: int) -> "LinkTransforms":
        """Return these, of which the first also stands at the log's first time, ns."""
        if not len(self.log_time) or self.log_time[0] <= opening:
            return self
        first = LinkPoses(
            np.concatenate([self.poses.translation[:1], self.poses.translation]),
            np.concatenate([self.poses.rotation[:1], self.poses.rotation]),
        )
        return LinkTransforms(
            np.concatenate([[opening], self.log_time]),
            np.concatenate([[min(opening, int(self.stamp[0]))], self.stamp]),
            first,
        )


def link_poses(joints: Sequence[Joint], positions: Floats) -> LinkPoses:
    """Return the pose of each joint's child in its parent.

    Args:
        joints: of a robot.
        positions: (n, joints) rad or m, of the joints that are `measured`; not used of fixed ones.
    """
    count = len(positions)
    translation = np.empty((count, len(joints), 3))
    rotation = np.empty((count, len(joints), 4))
    for column, joint in enumerate(joints):
        origin = np.array([joint.rotation])
        moved = joint.multiplier * positions[:, column] + joint.offset
        if joint.kind == "fixed":
            moved = np.zeros(count)
        along = np.outer(moved, joint.axis) if joint.kind == "prismatic" else np.zeros((count, 3))
        angle = moved if joint.kind == "revolute" else np.zeros(count)
        half = np.outer(np.sin(angle / 2.0), joint.axis)
        turn = np.column_stack([half, np.cos(angle / 2.0)])
        translation[:, column] = np.array(joint.translation) + rotate(origin, along)
        rotation[:, column] = multiply(np.repeat(origin, count, axis=0), turn)
    return LinkPoses(translation, rotation)
