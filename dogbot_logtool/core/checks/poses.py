"""Checks of the base's poses against second witnesses: feet, twist. A pose is a sensor, too."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Ints, median_of, percentiles_of
from dogbot_logtool.core.base.attitude import turns_and_up
from dogbot_logtool.core.base.comparison import Comparison, compare, compare_twist, usual_way_m
from dogbot_logtool.core.base.motion import FORWARD_ANGLES
from dogbot_logtool.core.base.witness import motion_in, stride_windows
from dogbot_logtool.core.gait.strides import any_strides
from dogbot_logtool.core.rotations import rotate
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding, found

SCALES: Final = (0.8, 1.25)
"""Ways by poses over those by a witness that are alike: feet roll and slip."""
UNITS: Final = {1e3: "millimetres", 1e2: "centimetres", 39.37: "inches", 3.281: "feet"}
"""Metres in what positions may be in."""
ASIDE_RAD: Final = np.radians(10.0)
"""A way that is less off its witness's is as good as mountings are."""
FURTHEST_LEGS: Final = 5.0
"""Lengths of a leg that no robot goes in a stride."""
LONGEST_LEG_M: Final = 0.25
"""m, of a robot of 1 kg; of others it grows with the cube root of their mass."""
HEAVIEST_KG: Final = 200.0
"""Assumed where the mass is not known."""
FEWEST_A_STRIDE: Final = 4.0
"""Distinct poses a stride from which they tell of attitude and height."""
MOST_OF_LOG: Final = 0.03
"""Share of the log that lies between two distinct poses from which its whole path is not known."""
TURNS_RAD: Final = np.radians(20.0)
"""A course that turns by more tells whether the orientation turns with it."""
TURNS_WITH: Final = 0.5
"""Least share of a witness's turn that is the same turn."""
LEANS_RAD: Final = np.radians(5.0)
"""An accelerometer that leans by more does not sit on a level base; mountings are as good."""
UPRIGHT: Final = np.array([0.0, 0.0, 1.0])
CLIMBS_M: Final = 0.05
"""m that feet rise or fall from which poses that keep their z are planar."""


def treadmill(walk: Walk) -> Iterator[Finding]:
    """Yield that the ground moves below a base that rests."""
    if walk.ground is None:
        return
    text = (
        f"feet that stand go back alike, at {walk.ground.speed_mps:.2f} m/s, while the base stays "
        "where it is: a treadmill; path, speed and lengths are those against the ground"
    )
    yield Finding("TREADMILL", text, "base")


def frozen(walk: Walk) -> Iterator[Finding]:
    """Yield that one pose is repeated while the robot walks on."""
    still = walk.frozen
    if still is None:
        return
    why = "nothing else in the log tells whether the base stays where it is"
    if still.by:
        why = f"by {still.by} the base moves at {still.moves_mps or 0.0:.2f} m/s"
        if still.turns_radps:
            why += f" and turns at {still.turns_radps:.2f} rad/s"
    case = "whole" if still.whole else "part"
    yield _doubted(
        walk,
        "POSE_FROZEN",
        *(() if walk.base_by_feet else (case,)),
        seconds=timespans.total(still.spans) / 1e9,
        at=walk.seconds(still.spans[:, 0])[0],
        steps=sum(len(foot.record.stances.touchdown) for foot in walk.feet),
        why=why,
    )


def scale(walk: Walk) -> Iterator[Finding]:
    """Yield that poses go further, or less far, than the feet walk or the twist tells."""
    for compared in _comparisons(walk):
        factor = compared.scale
        if factor is None:
            continue
        if SCALES[0] <= factor <= SCALES[1]:
            break
        walked, told = compared.walked_m
        yield _doubted(
            walk,
            "POSE_SCALE",
            factor=factor,
            by=compared.by,
            strides=len(compared.way),
            walked=walked,
            told=told,
            unit=_unit(factor),
        )
        return
    way = usual_way_m(walk.track.history, _windows(walk))
    longest = FURTHEST_LEGS * LONGEST_LEG_M * (walk.settings.mass_kg or HEAVIEST_KG) ** (1.0 / 3.0)
    if way is not None and way > longest:
        yield _doubted(walk, "POSE_SCALE", say="stride", way=way, longest=longest)


