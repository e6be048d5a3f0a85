"""A robot's description: the log's own, the user's, or one of primitives; its limbs over time.

The URDF of primitives is a robot of boxes, cylinders and spheres to look at where the log has no
model. Its links are the log's own frames, so that the log's transforms move it; the origins of its
joints are their first recorded poses, so that it stands before the first transform. Joints are
floating: how they move is not known.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import acos, atan2, hypot
from pathlib import Path
from typing import Final, NamedTuple
from xml.etree import ElementTree as ET

import numpy as np

from dogbot_logtool.core.arrays import Float32s, Floats, Ints, all_finite, header_time, median_of
from dogbot_logtool.core.frames.kinematics import Joint, LinkTransforms, link_poses
from dogbot_logtool.core.frames.transforms import FrameTrack, chain_of_frames, lookup
from dogbot_logtool.core.known_frames import KnownFrames, Point
from dogbot_logtool.core.recording import JointTable
from dogbot_logtool.core.rotations import roll_pitch_yaw, rotate
from dogbot_logtool.core.scene.feet import colour_parts, foot_colour
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.errors import CallError, DefinitionError
from dogbot_logtool.finding import Finding, found
from dogbot_logtool.io.printable import shell_joined
from dogbot_logtool.io.toml_table import read_text
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.decode.paths import path_of
from dogbot_logtool.reader.messages.messages import definition_of
from dogbot_logtool.robot.measuring.legs import leg_chains
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.selection import Selection
from dogbot_logtool.robot.topics import first_messages
from dogbot_logtool.robot.urdf import RobotOfUrdf, parse_urdf, read_robot

_LARGEST: Final = 16 << 20
"""Bytes of a URDF that are read."""


def read_urdf(file: Path) -> str:
    """Read and check a URDF.

    Raises:
        CallError: it cannot be read, is too large, is no XML with a root `robot`, or declares
            entities, which viewers might fetch.
    """
    try:
        text = read_text(file, "a URDF", _LARGEST)
        parse_urdf(text)
    except CallError as error:
        raise CallError(f"--urdf {error}") from None
    except ValueError as error:
        raise CallError(f"--urdf {file}: {error}") from None
    return text


def description_channels(log: Log) -> Sequence[Channel]:
    """Return the channels that describe a robot."""
    return [
        channel
        for channel in log.channels.values()
        if channel.topic.rpartition("/")[2] == "robot_description"
        and channel.type_name == "std_msgs/String"
        and log.counts.get(channel.id, 1)
    ]


def own_description(log: Log) -> str | None:
    """Return the log's first robot description; None: it has none that can be read."""
    for channel in description_channels(log):
        try:
            urdf = path_of("data", "text", definition_of(channel))
        except DefinitionError:
            continue
        for messages in first_messages(log, channel, urdf.columns):
            if len(messages.channel):
                return urdf.texts(messages.table)[1].text(0)
    return None


class Model(NamedTuple):
    """The robot's description, the log's own or the user's."""

    robot: RobotOfUrdf | None
    why_none: str = ""
    """Why there is none that can be used."""
    call: str = ""
    """A call that would give one."""


def read_model(log: Log, urdf: Path | None) -> Model:
    """Read the user's description, or else the log's.

    Raises:
        CallError: the user's file is no URDF.
    """
    text = own_description(log) if urdf is None else read_urdf(urdf)
    if text is None:
        call = shell_joined(["dogbot-logtool", "stats", *log.words, "--urdf", "ROBOT.urdf"])
        return Model(None, "the log has no robot description, which says how the legs go", call)
    try:
        return Model(read_robot(text))
    except ValueError as error:
        return Model(None, f"the robot description {error}")


