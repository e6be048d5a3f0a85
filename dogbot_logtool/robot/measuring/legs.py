"""Which of a log's messages tell of its legs, joints and frames, and where feet are."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from dogbot_logtool.core.frames.kinematics import Joint
from dogbot_logtool.core.frames.transforms import chain_of_frames
from dogbot_logtool.core.frames.wrench_frame import FramePoint
from dogbot_logtool.core.known_frames import KnownFrames, Point
from dogbot_logtool.core.legs.joints import LegChain, LegSettings
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.settings import WalkSettings
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.robot.names import leg_of, name_feet
from dogbot_logtool.robot.selection import Selection
from dogbot_logtool.robot.urdf import RobotOfUrdf
from dogbot_logtool.robot.words import ENDS, SOLES, Part, parts_of, texts_of, words_of

_ORIGIN: Final = (0.0, 0.0, 0.0)


def find_legs(
    recording: Recording,
    selection: Selection,
    probe: KnownFrames,
    robot: RobotOfUrdf | None,
) -> LegSettings | None:
    """Decide what tells of the legs; None: nothing does.

    Joint states with a robot description place the feet, else transforms do.
    """
    feet = selection.robot.feet
    measured = {name for each in recording.joints for name in each.names}
    joints = {joint.child: joint for joint in robot.joints} if robot and measured else {}
    chains = leg_chains(selection, probe, {child: joint.parent for child, joint in joints.items()})
    moved = [_moved(chain, joints) for chain in chains]
    lacking = [[name for name in names if name not in measured] for names in moved]
    known = [bool(names) and not missing for names, missing in zip(moved, lacking, strict=True)]
    chains = [chain if kept else None for chain, kept in zip(chains, known, strict=True)]
    by_joints = any(chains)
    if not by_joints:
        chains = leg_chains(selection, probe, probe.parent_of)
    if not any(chains) and not recording.joints:
        return None
    by_frames = not by_joints and any(chains)
    foot_of_joint = _feet_of_joints(feet, [] if by_frames else moved, measured)
    # Joint states that name no joint of a leg leave none out.
    has_legs = any(name in measured for names in moved for name in names)
    return LegSettings(
        chains=tuple(chains),
        reasons=tuple(
            "" if chain else _why_not(selection, probe, foot, lacking[foot])
            for foot, chain in enumerate(chains)
        ),
        joints=() if by_frames else tuple(joints.values()),
        foot_of_joint=foot_of_joint,
        pairs=_pairs(feet, foot_of_joint),
        limits=robot.limits if robot else {},
        lacking=tuple(name for each in lacking for name in each) if has_legs else (),
    )


def _moved(chain: LegChain | None, joints: Mapping[str, Joint]) -> list[str]:
    """Return the recorded joints that move a foot, each once."""
    held = [joints[frame] for frame in (chain.frames if chain else ())]
    return list(dict.fromkeys(joint.measured for joint in held if joint.kind != "fixed"))


def _why_not(selection: Selection, probe: KnownFrames, foot: int, lacking: Sequence[str]) -> str:
    """Say why a foot has no chain."""
    if lacking:
        return f"joint states do not tell of {', '.join(lacking)}"
    link = selection.robot.feet[foot].frame or probe.links[foot]
    if link is None:
        return "no frame is known to be its own"
    return f"nothing connects its frame {link} with {probe.base}"


def _feet_of_joints(
    feet: Sequence[Foot], moved: Sequence[Sequence[str]], names: set[str]
) -> dict[str, int]:
    """Return the foot that each joint moves: by the chain of joints, else by names."""
    # A joint of several legs counts as one of the first.
    of_foot = reversed([*enumerate(moved)])
    found = {name: number for number, each in of_foot for name in each if name in names}
    legs = [foot.leg_position or leg_of(foot.name) for foot in feet]
    for name in sorted(names - found.keys()):
        leg = leg_of(name)
        matching = [number for number, each in enumerate(legs) if _is_of(leg, each)]
        if len(matching) == 1 and Part.NOT_A_FOOT not in parts_of([name]):
            found[name] = matching[0]
    return found


def _is_of(leg: tuple[str, str], foot: tuple[str, str]) -> bool:
    """Tell whether a joint's leg is that of a foot; two feet have no ends."""
    ends = foot[0] if foot[0] in {"front", "back"} else ""
    return bool(foot[1]) and leg[1] == foot[1] and (leg[0] == foot[0] or not (ends or leg[0]))


