"""Feet without sensors and a base without poses: what a log's joint states tell of both."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final, Literal

import numpy as np

from dogbot_logtool.core import estimated
from dogbot_logtool.core.arrays import Flags, Floats, Ints, all_finite, median_of, nearest_rows
from dogbot_logtool.core.base.attitude import LONG_S, Inertial, by_attitude, inertial_at, level
from dogbot_logtool.core.base.foot_path import LONGEST_STEP_S
from dogbot_logtool.core.base.leg_odometry import leg_odometry
from dogbot_logtool.core.base.poses import Odometry, base_history
from dogbot_logtool.core.contact.contact_detection import find_stances
from dogbot_logtool.core.contact.contact_rule import ContactRule
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import (
    TimeSource,
    advancing,
    check_stamps,
    first_at_each_tick,
)
from dogbot_logtool.core.frames.kinematics import LegMotion, leg_motion
from dogbot_logtool.core.legs.joints import JointTable
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.rotations import from_roll_pitch_yaw, multiply, rotate
from dogbot_logtool.core.settings import GRAVITY_MPS2
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.printable import shell_joined
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.robot.robot_model.description import read_urdf
from dogbot_logtool.robot.robot_model.joint_motion import own_description
from dogbot_logtool.robot.robot_model.robot_of_urdf import (
    NamedLeg,
    RobotOfUrdf,
    find_legs,
    read_robot,
)
from dogbot_logtool.robot.selection import Selection

RATE_HZ: Final = 200.0
"""At which legs are looked at, at most."""
SLOWEST_S: Final = 0.04
"""s between two joint states, beyond which they tell no contact."""
SHORTEST_S: Final = 0.04
"""s: shorter swings and stances are none."""
TURNS_S: Final = 0.1
"""s before and after a time, over which turns by the feet are averaged."""
_FEWEST: Final = 20
"""Joint states at least."""
_WORLD: Final = "odom"


@dataclass(frozen=True, slots=True)
class _Columns:
    """Joints of all legs at n times."""

    log_time: Ints
    stamp: Ints
    time: Ints
    """(n,) ns, on the clock that can be used; strictly increasing."""
    clock: TimeSource
    topic: str
    position: Mapping[str, Floats]
    """(n,) rad or m, by the joint's name; also `effort`, N m or N."""
    effort: Mapping[str, Floats]

    @property
    def seconds(self) -> Floats:
        """(n,) s since the first."""
        return np.asarray((self.time - self.time[0]) / 1e9)


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


def median_positions(tables: Sequence[JointTable]) -> dict[str, float]:
    """Return the usual position of each recorded joint, rad or m."""
    found: dict[str, float] = {}
    for table in tables:
        for column, name in enumerate(table.names):
            values = table.samples.position[:, column]
            values = values[np.isfinite(values)]
            if len(values):
                found.setdefault(name, float(median_of(values)))
    return found


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
    legs, axis = find_legs(robot, median_positions(recording.joints)) if robot else ((), "+x")
    columns = _columns(recording, legs) if legs else None
    reason = model.why_none or _why_not(recording, legs, columns)
    if robot is None or columns is None or reason:
        return recording, _without_legs(selection, reason, model.call) if lacks_feet else selection
    mass = selection.robot.mass_kg or robot.mass_kg
    found = _estimate(recording, selection, legs, columns, robot, mass)
    named = replace(
        selection.robot,
        mass_kg=mass if lacks_feet else selection.robot.mass_kg,
        forward_axis=axis if selection.robot_is_guessed else selection.robot.forward_axis,
        base_frame=selection.robot.base_frame or _base_frame(recording, robot),
    )
    recording = replace(recording, base=found.base if lacks_base else recording.base)
    findings = [*selection.findings]
    if lacks_base:
        named = replace(named, world_frame=named.world_frame or _WORLD)
        findings = [each for each in findings if each.code != "NO_BASE"]
        findings.append(_of_base(found))
    if not lacks_feet:
        recording = replace(recording, feet=_with_points(recording, selection, legs, found))
    if lacks_feet:
        feet = tuple(
            Foot(leg.name, columns.topic, leg_position=leg.position, frame=leg.leg.foot)
            for leg in legs
        )
        named = replace(named, feet=feet)
        recording = replace(recording, feet=found.samples)
        findings = [each for each in findings if not _is_settled(each, recording)]
        findings += [_of_contact(found, columns), *_of_efforts(found)]
    selection = replace(
        selection,
        robot=named,
        findings=tuple(findings),
        contact_from=found.contact_from if lacks_feet else "",
        base_from_legs=lacks_base,
    )
    return recording, selection