class RobotDescription(NamedTuple):
    """The content of `/robot_description`."""

    urdf: str | None
    """None: nothing."""
    findings: tuple[Finding, ...] = ()
    hips: Floats | None = None
    """(feet, 3) m, base frame: where lines to standing feet begin, NaN where not known; None: the
    legs move by transforms, or no foot has a leg position."""
    joints: tuple[Joint, ...] = ()
    """Those by which joint states move its links, where no transforms do."""
    height_m: float = 1.0
    """Height of the base above the feet."""


def robot_description(
    log: Log, selection: Selection, model: RobotOfUrdf | None, walk: Walk, options: ConvertOptions
) -> RobotDescription:
    """Choose the robot description.

    Args:
        log: its own description stays as it is.
        selection: the robot's feet.
        model: the robot's description, where joint states move it.
        walk: what was measured.
        options: with the user's file, and whether the log's messages are in the output.

    Raises:
        CallError: the user's file is no URDF.
    """
    urdf = None if options.urdf is None else read_urdf(options.urdf)
    frames = walk.frames
    shape, bones = robot_shape(walk), skeleton(selection, frames, {})
    joints = _moved_joints(model, walk) if model and options.tf != "never" else ()
    hips = None
    if shape.hips and not (bones.legs or joints):
        feet, nowhere = range(len(selection.robot.feet)), (np.nan,) * 3
        hips = np.array([shape.hips.get(foot, nowhere) for foot in feet])
    own = sorted({channel.topic for channel in description_channels(log)}) if options.copy else []
    told = [found("ROBOT_DESCRIPTION", say="own", topics=", ".join(own))] if own else []
    if model and joints:
        moving, topic = sum(each.kind != "fixed" for each in joints), walk.recording.joints[0].topic
        told.append(found("ROBOT_DESCRIPTION", say="moved", topic=topic, joints=f"{moving}"))
        if frames.base not in {link for joint in joints for link in (joint.parent, joint.child)}:
            told.append(found("ROBOT_DESCRIPTION", say="no_base", base=frames.base))
    if not own and urdf is None:
        robot = replace(selection.robot, forward_axis=walk.settings.forward_axis)
        urdf = primitive_urdf(robot, bones, shape)
    return RobotDescription(None if own else urdf, tuple(told), hips, joints, shape.height_m)


def _moved_joints(model: RobotOfUrdf, walk: Walk) -> tuple[Joint, ...]:
    """Return the joints by which joint states move links; none: they do not, or transforms do."""
    placed = {*walk.frames.parents, walk.frames.base}
    told = next((table.names for table in walk.recording.joints), ())
    kept = tuple(
        joint
        for joint in model.joints
        if joint.child not in placed and (joint.kind == "fixed" or joint.measured in told)
    )
    return kept if any(joint.kind != "fixed" for joint in kept) else ()


def moved_links(joints: Sequence[Joint], table: JointTable) -> LinkTransforms:
    """Return the links of joint states; those that lack a joint are left out."""
    told = table.samples
    own = np.zeros((len(told.log_time), len(joints)))
    for column, joint in enumerate(joints):
        if joint.kind != "fixed":
            own[:, column] = told.position[:, table.names.index(joint.measured)]
    rows = np.flatnonzero(all_finite(own))
    log_time = told.log_time[rows]
    poses = link_poses(joints, own[rows])
    return LinkTransforms(log_time, header_time(told.stamp[rows], log_time), *poses)


def without_legs(reason: str, call: str) -> Finding:
    """Say why there is no gait, with a call that would give one; empty: none is known."""
    told = found("NO_FEET", say="joints", reason=reason)
    text = f"{told.text}; with it, this measures the gait: {call}" if call else told.text
    return replace(told, text=text, command=call)


# --- what is drawn: frames below the base, shape, limbs over time --------------------------------

_INSIDE: Final = 0.75
"""Hips over feet: how much nearer to the middle of the body they are assumed to be."""
_DENSITY: Final = 500.0
"""kg/m3 of a body whose legs are not known; half of water's, as robots have."""
_USUAL_MASS_KG: Final = 12.0
_ORIGIN: Final = (0.0, 0.0, 0.0)
_GRID_M: Final = 0.02
"""m, to which points of soles are rounded: a picture needs no more."""
MOST_FRAMES: Final = 64
"""Frames of a robot that are followed."""


