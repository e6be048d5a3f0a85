"""Which of a log's messages tell of its legs: joints and frames."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.frames.transforms import TransformBuffer
from dogbot_logtool.core.legs.foot_path import LegChain, chain_to, moving_parents
from dogbot_logtool.core.legs.joint_track import JointLimits
from dogbot_logtool.core.legs.settings import JointPair, LegSettings
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.reader.messages.frame_tracks import moving_tracks
from dogbot_logtool.reader.wanted import WantedJoints
from dogbot_logtool.robot.feet.names import name_feet
from dogbot_logtool.robot.feet.words import ENDS, LETTERS, SIDES, Part, words_of
from dogbot_logtool.robot.probe import Probe, frame_names
from dogbot_logtool.robot.robot_model.joint_motion import (
    joint_channels,
    joint_names,
    own_description,
)
from dogbot_logtool.robot.robot_model.soles import link_of_foot
from dogbot_logtool.robot.robot_model.urdf import (
    parse_urdf,
    said_of_left_out,
    urdf_joints,
    urdf_limits,
)
from dogbot_logtool.robot.topics.selection import Selection

_SOLE: Final = frozenset({"sole", "soles", "footsole"})


def wanted_joints(log: Log) -> tuple[WantedJoints, ...]:
    """Choose the channels of joint states, the best first; each joint is read of one of them."""
    wanted, seen = [], set[str]()
    for channel in joint_channels(log):
        wanted.append(WantedJoints(channel, frozenset(seen)))
        seen |= joint_names(log, channel)
    return tuple(wanted)


def find_legs(
    log: Log, recording: Recording, selection: Selection, probe: Probe, clock: TimeSource
) -> tuple[LegSettings, TransformBuffer] | None:
    """Decide what tells of the legs, and follow their frames that move; None: nothing does.

    Joint states with the log's own robot description place the feet, else its transforms.
    """
    seen = {name for table in recording.joints for name in table.names}
    legs = _Legs(selection, probe)
    chains, limits = legs.by_description(log, seen) if seen else ((), {})
    if not any(chains):
        chains = legs.by_transforms()
    if not any(chains) and not recording.joints:
        return None
    by_transforms = [None if chain is None or chain.joints else chain for chain in chains]
    foot_of_joint = _feet_of_joints(selection.robot.feet, chains, seen)
    settings = LegSettings(
        chains=chains,
        reasons=tuple("" if chain else legs.why_not(foot) for foot, chain in enumerate(chains)),
        joint_topics=tuple(table.topic for table in recording.joints),
        foot_of_joint=foot_of_joint,
        pairs=_pairs(selection.robot.feet, foot_of_joint),
        limits=limits,
        untold=legs.untold(seen),
        statics=probe.statics,
    )
    moving = moving_parents(by_transforms, legs.parents, probe.statics)
    return settings, moving_tracks(recording.transforms, moving, clock)


class _Legs:
    """Looks for the frames of feet."""

    def __init__(self, selection: Selection, probe: Probe) -> None:
        self._selection, self._probe = selection, probe
        self._base = frame_names(selection.robot, probe)[1]
        self.parents = {
            child: next(iter(names)) for child, names in probe.parents.items() if len(names) == 1
        }
        self._untold: dict[int, list[str]] = {}
        """Joints by foot that the robot description has and joint states do not name."""
        self._left_out = 0
        """Joints of the robot description that make no tree of links."""
        self._described: set[str] = set()
        """Joints of legs by the robot description."""

    def by_description(
        self, log: Log, told: set[str]
    ) -> tuple[tuple[LegChain | None, ...], Mapping[str, JointLimits]]:
        """Return how feet hang on the base by the log's robot description, and joints' limits.

        Args:
            log: the log.
            told: joints that joint states tell of.
        """
        try:
            root = parse_urdf(own_description(log) or "")
        except ValueError:
            return (), {}
        described, self._left_out = urdf_joints(root)
        joints = {joint.child: joint for joint in described}
        parents = {child: joint.parent for child, joint in joints.items()}
        found = []
        for foot, chain in enumerate(self._chains(parents)):
            held = [joints[frame] for frame in chain.frames] if chain else []
            moved = {joint.measured: None for joint in held if joint.kind != "fixed"}
            untold = [name for name in moved if name not in told]
            self._described |= moved.keys()
            if untold:
                self._untold[foot] = untold
            found.append(
                chain_to(
                    parents,
                    chain.frames[0],
                    self._base,
                    chain.point,
                    touches=chain.touches,
                    joints=joints,
                )
                if chain and moved and not untold
                else None
            )
        return tuple(found), urdf_limits(root)

    def by_transforms(self) -> tuple[LegChain | None, ...]:
        """Return how feet hang on the base by the log's transforms."""
        statics = self._probe.statics.frames
        return tuple(
            chain if chain and any(frame not in statics for frame in chain.frames) else None
            for chain in self._chains(self.parents)
        )

    def why_not(self, foot: int) -> str:
        """Say why a foot has no chain."""
        if foot in self._untold:
            return f"joint states do not tell of {', '.join(self._untold[foot])}"
        link = self._selection.robot.feet[foot].frame or self._probe.links[foot]
        if link is None:
            return "no frame is known to be its own"
        reason = f"nothing connects its frame {link} with {self._base}"
        return f"{reason}; {said_of_left_out(self._left_out)}" if self._left_out else reason

    def untold(self, told: set[str]) -> tuple[str, ...]:
        """Return joints of legs that joint states leave out, if they name others of the legs.

        Args:
            told: joints that joint states tell of.
        """
        missing = [name for names in self._untold.values() for name in names]
        return tuple(missing) if self._described & told else ()

    def _chains(self, parents: Mapping[str, str]) -> list[LegChain | None]:
        """Return how feet hang on the base by the parents of frames."""
        feet = self._selection.robot.feet
        named = _named_frames(feet, parents)
        return [self._chain(number, parents, named.get(number)) for number in range(len(feet))]

    def _chain(self, number: int, parents: Mapping[str, str], named: str | None) -> LegChain | None:
        """Return how a foot hangs on the base: by its own frame, or by one that is named so."""
        described = self._selection.robot.feet[number]
        if described.frame is not None:
            point, frame = described.contact_point_m, described.frame
            return chain_to(parents, frame, self._base, point, touches=any(point))
        link, like = link_of_foot(self._selection, self._probe, number)
        if link is not None:
            soles = self._probe.exact_soles
            sole = soles.get(number) or soles.get(like)
            if sole is not None:
                return chain_to(parents, link, self._base, sole, touches=True)
        origin = (0.0, 0.0, 0.0)
        found = (
            chain_to(parents, each, self._base, origin, touches=False)
            for each in (named, link)
            if each is not None
        )
        return next((chain for chain in found if chain is not None), None)