def _unit(factor: float) -> str:
    near = [unit for number, unit in UNITS.items() if 0.8 <= factor / number <= 1.25]
    if near:
        return f": positions in {near[0]}? --set odometry_scale={1.0 / factor:.3g}"
    return ": another unit, or a clock that runs at another speed?"


def direction(walk: Walk) -> Iterator[Finding]:
    """Yield that positions go another way than the body's axes and the feet tell."""
    for compared in _comparisons(walk):
        angle = compared.direction_rad
        if angle is None:
            continue
        if abs(angle) > ASIDE_RAD:
            yield _doubted(
                walk,
                "POSE_DIRECTION",
                degrees=abs(np.degrees(angle)),
                side="left" if angle > 0.0 else "right",
                by=compared.by,
                strides=len(compared.way),
            )
        return


def orientation(walk: Walk) -> Iterator[Finding]:
    """Yield that the orientation does not turn although the robot does."""
    windows = _windows(walk)
    if not len(windows):
        return
    told: tuple[float, float, str] | None = None
    for compared in _comparisons(walk):
        if compared.turn is not None:
            own, other = float(compared.turn.sum()), float(compared.told_turn.sum())
            if abs(other) > TURNS_RAD and own * np.sign(other) < TURNS_WITH * abs(other):
                told = own, other, compared.by
            break
    else:
        told = _gyroscope_turns(walk, windows) or _course_turns(walk, windows)
    if told is not None:
        own, other, by = told
        turned = np.degrees([own, other]).tolist()
        yield _doubted(walk, "POSE_ORIENTATION", own=turned[0], told=turned[1], by=by)


def _gyroscope_turns(walk: Walk, windows: Ints) -> tuple[float, float, str] | None:
    """Return how far the orientation turns and how far the gyroscope says; None: they agree."""
    turns, _ = _inertial(walk, windows)
    own = motion_in(walk.poses, windows).turn
    if not len(turns) or len(turns) != len(own):
        return None
    both = np.isfinite(turns) & np.isfinite(own)
    turned, told = float(own[both].sum()), float(turns[both].sum())
    if abs(told) > TURNS_RAD and turned * np.sign(told) < TURNS_WITH * abs(told):
        return turned, told, "the gyroscope"
    return None


def _inertial(walk: Walk, windows: Ints) -> tuple[Floats, Floats]:
    """Return turns and directions of up in windows by the inertial unit; see `turns_and_up`."""
    topic = walk.settings.imu_topic
    for each in walk.beside:
        if topic and each.topic == topic:
            return turns_and_up(each.time, each.vector, each.turn_rate, windows)
    return np.empty(0), np.empty((0, 3))


def _leans_rad(walk: Walk, windows: Ints) -> float:
    """Return how far the accelerometer leans in a quarter of the windows or more, rad.

    Where its mounting is known, from the base's upright; else from its own usual direction.
    """
    _, up = _inertial(walk, windows)
    if not len(up):
        return 0.0
    usual, mounting = median_of(up, axis=0), walk.settings.imu_mounting
    frames = () if walk.recording.accelerations is None else walk.recording.accelerations.frames
    if mounting is not None:
        up, usual = rotate(np.array([mounting]), up), UPRIGHT
    elif [name.lstrip("/") for name in frames] == [walk.frames.base]:
        usual = UPRIGHT
    cosine = np.clip(up @ usual / np.linalg.norm(usual), -1.0, 1.0)
    return float(percentiles_of(np.arccos(cosine), 75.0))


def _course_turns(walk: Walk, windows: Ints) -> tuple[float, float, str] | None:
    """Return how far a course turns beside an orientation that is one to the bit.

    Returns:
        None where the orientation changes, or the course does not turn.
    """
    poses = walk.poses
    if len(poses.time) < 2 or float(np.ptp(poses.angles, axis=0).max()) > 0.0:
        return None
    at = poses.position_at(windows.ravel())[:, :2].reshape(-1, 2, 2)
    step = at[:, 1] - at[:, 0]
    step = step[np.hypot(*step.T) > CLIMBS_M]
    if len(step) < 2:
        return None
    course = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    turned = float(course[-1] - course[0])
    return (0.0, turned, "its course") if abs(turned) > 2.0 * TURNS_RAD else None


