"""Feet without sensors and a base without poses: what a log's joint states tell of both."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, median_of
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.estimated import forces
from dogbot_logtool.core.estimated.estimate import SLOWEST_S, Estimate, estimate, placed_by_legs
from dogbot_logtool.core.estimated.leg_joints import LegJoints, joints_of_legs
from dogbot_logtool.core.frames.kinematics import Leg
from dogbot_logtool.core.legs.joints import JointTable
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.rotations import multiply
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.printable import shell_joined
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.robot.robot_model.description import read_urdf
from dogbot_logtool.robot.robot_model.joints_of_log import own_description
from dogbot_logtool.robot.robot_model.robot_of_urdf import (
    Legs,
    RobotOfUrdf,
    find_legs,
    read_robot,
)
from dogbot_logtool.robot.selection import Selection

_WORLD: Final = "odom"


@dataclass(frozen=True, slots=True)
class Model:
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


def told_by_legs(
    recording: Recording, selection: Selection, model: Model
) -> tuple[Recording, Selection]:
    """Add the contacts of feet without sensors, and the poses of a base without odometry.

    Args:
        recording: the columns of a log with joint states.
        selection: its topics.
        model: the robot's description.
    """
    robot = model.robot
    recording = _named_as_described(recording, robot) if robot else recording
    lacks_feet, lacks_base = not selection.contacts, not selection.odometry
    if not (lacks_feet or lacks_base):
        return recording, selection
    named, found = selection.robot, Legs()
    knows_axis = named.is_given("forward_axis") or not selection.robot_is_guessed
    if robot is not None:
        robot = _based(recording, selection, robot)
        axis = named.forward_axis if knows_axis else None
        found = find_legs(robot, _posture(recording.joints), axis)
    names = dict.fromkeys(name for leg in found.legs for name in leg.measured)
    joints = joints_of_legs(recording.joints, tuple(names)) if names else None
    reason = model.why_none or (found.why_none and f"the robot description {found.why_none}")
    reason = reason or _why_not(recording, found.legs, joints)
    if robot is None or joints is None or reason:
        return recording, _without_legs(selection, reason, model.call) if lacks_feet else selection
    mass = selection.robot.mass_kg or robot.mass_kg
    told = estimate(recording, found.legs, joints, _mounting(recording, robot), mass)
    findings = [*selection.findings]
    base_frame = named.base_frame or robot.base
    named = replace(named, forward_axis=found.forward_axis, base_frame=base_frame)
    if lacks_base:
        named = replace(named, world_frame=named.world_frame or _WORLD)
        findings = [each for each in findings if each.code != "NO_BASE"]
        findings.append(_of_base(told))
    feet = _with_points(recording, selection, found.legs, told)
    if lacks_feet:
        own = [
            Foot(leg.name, joints.topic, leg_position=leg.position, frame=leg.foot)
            for leg in found.legs
        ]
        named, feet = replace(named, mass_kg=mass, feet=tuple(own)), told.feet
        findings = [each for each in findings if not _is_settled(each, recording)]
        findings += [_of_contact(told, joints.topic), *_of_efforts(told, found.legs)]
    return replace(recording, feet=feet, base=told.base if lacks_base else recording.base), replace(
        selection,
        robot=named,
        findings=tuple(findings),
        contact_from=told.contact_from if lacks_feet else "",
        base_from_legs=lacks_base,
    )


def _posture(tables: Sequence[JointTable]) -> dict[str, float]:
    """Return the usual position of each recorded joint, rad or m."""
    found: dict[str, float] = {}
    for table in tables:
        for column, name in enumerate(table.names):
            values = table.samples.position[:, column]
            values = values[np.isfinite(values)]
            if len(values):
                found.setdefault(name, float(median_of(values)))
    return found


def _with_points(
    recording: Recording, selection: Selection, legs: Sequence[Leg], told: Estimate
) -> tuple[Samples, ...]:
    """Return sensors' samples with the places where their legs rest, if sensors tell none."""
    if selection.has_points:
        return recording.feet
    of_leg = {leg.position: samples for leg, samples in zip(legs, told.feet, strict=True)}
    return tuple(
        placed_by_legs(samples, of_leg[foot.leg_position])
        if foot.leg_position and foot.leg_position in of_leg
        else samples
        for foot, samples in zip(selection.robot.feet, recording.feet, strict=True)
    )


def _named_as_described(recording: Recording, robot: RobotOfUrdf) -> Recording:
    """Name joints as the description does, where none is, but for namespaces and capitals."""
    described = {joint.name.lower(): joint.name for joint in robot.joints if joint.kind != "fixed"}
    told = [name for table in recording.joints for name in table.names]
    short = {name: name.replace(":", "/").rpartition("/")[2].lower() for name in told}
    if not set(described.values()).isdisjoint(told) or len(set(short.values())) < len(short):
        return recording
    tables = (
        replace(table, names=tuple(described.get(short[name], name) for name in table.names))
        for table in recording.joints
    )
    return replace(recording, joints=tuple(tables))


