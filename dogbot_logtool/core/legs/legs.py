"""What is known of the legs of a walk, and the work and motion of joints over strides."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, median_of, percentiles_of
from dogbot_logtool.core.base.foot_path import FootPath, silent_before, unbroken
from dogbot_logtool.core.corrections.clock import ClockDifference
from dogbot_logtool.core.frames.transforms import FrameTrack
from dogbot_logtool.core.gait.feet import CYCLE_POINTS, QUARTILES
from dogbot_logtool.core.gait.strides import Strides
from dogbot_logtool.core.legs.joints import JointTrack
from dogbot_logtool.core.metrics import Legs
from dogbot_logtool.core.records import Curve, Shape

if TYPE_CHECKING:
    from dogbot_logtool.core.legs.paths import LegSettings


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class LegFoot:
    """The leg of a foot."""

    name: str
    frame: str
    """Frame of the foot; empty: not known."""
    reason: str
    """Why its swings are not known; empty where they are."""
    path: FootPath | None
    """Of the foot in the base's frame; None: not known."""
    moves: bool = False
    """The reason is that the frame is not at rest in stances."""
    strides: Mapping[str, Floats] = field(default_factory=dict)
    """(strides,) what is known of each stride of the foot, by the name of its metric."""
    height: Shape = None
    """m above the line between the footfalls, over the stride."""
    is_slow: bool = False
    """Whether the foot is told too rarely for velocities."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class LegFigures:
    """What is known of all legs, whether or not the log gives reasons to doubt it."""

    settings: "LegSettings"
    feet: tuple[LegFoot, ...]
    joints: Mapping[str, JointTrack]
    """Each joint, by its name."""
    links: Mapping[str, FrameTrack]
    """The links that joints move, and those that rest on them."""
    work: Floats
    """(2, strides) J, positive and absolute work of all joints in strides of the reference foot."""
    metrics: Legs
    clocks_apart: Mapping[str, ClockDifference]
    """Topics of joint states whose clock is too far from that of the feet."""

    @property
    def moving(self) -> list[JointTrack]:
        """Joints that move."""
        return [joint for joint in self.joints.values() if joint.moves]

    def joints_of(self, foot: int) -> list[JointTrack]:
        """Return the joints that move a foot."""
        of = self.settings.foot_of_joint
        return [joint for name, joint in self.joints.items() if of.get(name) == foot]


def joint_work(joint: JointTrack, begin: Ints, end: Ints) -> Floats:
    """(2, m) J, positive and absolute work of a joint in some spans, (m,) ns each.

    A span with a silence of the joint's states, or with an effort that is not known, has none:
    NaN.
    """
    since = (joint.time - joint.time[0]).astype(np.float64)
    first, last = begin - joint.time[0], end - joint.time[0]
    totals = np.nancumsum(joint.work, axis=1, dtype=np.float64)
    done = [np.interp(last, since, each) - np.interp(first, since, each) for each in totals]
    known = unbroken(joint.time, ~np.isfinite(joint.work[0]), begin, end)
    work: Floats = np.where(known, done, np.nan)
    return work


def summed_work(joints: Sequence[JointTrack], begin: Ints, end: Ints) -> Floats:
    """(2, m) J, positive and absolute work of several joints; NaN of none."""
    if not joints:
        return np.full((2, len(begin)), np.nan)
    work: Floats = np.sum([joint_work(joint, begin, end) for joint in joints], axis=0)
    return work


def joint_curve(joint: JointTrack, strides: Strides) -> tuple[Curve, float] | None:
    """Return the usual motion of a joint over whole strides; None where none is known.

    Returns:
        Its position over the gait cycle, and the median range of motion in a stride, rad or m.
    """
    whole = unbroken(joint.time, silent_before(joint.time), strides.touchdown, strides.end)
    if not joint.moves or not whole.any():
        return None
    phase = np.linspace(0.0, 1.0, CYCLE_POINTS)
    start, period = strides.touchdown[whole], (strides.end - strides.touchdown)[whole]
    time = (start - joint.time[0])[:, None] + period[:, None] * phase
    since = (joint.time - joint.time[0]).astype(np.float64)
    position = np.interp(time, since, joint.position.astype(np.float64))
    parts = 100.0 * phase, *percentiles_of(position, QUARTILES, axis=0)
    usual_range = float(median_of(np.ptp(position, axis=1)))
    return Curve(*(tuple(each.tolist()) for each in parts)), usual_range