def planar(walk: Walk) -> Iterator[Finding]:
    """Yield that poses are those of a plane: z, roll and pitch never change."""
    poses = walk.poses
    if walk.base_by_feet or len(poses.time) < 2 or not len(_windows(walk)):
        return
    flat = np.column_stack([poses.position[:, 2], poses.angles[:, :2]])
    if float(np.ptp(flat, axis=0).max()) > 0.0:
        return
    where = "base.climb_m"
    climbed = [float(each.told_rise.sum()) for each in _comparisons(walk) if each.by != "legs"]
    climbed = [each for each in climbed if np.isfinite(each)]
    leans = walk.witness is not None and walk.base is not None and walk.base.slope_rad
    if climbed and walk.witness is not None and abs(climbed[0]) > CLIMBS_M:
        feet = f", while the feet go {climbed[0]:+.2f} m up"
        yield found("POSE_PLANAR", "contradicted", where=where, while_feet=feet)
    elif leans and leans > ASIDE_RAD / 3.0:
        feet = f", while the feet's plane leans by {np.degrees(leans):.0f} degrees"
        yield found("POSE_PLANAR", "contradicted", where=where, while_feet=feet)
    elif (lean := _leans_rad(walk, _windows(walk))) > LEANS_RAD:
        feet = f", while the accelerometer leans by {np.degrees(lean):.0f} degrees"
        yield found("POSE_PLANAR", "contradicted", where=where, while_feet=feet)
    elif walk.poses.position[0, 2] == 0.0:
        yield found("POSE_PLANAR", where=where, while_feet="")


def rate(walk: Walk) -> Iterator[Finding]:
    """Yield that poses are rare, or that most messages repeat the one before."""
    poses, period_s = walk.base_history, walk.period_s
    interval_s = poses.interval_s
    if not len(poses.time) or not period_s or not interval_s:
        return
    per_stride = period_s / interval_s
    cases = ("rare",) if per_stride < FEWEST_A_STRIDE else ()
    if interval_s > MOST_OF_LOG * float(np.ptp(poses.time)) / 1e9:
        # Where the base goes after the last pose is not known.
        cases = (*cases, "short")
    rates = f"{1.0 / interval_s:.2g} distinct poses a second, {per_stride:.1f} a stride"
    if poses.repeated or cases:
        say = "plain" if poses.repeated else "rare"
        count, of = poses.repeated, poses.messages
        yield found(
            "POSE_REPEATED", *cases, where="base", say=say, repeated=count, poses=of, rates=rates
        )


def _windows(walk: Walk) -> Ints:
    """(k, 2) ns, strides one after another while the robot walks."""
    period_s = walk.period_s
    if not period_s or len(walk.poses.time) < 2:
        return timespans.no_spans()
    walks = any_strides(walk.records, walk.fallen, walk.standing.without_steps)
    return stride_windows(timespans.merge(walks), period_s)


def _comparisons(walk: Walk) -> Iterator[Comparison]:
    """Yield comparisons of the poses, the surest first."""
    windows = _windows(walk)
    if not len(windows) or walk.ground is not None or walk.base_by_feet:
        return
    forward_rad = FORWARD_ANGLES[walk.settings.forward_axis]
    if walk.witness is not None:
        compared = compare(walk.poses, walk.witness, windows, forward_rad)
        if compared is not None:
            yield compared
    compared = compare_twist(walk.poses, windows, forward_rad)
    if compared is not None:
        yield compared


def _doubted(walk: Walk, code: str, *cases: str, say: str = "", **values: object) -> Finding:
    """Return a finding about the poses, and about the feet whose places rest on them."""
    names = () if walk.base_by_feet else walk.feet_on_poses
    placed = ("placed",) if names else ()
    return found(code, *cases, *placed, where="base", say=say or "plain", feet=names, **values)
