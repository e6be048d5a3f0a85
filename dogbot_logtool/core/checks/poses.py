"""Checks of the base's poses against second witnesses: feet, twist. A pose is a sensor, too."""

from collections.abc import Iterator, Sequence
from typing import Any, Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Ints, all_finite, median_of, percentiles_of
from dogbot_logtool.core.base.attitude import turns_and_up
from dogbot_logtool.core.base.comparison import (
    Comparison,
    compare,
    compare_twist,
    motion_in,
    stride_windows,
)
from dogbot_logtool.core.base.motion import FORWARD_ANGLES
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
OTHER: Final = "another unit, or a clock that runs at another speed?"
COURSE: Final = "its course"
POINTS: Final = "contact points"
LEGS: Final = "legs"
LEAST_SLOPE_RAD: Final = ASIDE_RAD / 3.0
"""Lean of the feet's plane that contact points tell surely."""
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
MOST_RISE_M: Final = 0.1
"""m by which poses may rise against the legs; also `MOST_RISE`, as a share of the way, which is
what a lean that is some degrees off makes of it."""
MOST_RISE: Final = 0.05
CLIMBS_M: Final = 0.05
"""m that feet rise or fall from which poses that keep their z are planar."""


def treadmill(walk: Walk) -> Iterator[Finding]:
    """Yield that the ground moves below a base that rests."""
    if walk.ground is not None:
        yield found("TREADMILL", where="base", speed=walk.ground.speed_mps)


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
    cases = () if walk.base_by_feet else ("whole",) if still.whole else ("part",)
    seconds = timespans.total(still.spans) / 1e9
    at = walk.seconds(still.spans[:, 0])[0]
    steps = sum(len(record.stances.touchdown) for record in walk.records)
    yield _doubted(walk, "POSE_FROZEN", *cases, seconds=seconds, at=at, steps=steps, why=why)


def contradicted(walk: Walk) -> Iterator[Finding]:
    """Yield where a second witness of the base's motion contradicts the poses, stride by stride."""
    windows = _windows(walk)
    comparisons = [*_comparisons(walk, windows)]
    yield from _scale(walk, comparisons, windows)
    yield from _direction(walk, comparisons)
    yield from _orientation(walk, comparisons, windows)
    yield from _planar(walk, comparisons, windows)
    yield from _climb(comparisons)


def feet_agree(walk: Walk) -> bool:
    """Tell whether feet that stand, by their contacts, go back as far as the poses go ahead."""
    surest = next(_comparisons(walk, _windows(walk)), None)
    if surest is None or walk.witness is None or surest.by != walk.witness.by:
        return False
    return SCALES[0] <= (surest.scale or 0.0) <= SCALES[1]


def _windows(walk: Walk) -> Ints:
    """(k, 2) ns, strides one after another while the robot walks."""
    period_s = walk.period_s
    if not period_s or len(walk.poses.time) < 2:
        return timespans.no_spans()
    walks = any_strides(walk.records, walk.fallen, walk.standing.without_steps)
    return stride_windows(timespans.merge(walks), period_s)


def _comparisons(walk: Walk, windows: Ints) -> Iterator[Comparison]:
    """Yield comparisons of the poses, the surest first."""
    if not len(windows) or walk.ground is not None or walk.base_by_feet:
        return
    forward_rad, feet = FORWARD_ANGLES[walk.settings.forward_axis], walk.witness
    if feet is not None:
        # Legs tell of the body's own axes, contact points of where fore and hind feet are.
        own = motion_in(walk.poses, windows, forward_rad)
        reference = motion_in(feet.poses, windows, forward_rad if feet.by == "legs" else 0.0)
        turn, heading = feet.tells_turn, feet.tells_heading
        by_feet = compare(feet.by, own, reference, tells_turn=turn, tells_heading=heading)
        yield from () if by_feet is None else (by_feet,)
    by_twist = compare_twist(walk.poses, windows, forward_rad)
    yield from () if by_twist is None else (by_twist,)


def _scale(walk: Walk, comparisons: Sequence[Comparison], windows: Ints) -> Iterator[Finding]:
    """Yield that poses go further, or less far, than the feet walk or the twist tells."""
    lengths = np.abs(motion_in(walk.track.history, windows).displacement)
    length_m = (
        float(median_of(lengths[np.isfinite(lengths)])) if np.isfinite(lengths).any() else 0.0
    )
    longest = FURTHEST_LEGS * LONGEST_LEG_M * (walk.settings.mass_kg or HEAVIEST_KG) ** (1.0 / 3.0)
    surest = next((each for each in comparisons if each.scale is not None), None)
    factor = 1.0 if surest is None or surest.scale is None else surest.scale
    if surest is not None and not SCALES[0] <= factor <= SCALES[1]:
        near = [each for number, each in UNITS.items() if 0.8 <= factor / number <= 1.25]
        unit = f"positions in {near[0]}? --set odometry_scale={1.0 / factor:.3g}" if near else OTHER
        yield _doubted(walk, "POSE_SCALE", factor=factor, witness=surest, unit=unit)
    elif length_m > longest:
        yield _doubted(walk, "POSE_SCALE", say="stride", way=length_m, longest=longest)


def _direction(walk: Walk, comparisons: Sequence[Comparison]) -> Iterator[Finding]:
    """Yield that positions go another way than the body's axes and the feet tell."""
    surest = next((each for each in comparisons if each.direction_rad is not None), None)
    angle = (surest and surest.direction_rad) or 0.0
    if abs(angle) > ASIDE_RAD:
        degrees, side = abs(np.degrees(angle)), "left" if angle > 0.0 else "right"
        yield _doubted(walk, "POSE_DIRECTION", degrees=degrees, side=side, witness=surest)


