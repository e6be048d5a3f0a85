"""All checks of a walk: functions that yield findings, each naming the metrics that it voids.

A check reads what was measured and changes nothing; what its findings void is set to null
afterwards, in one place (`voids.py`).
"""

from collections.abc import Callable, Iterator
from typing import Final

from dogbot_logtool.core.checks import (
    base,
    clock,
    commands,
    feet,
    gait,
    imu,
    legs,
    loads,
    poses,
    sensors,
)
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding

Check = Callable[[Stats], Iterator[Finding]]

CHECKS: Final[tuple[Check, ...]] = (
    clock.clock_set,
    clock.clocks_differ,
    clock.feet_silent,
    clock.topics_timed,
    base.worlds_differ,
    base.falls,
    base.poses,
    base.up_axis,
    base.height_drifts,
    base.sides_swapped,
    base.forward_axis,
    base.pose_jumps,
    poses.treadmill,
    poses.frozen,
    poses.scale,
    poses.direction,
    poses.orientation,
    poses.planar,
    poses.rate,
    sensors.unloaded_levels,
    sensors.silent_feet,
    sensors.dead,
    sensors.stuck,
    sensors.stopped,
    sensors.saturated,
    sensors.spikes,
    sensors.samples_left_out,
    sensors.chatter,
    sensors.sampled_slowly,
    feet.sampled_slowly,
    feet.flags_inverted,
    feet.payload,
    gait.no_class,
    gait.other_reference_foot,
    gait.moves_without_steps,
    gait.lifted,
    gait.several_gaits,
    gait.against_plan,
    gait.slips,
    loads.no_force,
    loads.mass_unknown,
    loads.impulse_is_not_weight,
    loads.forces_lean,
    loads.forces_push,
    legs.foot_frames,
    legs.sampled_slowly,
    legs.joint_clocks,
    legs.joint_work,
    commands.refused,
    commands.followed,
    imu.mounting,
    imu.forces,
)
"""In order of the subjects; findings are sorted by consequence."""


def findings_of(stats: Stats) -> tuple[Finding, ...]:
    """Make all checks, and return what they find: what is of most consequence first."""
    made = [finding for check in CHECKS for finding in check(stats)]
    return tuple(sorted(made, key=_consequence))


def _consequence(finding: Finding) -> tuple[int, float]:
    """Return the key that sorts findings: what makes most metrics doubtful comes first."""
    return finding.severity, float("inf") if finding.rank is None else finding.rank