class Skeleton(NamedTuple):
    """The frames below the base."""

    base: str
    frames: Mapping[str, FrameTrack]
    """By name, parents before children."""
    legs: Mapping[int, tuple[str, ...]]
    """The frames from that of a foot up to the child of the base, by foot, where they are known."""
    soles: Mapping[int, Point]
    """m, where these feet touch the ground in their frames."""

    @property
    def limbs(self) -> list[str]:
        """The frames of legs, and others that move."""
        legs = {frame for leg in self.legs.values() for frame in leg}
        return [name for name, own in self.frames.items() if name in legs or not own.static]


class RobotShape(NamedTuple):
    """The known shape of the robot."""

    hips: Mapping[int, Point]
    """m, base frame: where legs are assumed to begin, by foot."""
    height_m: float
    """Height of the base above the feet."""
    size_m: float
    """Length of the body, or its height above the feet if that is more."""


def skeleton(selection: Selection, probe: KnownFrames, links: Mapping[str, FrameTrack]) -> Skeleton:
    """Return the frames of a log that hang below the base; those with two parents do not.

    Args:
        selection: the robot's feet.
        probe: the frames that the log's transforms place.
        links: those that joint states place.
    """
    base, known = probe.base, {**links, **probe.tracks(probe.parent_of)}
    parents = {child: track.parent for child, track in known.items()}
    chains = {child: chain_of_frames(parents, child, base) or () for child in known}
    below = sorted((len(chain), child) for child, chain in chains.items() if chain)
    frames = {child: known[child] for _, child in below}
    legs, soles = dict[int, tuple[str, ...]](), dict[int, Point]()
    for number, leg in enumerate(leg_chains(selection, probe, parents, base)):
        if leg is not None:
            is_given = selection.robot.feet[number].frame is not None
            legs[number] = leg.frames
            soles[number] = leg.point if is_given else _rounded(leg.point)
    return Skeleton(base, frames, legs, soles)


def _rounded(point: Point) -> Point:
    x, y, z = (np.round(np.array(point) / _GRID_M) * _GRID_M + 0.0).tolist()
    return x, y, z


def robot_shape(walk: Walk) -> RobotShape:
    """Return what the positions of standing feet, else the mass, tell of a robot's shape."""
    found = walk.frames.stances(walk.recording.feet)
    stances = {foot: _rounded(point) for foot, point in found.items()}
    length = height = body_size_m(walk.settings.mass_kg)[0]
    if stances:
        points = np.array(list(stances.values()))
        height = max(-float(median_of(points[:, 2])), 0.0) or length
        length = max(float(np.ptp(points[:, :2], axis=0).max()), 0.5 * length)
    hips = {foot: (_INSIDE * x, _INSIDE * y, 0.0) for foot, (x, y, _) in stances.items()}
    return RobotShape(hips, height, max(length, height))


def body_size_m(mass_kg: float | None) -> tuple[float, float, float]:
    """Return length, width and height, m, of a body of some mass; None: a usual one."""
    third = ((mass_kg or _USUAL_MASS_KG) / _DENSITY / 6.0) ** (1.0 / 3.0)
    return 3.0 * third, 2.0 * third, third


class Limbs(NamedTuple):
    """The origins of frames below the base, and the feet's soles, over time."""

    point: Float32s
    """(n, k, 3) m, in the base's frame; NaN where not known."""
    parents: tuple[int, ...]
    """(k,) index of the point that each hangs on; -1: the base."""
    soles: tuple[int | None, ...]
    """Index of each foot's sole; None: its frame is not known."""


