"""Checks of the base among the contact points, of its axes, and of what happens to it."""

from collections.abc import Iterator
from typing import Any, Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import (
    Floats,
    Ints,
    all_finite,
    median_of,
    median_of_known,
    norms,
    percentiles_of,
)
from dogbot_logtool.core.base.ground import usual_places
from dogbot_logtool.core.base.leg_odometry import turns_and_up
from dogbot_logtool.core.base.witness import (
    LEGS,
    POINTS,
    Comparison,
    Motion,
    by_twist,
    compare,
    motion_in,
    stride_windows,
)
from dogbot_logtool.core.consistency import STEADY, trend
from dogbot_logtool.core.rotations import rotate
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding, Words, found

SIDES_APART_M: Final = 0.02
"""m by which a left foot must be to the right of the right one for that to be said."""
STRAIGHT: Final = 0.9
"""Net way over path of a base that goes straight."""
WALKED_M: Final = 0.5
"""m, way to a side from which its direction means something."""


def worlds_differ(walk: Walk) -> Iterator[Finding]:
    """Yield where base and contact points are not in one world, or drift apart.

    The base may also not be above the contact points although it is among them.
    """
    worlds = walk.worlds
    if worlds is not None and walk.worlds_differ:
        cases, say = ["aside"], "plain"
        if walk.settings.base_from_legs:
            cases, say = [*cases, "reckoned"], "reckoned"
        elif walk.loses_track:
            cases.append("loses_way")
        if walk.settings.force_in_world:
            cases.append("turned")
        feet, where = [foot.name for foot in walk.feet], "stability"
        yield found("WORLDS_DIFFER", *cases, feet=feet, where=where, say=say, worlds=worlds)
    elif worlds is not None and walk.base is not None and walk.base.height_m is None:
        yield found("WORLDS_DIFFER", "below", where="base.height_m")


def falls(walk: Walk) -> Iterator[Finding]:
    """Yield when the robot falls, or tips over as the recording ends."""
    if len(walk.fallen):
        at, seconds = walk.seconds(walk.fallen[:, 0])[0], timespans.total(walk.fallen) / 1e9
        yield found("FALL", where="base", at=at, seconds=seconds)
    elif (tips := walk.tipping) is not None:
        at, where = (tips.since - walk.origin) / 1e9, f"base.{tips.angle}_rad"
        yield found("FALL", where=where, say="tips", tipping=tips, at=at)


def poses(walk: Walk) -> Iterator[Finding]:
    """Yield how many poses are missing or cannot be used."""
    record = walk.base_history
    if walk.base is None and (walk.corrected.leaning_rad is not None or len(walk.frozen)):
        return
    if record.not_usable:
        yield found("NOT_FINITE", "base", where="base", say="poses", record=record)
    if record.not_advancing:
        yield found("BAD_STAMPS", where="base", say="poses", record=record)
    if walk.base is None and not (record.messages and record.not_usable == record.messages):
        yield found("NO_BASE", "few_poses", where="base")


def by_feet(walk: Walk) -> Iterator[Finding]:
    """Yield that the feet's motion stands in for poses of the base."""
    if walk.base_by_feet and walk.witness is not None:
        by = walk.witness.by
        part = ("part",) if by == POINTS else ()
        yield found("BASE_FROM_LEGS", "feet", *part, where="base", say="plain", by=by)


def up_axis(walk: Walk) -> Iterator[Finding]:
    """Yield that z is not up: such poses are left out of all that is computed."""
    if walk.corrected.leaning_rad is not None:
        yield found("UP_AXIS", where="base", degrees=np.degrees(walk.corrected.leaning_rad))


