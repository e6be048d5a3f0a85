"""What estimators do to poses: freeze, repeat, count in other units, turn, step, forget a part."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from tests.truth.recording import (
    BaseRecording,
    Disturbance,
    Floats,
    Recording,
    about_axis,
    inverse,
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


def _base(change: Callable[[BaseRecording], BaseRecording]) -> Disturbance:
    return lambda recording: replace(recording, base=change(recording.base))


def frozen(from_s: float = 0.0, *, until_s: float = np.inf, with_twist: bool = True) -> Disturbance:
    """Let every message from a time on repeat the pose of that time, and perhaps no twist."""

    def change(base: BaseRecording) -> BaseRecording:
        late = (base.time >= from_s) & (base.time < until_s)
        first = int(np.argmax(late))
        position, orientation = base.position.copy(), base.orientation.copy()
        position[late], orientation[late] = position[first], orientation[first]
        velocity = base.velocity if with_twist else np.zeros_like(base.velocity)
        return replace(base, position=position, orientation=orientation, velocity=velocity)

    return _base(change)


def zeros(base_orientation: tuple[float, ...] = (0.0, 0.0, 0.0, 1.0)) -> Disturbance:
    """Let nothing be filled in."""
    return _base(
        lambda base: replace(
            base,
            position=np.zeros_like(base.position),
            orientation=np.tile(base_orientation, (len(base.time), 1)),
            velocity=np.zeros_like(base.velocity),
        )
    )


def repeated(rate_hz: float) -> Disturbance:
    """Let messages repeat an estimate that is made less often."""

    def change(base: BaseRecording) -> BaseRecording:
        made = np.searchsorted(base.time, np.floor(base.time * rate_hz + 1e-9) / rate_hz - 1e-9)
        position, orientation = base.position[made], base.orientation[made]
        return replace(base, position=position, orientation=orientation)

    return _base(change)


def rarely(rate_hz: float) -> Disturbance:
    """Let messages come less often."""

    def change(base: BaseRecording) -> BaseRecording:
        ticks = np.floor(base.time * rate_hz + 1e-9)
        return base.pick(np.flatnonzero(np.diff(ticks, prepend=-1.0) > 0.0))

    return _base(change)


def scaled(factor: float, *, with_twist: bool = True) -> Disturbance:
    """Let positions be in another unit, the twist too unless it is a sensor of its own."""
    return _base(
        lambda base: replace(
            base,
            position=base.position * factor,
            velocity=base.velocity * (factor if with_twist else 1.0),
        )
    )


def _about_z(base: BaseRecording, angle: Floats | float) -> Floats:
    return about_axis(2, np.broadcast_to(np.asarray(angle, np.float64), (len(base.time),)))


def positions_turned(angle_rad: float) -> Disturbance:
    """Let positions be of a frame that is turned against that of orientations."""
    return _base(
        lambda base: replace(
            base,
            position=turned(_about_z(base, angle_rad), base.position),
            velocity=turned(_about_z(base, angle_rad), base.velocity),
        )
    )


def yaw_off(angle_rad: float) -> Disturbance:
    """Let the body's axes be turned against the body."""
    return _base(
        lambda base: replace(base, orientation=product(base.orientation, _about_z(base, angle_rad)))
    )


def started_anywhere(metres: tuple[float, float, float], angle_rad: float) -> Disturbance:
    """Let odometry begin at another place, with another heading: nothing is wrong with that."""
    return _base(
        lambda base: replace(
            base,
            position=turned(_about_z(base, angle_rad), base.position) + np.array(metres),
            orientation=product(_about_z(base, angle_rad), base.orientation),
            velocity=turned(_about_z(base, angle_rad), base.velocity),
        )
    )


def orientation_constant(recording: Recording) -> Recording:
    """Let the orientation be that of the first pose for ever."""
    base = recording.base
    orientation = np.tile(base.orientation[:1], (len(base.time), 1))
    return replace(recording, base=replace(base, orientation=orientation))


def relocalised(
    at_s: float, angle_rad: float, metres: tuple[float, float] = (0.0, 0.0)
) -> Disturbance:
    """Let a localisation turn and move the world about the base at once."""

    def change(base: BaseRecording) -> BaseRecording:
        late = base.time >= at_s
        turn = _about_z(base, np.where(late, angle_rad, 0.0))
        about = base.position[int(np.argmax(late))]
        step = np.where(late[:, None], np.array([*metres, 0.0]), 0.0)
        return replace(
            base,
            position=turned(turn, base.position - about) + about + step,
            orientation=product(turn, base.orientation),
            velocity=turned(turn, base.velocity),
        )

    return _base(change)


def yaw_steps(at_s: float, angle_rad: float) -> Disturbance:
    """Let the yaw alone step at once."""
    return _base(
        lambda base: replace(
            base,
            orientation=product(
                base.orientation, _about_z(base, np.where(base.time >= at_s, angle_rad, 0.0))
            ),
        )
    )


def of_link(
    metres: tuple[float, float, float], frame: str = "imu_link", *, told: bool = True
) -> Disturbance:
    """Let poses be those of another link, and perhaps a static transform tell where it is."""

    def change(recording: Recording) -> Recording:
        base = recording.base
        arm = turned(base.orientation, np.tile(np.array(metres), (len(base.time), 1)))
        statics = ((frame, (*metres, 0.0, 0.0, 0.0, 1.0)),) if told else ()
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


def flat(recording: Recording) -> Recording:
    """Let poses be those of a plane: z, roll and pitch stay zero."""
    base = recording.base
    position = base.position * [1.0, 1.0, 0.0]
    ahead = turned(base.orientation, np.tile([1.0, 0.0, 0.0], (len(base.time), 1)))
    orientation = about_axis(2, np.arctan2(ahead[:, 1], ahead[:, 0]))
    return replace(recording, base=replace(base, position=position, orientation=orientation))
