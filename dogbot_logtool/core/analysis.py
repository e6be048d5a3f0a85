"""From the columns of a recording to all that is measured of its walk.

    walk = analyse(recording, WalkSettings(feet, mass_kg=19.2))
    walk.metrics.gait.name

The order is the same for every log: corrections, masks, what is measured with them, checks that
look for reasons to doubt it, and metrics, less those that are in doubt.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from dogbot_logtool.core.base.falls import find_tipping
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.checks.engine import consequence, findings_of
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.corrected import Corrected, correct
from dogbot_logtool.core.gait.segments import Segment, find_segments, main_segment, reference_foot
from dogbot_logtool.core.leg_position import quadruped
from dogbot_logtool.core.masks import loads_in, mask_walk, stability_in, support_in
from dogbot_logtool.core.metrics import Log
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.settings import WalkSettings
from dogbot_logtool.core.stability import instants
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.core.walk_metrics import metrics_of
from dogbot_logtool.finding import Finding

if TYPE_CHECKING:
    from dogbot_logtool.core.legs.swings import LegSettings

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


def _measured(walk: Walk) -> Walk:
    """Measure a walk of which the masks are known."""
    settings, records, feet = walk.settings, walk.records, walk.feet
    supported = support_in(walk)
    segments: tuple[Segment, ...] = ()
    if feet and not walk.feet_clocks_are_apart:
        segments = find_segments(feet, walk.standing, contacts_known=supported is not None)
    origin, end = _extent(records, walk.poses)
    placed_at = None
    if walk.contacts_known and not (walk.base_is_apart or walk.base_by_feet):
        offset_m = settings.com_offset_m or (0.0, 0.0, 0.0)
        placed_at = instants(records, walk.placed_poses, settings.forward_axis, offset_m)
    walk = replace(
        walk,
        origin=origin,
        end=end,
        reference=reference_foot(feet),
        corners=quadruped([foot.leg_position for foot in settings.feet]),
        tipping=find_tipping(walk.base_history, settings.forward_axis),
        segments=segments,
        main=main_segment(segments),
        support=supported,
        instants=placed_at,
    )
    walk = replace(walk, loads=loads_in(walk), stability=stability_in(walk))
    # Modules of what few logs hold are loaded for those that do.
    if walk.corrected.commands is not None:
        from dogbot_logtool.core.commands import follow_commands  # noqa: PLC0415

        walk = replace(walk, command_track=follow_commands(walk))
    if walk.corrected.inertial is not None:
        from dogbot_logtool.core.imu import compare_imu  # noqa: PLC0415

        walk = replace(walk, imu=compare_imu(walk))
    return walk


def _with_plan(walk: Walk, planned: Walk) -> Walk:
    """Add how the feet follow their plan, if that is on the same clock."""
    from dogbot_logtool.core.planned import follow_plan  # noqa: PLC0415 - few logs hold a plan

    clocks = [each.settings.clock for each in (walk, planned)]
    plan = {foot.name: foot for foot in planned.feet}
    if clocks[0] is not clocks[1]:
        return replace(walk, plan_apart=min(foot.topic for foot in planned.feet))
    found = tuple(
        follow_plan(foot, plan[foot.name]) if foot.name in plan else None for foot in walk.feet
    )
    return replace(walk, planned=found)


def _extent(feet: Sequence[FootHistory], base: BaseHistory) -> tuple[int, int]:
    """First and last time of any used message, ns; zeros in an empty log."""
    starts = [foot.start for foot in feet if foot.start is not None]
    ends = [foot.end for foot in feet if foot.end is not None]
    if len(base.time):
        starts.append(int(base.time[0]))
        ends.append(int(base.time[-1]))
    return min(starts, default=0), max(ends, default=0)