def find_limbs(walk: Walk, selection: Selection, time: Ints) -> Limbs | None:
    """Follow the frames of a robot; None where nothing connects any with its base.

    The log's transforms place them, or its joint states with its robot description.

    Args:
        walk: what was measured.
        selection: the robot's feet.
        time: (n,) ns on the walk's clock, increasing.
    """
    known = skeleton(selection, walk.frames, walk.legs.links if walk.legs else {})
    drawn, base = known.limbs, known.base
    # Whether a transform was recorded late changes no picture.
    tracks = {name: own._replace(log_time=own.time) for name, own in known.frames.items()}
    if not drawn or len(drawn) > MOST_FRAMES:
        return None
    parents = {child: track.parent for child, track in known.frames.items()}
    feet = {foot: (frames[0], known.soles[foot]) for foot, frames in known.legs.items()}
    points: list[Floats] = []
    for frame, point in (*((frame, _ORIGIN) for frame in drawn), *feet.values()):
        pose = lookup(tracks, frame, base, time, time)
        points.append(pose.translation + rotate(pose.rotation, np.array([point])))
    above = [*(parents[frame] for frame in drawn), *(frame for frame, _ in feet.values())]
    sole = {foot: len(drawn) + index for index, foot in enumerate(feet)}
    return Limbs(
        np.stack(points, axis=1).astype(np.float32),
        tuple(_nearest(drawn, parents, base, frame) for frame in above),
        tuple(sole.get(foot) for foot in range(len(selection.robot.feet))),
    )


def _nearest(drawn: Sequence[str], parents: Mapping[str, str], base: str, frame: str) -> int:
    """Return the index of a frame or, where it is not drawn, of the next above; -1: the base."""
    while frame != base and frame not in drawn:
        frame = parents[frame]
    return -1 if frame == base else drawn.index(frame)


# --- a URDF of primitives ---

_AXES: Final = {"+x": (1, 0, 0), "-x": (-1, 0, 0), "+y": (0, 1, 0), "-y": (0, -1, 0)}
_FEWEST_HIPS: Final = 3
"""Assumed hips that span a body."""
_SHORTEST_LIMB_M: Final = 0.01
_THICKNESS: Final = 0.045
"""Radius of a limb over the length of a leg."""
_THINNEST_M, _THICKEST_M = 0.005, 0.04
_COLOURS: Final = {"body": "#b8bec6", "limb": "#5c6470", "nose": "#2f3640"}


def primitive_urdf(described: Robot, frames: Skeleton, shape: RobotShape) -> str:
    """Return the URDF of a body, limbs between joints, feet in their colours, and a nose.

    Args:
        described: its name, its forward axis, and its mass, which gives the body's size where the
            legs do not.
        frames: below its base.
        shape: where legs without frames are assumed to begin.
    """
    robot = ET.Element("robot", name=described.name)
    materials = {foot: f"foot {described.feet[foot].name}" for foot in frames.legs}
    colours = _COLOURS | {name: foot_colour(foot) for foot, name in materials.items()}
    for material, colour in colours.items():
        element = ET.SubElement(robot, "material", name=material)
        ET.SubElement(element, "color", rgba=_text([*colour_parts(colour), 1.0]))
    links = {
        frame: ET.SubElement(robot, "link", name=frame) for frame in (frames.base, *frames.frames)
    }
    centre, size = _body(described, frames, shape)
    _add_visual(links[frames.base], "body", "box", centre, size=size)
    forward = np.array(_AXES[described.forward_axis])
    depth, across = 0.15 * size.max(), 0.4 * size[:2][forward[:2] == 0].item()
    nose = np.where(forward != 0, depth, across)
    nose[2] = 0.6 * size.min()
    middle = centre + forward * (size + depth) / 2.0
    _add_visual(links[frames.base], "nose", "box", middle, size=nose)
    radius = _limb_radius(frames)
    hips = {leg[-1] for leg in frames.legs.values()}
    for frame in (each for each in frames.limbs if each not in hips):
        track = frames.frames[frame]
        _add_limb(links[track.parent], track.translation[0], radius)
        _add_visual(links[frame], "limb", "sphere", radius=[radius])
    for foot, (frame, *_) in frames.legs.items():
        point = frames.soles[foot]
        _add_limb(links[frame], point, radius)
        _add_visual(links[frame], materials[foot], "sphere", point, radius=[1.6 * radius])
    for child, track in frames.frames.items():
        kind = "fixed" if track.static else "floating"
        joint = ET.SubElement(robot, "joint", name=f"{track.parent} to {child}", type=kind)
        angles = roll_pitch_yaw(track.rotation[:1])[0]
        ET.SubElement(joint, "origin", xyz=_text(track.translation[0]), rpy=_text(angles))
        ET.SubElement(joint, "parent", link=track.parent)
        ET.SubElement(joint, "child", link=child)
    ET.indent(robot)
    return ET.tostring(robot, encoding="unicode") + "\n"