def _is_settled(finding: Finding, recording: Recording) -> bool:
    """Tell whether a finding is about feet that are known now, or takes joints for feet."""
    joints = (f"{table.topic}:" in finding.text for table in recording.joints)
    return finding.code == "NO_FEET" or (finding.code == "FEET_UNSURE" and any(joints))


def _based(recording: Recording, selection: Selection, robot: RobotOfUrdf) -> RobotOfUrdf:
    """Return a robot whose base is the robot's file's, or that of the poses, if it has that."""
    below = {joint.parent for joint in robot.joints}
    named = (selection.robot.base_frame or "", *recording.base_frames)
    base = next((each.strip("/") for each in named if each.strip("/") in below), robot.base)
    other = replace(robot, base=base)
    return other if base == robot.base or find_legs(other, {}).legs else robot


def _mounting(recording: Recording, robot: RobotOfUrdf) -> Floats:
    """(4,) x, y, z, w, of an inertial unit's frame in the base's, by fixed joints."""
    frames = recording.accelerations.frames if recording.accelerations else ()
    above = {joint.child: joint for joint in robot.joints if joint.kind == "fixed"}
    turn = np.array([[0.0, 0.0, 0.0, 1.0]])
    link = frames[0].strip("/") if len(frames) == 1 else robot.base
    while link != robot.base and link in above:
        turn = multiply(np.array([above[link].rotation]), turn)
        link = above[link].parent
    return np.asarray(turn[0])


def _why_not(recording: Recording, legs: Sequence[Leg], joints: LegJoints | None) -> str:
    """Say why joint states tell nothing of the feet; empty if they do."""
    if joints is None:
        told = {name for table in recording.joints for name in table.names}
        lacking = [name for leg in legs for name in leg.measured if name not in told]
        names = ", ".join(dict.fromkeys(lacking))
        if not names:
            return "too few joint states tell the positions of all joints of the legs"
        return f"joint states do not tell of {names}, which the robot description has"
    interval = float(median_of(np.diff(joints.time))) / 1e9
    if interval > SLOWEST_S:
        return f"joint states come {1.0 / interval:.3g} times a second, too rarely"
    return ""


def _without_legs(selection: Selection, reason: str, call: str) -> Selection:
    """Say why there is no gait, in place of what says that there are no topics of feet."""
    findings = [each for each in selection.findings if each.code != "NO_FEET"]
    text = f"no topic tells of feet, so there is no gait, and joints do not tell: {reason}"
    text += f"; with it, this measures the gait: {call}" if call else ""
    return replace(selection, findings=(*findings, Finding("NO_FEET", text, command=call)))


def _of_base(told: Estimate) -> Finding:
    """Say that the base is worked out from the legs."""
    lean = "by the accelerometer" if told.tells_up else "taken as none"
    text = (
        "the log has no poses of the base: they are worked out from the standing feet (leg "
        f"odometry), with turns by {told.turns_from}, roll and pitch {lean}; in a physics engine, "
        "speeds were within 4 %; place and heading drift"
    )
    return Finding("BASE_FROM_LEGS", text)


def _of_efforts(told: Estimate, legs: Sequence[Leg]) -> Iterator[Finding]:
    """Yield why efforts are no torques: then work is none, either."""
    if told.why_no_force.startswith(forces.TOO_MUCH):
        text = f"no work is known: {told.why_no_force}"
        yield Finding("JOINT_VALUES", text, "legs.absolute_work_j", cases=("efforts",))
    if told.why_no_force.startswith(forces.WRONG_SIGN):
        names = tuple(leg.name for leg in legs)
        yield Finding("EFFORT_SIGN", told.why_no_force, "legs.positive_work_j", feet=names)


def _of_contact(told: Estimate, topic: str) -> Finding:
    """Say that contact is estimated, and from what."""
    if told.contact_from == "joint_torques":
        text = (
            f"contacts and forces of the feet are estimated from positions and efforts of {topic}: "
            "in a physics engine, contact times were within 0.03 of a stride, vertical forces "
            "within 0.15 body weights rms, their sum 0.93 to 1.0 of the weight"
        )
        return Finding("CONTACT_ESTIMATED", text)
    text = (
        f"contacts of the feet are estimated from the motion of the legs ({topic}): beside a "
        "physics engine and the sensors of a Go1, times in contact were within 0.1 of a stride; "
        f"there are no forces: {told.why_no_force}"
    )
    return Finding("CONTACT_ESTIMATED", text)