def _pairs(feet: Sequence[Foot], foot_of: Mapping[str, int]) -> dict[str, tuple[str, str]]:
    """Return the joints of legs that are alike but for their side."""
    found: dict[str, dict[str, str]] = {}
    for joint, foot in sorted(foot_of.items()):
        end, side = feet[foot].leg_position or leg_of(feet[foot].name)
        words = [w.text for w in words_of(joint) if not (w.is_position or w.text in ENDS)]
        end = end if end in {"front", "back"} or len(feet) > 2 else ""
        found.setdefault("_".join(filter(None, (end, *words))), {})[side] = joint
    return {
        name: (sides["left"], sides["right"])
        for name, sides in found.items()
        if sides.keys() >= {"left", "right"}
    }


def sensor_points(
    selection: Selection, frames: KnownFrames, settings: WalkSettings
) -> list[FramePoint | None]:
    """Return the position of each foot without contact points; None: it has some, or no force.

    It is at the frame of the robot's file or of its messages; where the log's transforms do not
    place that, at the frame that is named like the leg's foot.
    """
    parents = frames.parent_of
    named = named_frames(selection.robot.feet, parents)
    points = frames.in_base(settings)
    for foot, described in enumerate(selection.robot.feet):
        has_points = any(source.has_points for source in selection.sources_of(foot))
        if points[foot] or has_points or not settings.feet[foot].has_force:
            continue
        frame = described.frame or frames.links[foot]
        is_placed = frame and chain_of_frames(parents, frame, frames.world) is not None
        if described.frame is None and described.leg_position is not None and not is_placed:
            frame = named.get(foot, frame)
        points[foot] = FramePoint(frame, described.contact_point_m) if frame else None
    return points


# --- the frames of feet ---


def leg_chains(
    selection: Selection, probe: KnownFrames, parents: Mapping[str, str]
) -> list[LegChain | None]:
    """Return how feet hang on the base by the parents of frames.

    Each does by its own frame, or by one that is named so.
    """
    feet, chains = selection.robot.feet, list[LegChain | None]()
    named = named_frames(feet, parents)
    for number, foot in enumerate(feet):
        frame, point = _place_of_foot(selection, probe, number) or (None, None)
        if frame and point:
            places = [(frame, point, foot.frame is None or any(point))]
        else:
            places = [(each, _ORIGIN, False) for each in (named.get(number), frame) if each]
        found = (
            LegChain(frames, probe.base.lstrip("/"), point, touches)
            for frame, point, touches in places
            if (frames := chain_of_frames(parents, frame, probe.base))
        )
        chains.append(next(found, None))
    return chains


def named_frames(feet: Sequence[Foot], frames: Iterable[str]) -> dict[int, str]:
    """Return the frame of each foot among frames that are named like the feet of all legs.

    A frame of the sole comes before others, which may as well be at the ankle or the knee.
    """
    names = list(frames)
    soles = [name for name in names if texts_of(name) & SOLES]
    found, _ = name_feet(soles, contacts_only=False)
    found = found or name_feet(names, contacts_only=False)[0]
    if found is None or found.part is not Part.FOOT:
        return {}
    named = {each.leg_position or each.name: each.topic for each in found.feet}
    keys = (foot.leg_position if foot.leg_position in named else foot.name for foot in feet)
    return {number: named[key] for number, key in enumerate(keys) if key in named}


def _place_of_foot(
    selection: Selection, probe: KnownFrames, number: int
) -> tuple[str, Point | None] | None:
    """Return the frame of a foot and where it touches, m in that frame; None: not known.

    By the robot's file, else by the link of its contacts. A foot that reports no contact is on a
    link that is named as another foot's, but for the foot's name, and is made like that one.
    """
    foot = selection.robot.feet[number]
    names = [each.name for each in selection.robot.feet]
    if foot.frame is not None:
        return foot.frame.lstrip("/"), foot.contact_point_m
    for like, link in sorted(enumerate(probe.links), key=lambda each: each[0] != number):
        if link is not None and (like == number or names[like] in link):
            named = link.lstrip("/").replace(names[like], foot.name)
            if like == number or named in probe.parents:
                return named, probe.soles.get(number, probe.soles.get(like))
    return None
