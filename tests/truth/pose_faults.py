"""What estimators do to poses: freeze, repeat, count in other units, turn, step, forget a part."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tests.truth.recording import (
    BaseRecording,
    Disturbance,
    Floats,
    Recording,
    about_axis,
    inverse,
    of_base,
    product,
    turned,
    vector_messages,
)
from tests.truth.robots import GRAVITY_MPS2
from tests.truth.time_faults import slow_simulation


def feet_in_base(recording: Recording) -> Recording:
    """Let one topic tell contact and place of all feet, in the base's axes.

    The places are those against the true base: apply it before the base is disturbed.
    """
    base = recording.base
    places = []
    for foot in recording.feet:
        columns = [np.interp(foot.time, base.time, axis) for axis in base.position.T]
        turn = np.stack([np.interp(foot.time, base.time, a) for a in base.orientation.T], axis=1)
        turn /= np.linalg.norm(turn, axis=1)[:, None]
        places.append(turned(inverse(turn), foot.point - np.stack(columns, axis=1)))
    return replace(recording, kind="spot", places=tuple(places))


def feet_in_tf(recording: Recording) -> Recording:
    """Let transforms tell where the frames of the feet's force sensors are on the true base."""
    return replace(feet_in_base(recording), kind="wrench", has_tf=True)


def with_gyroscope(noise: float = 0.02) -> Disturbance:
    """Let an inertial unit tell accelerations and turns of the true base: apply it first."""

    def change(recording: Recording) -> Recording:
        base = recording.base
        seconds, back = base.time, inverse(base.orientation)
        moves = np.gradient(np.gradient(base.position, seconds, axis=0), seconds, axis=0)
        felt = turned(back, moves + np.array([0.0, 0.0, GRAVITY_MPS2]))
        # Of small turns, the vector part is half of the turn.
        half = product(back[:-1], base.orientation[1:])[:, :3]
        rate = 2.0 * half / np.diff(seconds)[:, None]
        rate = np.concatenate([rate, rate[-1:]])
        both = np.concatenate([felt, rate], axis=1)
        both += np.random.default_rng(3).normal(0.0, noise, both.shape)
        imu = vector_messages("/imu/data", "imu", seconds, both)
        return replace(recording, beside=(*recording.beside, imu))

    return change


def places_unfilled(recording: Recording) -> Recording:
    """Let a driver fill in contact only: all places are zero."""
    return replace(recording, places=tuple(np.zeros_like(each) for each in recording.places))


@of_base
def frozen(
    base: BaseRecording, from_s: float = 0.0, *, until_s: float = np.inf, with_twist: bool = True
) -> BaseRecording:
    """Let every message from a time on repeat the pose of that time, and perhaps no twist."""
    late = (base.time >= from_s) & (base.time < until_s)
    rows = np.where(late, np.argmax(late), np.arange(len(late)))
    held = replace(base, position=base.position[rows], orientation=base.orientation[rows])
    return held if with_twist else replace(held, velocity=np.zeros_like(base.velocity))


@of_base
def zeros(
    base: BaseRecording, orientation: tuple[float, ...] = (0.0, 0.0, 0.0, 1.0)
) -> BaseRecording:
    """Let nothing be filled in."""
    none, turn = np.zeros_like(base.position), np.tile(orientation, (len(base.time), 1))
    return replace(base, position=none, orientation=turn, velocity=none)


@of_base
def repeated(base: BaseRecording, rate_hz: float) -> BaseRecording:
    """Let messages repeat an estimate that is made less often."""
    made = np.searchsorted(base.time, np.floor(base.time * rate_hz + 1e-9) / rate_hz - 1e-9)
    return replace(base, position=base.position[made], orientation=base.orientation[made])


@of_base
def rarely(base: BaseRecording, rate_hz: float) -> BaseRecording:
    """Let messages come less often."""
    return base.pick(np.flatnonzero(np.diff(np.floor(base.time * rate_hz + 1e-9), prepend=-1.0)))


@of_base
def silent(base: BaseRecording, from_s: float, until_s: float = np.inf) -> BaseRecording:
    """Let no messages come for a while."""
    return base.pick((base.time < from_s) | (base.time >= until_s))


@of_base
def scaled(base: BaseRecording, factor: float, *, with_twist: bool = True) -> BaseRecording:
    """Let positions be in another unit, the twist too unless it is a sensor of its own."""
    velocity = base.velocity * (factor if with_twist else 1.0)
    return replace(base, position=base.position * factor, velocity=velocity)