def _with_points(
    recording: Recording, selection: Selection, legs: Sequence[NamedLeg], found: "_Found"
) -> tuple[Samples, ...]:
    """Return sensors' samples with the places where their legs rest, if sensors tell none."""
    if selection.has_points:
        return recording.feet
    of_leg = {leg.position: samples for leg, samples in zip(legs, found.samples, strict=True)}
    feet = []
    for foot, samples in zip(selection.robot.feet, recording.feet, strict=True):
        told = of_leg.get(foot.leg_position) if foot.leg_position else None
        if told is None or not len(samples.log_time):
            feet.append(samples)
            continue
        row = nearest_rows(told.log_time, samples.log_time)
        near = np.abs(told.log_time[row] - samples.log_time) <= SLOWEST_S * 1e9
        place = np.where(near[:, None], told.position[row], np.nan)
        feet.append(replace(samples, position=place))
    return tuple(feet)


def _named_as_described(recording: Recording, robot: RobotOfUrdf) -> Recording:
    """Name joints as the description does, where none is, but for namespaces and capitals."""
    described = {joint.name.lower(): joint.name for joint in robot.joints if joint.kind != "fixed"}
    told = [name for table in recording.joints for name in table.names]
    if not set(described.values()).isdisjoint(told):
        return recording
    short = {name: name.replace(":", "/").rpartition("/")[2].lower() for name in told}
    if len(set(short.values())) < len(short):
        return recording
    names = {name: described.get(last, name) for name, last in short.items()}
    tables = (
        replace(table, names=tuple(names[name] for name in table.names))
        for table in recording.joints
    )
    return replace(recording, joints=tuple(tables))


def _is_settled(finding: Finding, recording: Recording) -> bool:
    """Tell whether a finding is about feet that are known now, or takes joints for feet."""
    joints = (f"{table.topic}:" in finding.text for table in recording.joints)
    return finding.code == "NO_FEET" or (finding.code == "FEET_UNSURE" and any(joints))


def _base_frame(recording: Recording, robot: RobotOfUrdf) -> str:
    """Return the base's frame: that of the poses, where the description has it."""
    names = {name for joint in robot.joints for name in (joint.parent, joint.child)}
    told = [each.strip("/") for each in recording.base_frames]
    return next((each for each in told if each in names), robot.base)


def _why_not(recording: Recording, legs: Sequence[NamedLeg], columns: _Columns | None) -> str:
    """Say why joint states tell nothing of the feet; empty if they do."""
    if not legs:
        return "the robot description has no two legs: chains of joints that end below the base"
    if columns is None:
        told = {name for table in recording.joints for name in table.names}
        lacking = [name for leg in legs for name in leg.leg.measured if name not in told]
        names = ", ".join(dict.fromkeys(lacking))
        if not names:
            return "too few joint states tell the positions of all joints of the legs"
        return f"joint states do not tell of {names}, which the robot description has"
    interval = float(median_of(np.diff(columns.time))) / 1e9
    if interval > SLOWEST_S:
        return f"joint states come {1.0 / interval:.3g} times a second, too rarely"
    return ""


def _without_legs(selection: Selection, reason: str, call: str) -> Selection:
    """Say why there is no gait, in place of what says that there are no topics of feet."""
    findings = [each for each in selection.findings if each.code != "NO_FEET"]
    text = f"no topic tells of feet, so there is no gait, and joints do not tell: {reason}"
    text += f"; with it, this measures the gait: {call}" if call else ""
    return replace(selection, findings=(*findings, Finding("NO_FEET", text, command=call)))