def sides_swapped(walk: Walk) -> Iterator[Finding]:
    """Yield where left feet touch on the right; where all do, the walk is a mirror image."""
    # In another world, contact points tell nothing of the body's sides.
    if walk.worlds_differ or walk.base_by_feet:
        return
    positions, forward_rad = [foot.leg_position for foot in walk.feet], walk.settings.forward_rad
    places = usual_places(walk.placed_poses, walk.records, positions)
    to_the_left = np.array([-np.sin(forward_rad), np.cos(forward_rad)])
    apart_m = {
        end: float((place - places[end, "right"]) @ to_the_left)
        for (end, side), place in places.items()
        if side == "left" and (end, "right") in places
    }
    swapped = [end for end, metres in apart_m.items() if metres < -SIDES_APART_M]
    if swapped and len(swapped) == len(apart_m):
        yield found("SIDES_SWAPPED", where="base.yaw_change_rad")
        return
    for end in swapped:
        left, right = (walk.feet[positions.index((end, side))].name for side in ("left", "right"))
        where = f"feet.{left}.topic"
        yield found("SIDES_SWAPPED", "one_pair", where=where, left=left, right=right)


def forward_axis(walk: Walk) -> Iterator[Finding]:
    """Yield that another axis than the guessed one is forward, or may be."""
    settings, base = walk.settings, walk.base
    if base is None:
        return
    if settings.forward_axis_reason:
        yield found("FORWARD_AXIS", where="settings.forward_axis", settings=settings)
    if not settings.forward_axis_is_assumed:
        return
    forward, left = base.forward_speed_mps or 0.0, base.lateral_speed_mps or 0.0
    # A heading that never turns beside a bend is none.
    goes = bool(base.yaw_rate_radps)
    goes |= (base.net_displacement_m or 0.0) >= STRAIGHT * (base.path_length_m or 0.0)
    goes &= abs(left) * (base.duration_s or 0.0) > WALKED_M
    if goes and abs(left) > 2.0 * abs(forward):
        where, side = "base.forward_speed_mps", "left" if left > 0.0 else "right"
        words: Words = {"settings": settings, "base": base, "side": side, "speed": abs(left)}
        yield found("FORWARD_AXIS", "assumed", where=where, say="sideways", **words)


WINDOW_S: Final = 1.0
"""s, in place of strides where none are known."""
SCALES: Final = (0.8, 1.25)
"""Ways by poses over those by a witness that are alike: feet roll and slip."""
ASIDE_RAD: Final = np.radians(10.0)
"""A way that is less off its witness's is as good as mountings are."""
LEVEL_RAD: Final = 0.03
"""Of a treadmill, on which a base goes neither up nor down; or a base without roll and pitch."""


def treadmill(walk: Walk) -> Iterator[Finding]:
    """Yield that the ground moves below a base that rests."""
    if walk.ground is not None:
        level = walk.base is not None and (walk.base.slope_rad or 0.0) < LEVEL_RAD
        cases = () if level else ("leans",)
        yield found("TREADMILL", *cases, where="base", speed=walk.ground.speed_mps)


def frozen(walk: Walk) -> Iterator[Finding]:
    """Yield that one pose is repeated while the robot walks on."""
    if not len(walk.frozen):
        return
    cases = () if walk.base_by_feet else ("whole",) if walk.base is None else ("part",)
    seconds, at = timespans.total(walk.frozen) / 1e9, walk.seconds(walk.frozen[:, 0])[0]
    steps = sum(len(record.stances.touchdown) for record in walk.records)
    yield _doubted(walk, "POSE_FROZEN", *cases, seconds=seconds, at=at, steps=steps)


FEWEST_A_STRIDE: Final = 4.0
"""Distinct poses a stride from which they tell of attitude and height."""


def rate(walk: Walk) -> Iterator[Finding]:
    """Yield that poses are rare, or that most messages repeat the one before."""
    poses, period_s = walk.base_history, walk.period_s
    interval_s = poses.interval_s
    if not len(poses.time) or not period_s or not interval_s:
        return
    per_stride = period_s / interval_s
    cases = ("rare",) if per_stride < FEWEST_A_STRIDE else ()
    if poses.repeated or cases:
        rates = f"{1.0 / interval_s:.2g} distinct poses a second, {per_stride:.1f} a stride"
        yield found("POSE_REPEATED", *cases, where="base", poses=poses, rates=rates)


