"""Checks of a recording before it is trusted, and those that were not possible.

Which findings a check fails with stands in ``findings.toml``.
"""

from collections.abc import Callable, Iterable
from enum import StrEnum
from typing import Final

import numpy as np

from dogbot_logtool.core.imu import Reading
from dogbot_logtool.core.loads import vertical_is_known
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.finding import Finding, Severity


class Outcome(StrEnum):
    """Outcome of a check."""

    PASSED = "passed"
    FAILED = "failed"
    NOT_MADE = "not made"
    """The log holds data of the kind that it needs, but too little."""
    DOES_NOT_APPLY = "does not apply"
    """The log holds no data of that kind."""


@dataclass(frozen=True, slots=True)
class Check:
    """One thing that a figure rests on."""

    name: str
    """The condition in a few words."""
    outcome: Outcome
    reason: str = ""
    """Why it failed, could not be made or does not apply."""


Reason = Callable[[Stats], str]
"""A sentence; empty where there is no such reason."""


@dataclass(frozen=True, slots=True)
class CheckKind:
    """A check, and when it cannot be made."""

    name: str
    """As findings name it."""
    lack: Reason
    """Data that the log lacks, so that it does not apply."""
    obstacle: Reason
    """Why it cannot be made although it applies."""


def checks_of(stats: Stats, findings: Iterable[Finding]) -> tuple[Check, ...]:
    """Return all checks with what came of them.

    Args:
        stats: all figures.
        findings: about the figures, and about the log.
    """
    said = [each for each in findings if each.severity is not Severity.NOTE]
    return tuple(_check(kind, stats, said) for kind in KINDS)


def _check(kind: CheckKind, stats: Stats, said: list[Finding]) -> Check:
    against = [each.text for each in said if kind.name in each.fails]
    if against:
        return Check(kind.name, Outcome.FAILED, against[0])
    if lack := kind.lack(stats):
        return Check(kind.name, Outcome.DOES_NOT_APPLY, lack)
    if obstacle := kind.obstacle(stats):
        return Check(kind.name, Outcome.NOT_MADE, obstacle)
    return Check(kind.name, Outcome.PASSED)


def _nothing(_: Stats) -> str:
    return ""


def _no_feet(stats: Stats) -> str:
    seen = any(foot.record.start is not None for foot in stats.feet)
    return "" if seen else "the log has no usable messages of feet"


def _no_poses(stats: Stats) -> str:
    return "" if len(stats.base_history.time) else "the log has no usable poses"


def _no_feet_or_poses(stats: Stats) -> str:
    return _no_feet(stats) or _no_poses(stats)


def _used_topics(stats: Stats) -> set[str]:
    topics = {foot.topic for foot in stats.feet if foot.record.start is not None}
    return topics if _no_poses(stats) else topics | {stats.settings.odometry_topic}


def _no_stamps(stats: Stats) -> str:
    used = [topic for topic in stats.topics if topic.topic in _used_topics(stats)]
    missing = [topic.topic for topic in used if topic.zero_stamps is None]
    return f"messages of {', '.join(missing)} have no header stamps" if missing else ""


def _no_two_clocks(stats: Stats) -> str:
    if len(_used_topics(stats)) < 2:
        return "there is only one topic"
    used = [topic for topic in stats.topics if topic.topic in _used_topics(stats)]
    if used and all(topic.offset_median_s == 0.0 for topic in used):
        return "log times are the header stamps"
    return _no_stamps(stats)


def _clocks_not_compared(stats: Stats) -> str:
    missing = _used_topics(stats) - {each.topic for each in stats.clocks}
    topics = ", ".join(sorted(missing))
    return f"too little time with header stamps in common: {topics}" if missing else ""


def _no_two_worlds(stats: Stats) -> str:
    pointed = any(np.isfinite(foot.record.track.point).any() for foot in stats.feet)
    return _no_poses(stats) or ("" if pointed else "the sensors report no contact points")


def _worlds_not_compared(stats: Stats) -> str:
    short = "two feet are not seen to touch near poses for a second each"
    return "" if stats.worlds is not None else short


def _no_forces(stats: Stats) -> str:
    known = any(foot.record.has_force for foot in stats.feet)
    return "" if known else "the sensors report no forces"


def _unloaded_not_seen(stats: Stats) -> str:
    """Say why zero is assumed where it cannot be seen that unloaded sensors read zero."""
    levels = [
        stats.settings.sensor(row).level
        for row, foot in enumerate(stats.feet)
        if foot.record.has_force
    ]
    return next((level.reason for level in levels if level.reason), "")


def _no_legs(stats: Stats) -> str:
    return "" if stats.legs is not None else "nothing tells of the legs"


def _legs_not_compared(stats: Stats) -> str:
    """Say why legs could not be compared with contacts."""
    reasons = [leg.reason for leg in stats.legs.feet if leg.reason] if stats.legs else []
    return reasons[0] if reasons else ""


def _weight_not_compared(stats: Stats) -> str:
    if stats.loads.vertical_impulse_over_weight is not None:
        return ""
    if stats.settings.mass_kg is None:
        return "the mass is not known"
    if not all(vertical_is_known(foot.record) for foot in stats.feet):
        return "vertical forces are not known"
    return "the vertical load of every foot is not known for long enough"


def _no_imu(stats: Stats) -> str:
    if not stats.settings.imu_topic:
        return "the log has no accelerometer of the base"
    return (
        "all accelerations are zero"
        if stats.imu and stats.imu.mounting.reading is Reading.NOTHING
        else _no_poses(stats)
    )


def _imu_not_compared(stats: Stats) -> str:
    if stats.imu is None:
        return "accelerometer and poses are not known together for 2 s"
    unsure = "the accelerometer does not follow the base's attitude"
    return unsure if stats.imu.mounting.reading is Reading.UNCLEAR else ""


KINDS: Final = (
    CheckKind("every foot's sensor works", _no_feet, _nothing),
    CheckKind("what sensors read without load is known", _no_forces, _unloaded_not_seen),
    CheckKind("the base's poses are sound", _no_poses, _nothing),
    CheckKind("header stamps are sound", _no_stamps, _nothing),
    CheckKind("all topics have one clock", _no_two_clocks, _clocks_not_compared),
    CheckKind("no topic is silent for long", _nothing, _nothing),
    CheckKind("contacts are where the base is", _no_two_worlds, _worlds_not_compared),
    CheckKind("the base moves as the feet step", _no_feet_or_poses, _nothing),
    CheckKind("the feet carry the weight", _no_forces, _weight_not_compared),
    CheckKind("nothing contradicts the accelerometer", _no_imu, _imu_not_compared),
    CheckKind("the legs move as the feet step", _no_legs, _legs_not_compared),
)
