"""Settings of the figures of the legs."""

from collections.abc import Mapping
from dataclasses import field

from dogbot_logtool.core.frames.transforms import TransformBuffer
from dogbot_logtool.core.legs.foot_path import LegChain
from dogbot_logtool.core.legs.joint_track import JointLimits
from dogbot_logtool.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class JointPair:
    """Two joints that are alike, one on each side of the robot."""

    name: str
    left: str
    """The joint's name; also `right`."""
    right: str


@dataclass(frozen=True, slots=True)
class LegSettings:
    """Sources of a log's legs, decided before its first message is read."""

    chains: tuple[LegChain | None, ...]
    """How each foot hangs on the base; None: not known."""
    reasons: tuple[str, ...]
    """Why a foot has no chain; empty where it has one."""
    joint_topics: tuple[str, ...] = ()
    """Topics of joint states; the best first, whose states of a joint count."""
    foot_of_joint: Mapping[str, int] = field(default_factory=dict)
    """Index of the foot that a joint moves, by the joint's name."""
    pairs: tuple[JointPair, ...] = ()
    limits: Mapping[str, JointLimits] = field(default_factory=dict)
    """Limits by the robot description, by the joint's name."""
    untold: tuple[str, ...] = ()
    """Joints of legs that the robot description has and joint states leave out."""
    statics: TransformBuffer = field(default_factory=TransformBuffer)
    """Transforms that hold for ever."""

    @property
    def by_joints(self) -> bool:
        """Whether joint states and a robot description place the feet, not transforms."""
        return any(chain is not None and chain.joints for chain in self.chains)
