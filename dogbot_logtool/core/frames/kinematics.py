"""Forward kinematics: poses of links from positions of joints."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal, NamedTuple, TypeVar

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, concatenated, picked
from dogbot_logtool.core.rotations import multiply, rotate

Kind = Literal["revolute", "continuous", "prismatic", "fixed"]
Triple = tuple[float, float, float]
_UPRIGHT: Final = (0.0, 0.0, 0.0, 1.0)
LARGEST_LAG_NS: Final = 100_000_000
"""ns: stamps further behind log time are of another clock."""


class Joint(NamedTuple):
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


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class TransformMessages:
    """Poses of k frames in their parents, as n messages to write."""

    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns, when the poses hold."""
    translation: Floats
    """(n, k, 3) m."""
    rotation: Floats
    """(n, k, 4) quaternion x, y, z, w."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class LinkTransforms(TransformMessages):
    """Those of links that joints move."""


AnyTransforms = TypeVar("AnyTransforms", bound=TransformMessages)


def from_opening(transforms: AnyTransforms, opening: int) -> AnyTransforms:
    """Return transforms of which the first also stands at the log's first time.

    Its stamp is that time, too, unless the clock of the stamps is another one: a stamp from the
    future of the others would hold for ever.

    Args:
        transforms: the first of a log.
        opening: ns, log time.
    """
    first = picked(transforms, slice(0, 1))
    if (first.log_time <= opening).all() and (first.stamp <= opening).all():
        return transforms
    stamp = np.where(first.stamp > opening - LARGEST_LAG_NS, opening, first.stamp)
    opened = replace(first, log_time=np.array([opening]), stamp=stamp)
    return concatenated([opened, transforms])


def link_poses(joints: Sequence[Joint], positions: Floats) -> tuple[Floats, Floats]:
    """Return the pose of each joint's child in its parent.

    Args:
        joints: of a robot.
        positions: (n, joints) rad or m, of the joints that are `measured`; not used of fixed ones.

    Returns:
        (n, joints, 3) m, and (n, joints, 4) unit quaternions x, y, z, w.
    """
    count = len(positions)
    translation = np.empty((count, len(joints), 3))
    rotation = np.empty((count, len(joints), 4))
    for column, joint in enumerate(joints):
        origin = np.array([joint.rotation])
        translation[:, column], rotation[:, column] = joint.translation, joint.rotation
        moved = joint.multiplier * positions[:, column] + joint.offset
        if joint.kind == "prismatic":
            translation[:, column] += rotate(origin, np.outer(moved, joint.axis))
        elif joint.kind != "fixed":
            half = np.outer(np.sin(moved / 2.0), joint.axis)
            turn = np.column_stack([half, np.cos(moved / 2.0)])
            rotation[:, column] = multiply(origin, turn)
    return translation, rotation


class Mass(NamedTuple):
    """A mass that a joint of a leg carries."""

    joint: int
    """Index of the joint in the leg; the mass is fixed to its child."""
    mass_kg: float
    centre: Triple
    """m, in the child's frame."""


class Leg(NamedTuple):
    """A chain of joints from the base to a foot."""

    joints: tuple[Joint, ...]
    """From the base outwards."""
    masses: tuple[Mass, ...] = ()
    """Empty: not known."""
    point: Triple = (0.0, 0.0, 0.0)
    """m, of the foot, in the frame of the last link."""
    radius_m: float = 0.0
    """Of the ball there that is the foot; 0: not known, or none."""
    name: str = ""
    """``front_left`` ..., or a number."""
    position: tuple[str, str] | None = None
    """("front" | "middle" | "back", "left" | "right" | "centre")."""

    @property
    def foot(self) -> str:
        """Name of its last link."""
        return self.joints[-1].child

    @property
    def measured(self) -> tuple[str, ...]:
        """The recorded joints that move it, each once."""
        names = (joint.measured for joint in self.joints if joint.kind != "fixed")
        return tuple(dict.fromkeys(names))


class LegMotion(NamedTuple):
    """Where the parts of a leg are at n times, in the base's frame."""

    leg: Leg
    foot: Floats
    """(n, 3) m."""
    origins: Floats
    """(n, joints, 3) m, of each joint's child."""
    axes: Floats
    """(n, joints, 3) unit vectors about or along which they move."""
    centres: Floats
    """(n, masses, 3) m, of the masses."""

    def jacobian(self, point: Floats, joints: int | None = None) -> tuple[Floats, Floats]:
        """Return how recorded joints move and turn a point of the leg.

        Args:
            point: (n, 3) m, in the base's frame.
            joints: how many joints, counted from the base, lie before the point; None: all.

        Returns:
            (n, 3, k) m/s and rad/s for each rad/s, or m/s, of the k joints in `Leg.measured`.
        """
        names = self.leg.measured
        moved = np.zeros((len(point), 3, len(names)))
        turned = np.zeros((len(point), 3, len(names)))
        for row, joint in enumerate(self.leg.joints[:joints]):
            if joint.kind == "fixed":
                continue
            column, axis = names.index(joint.measured), joint.multiplier * self.axes[:, row]
            if joint.kind == "prismatic":
                moved[:, :, column] += axis
            else:
                moved[:, :, column] += np.cross(axis, point - self.origins[:, row])
                turned[:, :, column] += axis
        return moved, turned


def leg_motion(leg: Leg, positions: Floats) -> LegMotion:
    """Return where the parts of a leg are.

    Args:
        leg: the leg.
        positions: (n, k) rad or m, of the joints in `Leg.measured`.
    """
    count, names = len(positions), leg.measured
    columns = [names.index(j.measured) if j.kind != "fixed" else 0 for j in leg.joints]
    shifts, turns = link_poses(leg.joints, positions[:, columns])
    place, turn = np.zeros((count, 3)), np.tile(_UPRIGHT, (count, 1))
    origins, axes = np.empty((2, count, len(leg.joints), 3))
    centres = np.empty((count, len(leg.masses), 3))
    for row, joint in enumerate(leg.joints):
        place = place + rotate(turn, shifts[:, row])
        turn = multiply(turn, turns[:, row])
        origins[:, row], axes[:, row] = place, rotate(turn, np.array([joint.axis]))
        for number, mass in enumerate(leg.masses):
            if mass.joint == row:
                centres[:, number] = place + rotate(turn, np.array([mass.centre]))
    foot = place + rotate(turn, np.array([leg.point]))
    return LegMotion(leg, foot, origins, axes, centres)
