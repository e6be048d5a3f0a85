"""What estimators do to poses and their world: freeze, repeat, turn, step, drift, forget a part."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tests.truth.geometry import Floats, about_axis, inverse, product, turned
from tests.truth.recording import BaseRecording, Disturbance, Recording, at_times, of_base


def feet_in_base(recording: Recording) -> Recording:
    """Let one topic tell contact and place of all feet, in the base's axes.

    The places are those against the true base: apply it before the base is disturbed.
    """
    base = recording.base
    places = []
    for foot in recording.feet:
        turn = at_times(foot.time, base, base.orientation)
        turn /= np.linalg.norm(turn, axis=1)[:, None]
        at = foot.point - at_times(foot.time, base, base.position)
        places.append(turned(inverse(turn), at))
    return replace(recording, kind="spot", places=tuple(places))


def feet_in_tf(recording: Recording) -> Recording:
    """Let transforms tell where the frames of the feet's force sensors are on the true base."""
    return replace(feet_in_base(recording), kind="wrench", has_tf=True)


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
def yaw_off(base: BaseRecording, angle_rad: float, from_s: float = 0.0) -> BaseRecording:
    """Let the body's axes be turned against the body, from a time on."""
    turn = _about_z(base, np.where(base.time >= from_s, angle_rad, 0.0))
    return replace(base, orientation=product(base.orientation, turn))


@of_base
def relocalised(
    base: BaseRecording, at_s: float, angle_rad: float, metres: Sequence[float] = (0.0, 0.0, 0.0)
) -> BaseRecording:
    """Let a localisation turn and move the world about the base at once."""
    late = base.time >= at_s
    turn, centre = _about_z(base, np.where(late, angle_rad, 0.0)), base.position[np.argmax(late)]
    return replace(
        base,
        position=turned(turn, base.position - centre) + centre + np.outer(late, metres),
        orientation=product(turn, base.orientation),
        velocity=turned(turn, base.velocity),
    )


@of_base
def orientation_constant(base: BaseRecording) -> BaseRecording:
    """Let the orientation be that of the first pose for ever."""
    return replace(base, orientation=np.tile(base.orientation[:1], (len(base.time), 1)))


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


def of_robot(name: str) -> Disturbance:
    """Let the only poses be those of another robot, which goes elsewhere."""

    def change(recording: Recording) -> Recording:
        other = relocalised(0.0, 1.0, (5.0, -3.0, 0.0))(recording)
        moved = replace(other.base, position=other.base.position * [1.6, 1.6, 1.0])
        return replace(recording, base=moved, odometry=f"/{name}/odom")

    return change


@of_base
def flat(base: BaseRecording) -> BaseRecording:
    """Let poses be those of a plane: z, roll and pitch stay zero."""
    ahead = turned(base.orientation, np.tile([1.0, 0.0, 0.0], (len(base.time), 1)))
    orientation = about_axis(2, np.arctan2(ahead[:, 1], ahead[:, 0]))
    return replace(base, position=base.position * [1.0, 1.0, 0.0], orientation=orientation)


def _moved(base: BaseRecording, by: Floats) -> BaseRecording:
    return replace(base, position=base.position + by)


@of_base
def from_zero(base: BaseRecording) -> BaseRecording:
    """Let the odometry begin at the origin, wherever the base is."""
    return _moved(base, -base.position[0])


def points_drifting(share: float) -> Disturbance:
    """Let contact points be placed by another odometry, which drifts by a share of the way."""

    def change(recording: Recording) -> Recording:
        base, level = recording.base, share * np.array([1.0, 1.0, 0.0])
        return recording.each_foot(
            lambda _, foot: replace(
                foot, point=foot.point + level * at_times(foot.time, base, base.position)
            )
        )

    return change


@of_base
def drifting(base: BaseRecording, metres_per_metre: float) -> BaseRecording:
    """Let the odometry overrate the way by a part of it, sideways."""
    way = np.linalg.norm(base.position - base.position[0], axis=1)
    return _moved(base, np.outer(way * metres_per_metre, (0.0, 1.0, 0.0)))


@of_base
def rising(base: BaseRecording, metres_per_second: float) -> BaseRecording:
    """Let z of the odometry drift."""
    return _moved(base, np.outer(base.time * metres_per_second, (0.0, 0.0, 1.0)))


@of_base
def leaning(base: BaseRecording, at_s: float, metres: Sequence[float]) -> BaseRecording:
    """Let the body lean elsewhere over its feet from some moment on, within a second."""
    part = np.clip(base.time - at_s, 0.0, 1.0)
    return _moved(base, np.outer(part * part * (3.0 - 2.0 * part), metres))


@of_base
def jump(base: BaseRecording, at_s: float, metres: Sequence[float]) -> BaseRecording:
    """Let the odometry count from another place, from a time on."""
    return _moved(base, np.outer(base.time >= at_s, metres))


@of_base
def pose_noise(base: BaseRecording, std_m: float) -> BaseRecording:
    """Add white noise to the base's position."""
    return _moved(base, np.random.default_rng(0).normal(0.0, std_m, base.position.shape))


@of_base
def restamped(base: BaseRecording, seconds: float) -> BaseRecording:
    """Let a recorder stamp the odometry anew, late: by stamps and log times alike."""
    late = round(seconds * 1e9)
    return replace(base, stamp=base.stamp + late, log_time=base.log_time + late)


def z_down(recording: Recording) -> Recording:
    """Let base, contact points and forces be in a world with z down and y to the right."""
    flip, turn = np.array([1.0, -1.0, -1.0]), np.array([1.0, -1.0, -1.0, 1.0])
    base = recording.base
    turned_base = replace(
        base,
        position=base.position * flip,
        orientation=base.orientation * turn,
        velocity=base.velocity * flip,
    )
    return replace(recording, base=turned_base).each_foot(
        lambda _, foot: replace(
            foot, force=foot.force * flip, point=foot.point * flip, normal=foot.normal * flip
        )
    )


def swapped(first: str, second: str) -> Disturbance:
    """Let two feet's sensors speak on each other's topics."""

    def change(recording: Recording) -> Recording:
        rows = [recording.robot.feet.index(name) for name in (first, second)]
        feet = list(recording.feet)
        feet[rows[0]], feet[rows[1]] = feet[rows[1]], feet[rows[0]]
        return replace(recording, feet=tuple(feet))

    return change


@of_base
def y_up(base: BaseRecording, *, body: bool) -> BaseRecording:
    """Let motion capture count in a world whose y is up, and x forward.

    Args:
        base: its poses.
        body: whether the body's y is up, too, as that of a rigid body that was defined in it.
    """
    turn = about_axis(0, np.full(len(base.time), -np.pi / 2.0))
    orientation = product(turn, base.orientation)
    return replace(
        base,
        position=turned(turn, base.position),
        orientation=product(orientation, inverse(turn)) if body else orientation,
        velocity=turned(turn, base.velocity),
    )