def _columns(recording: Recording, legs: Sequence[NamedLeg]) -> _Columns | None:
    """Return the joints of all legs, at the times of the topic that tells of most of them."""
    wanted = dict.fromkeys(name for leg in legs for name in leg.leg.measured)
    table_of = {name: table for table in reversed(recording.joints) for name in table.names}
    if any(name not in table_of for name in wanted):
        return None
    tables = [table_of[name] for name in wanted]
    main = max(tables, key=tables.count)
    checks = {t.topic: check_stamps(t.topic, t.samples.stamp, t.samples.log_time) for t in tables}
    stamped = all(check.mostly_usable for check in checks.values())
    clock = TimeSource.HEADER if stamped else TimeSource.LOG
    own = [main.names.index(name) for name in wanted if table_of[name] is main]
    usable = all_finite(main.samples.position[:, own])
    if stamped:
        usable &= checks[main.topic].usable
    rows = np.flatnonzero(usable)
    rows = rows[advancing(clock.of(main.samples)[rows])]
    rows = rows[first_at_each_tick(clock.of(main.samples)[rows], RATE_HZ)]
    if len(rows) < _FEWEST:
        return None
    time = clock.of(main.samples)[rows]
    position, effort = (
        {
            name: values[rows, column].astype(np.float64)
            if table is main
            else _interpolated(time, clock.of(table.samples), values[:, column])
            for name, table in zip(wanted, tables, strict=True)
            for column in [table.names.index(name)]
            for values in [getattr(table.samples, what)]
        }
        for what in ("position", "effort")
    )
    if not all(np.isfinite(each).all() for each in position.values()):
        return None
    times = main.samples.log_time[rows], main.samples.stamp[rows], time
    return _Columns(*times, clock, main.topic, position, effort)


def _interpolated(at: Ints, time: Ints, values: Floats) -> Floats:
    """(n,) values of another topic; NaN where all are."""
    rows = np.flatnonzero(np.isfinite(values))
    rows = rows[advancing(time[rows])]
    if not len(rows):
        return np.full(len(at), np.nan)
    first = time[rows[0]]
    return np.asarray(np.interp(at - first, time[rows] - first, values[rows]))


@dataclass(frozen=True, slots=True)
class _Found:
    """What legs tell."""

    samples: tuple[Samples, ...]
    base: Odometry
    contact_from: Literal["joint_torques", "kinematics"]
    why_no_force: str
    inertial: Inertial
    turns_from: str
    names: tuple[str, ...]


def _estimate(
    recording: Recording,
    selection: Selection,
    legs: Sequence[NamedLeg],
    columns: _Columns,
    robot: RobotOfUrdf,
    mass_kg: float | None,
) -> _Found:
    """Work out contacts, forces and poses."""
    seconds = columns.seconds
    motions = []
    for leg in legs:
        positions = np.stack([columns.position[name] for name in leg.leg.measured], axis=1)
        motions.append((leg_motion(leg.leg, positions), estimated.slopes(seconds, positions)))
    inertial, turns_from = _inertial(recording, selection, columns, robot)
    points = np.stack(
        [motion.foot - motion.leg.radius_m * inertial.up for motion, _ in motions], axis=1
    )
    velocity = np.stack(
        [
            np.einsum("nik,nk->ni", motion.jacobian(points[:, foot])[0], rate)
            for foot, (motion, rate) in enumerate(motions)
        ],
        axis=1,
    )
    ground = estimated.resting_feet(seconds, points, velocity, inertial.turn, inertial.up)
    if not turns_from:
        inertial = _turned_by_feet(columns, points, ground.resting, inertial)
        ground = estimated.resting_feet(seconds, points, velocity, inertial.turn, inertial.up)
    force, why = _forces(columns, [motion for motion, _ in motions], points, inertial, mass_kg)
    standing = ground.resting
    if force is not None:
        vertical = np.einsum("nfi,ni->nf", force, inertial.up)
        standing = estimated.loaded_feet(seconds, vertical, (mass_kg or 0.0) * GRAVITY_MPS2, ground)
    standing = np.stack([_debounced(columns.time, each) for each in standing.T], axis=1)
    base = _base(columns, points, ground.velocity(standing), standing, inertial)
    placed = _placed(recording, columns, base) if selection.odometry else base
    samples = tuple(
        _samples(columns, foot, standing[:, foot], points[:, foot], force, placed)
        for foot in range(len(legs))
    )
    return _Found(
        samples=samples,
        base=base,
        contact_from="kinematics" if force is None else "joint_torques",
        why_no_force=why,
        inertial=inertial,
        turns_from=turns_from,
        names=tuple(leg.name for leg in legs),
    )


def _debounced(time: Ints, standing: Flags) -> Flags:
    rule = ContactRule(on_n=1.0, off_n=0.0, debounce_s=SHORTEST_S)
    begin, end, _, _ = find_stances(time, standing, rule)
    change = np.zeros(len(time) + 1, np.int64)
    np.add.at(change, begin, 1)
    np.add.at(change, end, -1)
    down = np.cumsum(change[:-1]) > 0
    down[-1:] |= standing[-1:] & down[-2:-1]
    return np.asarray(down)