def pose_jumps(walk: Walk) -> Iterator[Finding]:
    """Yield that the pose jumps."""
    jumps = walk.jumps
    if len(jumps.spans):
        size, turn = norms(jumps.size_m), np.abs(jumps.turn_rad)
        at = walk.seconds(jumps.spans[:, 1])[int((size + turn).argmax())]
        words: Words = {"jumps": len(size), "metres": size.max(), "degrees": np.degrees(turn).max()}
        yield found("POSE_JUMP", where="base.path_length_m", at=at, **words)


def contradicted(walk: Walk) -> Iterator[Finding]:
    """Yield where a second witness of the base's motion contradicts the poses, stride by stride."""
    windows = _windows(walk)
    # Feet that rest in the air cast doubt on contact, and not on the poses.
    if not len(windows) or walk.base_by_feet or rest_in_the_air(walk):
        return
    forward_rad = walk.settings.forward_rad
    own = motion_in(walk.poses, windows, forward_rad)
    feet, twist = (
        compare(each, own, windows, forward_rad) for each in (walk.witness, by_twist(walk.poses))
    )
    way = next((each for each in (feet, twist) if each is not None and each.tells_way), None)
    yield from _scale(walk, own, way)
    if way is not None and abs(way.direction_rad) > ASIDE_RAD:
        degrees = abs(np.degrees(way.direction_rad))
        side = "left" if way.direction_rad > 0.0 else "right"
        usual = np.abs(median_of(walk.poses.angles[:, :2], axis=0)).max()
        leans = ("leans",) if usual > LEVEL_RAD else ()
        yield _doubted(walk, "POSE_DIRECTION", *leans, degrees=degrees, side=side, witness=way)
    yield from _orientation(walk, own, feet, windows)
    yield from (planar := list(_planar(walk, feet, windows)))
    if not (planar or walk.settings.base_from_legs):
        yield from _climb_in_stand(walk, own) if feet is None else _climb(walk, feet)


def feet_agree(walk: Walk) -> bool:
    """Tell whether feet that stand, by their contacts, go back as the poses go ahead."""
    windows, forward_rad = _windows(walk), walk.settings.forward_rad
    if not len(windows):
        return False
    own = motion_in(walk.poses, windows, forward_rad)
    feet = compare(walk.witness, own, windows, forward_rad)
    return feet is not None and feet.goes and SCALES[0] <= feet.scale <= SCALES[1]


STAYS_M: Final = 0.03
"""m that a base, or a foot, moves at most while it stands."""
RESTS: Final = 0.2
"""Share of its way in contact that a foot goes at most from there to the next, where contact is
true in the air."""
HALF: Final = 0.5
"""Duty factor of feet above which a stride is a walk's."""


def rest_in_the_air(walk: Walk) -> bool:
    """Tell whether most feet, by their places in the base's axes, rest but where flags are true.

    Feet of poses that look backwards do so, too, but are down for more than half of the time.
    """
    resting = 0
    for foot, path in zip(walk.feet, walk.corrected.places, strict=True):
        stood, down = foot.stood, foot.record.contact_fraction() or 0.0
        if path is None or foot.record.has_force or len(stood.first) < 2:
            continue
        if 0.0 < down < HALF:
            travel_m = median_of_known(stood.travel_m, axis=0)
            between_m = median_of_known(norms(stood.first[1:] - stood.last[:-1]), axis=0)
            resting += bool(travel_m > STAYS_M and between_m < RESTS * travel_m)
    return 2 * resting > len(walk.feet)


def _windows(walk: Walk) -> Ints:
    """(k, 2) ns, strides one after another while the robot walks on ground that rests.

    Without strides, windows; none without poses.
    """
    if len(walk.poses.time) < 2 or walk.ground is not None:
        return timespans.no_spans()
    walked = timespans.merge(walk.strides) if walk.period_s else walk.poses.known
    return stride_windows(walked, walk.period_s or WINDOW_S)


FURTHEST_LEGS: Final = 5.0
"""Lengths of a leg that no robot goes in a stride."""
LONGEST_LEG_M: Final = 0.25
"""m, of a robot of 1 kg; of others it grows with the cube root of their mass."""
HEAVIEST_KG: Final = 200.0
"""Assumed where the mass is not known."""