def _body(robot: Robot, frames: Skeleton, shape: RobotShape) -> tuple[Floats, Floats]:
    """Return centre and size, m, of the box between the hips; of the mass's size without hips.

    The latter stands on the base's origin where the robot is a biped.
    """
    hips = [frames.frames[leg[-1]].translation[0] for leg in frames.legs.values()]
    if not hips and len(shape.hips) >= _FEWEST_HIPS:
        hips = [np.array(hip) for hip in shape.hips.values()]
    if not hips:
        length, width, height = body_size_m(robot.mass_kg)
        upright = len(robot.feet) == 2
        length, height = (height, length) if upright else (length, height)
        length, width = (length, width) if _AXES[robot.forward_axis][0] else (width, length)
        centre = np.array([0.0, 0.0, 0.5 * height if upright else 0.0])
        return centre, np.array([length, width, height])
    low, high = np.min(hips, axis=0), np.max(hips, axis=0)
    longest = max(float((high - low)[:2].max()), 0.1)
    size = np.maximum(high - low, 0.4 * longest)
    size[2] = 0.25 * longest
    return (low + high) / 2.0, size


def _limb_radius(frames: Skeleton) -> float:
    """Return the radius of limbs, m, by the length of the longest leg."""
    lengths = [
        sum(hypot(*frames.frames[frame].translation[0]) for frame in leg[:-1])
        + hypot(*frames.soles[foot])
        for foot, leg in frames.legs.items()
    ]
    return min(max(_THICKNESS * max(lengths, default=0.5), _THINNEST_M), _THICKEST_M)


def _add_limb(link: ET.Element, end: Sequence[float] | Floats, radius: float) -> None:
    """Add a cylinder from a link's origin to a point, where it is long enough to be seen."""
    length = hypot(*end)
    if length >= _SHORTEST_LIMB_M:
        x, y, z = end
        turn = (0.0, acos(min(max(z / length, -1.0), 1.0)), atan2(y, x))
        middle = (x / 2.0, y / 2.0, z / 2.0)
        _add_visual(link, "limb", "cylinder", middle, turn, radius=[radius], length=[length])


def _add_visual(
    link: ET.Element,
    material: str,
    shape: str,
    centre: Sequence[float] | Floats = _ORIGIN,
    turn: Sequence[float] = _ORIGIN,
    **sizes: Sequence[float] | Floats,
) -> None:
    visual = ET.SubElement(link, "visual")
    ET.SubElement(visual, "origin", xyz=_text(centre), rpy=_text(turn))
    geometry = {name: _text(numbers) for name, numbers in sizes.items()}
    ET.SubElement(ET.SubElement(visual, "geometry"), shape, geometry)
    ET.SubElement(visual, "material", name=material)


def _text(numbers: Sequence[float] | Floats) -> str:
    """Return numbers, rounded to micrometres, as a URDF has them; -0 is 0."""
    return " ".join(f"{round(float(number), 6) + 0.0:.6g}" for number in numbers)