def _inertial(
    recording: Recording, selection: Selection, columns: _Columns, robot: RobotOfUrdf
) -> tuple[Inertial, str]:
    """Return how the base leans and turns, and by what: its inertial unit, else its poses."""
    readings = recording.accelerations
    if readings is not None:
        read, times = readings.samples, columns.clock.of(readings.samples)
        reach = round(LONG_S * 1e9)
        near = (times >= columns.time[0] - reach) & (times <= columns.time[-1] + reach)
        rows = np.flatnonzero(near & all_finite(read.vector) & all_finite(read.turn_rate))
        rows = rows[advancing(times[rows])]
        if len(rows) >= _FEWEST:
            seconds = (times[rows] - columns.time[0]) / 1e9
            turn = np.array([_mounting(readings.frames, robot)])
            told = rotate(turn, read.vector[rows]), rotate(turn, read.turn_rate[rows])
            return inertial_at(columns.seconds, seconds, *told, GRAVITY_MPS2), "a gyroscope"
    if selection.odometry:
        angles = base_history(recording.base, columns.clock).angles_at(columns.time)
        if np.isfinite(angles).any():
            return by_attitude(columns.seconds, _filled(angles), GRAVITY_MPS2), "its poses"
    return level(len(columns.time), GRAVITY_MPS2), ""


def _mounting(frames: Sequence[str], robot: RobotOfUrdf) -> Floats:
    """(4,) x, y, z, w, of an inertial unit's frame in the base's, by fixed joints."""
    above = {joint.child: joint for joint in robot.joints if joint.kind == "fixed"}
    turn = np.array([[0.0, 0.0, 0.0, 1.0]])
    link = frames[0].strip("/") if len(frames) == 1 else robot.base
    while link != robot.base and link in above:
        turn = multiply(np.array([above[link].rotation]), turn)
        link = above[link].parent
    return np.asarray(turn[0])