def _scale(walk: Walk, own: Motion, way: Comparison | None) -> Iterator[Finding]:
    """Yield that poses go further, or less far, than the feet walk or the twist tells."""
    length_m = float(median_of_known(np.abs(own.displacement), axis=0))
    longest = FURTHEST_LEGS * LONGEST_LEG_M * (walk.settings.mass_kg or HEAVIEST_KG) ** (1.0 / 3.0)
    factor = 1.0 if way is None else way.scale
    if not SCALES[0] <= factor <= SCALES[1]:
        unit = f"another unit (--set odometry_scale={1.0 / factor:.3g}), or " if factor else ""
        yield _doubted(walk, "POSE_SCALE", factor=factor, witness=way, unit=unit)
    elif walk.period_s and length_m > longest:
        yield _doubted(walk, "POSE_SCALE", say="stride", way=length_m, longest=longest)


TURNS_RAD: Final = np.radians(20.0)
"""A course that turns by more tells whether the orientation turns with it."""
TURNS_WITH: Final = 0.3
"""Least share of a witness's turn that is the same turn."""
STRAYS_RAD: Final = np.radians(4.0)
"""A stride, by which legs that slip may seem to turn while the orientation does something else."""
CLIMBS_M: Final = 0.05
"""m that feet rise or fall from which poses that keep their z are planar."""


def _orientation(
    walk: Walk, own: Motion, feet: Comparison | None, windows: Ints
) -> Iterator[Finding]:
    """Yield that the orientation does not turn although the robot does, by all that tells."""
    is_constant = bool(walk.period_s) and not np.ptp(walk.poses.angles, axis=0).any()
    told = [("the gyroscope", _inertial(walk, windows)[0], own.turn, TURNS_RAD)]
    if feet is not None and walk.witness is not None and walk.witness.tells_turn:
        strays = STRAYS_RAD * feet.strides if feet.by == LEGS and not is_constant else 0.0
        told.append((feet.by, feet.reference.turn, feet.own.turn, TURNS_RAD + strays))
    told = [each for each in told if np.nan_to_num(each[1]).any()]
    if is_constant and not told:
        course = np.unwrap(np.angle(own.displacement[np.abs(own.displacement) > CLIMBS_M]))
        told.append(("its course", np.diff(course), 0.0 * np.diff(course), 2.0 * TURNS_RAD))
    doubts = [_turns_apart(*each) for each in told]
    if doubts and all(doubts):
        yield _doubted(walk, "POSE_DIRECTION", "constant", **doubts[-1])


def _turns_apart(by: str, told: Floats, own: Floats, least: float) -> dict[str, Any]:
    """Return how far a witness and the poses turn; empty where the poses turn with it.

    Args:
        by: the witness.
        told: (k,) rad, its turns in some windows; NaN: not known.
        own: (k,) rad, those of the poses.
        least: rad that the witness must turn in all.
    """
    both = np.isfinite(told) & np.isfinite(own)
    turned, as_posed = float(told[both].sum()), float(own[both].sum())
    if abs(turned) <= least or as_posed * np.sign(turned) >= TURNS_WITH * abs(turned):
        return {}
    return {"by": by, "told": np.degrees(turned), "own": np.degrees(as_posed)}


def _inertial(walk: Walk, windows: Ints) -> tuple[Floats, Floats]:
    """(k,) rad turned and (k, 3) up by the inertial unit; NaN: not known. See `turns_and_up`."""
    own = walk.corrected.inertial
    if own is not None and len(windows):
        return turns_and_up(own.time, own.vector, own.turn_rate, windows)
    return np.full(len(windows), np.nan), np.full((len(windows), 3), np.nan)


LEAST_SLOPE_RAD: Final = ASIDE_RAD / 3.0
"""Lean of the feet's plane that contact points tell surely."""
LEANS_RAD: Final = np.radians(5.0)
"""An accelerometer that leans by more does not sit on a level base; mountings are as good."""
UPRIGHT: Final = np.array([0.0, 0.0, 1.0])


