"""Checks of the base's poses against second witnesses: feet, twist. A pose is a sensor, too."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.base.comparison import Comparison, compare, compare_twist, usual_way_m
from dogbot_logtool.core.base.motion import FORWARD_ANGLES
from dogbot_logtool.core.base.witness import stride_windows
from dogbot_logtool.core.gait.strides import any_strides
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding, counted

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
TURNS_RAD: Final = np.radians(20.0)
"""A course that turns by more tells whether the orientation turns with it."""
TURNS_WITH: Final = 0.5
"""Least share of a witness's turn that is the same turn."""
CLIMBS_M: Final = 0.05
"""m that feet rise or fall from which poses that keep their z are planar."""


def treadmill(stats: Stats) -> Iterator[Finding]:
    """Yield that the ground moves below a base that rests."""
    if stats.ground is None:
        return
    text = (
        f"feet that stand go back alike, at {stats.ground.speed_mps:.2f} m/s, while the base stays "
        "where it is: a treadmill; path, speed and lengths are those against the ground"
    )
    yield Finding("TREADMILL", text, "base")


def frozen(stats: Stats) -> Iterator[Finding]:
    """Yield that one pose is repeated while the robot walks on."""
    found = stats.frozen
    if found is None:
        return
    seconds = timespans.total(found.spans) / 1e9
    start = stats.seconds(found.spans[:, 0])[0]
    steps = sum(len(foot.record.stances.touchdown) for foot in stats.feet)
    if found.by:
        why = f"by {found.by} the base moves at {found.moves_mps or 0.0:.2f} m/s"
        if found.turns_radps:
            why += f" and turns at {found.turns_radps:.2f} rad/s"
    else:
        why = "nothing else in the log tells whether the base stays where it is"
    text = (
        f"the pose is the same to the bit for {seconds:.1f} s from {start:.1f} s on, while the "
        f"feet step ({steps} touchdowns in the log): {why}"
    )
    names = _placed_by_poses(stats)
    cases = ("whole",) if found.whole else ("part",)
    yield Finding("POSE_FROZEN", text, "base", cases=(*cases, *_cases(names)), feet=names)


def scale(stats: Stats) -> Iterator[Finding]:
    """Yield that poses go further, or less far, than the feet walk or the twist tells."""
    names = _placed_by_poses(stats)
    for compared in _comparisons(stats):
        factor = compared.scale
        if factor is None:
            continue
        if SCALES[0] <= factor <= SCALES[1]:
            break
        walked, told = compared.walked_m
        text = (
            f"the poses go {factor:.3g} times as far as {compared.by} in {len(compared.way)} "
            f"strides, {walked:.3g} m against {told:.3g} m{_unit(factor)}"
        )
        yield Finding("POSE_SCALE", text, "base", cases=_cases(names), feet=names)
        return
    way = usual_way_m(stats.track.history, _windows(stats))
    longest = FURTHEST_LEGS * LONGEST_LEG_M * (stats.settings.mass_kg or HEAVIEST_KG) ** (1.0 / 3.0)
    if way is not None and way > longest:
        text = (
            f"the poses go {way:.3g} m in a stride, which no robot of this size does (at most "
            f"{longest:.1f} m): millimetres, another unit, or another clock?"
        )
        yield Finding("POSE_SCALE", text, "base", cases=_cases(names), feet=names)


def _unit(factor: float) -> str:
    near = [unit for number, unit in UNITS.items() if 0.8 <= factor / number <= 1.25]
    if near:
        return f": positions in {near[0]}? --set odometry_scale={1.0 / factor:.3g}"
    return ": another unit, or a clock that runs at another speed?"


def direction(stats: Stats) -> Iterator[Finding]:
    """Yield that positions go another way than the body's axes and the feet tell."""
    for compared in _comparisons(stats):
        angle = compared.direction_rad
        if angle is None:
            continue
        if abs(angle) > ASIDE_RAD:
            side = "left" if angle > 0.0 else "right"
            text = (
                f"the positions go {abs(np.degrees(angle)):.0f} degrees to the {side} of where "
                f"the base goes by {compared.by}, against its own heading, over "
                f"{len(compared.way)} strides: positions and orientation are not of one frame"
            )
            names = _placed_by_poses(stats)
            yield Finding("POSE_DIRECTION", text, "base", cases=_cases(names), feet=names)
        return