def _orientation(walk: Walk, comparisons: Sequence[Comparison], windows: Ints) -> Iterator[Finding]:
    """Yield that the orientation does not turn although the robot does."""
    for own, turned, by in _turns(walk, comparisons, windows):
        least = 2.0 * TURNS_RAD if by == COURSE else TURNS_RAD
        if abs(turned) > least and own * np.sign(turned) < TURNS_WITH * abs(turned):
            own_deg, deg = np.degrees([own, turned]).tolist()
            yield _doubted(walk, "POSE_DIRECTION", "constant", own=own_deg, told=deg, by=by)
            return


def _turns(
    walk: Walk, comparisons: Sequence[Comparison], windows: Ints
) -> Iterator[tuple[float, float, str]]:
    """Yield by how much poses turn and by how much a witness says; only feet are asked, if any."""
    feet = next((each for each in comparisons if each.tells_turn), None)
    if feet is not None:
        yield float(feet.own.turn.sum()), float(feet.reference.turn.sum()), feet.by
        return
    poses = walk.poses
    own = motion_in(poses, windows).turn
    turns, _ = _inertial(walk, windows)
    both = np.isfinite(own) & np.isfinite(turns)
    yield float(own[both].sum()), float(turns[both].sum()), "the gyroscope"
    # An orientation that is one to the bit, beside a course that turns.
    if len(windows) and not np.ptp(poses.angles, axis=0).any():
        step = np.diff(poses.position_at(windows.ravel())[:, :2].reshape(-1, 2, 2), axis=1)[:, 0]
        step = step[np.hypot(*step.T) > CLIMBS_M]
        course = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
        yield 0.0, float(course[-1] - course[0]) if len(course) > 1 else 0.0, COURSE


def _inertial(walk: Walk, windows: Ints) -> tuple[Floats, Floats]:
    """(k,) rad turned and (k, 3) up by the inertial unit; NaN: not known. See `turns_and_up`."""
    own = walk.corrected.inertial
    if own is not None and len(windows):
        return turns_and_up(own.time, own.vector, own.turn_rate, windows)
    return np.full(len(windows), np.nan), np.full((len(windows), 3), np.nan)


def _leans_rad(walk: Walk, windows: Ints) -> float:
    """Return how far the accelerometer leans in a quarter of the strides or more, rad.

    Where its mounting is known, from the base's upright; else from its own usual direction.
    """
    _, up = _inertial(walk, windows)
    up, inertial = up[all_finite(up)], walk.recording.accelerations
    if not len(up) or inertial is None:
        return 0.0
    usual, mounting = median_of(up, axis=0), walk.settings.imu_mounting
    if mounting is not None:
        up = rotate(np.array([mounting]), up)
    if mounting is not None or [f.lstrip("/") for f in inertial.frames] == [walk.frames.base]:
        usual = UPRIGHT
    cosine = np.clip(up @ usual / np.linalg.norm(usual), -1.0, 1.0)
    return float(percentiles_of(np.arccos(cosine), 75.0))


def _planar(walk: Walk, comparisons: Sequence[Comparison], windows: Ints) -> Iterator[Finding]:
    """Yield that poses are those of a plane: z, roll and pitch never change."""
    poses = walk.poses
    flat = np.column_stack([poses.position[:, 2], poses.angles[:, :2]])
    if walk.base_by_feet or not len(windows) or float(np.ptp(flat, axis=0).max()) > 0.0:
        return
    climb = next(
        (float(each.reference.rise.sum()) for each in comparisons if each.by == POINTS), 0.0
    )
    slope = (walk.base and walk.base.slope_rad) or 0.0
    while_feet = ""
    if abs(climb) > CLIMBS_M:
        while_feet = f", while the feet go {climb:+.2f} m up"
    elif walk.witness is not None and slope > LEAST_SLOPE_RAD:
        while_feet = f", while the feet's plane leans by {np.degrees(slope):.0f} degrees"
    elif (lean := _leans_rad(walk, windows)) > LEANS_RAD:
        while_feet = f", while the accelerometer leans by {np.degrees(lean):.0f} degrees"
    if while_feet or poses.position[0, 2] == 0.0:
        cases = ("contradicted",) if while_feet else ()
        where = "base.climb_m"
        yield found("POSE_PLANAR", *cases, where=where, say="plain", while_feet=while_feet)


def _climb(comparisons: Sequence[Comparison]) -> Iterator[Finding]:
    """Yield that z of the poses goes away from where the legs lift the base."""
    legs = next((each for each in comparisons if each.by == LEGS), None)
    if legs is None or not SCALES[0] <= (legs.scale or 0.0) <= SCALES[1]:
        return
    metres = float((legs.own.rise - legs.reference.rise).sum())
    if abs(metres) > max(MOST_RISE_M, MOST_RISE * legs.reference.walked_m):
        where = "base.climb_m"
        yield found(
            "WORLDS_DIFFER", "drifts", "legs", where=where, say="legs", metres=metres, told=legs
        )


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
    if poses.repeated or cases:
        say = "plain" if poses.repeated else "rare"
        rates = f"{1.0 / interval_s:.2g} distinct poses a second, {per_stride:.1f} a stride"
        yield found("POSE_REPEATED", *cases, where="base", say=say, poses=poses, rates=rates)


def _doubted(
    walk: Walk,
    code: str,
    *cases: str,
    **values: Any,  # noqa: ANN401 - as `found` has it
) -> Finding:
    """Return a finding about the poses, and about the feet whose places rest on them."""
    names = () if walk.base_by_feet else walk.feet_on_poses
    placed = ("placed",) if names else ()
    return found(code, *cases, *placed, where="base", feet=names, **values)