def _planar(walk: Walk, feet: Comparison | None, windows: Ints) -> Iterator[Finding]:
    """Yield that poses are those of a plane: z, roll and pitch never change."""
    poses = walk.poses
    flat = np.column_stack([poses.position[:, 2], poses.angles[:, :2]])
    if walk.period_s is None or float(np.ptp(flat, axis=0).max()) > 0.0:
        return
    climb = float(feet.reference.rise.sum()) if feet is not None and feet.by == POINTS else 0.0
    slope = (walk.base and walk.base.slope_rad) or 0.0
    leans = walk.witness is not None and slope > LEAST_SLOPE_RAD
    if abs(climb) > CLIMBS_M or leans or _leans_rad(walk, windows) > LEANS_RAD:
        yield found("POSE_PLANAR", "contradicted", where="base.climb_m")
    elif poses.position[0, 2] == 0.0:
        yield found("POSE_PLANAR", where="base.climb_m")


def _leans_rad(walk: Walk, windows: Ints) -> float:
    """Return how far the accelerometer leans in a quarter of the strides or more, rad.

    Where its mounting is known, from the base's upright; else from its own usual direction.
    """
    _, up = _inertial(walk, windows)
    up = up[all_finite(up)]
    if not len(up):
        return 0.0
    usual, mounting = median_of(up, axis=0), walk.settings.imu_mounting
    if mounting is not None:
        up, usual = rotate(np.array([mounting]), up), UPRIGHT
    cosine = np.clip(up @ usual / np.linalg.norm(usual), -1.0, 1.0)
    return float(percentiles_of(np.arccos(cosine), 75.0))


MOST_RISE_M: Final = 0.1
"""m by which poses may rise against the legs; also `MOST_RISE`, as a share of the way, which is
what a lean that is some degrees off makes of it, and `SINKS`, a share of a leg a stride: how the
base bounces while no foot stands is guessed."""
MOST_RISE: Final = 0.05
SINKS: Final = 0.03
SINKS_UNSEEN: Final = 0.08
"""The same where no sensor tells when feet stand."""
RISES: Final = 0.2
"""Share of its height, or of the feet's spread, by which a base that rises steadily over its feet
does not do it itself."""
FEWEST_STRIDES: Final = 4


def _climb(walk: Walk, feet: Comparison) -> Iterator[Finding]:
    """Yield that z of the poses goes away from where the feet lift the base."""
    rise = np.cumsum(feet.own.rise - feet.reference.rise)
    metres, height = float(rise[-1]), walk.base and walk.base.height_m
    # Where z of one is counted from elsewhere, the height over the feet is not known.
    tall = height.median if height else walk.worlds.spread_m if walk.worlds else np.inf
    words: Words = {"metres": metres, "told": feet}
    if feet.by == LEGS:
        goes_alike = feet.is_short or SCALES[0] <= feet.scale <= SCALES[1]
        sinks_m = feet.leg_m * (SINKS_UNSEEN if walk.settings.contact_from else SINKS)
        most = max(MOST_RISE_M, MOST_RISE * feet.reference.walked_m, sinks_m * feet.strides)
        if goes_alike and abs(metres) > most:
            yield found("WORLDS_DIFFER", "drifts", "legs", where="base.climb_m", **words)
    elif feet.strides >= FEWEST_STRIDES and abs(metres) > RISES * tall:
        # A robot that crouches, or stretches its legs, does so at once.
        _, steadiness = trend(rise[:, None])
        if steadiness >= STEADY:
            yield found("WORLDS_DIFFER", "drifts", where="base.height_m", **words)


def _climb_in_stand(walk: Walk, own: Motion) -> Iterator[Finding]:
    """Yield that z of the poses changes while no leg moves."""
    rests = walk.witness is not None and walk.witness.rests and walk.period_s is None
    metres = float(np.nansum(own.rise))
    if rests and walk.contacts_known and abs(metres) > MOST_RISE_M:
        where = "base.climb_m"
        yield found("WORLDS_DIFFER", "drifts", "legs", where=where, say="stands", metres=metres)


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
