"""What joint states tell of feet without sensors or names, and of a base without poses."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import permutations
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, all_finite, median_of, norms
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.frames.kinematics import Leg
from dogbot_logtool.core.legs.estimate import Estimate, estimate, placed_by_legs
from dogbot_logtool.core.legs.ground import TOO_MUCH, WRONG_SIGN, joints_of_legs
from dogbot_logtool.core.recording import JointTable, Recording
from dogbot_logtool.core.rotations import multiply
from dogbot_logtool.core.settings import WalkSettings
from dogbot_logtool.finding import Finding, found
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.reader.recording import read_recording
from dogbot_logtool.robot.names import FootSet
from dogbot_logtool.robot.robot_model.description import Model, without_legs
from dogbot_logtool.robot.robot_model.legs_of_urdf import axis_by_names, find_legs
from dogbot_logtool.robot.robot_model.urdf import RobotOfUrdf
from dogbot_logtool.robot.selection import Selection, select_topics

_WORLD: Final = "odom"
MOST_FEET: Final = 6
"""Feet whose every order is tried."""
LIKELY: Final = 0.3
"""Correlation of load and contact from which a field is a leg's foot."""
CLEAR: Final = 0.15
"""By which it must lead before that of any other leg."""


def measured_by_legs(
    recording: Recording, selection: Selection, model: Model
) -> tuple[Recording, Selection]:
    """Add the contacts of feet without sensors, and the poses of a base without odometry.

    Args:
        recording: the columns of a log with joint states.
        selection: its topics.
        model: the robot's description.
    """
    robot, lacks_feet = model.robot, not selection.contacts
    recording = _named_as_described(recording, robot) if robot else recording
    if selection.contacts and selection.odometry:
        return recording, selection
    try:
        if robot is None:
            raise ValueError(model.why_none)
        legs, selection, estimated = _estimated(recording, selection, robot)
    except ValueError as reason:
        if not lacks_feet:
            return recording, selection
        settled = [each for each in selection.findings if each.code != "NO_FEET"]
        finding = without_legs(str(reason), model.call)
        return recording, selection._replace(findings=(*settled, finding))
    feet = estimated.feet if lacks_feet else _with_points(recording, selection, legs, estimated)
    base = recording.base if selection.odometry else estimated.base
    return replace(recording, feet=feet, base=base), selection


def _estimated(
    recording: Recording, selection: Selection, robot: RobotOfUrdf
) -> tuple[Sequence[Leg], Selection, Estimate]:
    """Return the legs, what they tell, and the selection with what the log lacks.

    Raises:
        ValueError: a sentence: why they tell nothing.
    """
    named, lacks_feet = selection.robot, not selection.contacts
    robot = _based(recording, named.base_frame, robot)
    knows_axis = "forward_axis" in named.given or not selection.robot_is_guessed
    axis = named.forward_axis if knows_axis else None
    try:
        legs, axis = find_legs(robot, _posture(recording.joints), axis)
    except ValueError as reason:
        raise ValueError(f"the robot description {reason}") from None
    names = dict.fromkeys(name for leg in legs for name in leg.measured)
    joints = joints_of_legs(recording.joints, tuple(names))
    mass = named.mass_kg or robot.mass_kg
    estimated = estimate(recording, legs, joints, _mounting(recording, robot), mass)
    named = replace(named, forward_axis=axis, base_frame=named.base_frame or robot.base)
    findings = [*selection.findings]
    if not selection.odometry:
        named = replace(named, world_frame=named.world_frame or _WORLD)
        findings = [each for each in findings if each.code != "NO_BASE"]
        lean, within = "taken as none", "14 %"
        if estimated.tells_up:
            lean, within = "by the accelerometer", "6 %"
        by = estimated.turns_from
        findings.append(found("BASE_FROM_LEGS", say="joints", by=by, lean=lean, within=within))
    if lacks_feet:
        topic = joints.topic
        own = tuple(
            Foot(
                leg.name,
                topic,
                leg_position=leg.position,
                frame=leg.foot,
                contact_point_m=leg.point,
            )
            for leg in legs
        )
        named = replace(named, mass_kg=mass, feet=own)
        findings = [each for each in findings if not _is_settled(each, recording)]
        findings += _of_contact(estimated, topic, tuple(leg.name for leg in legs))
    selection = selection._replace(
        robot=named,
        findings=tuple(findings),
        contact_from=estimated.contact_from if lacks_feet else "",
        base_from_legs=not selection.odometry,
    )
    return legs, selection, estimated


def facing(settings: WalkSettings, recording: Recording, robot: RobotOfUrdf) -> WalkSettings:
    """Let the names of a robot's legs tell its forward axis, if that was only guessed."""
    axis = None
    if settings.forward_axis_is_assumed:
        axis = axis_by_names(robot, _posture(recording.joints))
    if axis is None:
        return settings
    settings = replace(settings, forward_axis_is_assumed=False)
    if axis == settings.forward_axis:
        return settings
    reason = (
        f"{settings.forward_axis} of the guessed robot is not forward here: its legs' names say"
    )
    return replace(settings, forward_axis=axis, forward_axis_reason=reason)


def _posture(tables: Sequence[JointTable]) -> dict[str, float]:
    """Return the usual position of each recorded joint, rad or m."""
    usual: dict[str, float] = {}
    for table in tables:
        for name, values in zip(table.names, table.samples.position.T, strict=True):
            known = values[np.isfinite(values)]
            if len(known):
                usual.setdefault(name, float(median_of(known)))
    return usual