def _named_frames(feet: Sequence[Foot], frames: Iterable[str]) -> dict[int, str]:
    """Return the frame of each foot among frames that are named like the feet of all legs.

    A frame of the sole comes before others, which may as well be at the ankle or the knee.
    """
    names = list(frames)
    soles = [name for name in names if any(word.text in _SOLE for word in words_of(name))]
    found = name_feet(soles, contacts_only=False).chosen
    found = found or name_feet(names, contacts_only=False).chosen
    if found is None or found.part is not Part.FOOT:
        return {}
    named = {each.position or each.name: each.topic for each in found.feet}
    keys = (foot.leg_position if foot.leg_position in named else foot.name for foot in feet)
    return {number: named[key] for number, key in enumerate(keys) if key in named}


def _feet_of_joints(
    feet: Sequence[Foot], chains: Sequence[LegChain | None], names: set[str]
) -> dict[str, int]:
    """Return the foot that each joint moves: by the chain of joints, else by names."""
    found: dict[str, int] = {}
    for number, chain in enumerate(chains):
        for joint in chain.joints if chain else ():
            if joint.kind != "fixed":
                found.setdefault(joint.measured, number)
    legs = [foot.leg_position or _leg_of(foot.name) for foot in feet]
    for name in sorted(names - found.keys()):
        leg = _leg_of(name)
        matching = [number for number, each in enumerate(legs) if _is_of(leg, each)]
        if len(matching) == 1 and not any(w.part is Part.NOT_A_FOOT for w in words_of(name)):
            found[name] = matching[0]
    return found


def _leg_of(name: str) -> tuple[str, str]:
    """Return the end and the side of the robot that a name tells; empty where it does not."""
    end = side = ""
    for word in words_of(name):
        if word.text in LETTERS:
            return LETTERS[word.text]
        end, side = ENDS.get(word.text, end), SIDES.get(word.text, side)
    return end, side


def _is_of(leg: tuple[str, str], foot: tuple[str, str]) -> bool:
    """Tell whether a joint's leg is that of a foot; two feet have no ends."""
    ends = foot[0] if foot[0] in {"front", "back"} else ""
    return bool(foot[1]) and leg[1] == foot[1] and (leg[0] == foot[0] or not (ends or leg[0]))


def _pairs(feet: Sequence[Foot], foot_of: Mapping[str, int]) -> tuple[JointPair, ...]:
    """Return the joints of legs that are alike but for their side."""
    found: dict[str, dict[str, str]] = {}
    for joint, foot in sorted(foot_of.items()):
        end, side = feet[foot].leg_position or _leg_of(feet[foot].name)
        words = [w.text for w in words_of(joint) if w.text not in {*LETTERS, *ENDS, *SIDES}]
        end = end if end in {"front", "back"} or len(feet) > 2 else ""
        found.setdefault("_".join(filter(None, (end, *words))), {})[side] = joint
    return tuple(
        JointPair(name, sides["left"], sides["right"])
        for name, sides in found.items()
        if sides.keys() >= {"left", "right"}
    )
