"""Which of a log's messages tell of its legs: joints and frames."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.frames.kinematics import Joint
from dogbot_logtool.core.frames.transforms import TransformBuffer, moving_tracks
from dogbot_logtool.core.known_frames import KnownFrames
from dogbot_logtool.core.legs.paths import (
    JointPair,
    LegChain,
    LegSettings,
    chain_to,
)
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.reader.wanted import WantedJoints
from dogbot_logtool.robot.names import name_feet
from dogbot_logtool.robot.robot_model.description import link_of_foot
from dogbot_logtool.robot.robot_model.joint_motion import joint_channels, joint_names
from dogbot_logtool.robot.robot_model.robot_of_urdf import RobotOfUrdf, leg_of
from dogbot_logtool.robot.robot_model.urdf import said_of_left_out
from dogbot_logtool.robot.selection import Selection
from dogbot_logtool.robot.words import ENDS, LETTERS, SIDES, Part, words_of

_SOLE: Final = frozenset({"sole", "soles", "footsole"})


def wanted_joints(log: Log) -> tuple[WantedJoints, ...]:
    """Choose the channels of joint states, the best first; each joint is read of one of them."""
    wanted, seen = [], set[str]()
    for channel in joint_channels(log):
        wanted.append(WantedJoints(channel, frozenset(seen)))
        seen |= joint_names(log, channel)
    return tuple(wanted)


def find_legs(
    recording: Recording,
    selection: Selection,
    probe: KnownFrames,
    clock: TimeSource,
    robot: RobotOfUrdf | None,
) -> tuple[LegSettings, TransformBuffer] | None:
    """Decide what tells of the legs, and follow their frames that move; None: nothing does.

    Joint states with a robot description place the feet, else transforms do.
    """
    feet, told = selection.robot.feet, {name for each in recording.joints for name in each.names}
    joints = {joint.child: joint for joint in robot.joints} if robot and told else {}
    left_out = robot.left_out if robot else 0
    by_joints = _chains(selection, probe, {c: each.parent for c, each in joints.items()}, joints)
    moved = [_moved(chain) for chain in by_joints]
    lacking = [[name for name in names if name not in told] for names in moved]
    chains = [
        chain if names and not missing else None
        for chain, names, missing in zip(by_joints, moved, lacking, strict=True)
    ]
    parents = {c: next(iter(each)) for c, each in probe.parents.items() if len(each) == 1}
    if not any(chains):
        statics = probe.statics.frames
        chains = [
            chain if chain and any(frame not in statics for frame in chain.frames) else None
            for chain in _chains(selection, probe, parents)
        ]
    if not any(chains) and not recording.joints:
        return None
    frames = {frame for chain in chains if chain and not chain.joints for frame in chain.frames}
    moving = {frame: parents[frame] for frame in sorted(frames - probe.statics.frames.keys())}
    foot_of_joint = _feet_of_joints(feet, chains, told)
    # Joint states that name no joint of a leg leave none out.
    tells_of_legs = any(name in told for names in moved for name in names)
    settings = LegSettings(
        chains=tuple(chains),
        reasons=tuple(
            "" if chain else _why_not(selection, probe, foot, lacking[foot], left_out)
            for foot, chain in enumerate(chains)
        ),
        joint_topics=tuple(table.topic for table in recording.joints),
        foot_of_joint=foot_of_joint,
        pairs=_pairs(feet, foot_of_joint),
        limits=robot.limits if robot else {},
        untold=tuple(name for each in lacking for name in each) if tells_of_legs else (),
        statics=probe.statics,
    )
    return settings, moving_tracks(recording.transforms, moving, clock)


def _moved(chain: LegChain | None) -> list[str]:
    """Return the recorded joints that move a foot, each once."""
    joints = chain.joints if chain else ()
    return list(dict.fromkeys(joint.measured for joint in joints if joint.kind != "fixed"))


def _why_not(
    selection: Selection, probe: KnownFrames, foot: int, lacking: Sequence[str], left_out: int
) -> str:
    """Say why a foot has no chain."""
    if lacking:
        return f"joint states do not tell of {', '.join(lacking)}"
    link = selection.robot.feet[foot].frame or probe.links[foot]
    if link is None:
        return "no frame is known to be its own"
    base = probe.base
    reason = f"nothing connects its frame {link} with {base}"
    return f"{reason}; {said_of_left_out(left_out)}" if left_out else reason


def _chains(
    selection: Selection,
    probe: KnownFrames,
    parents: Mapping[str, str],
    joints: Mapping[str, Joint] | None = None,
) -> list[LegChain | None]:
    """Return how feet hang on the base by the parents of frames, perhaps those of joints.

    Each does by its own frame, or by one that is named so.
    """
    feet, base = selection.robot.feet, probe.base
    named = _named_frames(feet, parents)
    origin = (0.0, 0.0, 0.0)
    chains = []
    for number, foot in enumerate(feet):
        link, like = link_of_foot(selection, probe, number)
        sole = probe.soles.get(number) or probe.soles.get(like)
        if foot.frame is not None:
            places = [(foot.frame, foot.contact_point_m, any(foot.contact_point_m))]
        elif link is not None and sole is not None:
            places = [(link, sole, True)]
        else:
            places = [(frame, origin, False) for frame in (named.get(number), link) if frame]
        found = (
            chain_to(parents, frame, base, point, touches=touches, joints=joints)
            for frame, point, touches in places
        )
        chains.append(next((chain for chain in found if chain is not None), None))
    return chains


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
    named = {each.leg_position or each.name: each.topic for each in found.feet}
    keys = (foot.leg_position if foot.leg_position in named else foot.name for foot in feet)
    return {number: named[key] for number, key in enumerate(keys) if key in named}


def _feet_of_joints(
    feet: Sequence[Foot], chains: Sequence[LegChain | None], names: set[str]
) -> dict[str, int]:
    """Return the foot that each joint moves: by the chain of joints, else by names."""
    found: dict[str, int] = {}
    for number, chain in enumerate(chains):
        for name in _moved(chain):
            found.setdefault(name, number)
    legs = [foot.leg_position or leg_of(foot.name) for foot in feet]
    for name in sorted(names - found.keys()):
        leg = leg_of(name)
        matching = [number for number, each in enumerate(legs) if _is_of(leg, each)]
        if len(matching) == 1 and not any(w.part is Part.NOT_A_FOOT for w in words_of(name)):
            found[name] = matching[0]
    return found


def _is_of(leg: tuple[str, str], foot: tuple[str, str]) -> bool:
    """Tell whether a joint's leg is that of a foot; two feet have no ends."""
    ends = foot[0] if foot[0] in {"front", "back"} else ""
    return bool(foot[1]) and leg[1] == foot[1] and (leg[0] == foot[0] or not (ends or leg[0]))


def _pairs(feet: Sequence[Foot], foot_of: Mapping[str, int]) -> tuple[JointPair, ...]:
    """Return the joints of legs that are alike but for their side."""
    found: dict[str, dict[str, str]] = {}
    for joint, foot in sorted(foot_of.items()):
        end, side = feet[foot].leg_position or leg_of(feet[foot].name)
        words = [w.text for w in words_of(joint) if w.text not in {*LETTERS, *ENDS, *SIDES}]
        end = end if end in {"front", "back"} or len(feet) > 2 else ""
        found.setdefault("_".join(filter(None, (end, *words))), {})[side] = joint
    return tuple(
        JointPair(name, sides["left"], sides["right"])
        for name, sides in found.items()
        if sides.keys() >= {"left", "right"}
    )