def _about_z(base: BaseRecording, angle: Floats | float) -> Floats:
    return about_axis(2, np.broadcast_to(np.asarray(angle, np.float64), (len(base.time),)))


@of_base
def positions_turned(base: BaseRecording, angle_rad: float) -> BaseRecording:
    """Let positions be of a frame that is turned against that of orientations."""
    turn = _about_z(base, angle_rad)
    position, velocity = turned(turn, base.position), turned(turn, base.velocity)
    return replace(base, position=position, velocity=velocity)


@of_base
def yaw_off(base: BaseRecording, angle_rad: float) -> BaseRecording:
    """Let the body's axes be turned against the body."""
    return replace(base, orientation=product(base.orientation, _about_z(base, angle_rad)))


@of_base
def started_anywhere(
    base: BaseRecording, metres: tuple[float, float, float], angle_rad: float
) -> BaseRecording:
    """Let odometry begin at another place, with another heading: nothing is wrong with that."""
    return _turned(base, np.full(len(base.time), angle_rad), metres)


def _turned(
    base: BaseRecording, angle_rad: Floats, metres: Sequence[float] | Floats, about: int = 0
) -> BaseRecording:
    """Turn and move the world of poses about that of a row."""
    turn, centre = _about_z(base, angle_rad), base.position[about]
    return replace(
        base,
        position=turned(turn, base.position - centre) + centre + np.asarray(metres),
        orientation=product(turn, base.orientation),
        velocity=turned(turn, base.velocity),
    )


@of_base
def orientation_constant(base: BaseRecording) -> BaseRecording:
    """Let the orientation be that of the first pose for ever."""
    return replace(base, orientation=np.tile(base.orientation[:1], (len(base.time), 1)))


@of_base
def relocalised(
    base: BaseRecording, at_s: float, angle_rad: float, metres: tuple[float, float] = (0.0, 0.0)
) -> BaseRecording:
    """Let a localisation turn and move the world about the base at once."""
    late = base.time >= at_s
    moved = np.outer(late, (*metres, 0.0))
    return _turned(base, np.where(late, angle_rad, 0.0), moved, int(np.argmax(late)))


@of_base
def yaw_steps(base: BaseRecording, at_s: float, angle_rad: float) -> BaseRecording:
    """Let the yaw alone step at once."""
    steps = np.where(base.time >= at_s, angle_rad, 0.0)
    return replace(base, orientation=product(base.orientation, _about_z(base, steps)))


def of_link(metres: tuple[float, float, float], frame: str = "imu_link") -> Disturbance:
    """Let poses be those of another link, and a static transform tell where it is."""

    def change(recording: Recording) -> Recording:
        base = recording.base
        arm = turned(base.orientation, np.tile(np.array(metres), (len(base.time), 1)))
        statics = ((frame, (*metres, 0.0, 0.0, 0.0, 1.0)),)
        return replace(
            recording,
            base=replace(base, position=base.position + arm),
            child_frame=frame,
            statics=statics,
        )

    return change


def quarter_speed(*, feet: bool) -> Disturbance:
    """Let a simulation go at a quarter of real time, and feet, or the base, have no stamps."""

    def change(recording: Recording) -> Recording:
        slow = slow_simulation(4.0)(recording)
        if feet:
            return slow.each_foot(lambda _, foot: replace(foot, stamp=np.zeros_like(foot.stamp)))
        return replace(slow, base=replace(slow.base, stamp=np.zeros_like(slow.base.stamp)))

    return change


def of_robot(name: str) -> Disturbance:
    """Let the only poses be those of another robot, which goes elsewhere."""

    def change(recording: Recording) -> Recording:
        other = started_anywhere((5.0, -3.0, 0.0), 1.0)(recording)
        moved = replace(other.base, position=other.base.position * [1.6, 1.6, 1.0])
        return replace(recording, base=moved, odometry=f"/{name}/odom")

    return change


@of_base
def flat(base: BaseRecording) -> BaseRecording:
    """Let poses be those of a plane: z, roll and pitch stay zero."""
    ahead = turned(base.orientation, np.tile([1.0, 0.0, 0.0], (len(base.time), 1)))
    orientation = about_axis(2, np.arctan2(ahead[:, 1], ahead[:, 0]))
    return replace(base, position=base.position * [1.0, 1.0, 0.0], orientation=orientation)