def orientation(stats: Stats) -> Iterator[Finding]:
    """Yield that the orientation does not turn although the robot does."""
    windows = _windows(stats)
    if not len(windows):
        return
    told: tuple[float, float, str] | None = None
    for compared in _comparisons(stats):
        if compared.turn is not None:
            own, other = float(compared.turn.sum()), float(compared.told_turn.sum())
            if abs(other) > TURNS_RAD and own * np.sign(other) < TURNS_WITH * abs(other):
                told = own, other, compared.by
            break
    else:
        told = _course_turns(stats, windows)
    if told is None:
        return
    text = (
        f"the orientation turns by {np.degrees(told[0]):.0f} degrees, while the robot turns by "
        f"{np.degrees(told[1]):.0f} degrees by {told[2]}"
    )
    names = _placed_by_poses(stats)
    yield Finding("POSE_ORIENTATION", text, "base", cases=_cases(names), feet=names)


def _course_turns(stats: Stats, windows: Ints) -> tuple[float, float, str] | None:
    """Return how far a course turns beside an orientation that is one to the bit.

    Returns:
        None where the orientation changes, or the course does not turn.
    """
    poses = stats.poses
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


def planar(stats: Stats) -> Iterator[Finding]:
    """Yield that poses are those of a plane: z, roll and pitch never change."""
    poses = stats.poses
    if len(poses.time) < 2 or not len(_windows(stats)):
        return
    flat = np.column_stack([poses.position[:, 2], poses.angles[:, :2]])
    if float(np.ptp(flat, axis=0).max()) > 0.0:
        return
    text = "z, roll and pitch of the poses never change: they are those of a plane"
    climbed = [float(each.told_rise.sum()) for each in _comparisons(stats) if each.by != "legs"]
    climbed = [each for each in climbed if np.isfinite(each)]
    leans = stats.witness is not None and stats.base is not None and stats.base.slope_rad
    if climbed and stats.witness is not None and abs(climbed[0]) > CLIMBS_M:
        text += f", while the feet go {climbed[0]:+.2f} m up"
        yield Finding("POSE_PLANAR", text, "base.climb_m", cases=("contradicted",))
    elif leans and leans > ASIDE_RAD / 3.0:
        text += f", while the feet's plane leans by {np.degrees(leans):.0f} degrees"
        yield Finding("POSE_PLANAR", text, "base.climb_m", cases=("contradicted",))
    elif stats.poses.position[0, 2] == 0.0:
        yield Finding("POSE_PLANAR", text, "base.climb_m")


def rate(stats: Stats) -> Iterator[Finding]:
    """Yield that poses are rare, or that most messages repeat the one before."""
    poses, period_s = stats.base_history, stats.period_s
    interval_s = poses.interval_s
    if not len(poses.time) or not period_s or not interval_s:
        return
    per_stride = period_s / interval_s
    cases = ("rare",) if per_stride < FEWEST_A_STRIDE else ()
    rates = f"{1.0 / interval_s:.2g} distinct poses a second, {per_stride:.1f} a stride"
    if poses.repeated:
        text = f"{counted(poses.repeated, 'pose')} of {poses.messages} repeat the one before: "
        yield Finding("POSE_REPEATED", f"{text}{rates}", "base", cases=cases)
    elif cases:
        text = f"there are {rates}: too few for attitude, height and margins"
        yield Finding("POSE_REPEATED", text, "base", cases=cases)


def _windows(stats: Stats) -> Ints:
    """(k, 2) ns, strides one after another while the robot walks."""
    period_s = stats.period_s
    if not period_s or len(stats.poses.time) < 2:
        return timespans.no_spans()
    walks = any_strides(stats.records, stats.fallen, stats.standing.without_steps)
    return stride_windows(timespans.merge(walks), period_s)


def _comparisons(stats: Stats) -> Iterator[Comparison]:
    """Yield comparisons of the poses, the surest first."""
    windows = _windows(stats)
    if not len(windows) or stats.ground is not None:
        return
    forward_rad = FORWARD_ANGLES[stats.settings.forward_axis]
    if stats.witness is not None:
        compared = compare(stats.poses, stats.witness, windows, forward_rad)
        if compared is not None:
            yield compared
    compared = compare_twist(stats.poses, windows, forward_rad)
    if compared is not None:
        yield compared


def _placed_by_poses(stats: Stats) -> tuple[str, ...]:
    """Return the names of the feet whose places in the world rest on the poses."""
    by_points = stats.witness is not None and stats.witness.by == "contact points"
    return () if by_points else tuple(foot.name for foot in stats.feet)


def _cases(names: tuple[str, ...]) -> tuple[str, ...]:
    return ("placed",) if names else ()
