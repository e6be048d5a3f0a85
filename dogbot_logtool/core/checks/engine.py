"""All checks of a walk: functions that yield findings, each naming the metrics that it voids.

A check is a generator in one of these modules that takes what was measured, and nothing else. It
changes nothing; what its findings void is set to null afterwards, in one place (`records.void`).
"""

from collections.abc import Callable, Iterator
from inspect import isgeneratorfunction
from typing import Final

from dogbot_logtool.core.checks import (
    base,
    clock,
    commands,
    feet,
    frames,
    gait,
    imu,
    legs,
    loads,
    poses,
    sensors,
)
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding

Check = Callable[[Walk], Iterator[Finding]]
MODULES: Final = (clock, base, poses, sensors, feet, gait, loads, legs, commands, imu, frames)
CHECKS: Final[tuple[Check, ...]] = tuple(
    each
    for module in MODULES
    for name, each in vars(module).items()
    if isgeneratorfunction(each) and each.__module__ == module.__name__
    if not name.startswith("_") and [*each.__annotations__] == ["walk", "return"]
)
"""In order of the subjects; findings are sorted by consequence."""


def findings_of(walk: Walk) -> list[Finding]:
    """Make all checks, and return what they find."""
    return [finding for check in CHECKS for finding in check(walk)]


def consequence(finding: Finding) -> tuple[int, float]:
    """Return the key that sorts findings: what makes most metrics doubtful comes first."""
    return finding.severity, float("inf") if finding.rank is None else finding.rank
