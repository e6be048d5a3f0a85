"""Which of a log's messages tell of its legs, joints and frames, and where feet are."""

from collections.abc import Iterable, Mapping, Sequence

from dogbot_logtool.core.frames.kinematics import Joint
from dogbot_logtool.core.frames.transforms import chain_of_frames
from dogbot_logtool.core.frames.wrench_frame import FramePoint
from dogbot_logtool.core.known_frames import KnownFrames
from dogbot_logtool.core.legs.joints import LegChain, LegSettings
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.settings import WalkSettings
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.robot.names import leg_of, name_feet
from dogbot_logtool.robot.selection import Selection
from dogbot_logtool.robot.urdf import RobotOfUrdf
from dogbot_logtool.robot.words import (
    ENDS,
    LETTERS,
    SIDES,
    SOLES,
    Part,
    parts_of,
    texts_of,
    words_of,
)


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
    parents = {child: joint.parent for child, joint in joints.items()}
    chains = leg_chains(selection, probe, parents, probe.base)
    moved = [_moved(chain, joints) for chain in chains]
    lacking = [[name for name in names if name not in measured] for names in moved]
    known = [bool(names) and not missing for names, missing in zip(moved, lacking, strict=True)]
    chains = [chain if kept else None for chain, kept in zip(chains, known, strict=True)]
    by_joints = any(chains)
    if not by_joints:
        chains = leg_chains(selection, probe, probe.parent_of, probe.base)
    if not any(chains) and not recording.joints:
        return None
    by_frames = not by_joints and any(chains)
    foot_of_joint = _feet_of_joints(feet, [] if by_frames else moved, measured)
    # Joint states that name no joint of a leg leave none out.
    has_legs = any(map(measured.intersection, moved))
    return LegSettings(
        chains=tuple(chains),
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
        if leg[1] and legs.count(leg) == 1 and Part.NOT_A_FOOT not in parts_of([name]):
            found[name] = legs.index(leg)
    return found


def _pairs(feet: Sequence[Foot], foot_of: Mapping[str, int]) -> dict[str, tuple[str, str]]:
    """Return the joints of legs that are alike but for their side."""
    found: dict[str, dict[str, str]] = {}
    for joint, foot in sorted(foot_of.items()):
        end, side = feet[foot].leg_position or leg_of(feet[foot].name)
        words = [w.text for w in words_of(joint) if w.text not in {*ENDS, *SIDES, *LETTERS}]
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
    """Return the position of each foot without contact points; None: it has some, or no force."""
    points = frames.in_base(settings)
    chains = leg_chains(selection, frames, frames.parent_of, frames.world)
    for foot, chain in enumerate(chains):
        has_points = any(source.has_points for source in selection.sources_of(foot))
        if chain and not (points[foot] or has_points) and settings.feet[foot].has_force:
            points[foot] = FramePoint(chain.frames[0], chain.point)
    return points


# --- the frames of feet ---


def leg_chains(
    selection: Selection, probe: KnownFrames, parents: Mapping[str, str], top: str
) -> list[LegChain | None]:
    """Return how feet hang on a frame by the parents of frames.

    A foot does by the frame of the robot's file, else by the link of its contacts if its sole is
    known there, else by a frame that is named so, else by that link.
    """
    chains = list[LegChain | None]()
    names = [foot.name for foot in selection.robot.feet]
    named = named_frames(selection.robot.feet, parents)
    for number, foot in enumerate(selection.robot.feet):
        like, link = _link_of(names, probe, number)
        point, places = foot.contact_point_m, [foot.frame or link]
        if foot.frame is None:
            point = probe.soles.get(like, point)
            places[:0] = [] if any(point) else [named.get(number)]
        found = (chain_of_frames(parents, each, top) for each in places if each)
        frames = next(filter(None, found), None)
        chains.append(LegChain(frames, top.lstrip("/"), point) if frames else None)
    return chains


def _link_of(names: Sequence[str], probe: KnownFrames, number: int) -> tuple[int, str | None]:
    """Return the link of a foot's contacts, and the foot, itself or another, that is made like it.

    A foot that reports no contact is on a link that is named as another foot's.
    """
    for like, link in enumerate(probe.links):
        if probe.links[number] is None and link and names[like] in link:
            named = link.lstrip("/").replace(names[like], names[number])
            if named in probe.parents:
                return like, named
    return number, probe.links[number]


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
