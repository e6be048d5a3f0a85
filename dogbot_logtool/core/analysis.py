"""From the columns of a recording to all that is measured of its walk.

    walk = analyse(recording, WalkSettings(feet, mass_kg=19.2))
    walk.metrics.gait.name

The order is the same for every log: corrections, masks, what is measured with them, checks that
look for reasons to doubt it, and metrics, less those that are in doubt.
"""

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from dogbot_logtool.core import timespans
from dogbot_logtool.core.base.ground import (
    contact_path,
    find_moving_ground,
    footfalls,
    height_over_feet,
    with_forward_axis,
)
from dogbot_logtool.core.base.motion import base_motion, base_track, fallen_spans, find_tipping
from dogbot_logtool.core.base.poses import find_jumps, without_jumps
from dogbot_logtool.core.base.witness import (
    by_legs,
    by_points,
    find_frozen,
    without_frozen,
)
from dogbot_logtool.core.checks.engine import consequence, findings_of
from dogbot_logtool.core.clock import too_far_apart
from dogbot_logtool.core.consistency import compare_worlds, long_delay, without_stopped
from dogbot_logtool.core.corrected import Corrected, correct
from dogbot_logtool.core.gait.feet import foot_steps
from dogbot_logtool.core.gait.segments import Segment, find_segments, main_segment, reference_foot
from dogbot_logtool.core.gait.strides import any_strides, standing_in, support, typical_period_s
from dogbot_logtool.core.loads import dead_feet, is_stuck, loads_of
from dogbot_logtool.core.metrics import Log
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.settings import WalkSettings
from dogbot_logtool.core.stability import instants
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.core.walk_metrics import metrics_of
from dogbot_logtool.finding import Finding

if TYPE_CHECKING:
    from dogbot_logtool.core.legs.joints import LegSettings

NO_LOG: Final = Log("", "", "", None, None, 0, 0, 0)
"""What was read, for columns that come from no log."""
FindLegs = Callable[[Recording, Corrected], "LegSettings | None"]
"""Says where a recording tells of legs; None: it does not."""


def analyse(
    recording: Recording,
    settings: WalkSettings,
    find_legs: FindLegs | None = None,
    planned: WalkSettings | None = None,
    *,
    log: Log = NO_LOG,
    known: Iterable[Finding] = (),
) -> Walk:
    """Measure all that a recording tells of its walk.

    Args:
        recording: its columns, as recorded.
        settings: what is known before they are looked at.
        find_legs: finds the legs; None: nothing tells of them.
        planned: settings of the feet as a plan in the log has them; None: there is no plan.
        log: what was read.
        known: what was found while it was read.
    """
    corrected = correct(recording, settings)
    walk = _measured(mask_walk(corrected))
    legs = find_legs(recording, corrected) if find_legs else None
    if legs is not None:
        from dogbot_logtool.core.leg_evaluation import with_legs  # noqa: PLC0415

        walk = with_legs(walk, legs)
    if planned is not None:
        of_plan = replace(
            recording, feet=recording.planned, links={}, commands=None, accelerations=None
        )
        walk = _with_plan(walk, mask_walk(correct(of_plan, planned)))
    return judge(walk, log, known)


def judge(walk: Walk, log: Log, known: Iterable[Finding] = ()) -> Walk:
    """Make all checks of a walk, and its metrics, less those that findings void; see `analyse`."""
    findings = sorted((*findings_of(walk), *known), key=consequence)
    return replace(walk, findings=tuple(findings), metrics=metrics_of(walk, log, findings))


