"""Records of the figures of a robot's legs; `core/leg_evaluation.py` works them out."""

from collections.abc import Mapping
from dataclasses import replace

from dogbot_logtool.core.arrays import Aggregate
from dogbot_logtool.core.corrections.clock import ClockDifference
from dogbot_logtool.core.legs.joint_cycles import JointCurve, Work, no_work
from dogbot_logtool.core.legs.joint_track import JointHistory
from dogbot_logtool.core.legs.settings import JointPair, LegSettings
from dogbot_logtool.core.legs.swings import Footfalls, Steps, Swings
from dogbot_logtool.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class LegFoot:
    """The leg of a foot."""

    name: str
    frame: str
    """Frame of the foot; empty: not known."""
    reason: str
    """Why its swings are not known; empty where they are."""
    moves: bool
    """The reason is that the frame is not at rest in stances."""
    touches: bool
    """Whether the followed point is where the foot touches the ground."""
    travel_m: Aggregate | None
    """m, how far the point moves in the middle of a whole stance."""
    footfalls: Footfalls | None
    """None: not known."""
    swings: Swings
    """Swings of the foot's strides; also `steps`."""
    steps: Steps
    work: Work
    """Work of the leg's joints over the foot's strides."""


@dataclass(frozen=True, slots=True)
class LegJoint:
    """A joint of a leg, or another one that moves."""

    history: JointHistory
    foot: str
    """That it moves; empty: it is of no leg, or of one that is not known."""
    work: Work
    """Over the strides of that foot, or else of the reference foot."""
    curve: JointCurve | None
    """Over the strides of that foot; None: not known."""
    values_known: bool = True
    """Whether nothing contradicts the units of its states."""

    @property
    def range_of_motion(self) -> float:
        """Range of its position in the whole log, rad or m."""
        return self.history.highest - self.history.lowest


@dataclass(frozen=True, slots=True)
class SignDoubt:
    """Efforts that seem to have the wrong sign."""

    text: str
    """The contradiction in words."""
    key: str
    """Key of a figure that is not known because of it."""
    joints: frozenset[str]
    """Whose positive work is not known."""


@dataclass(frozen=True, slots=True)
class LegFigures:
    """The figures of the legs."""

    settings: LegSettings
    feet: tuple[LegFoot, ...]
    joints: tuple[LegJoint, ...]
    """By name: those of legs, and others that move."""
    work_unknown: str
    """Why no work is known; empty where it is."""
    work_refuted: bool
    """The reason is that the joint states' numbers contradict each other, or other sensors."""
    joints_slow: bool
    """The reason is that joint states come too rarely."""
    without_effort: tuple[str, ...]
    """Joints of no leg that move and tell no effort: their work is missing in that of all."""
    work: Work
    """Work of all joints over the strides of the reference foot."""
    cost_of_transport: float | None
    """Absolute work over m g d; None: not known."""
    clocks_apart: Mapping[str, ClockDifference]
    """Topics of joint states whose clock is too far from that of the feet."""
    sign_doubts: tuple[SignDoubt, ...] = ()

    def without_work(self, why: str) -> "LegFigures":
        """Return figures without those of work, since joint states' numbers are refuted."""
        count = len(self.work.absolute_j)
        return replace(
            self,
            work_unknown=why,
            work_refuted=True,
            work=no_work(count),
            cost_of_transport=None,
            feet=tuple(replace(leg, work=no_work(len(leg.work.absolute_j))) for leg in self.feet),
            joints=tuple(
                replace(each, work=no_work(len(each.work.absolute_j)), values_known=False)
                for each in self.joints
            ),
        )

    @property
    def moving(self) -> tuple[LegJoint, ...]:
        """Joints that move."""
        return tuple(joint for joint in self.joints if joint.history.moves)

    def joint(self, name: str) -> LegJoint | None:
        """Return a joint by its name."""
        return next((each for each in self.joints if each.history.name == name), None)

    @property
    def pairs(self) -> dict[str, tuple[JointPair, LegJoint, LegJoint]]:
        """Pairs of joints on the left and the right, by name."""
        found = {}
        for pair in self.settings.pairs:
            left, right = self.joint(pair.left), self.joint(pair.right)
            if left is not None and right is not None:
                found[pair.name] = (pair, left, right)
        return found
