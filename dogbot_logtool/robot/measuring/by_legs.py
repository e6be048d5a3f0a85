"""What joint states tell of feet without sensors or names, and of a base without poses."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import median_of
from dogbot_logtool.core.frames.transforms import fixed_turn
from dogbot_logtool.core.legs.estimate import Estimate, estimate
from dogbot_logtool.core.legs.ground import TOO_MUCH, joints_of_legs
from dogbot_logtool.core.legs.joints import link_tracks
from dogbot_logtool.core.recording import JointTable, Recording
from dogbot_logtool.core.settings import WalkSettings
from dogbot_logtool.finding import Finding, found
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.robot.description import Model, without_legs
from dogbot_logtool.robot.selection import Selection
from dogbot_logtool.robot.urdf import RobotOfUrdf, axis_by_names, legs_of_robot

_WORLD: Final = "odom"


def measured_by_legs(
    recording: Recording, selection: Selection, model: Model
) -> tuple[Recording, Selection]:
    """Add the contacts of feet without sensors, and the poses of a base without odometry.

    Args:
        recording: the columns of a log with joint states.
        selection: its topics.
        model: the robot's description.
    """
    if selection.contacts and selection.odometry:
        return recording, selection
    try:
        if model.robot is None:
            raise ValueError(model.why_none)
        told, estimated = _estimated(recording, selection, model.robot)
    except ValueError as reason:
        if selection.contacts:
            return recording, selection
        settled = [each for each in selection.findings if each.code != "NO_FEET"]
        finding = without_legs(str(reason), model.call)
        return recording, selection._replace(findings=(*settled, finding))
    feet = recording.feet if selection.contacts else estimated.feet
    base = recording.base if selection.odometry else estimated.base
    return replace(recording, feet=feet, base=base), told


def _estimated(
    recording: Recording, selection: Selection, robot: RobotOfUrdf
) -> tuple[Selection, Estimate]:
    """Return the selection with what the log lacks, and that by its legs.

    Raises:
        ValueError: a sentence: why they tell nothing.
    """
    named, lacks_feet = selection.robot, not selection.contacts
    robot = _based(recording, named.base_frame, robot)
    knows_axis = "forward_axis" in named.given or not selection.robot_is_guessed
    axis = named.forward_axis if knows_axis else None
    legs, axis = legs_of_robot(robot, _posture(recording.joints), axis)
    names = dict.fromkeys(name for leg in legs for name in leg.measured)
    joints = joints_of_legs(recording.joints, tuple(names))
    mass = named.mass_kg or robot.mass_kg
    named_frames = recording.accelerations.frames if recording.accelerations else ()
    unit = named_frames[0] if len(named_frames) == 1 else robot.base
    turn = fixed_turn(link_tracks(robot.joints, {}), unit, robot.base)
    mounting = np.array(turn or (0.0, 0.0, 0.0, 1.0))
    estimated = estimate(recording, legs, joints, mounting, mass)
    named = replace(named, forward_axis=axis, base_frame=named.base_frame or robot.base)
    findings = [*selection.findings]
    if not selection.odometry:
        named = replace(named, world_frame=named.world_frame or _WORLD)
        findings = [each for each in findings if each.code != "NO_BASE"]
        lean = "taken as none"
        within = "14 % of a body that stays level, mostly within 50 % of one that sways on two feet"
        if estimated.inertial.tells_up:
            lean, within = "by the accelerometer", "6 %"
        by = estimated.inertial.turns_from
        findings.append(found("BASE_FROM_LEGS", say="joints", by=by, lean=lean, within=within))
    if lacks_feet:
        topic = joints.topic
        feet = tuple(
            Foot(each.name, topic, "", each.position, each.foot, each.point) for each in legs
        )
        named = replace(named, mass_kg=mass, feet=feet)
        findings = [each for each in findings if not _is_settled(each, recording)]
        findings += _of_contact(estimated, topic)
    selection = selection._replace(
        robot=named,
        findings=tuple(findings),
        contact_from=estimated.contact_from if lacks_feet else "",
        base_from_legs=not selection.odometry,
    )
    return selection, estimated


def facing(settings: WalkSettings, recording: Recording, robot: RobotOfUrdf) -> WalkSettings:
    """Let the names of a robot's legs tell its forward axis, if that was only guessed."""
    if not settings.forward_axis_is_assumed:
        return settings
    axis, guessed = axis_by_names(robot, _posture(recording.joints)), settings.forward_axis
    if axis is None:
        return settings
    settings = replace(settings, forward_axis=axis, forward_axis_is_assumed=False)
    reason = f"{guessed} of the guessed robot is not forward here: its legs' names say"
    return settings if axis == guessed else replace(settings, forward_axis_reason=reason)


def _posture(tables: Sequence[JointTable]) -> dict[str, float]:
    """Return the usual position of each recorded joint, rad or m."""
    usual: dict[str, float] = {}
    for table in tables:
        for name, values in zip(table.names, table.samples.position.T, strict=True):
            known = values[np.isfinite(values)]
            usual.setdefault(name, float(median_of(known)) if len(known) else 0.0)
    return usual


def _is_settled(finding: Finding, recording: Recording) -> bool:
    """Tell whether a finding is about feet that are known now, or takes joints for feet."""
    joints = (f"{table.topic}:" in finding.text for table in recording.joints)
    return finding.code == "NO_FEET" or (finding.code == "FEET_UNSURE" and any(joints))


def _based(recording: Recording, named: str | None, robot: RobotOfUrdf) -> RobotOfUrdf:
    """Return a robot whose base is the robot's file's, or that of the poses, if it has that."""
    below = {joint.parent for joint in robot.joints}
    names = (each.strip("/") for each in (named or "", *recording.base_frames))
    return robot._replace(base=next((name for name in names if name in below), robot.base))


def _of_contact(estimated: Estimate, topic: str) -> Iterator[Finding]:
    """Yield that contact is estimated, and why efforts are no torques: work is none, either."""
    why = estimated.why_no_force
    say = "plain" if why else "forces"
    yield replace(found("CONTACT_ESTIMATED", say=say, topic=topic, why=why), where="")
    if why.startswith(TOO_MUCH):
        yield found("JOINT_VALUES", "efforts", where="legs.absolute_work_j", why=why)