def _with_points(
    recording: Recording, selection: Selection, legs: Sequence[Leg], estimated: Estimate
) -> tuple[Samples, ...]:
    """Return sensors' samples with the places where their legs rest, if sensors tell none."""
    if selection.has_points:
        return recording.feet
    pairs = zip(legs, estimated.feet, strict=True)
    of_leg = {leg.position or leg.name: samples for leg, samples in pairs}
    keys = [foot.leg_position or foot.name for foot in selection.robot.feet]
    return tuple(
        placed_by_legs(samples, of_leg[key]) if key in of_leg else samples
        for key, samples in zip(keys, recording.feet, strict=True)
    )


def _named_as_described(recording: Recording, robot: RobotOfUrdf) -> Recording:
    """Name joints as the description does, where none is, but for namespaces and capitals."""
    described = {joint.name.lower(): joint.name for joint in robot.joints if joint.kind != "fixed"}
    recorded = [name for table in recording.joints for name in table.names]
    short = {name: name.replace(":", "/").rpartition("/")[2].lower() for name in recorded}
    if not set(described.values()).isdisjoint(recorded) or len(set(short.values())) < len(short):
        return recording
    tables = (
        table._replace(names=tuple(described.get(short[name], name) for name in table.names))
        for table in recording.joints
    )
    return replace(recording, joints=tuple(tables))


def _is_settled(finding: Finding, recording: Recording) -> bool:
    """Tell whether a finding is about feet that are known now, or takes joints for feet."""
    joints = (f"{table.topic}:" in finding.text for table in recording.joints)
    return finding.code == "NO_FEET" or (finding.code == "FEET_UNSURE" and any(joints))


def _based(recording: Recording, named: str | None, robot: RobotOfUrdf) -> RobotOfUrdf:
    """Return a robot whose base is the robot's file's, or that of the poses, if it has that."""
    below = {joint.parent for joint in robot.joints}
    names = (each.strip("/") for each in (named or "", *recording.base_frames))
    other = robot._replace(base=next((name for name in names if name in below), robot.base))
    try:
        find_legs(other, {})
    except ValueError:
        return robot
    return other


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


def _of_contact(estimated: Estimate, topic: str, names: tuple[str, ...]) -> Iterator[Finding]:
    """Yield that contact is estimated, and why efforts are no torques: work is none, either."""
    why = estimated.why_no_force
    say = "plain" if why else "forces"
    yield replace(found("CONTACT_ESTIMATED", say=say, topic=topic, why=why), where="")
    if why.startswith(TOO_MUCH):
        yield found("JOINT_VALUES", "efforts", where="legs.absolute_work_j", why=why)
    if why.startswith(WRONG_SIGN):
        yield Finding("EFFORT_SIGN", why, "legs.positive_work_j", feet=names)


def named_by_legs(
    log: Log, options: MeasureOptions, selection: Selection, legs: Sequence[Samples]
) -> FootSet | None:
    """Name fields that may be feet by the legs that stand while they are loaded.

    Args:
        log: the log.
        options: of the call.
        selection: with the fields that may be feet, and the feet that legs tell.
        legs: contacts of these feet.

    Returns:
        None where no fields may be feet, they have names, or no order of them fits the legs.
    """
    offered = next(iter(selection.possible_feet), None)
    if offered is None or len(offered.feet) != len(legs) or len(legs) > MOST_FEET:
        return None
    # Joints' own efforts, by which legs have told contacts, are no sensors of feet.
    is_joint = offered.feet[0].topic == selection.robot.feet[0].topic
    if is_joint or any(foot.leg_position for foot in offered.feet):
        return None
    chosen = select_topics(log, replace(options, foot=None, feet=offered.feet))
    fields = read_recording(log, chosen.wanted(), 1).recording.feet
    time = legs[0].log_time
    loads = np.stack([_load_at(each, time) for each in fields])
    down = np.stack([each.in_contact for each in legs])
    # While all stand, or none, nothing is told apart.
    steps = down.any(axis=0) & ~down.all(axis=0) & np.isfinite(loads).all(axis=0)
    likeness = np.corrcoef(loads[:, steps], down[:, steps])[: len(fields), len(fields) :]
    rows = range(len(legs))
    order = max(permutations(rows), key=lambda order: likeness[rows, order].sum())
    own = likeness[rows, order]
    if not (own >= LIKELY).all():
        return None
    named = [selection.robot.feet[row] for row in order]
    feet = tuple(
        replace(field, name=leg.name, leg_position=leg.leg_position)
        for field, leg in zip(offered.feet, named, strict=True)
    )
    reason = "each is loaded while the leg of its name stands, by the joints"
    if (np.sort(likeness, axis=1)[:, -2] > own - CLEAR).any():
        reason += "; some legs move too much alike to be told apart surely"
    return offered._replace(feet=feet, marks=(*offered.marks, (0, reason)))


def _load_at(samples: Samples, time: Ints) -> Floats:
    known = np.flatnonzero(all_finite(samples.force))
    if not len(known):
        return np.full(len(time), np.nan)
    load = norms(samples.force[known]) if samples.force.any() else samples.in_contact[known]
    return np.asarray(np.interp(time - time[0], samples.log_time[known] - time[0], load))