def _turned_by_feet(
    columns: _Columns, points: Floats, resting: Flags, inertial: Inertial
) -> Inertial:
    """Return readings with the turn about the vertical that the resting feet tell."""
    turns = leg_odometry(columns.time, points, resting).turn_rate[:, 2]
    known = np.flatnonzero(np.isfinite(turns))
    if not len(known):
        return inertial
    rates = np.interp(np.arange(len(columns.time)), known, turns[known])
    around = min(2 * round(TURNS_S / float(median_of(np.diff(columns.seconds)))) + 1, len(rates))
    rates = np.convolve(np.pad(rates, around // 2, "edge"), np.ones(around) / around, "valid")
    turn = inertial.turn.copy()
    turn[:, 2] = rates[: len(turn)]
    return replace(inertial, turn=turn)


def _filled(values: Floats) -> Floats:
    """(n, k) with the nearest known values in place of NaN."""
    row = np.arange(len(values))
    known = np.flatnonzero(np.isfinite(values).all(axis=1))
    return np.stack([np.interp(row, known, column[known]) for column in values.T], axis=1)


def _forces(
    columns: _Columns,
    motions: Sequence[LegMotion],
    points: Floats,
    inertial: Inertial,
    mass_kg: float | None,
) -> tuple[Floats | None, str]:
    """Return (n, f, 3) N along the base's axes; None, and why, where efforts tell none."""
    efforts = [
        np.stack([columns.effort[name] for name in motion.leg.measured], axis=1)
        for motion in motions
    ]
    lacking = sum(not np.isfinite(each).all() for each in efforts)
    if lacking:
        empty = not any(np.isfinite(each).any() for each in efforts)
        return None, "efforts are empty" if empty else "some joints tell no effort"
    force = estimated.ground_forces(columns.seconds, motions, points, efforts, inertial.felt)
    vertical = np.einsum("nfi,ni->nf", force, inertial.up)
    if not any(each.any() for each in efforts):
        return None, "efforts are constantly zero"
    why = estimated.effort_fault(vertical, None if mass_kg is None else mass_kg * GRAVITY_MPS2)
    return (None if why else force), why


def _base(
    columns: _Columns, points: Floats, velocity: Floats, standing: Flags, inertial: Inertial
) -> Odometry:
    """Add up the velocities that standing feet tell; the height is that over these feet."""
    seconds = columns.seconds
    step = np.diff(seconds)
    step[step > LONGEST_STEP_S] = 0.0
    # Where no foot surely rests, the accelerometer tells how the velocity changes.
    own = inertial.felt - GRAVITY_MPS2 * inertial.up
    gained = np.zeros_like(velocity)
    gained[1:] = np.cumsum((own[1:] + own[:-1]) / 2.0 * step[:, None], axis=0)
    known = np.isfinite(velocity[:, 0]).any()
    filled = gained + _filled(velocity - gained) if known else np.zeros_like(velocity)
    angles = np.zeros((len(seconds), 3))
    angles[:, :2] = inertial.roll_pitch
    rate = inertial.yaw_rate
    angles[1:, 2] = np.cumsum((rate[1:] + rate[:-1]) / 2.0 * step)
    turned = from_roll_pitch_yaw(angles)
    moved = rotate(turned, filled)
    position = np.zeros((len(seconds), 3))
    position[1:] = np.cumsum((moved[1:] + moved[:-1]) / 2.0 * step[:, None], axis=0)
    position[:, 2] = _height(seconds, points, standing, inertial.up)
    return Odometry(columns.log_time, columns.stamp, position, turned, filled, inertial.turn)


def _height(seconds: Floats, points: Floats, standing: Flags, up: Floats) -> Floats:
    """(n,) m, of the base over the mean of the standing feet."""
    below = np.where(standing, -np.einsum("nfi,ni->nf", points, up), 0.0)
    count = standing.sum(axis=1)
    some = np.flatnonzero(count)
    if not len(some):
        return np.zeros(len(seconds))
    heights = below.sum(axis=1)[some] / count[some]
    return np.asarray(np.interp(seconds, seconds[some], heights))


def _placed(recording: Recording, columns: _Columns, base: Odometry) -> Odometry:
    """Return the recorded poses at the times of joint states."""
    history = base_history(recording.base, columns.clock)
    turned = from_roll_pitch_yaw(history.angles_at(columns.time))
    return replace(base, position=history.position_at(columns.time), orientation=turned)


def _samples(
    columns: _Columns,
    foot: int,
    standing: Flags,
    points: Floats,
    force: Floats | None,
    base: Odometry,
) -> Samples:
    """Return contact samples, with forces and points in the world."""
    count = len(columns.time)
    nothing = np.full((count, 3), np.nan)
    place = np.where(standing[:, None], base.position + rotate(base.orientation, points), np.nan)
    push = np.zeros((count, 3))
    if force is not None:
        push = np.where(standing[:, None], rotate(base.orientation, force[:, foot]), 0.0)
    return Samples(
        foot=np.broadcast_to(np.int64(foot), count),
        log_time=columns.log_time,
        stamp=columns.stamp,
        in_contact=standing,
        force=push,
        in_world=np.ones(count, np.bool_),
        points=np.isfinite(place[:, 0]).astype(np.int64),
        position=place,
        normal=nothing,
    )


def _of_base(found: _Found) -> Finding:
    """Say that the base is worked out from the legs."""
    how = found.turns_from or "the feet alone"
    lean = "by the accelerometer" if found.inertial.tells_up else "taken as none"
    text = (
        "the log has no poses of the base: they are worked out from the standing feet (leg "
        f"odometry), with turns by {how}, roll and pitch {lean}; in a physics engine, speeds were "
        "within 4 %; place and heading drift"
    )
    return Finding("BASE_FROM_LEGS", text)


def _of_efforts(found: _Found) -> Iterator[Finding]:
    """Yield why efforts are no torques: then work is none, either."""
    if found.why_no_force.startswith(estimated.TOO_MUCH):
        text = f"no work is known: {found.why_no_force}"
        yield Finding("JOINT_VALUES", text, "legs.absolute_work_j", cases=("efforts",))
    if found.why_no_force.startswith(estimated.WRONG_SIGN):
        yield Finding("EFFORT_SIGN", found.why_no_force, "legs.positive_work_j", feet=found.names)


def _of_contact(found: _Found, columns: _Columns) -> Finding:
    """Say that contact is estimated, and from what."""
    if found.contact_from == "joint_torques":
        text = (
            f"contacts and forces of the feet are estimated from positions and efforts of "
            f"{columns.topic}: in a physics engine, contact times were within 0.03 of a stride, "
            "vertical forces within 0.15 body weights rms, their sum 0.93 to 1.0 of the weight"
        )
        return Finding("CONTACT_ESTIMATED", text)
    text = (
        f"contacts of the feet are estimated from the motion of the legs ({columns.topic}): "
        "beside a physics engine and the sensors of a Go1, times in contact were within 0.1 of a "
        f"stride; there are no forces: {found.why_no_force}"
    )
    return Finding("CONTACT_ESTIMATED", text)