def mask_walk(corrected: Corrected) -> Walk:
    """Find jumps, falls, stands, dead sensors, clocks and worlds that cannot be compared.

    What is measured with these masks is not in the result yet.
    """
    settings = corrected.settings
    period_s = typical_period_s([each.stances for each in corrected.feet])
    # Feet of bipeds are named by their side only.
    positions = [foot.leg_position or ("", foot.name) for foot in settings.feet]
    # Places in the base are put into the world by its poses, and jump with them.
    placed_by_poses = any(path is not None for path in corrected.places)
    if placed_by_poses:
        witness = by_legs(corrected.places, corrected.feet, corrected.base)
    else:
        witness = by_points(corrected.feet, positions)
    frozen = find_frozen(corrected.base, corrected.feet, witness, period_s)
    recorded = without_frozen(corrected.base, frozen) if len(frozen) else corrected.base
    stand_in = None
    if witness is not None and corrected.leaning_rad is None:
        stand_in = witness.stand_in(recorded, settings.forward_rad)
    if stand_in is not None:
        recorded, settings = stand_in, replace(settings, base_from_legs=True)
    jumps = find_jumps(recorded)
    base = without_jumps(recorded, jumps)
    telling = [
        foot.without_force() if is_stuck(foot, corrected.feet) else foot for foot in corrected.feet
    ]
    if placed_by_poses and len(jumps.spans):
        telling = [foot.without_travel(jumps.spans) for foot in telling]
    if settings.contact_from:
        # No sensor is at fault where efforts were not right for a moment.
        telling = [replace(foot, spikes=foot.spikes[:0]) for foot in telling]
    records = without_stopped(telling, base)
    placed = recorded if placed_by_poses else base
    worlds = compare_worlds(records, placed, period_s)
    stood = [
        footfalls(contact_path(record) if path is None else path.in_world(base), record.stances)
        for record, path in zip(records, corrected.places, strict=True)
    ]
    height = height_over_feet(placed, records, stood)
    fallen = fallen_spans(recorded, records, height)
    weighed = loads_of(records, settings, any_strides(records, fallen, timespans.no_spans()))
    dead = tuple(dead_feet(records, weighed))
    period_s = typical_period_s([each.stances for each in records])
    apart = too_far_apart(corrected.clocks, period_s)
    unsupported = any(dead) or settings.lacks_feet or any(f.topic in apart for f in settings.feet)
    supported = None if unsupported else support(records)
    standing = standing_in(supported, period_s, base, fallen)
    walked = timespans.merge(any_strides(records, fallen, standing.without_steps))
    delay = None
    # Legs tell the base's height over the standing feet, and not how it bobs.
    tells = bool(len(base.time)) and not (settings.lacks_feet or settings.base_from_legs)
    if period_s and tells and not apart:
        delay = long_delay(records, base, period_s, walked)
    apart = apart | {settings.odometry_topic} if delay else apart
    ground = find_moving_ground(stood, base, placed_by_poses=placed_by_poses)
    on_ground = base if ground is None else ground.on_ground(base)
    track = base_track(on_ground, height, stood, standing.still)
    if stand_in is None and (worlds is None or worlds.agree):
        settings = with_forward_axis(settings, on_ground, records)
    feet = tuple(
        foot_steps(
            settings,
            row,
            record,
            stood[row],
            base,
            fallen,
            standing,
            ground=ground,
            is_dead=dead[row],
        )
        for row, record in enumerate(records)
    )
    return Walk(
        corrected=corrected,
        settings=settings,
        base_history=recorded,
        records=records,
        poses=base,
        jumps=jumps,
        frozen=frozen,
        base_by_feet=stand_in is not None,
        witness=witness,
        ground=ground,
        placed_poses=placed,
        track=track,
        base=base_motion(track, settings.forward_rad),
        fallen=fallen,
        standing=standing,
        feet=feet,
        clocks_apart=apart,
        base_delay=delay,
        worlds=worlds,
        loads=weighed,
    )


def _measured(walk: Walk) -> Walk:
    """Measure a walk of which the masks are known."""
    settings, records, feet = walk.settings, walk.records, walk.feet
    supported = support(records) if walk.contacts_known else None
    segments: tuple[Segment, ...] = ()
    if feet and not walk.feet_clocks_are_apart:
        segments = find_segments(feet, walk.standing, contacts_known=supported is not None)
    placed_at = None
    if walk.contacts_known and not (walk.base_is_apart or walk.base_by_feet):
        offset_m = settings.com_offset_m or (0.0, 0.0, 0.0)
        placed_at = instants(records, walk.placed_poses, settings.forward_rad, offset_m)
    walk = replace(
        walk,
        reference=reference_foot(feet),
        tipping=find_tipping(walk.base_history, settings.forward_rad),
        segments=segments,
        main=main_segment(segments),
        support=supported,
        instants=placed_at,
    )
    walk = replace(walk, loads=walk.loads_in(), stability=walk.stability_in())
    # Modules of what few logs hold are loaded for those that do.
    commands, inertial = walk.corrected.commands, walk.corrected.inertial
    if commands is not None:
        from dogbot_logtool.core.compared import follow_commands  # noqa: PLC0415

        walk = replace(walk, command_track=follow_commands(walk, commands))
    if inertial is not None:
        from dogbot_logtool.core.compared import compare_imu  # noqa: PLC0415

        walk = replace(walk, imu=compare_imu(walk, inertial))
    return walk


def _with_plan(walk: Walk, planned: Walk) -> Walk:
    """Add how the feet follow their plan, if that is on the same clock."""
    from dogbot_logtool.core.compared import follow_plan  # noqa: PLC0415 - few logs hold a plan

    clocks = [each.settings.clock for each in (walk, planned)]
    plan = {foot.name: foot for foot in planned.feet}
    if clocks[0] is not clocks[1]:
        return replace(walk, plan_apart=min(foot.topic for foot in planned.feet))
    found = tuple(
        follow_plan(foot, plan[foot.name]) if foot.name in plan else None for foot in walk.feet
    )
    return replace(walk, planned=found)
