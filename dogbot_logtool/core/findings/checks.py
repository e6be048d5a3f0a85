"""Checks of a recording before it is trusted, and those that were not possible."""

from collections.abc import Callable, Iterable
from enum import StrEnum
from typing import Final

import numpy as np

from dogbot_logtool.core.load.load_figures import vertical_is_known
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
class _Kind:
    name: str
    lack: Reason
    """Data that the log lacks, so that it does not apply."""
    obstacle: Reason
    """Why it cannot be made although it applies."""
    codes: frozenset[str]
    """Findings with which it fails."""


def checks_of(stats: Stats, findings: Iterable[Finding]) -> tuple[Check, ...]:
    """Return all checks with what came of them.

    Args:
        stats: all figures.
        findings: about the figures, and about the log.
    """
    said = [each for each in findings if each.severity is not Severity.NOTE]
    return tuple(_check(kind, stats, said) for kind in _KINDS)


def codes_of_checks() -> frozenset[str]:
    """Return the codes of all findings with which a check fails."""
    return frozenset().union(*(kind.codes for kind in _KINDS))


def _check(kind: _Kind, stats: Stats, said: list[Finding]) -> Check:
    against = [each.text for each in said if each.code in kind.codes]
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
    return "all accelerations are zero" if stats.imu and stats.imu.is_zero else _no_poses(stats)


def _imu_not_compared(stats: Stats) -> str:
    if stats.imu is None:
        return "accelerometer and poses are not known together for 2 s"
    unsure = "the accelerometer does not follow the base's attitude"
    return unsure if stats.imu.mounting.reading is None else ""


EVENTS: Final = frozenset(
    {
        "W_FALL",
        "W_TIPPING",
        "W_LOST",
        "W_ROBOT_ABSENT",
        "W_FEET_POSSIBLE",
        "W_NO_SUCH_TOPICS",
        "W_COMMANDS_REFUSED",
        "W_COMMAND_AXES",
        "W_COMMAND_OPPOSED",
    }
)
"""Warnings that no check fails with: what the robot does and is told to do, what reading lost,
which robot it is, and what is of other commands."""
_KINDS: Final = (
    _Kind(
        "every foot's sensor works",
        _no_feet,
        _nothing,
        frozenset(
            {
                "W_NO_MESSAGES",
                "W_NOTHING_USABLE",
                "W_FOOT_MISSING",
                "W_DEAD",
                "W_STUCK",
                "W_STOPPED",
                "W_SATURATED",
                "W_CHATTER",
                "W_CONTACT_UNKNOWN",
                "W_FLAGS_IGNORED",
                "W_FLAGS_CONTRADICTED",
                "W_SPIKES",
                "W_NOT_CALIBRATED",
                "W_NOT_FINITE",
                "W_IMPLAUSIBLE",
                "W_FEET_UNSURE",
                "W_NO_FEET",
                "W_UNREADABLE",
                "W_ELEMENT_UNKNOWN",
            }
        ),
    ),
    _Kind(
        "what sensors read without load is known",
        _no_forces,
        _unloaded_not_seen,
        frozenset({"W_CONTACT_UNKNOWN"}),
    ),
    _Kind(
        "the base's poses are sound",
        _no_poses,
        _nothing,
        frozenset(
            {
                "W_BAD_POSES",
                "W_UP_AXIS",
                "W_HEIGHT_DRIFTS",
                "W_POSE_JUMP",
                "W_NO_ODOMETRY",
                "W_BASE_PLANNED",
            }
        ),
    ),
    _Kind(
        "header stamps are sound",
        _no_stamps,
        _nothing,
        frozenset(
            {
                "W_LOG_TIME_USED",
                "W_ZERO_STAMPS",
                "W_STAMPS_AHEAD",
                "W_BACKWARD_STAMPS",
                "W_DUPLICATE_STAMPS",
                "W_CLOCK_SET",
                "W_NOT_ADVANCING",
                "W_BACKWARD_LOG_TIMES",
            }
        ),
    ),
    _Kind(
        "all topics have one clock",
        _no_two_clocks,
        _clocks_not_compared,
        frozenset({"W_CLOCK_OFFSET"}),
    ),
    _Kind(
        "no topic is silent for long",
        _nothing,
        _nothing,
        frozenset({"W_GAPS", "W_ALL_FEET_SILENT", "W_CONTACT_WITHOUT_ODOMETRY"}),
    ),
    _Kind(
        "contacts are where the base is",
        _no_two_worlds,
        _worlds_not_compared,
        frozenset({"W_WORLDS_DIFFER"}),
    ),
    _Kind(
        "the base moves as the feet step",
        _no_feet_or_poses,
        _nothing,
        frozenset(
            {
                "W_MOVES_WITHOUT_STEPS",
                "W_SIDES_SWAPPED",
                "W_FORWARD_AXIS",
                "W_MOVES_SIDEWAYS",
                "W_SLIPS",
            }
        ),
    ),
    _Kind(
        "the feet carry the weight",
        _no_forces,
        _weight_not_compared,
        frozenset(
            {
                "W_IMPULSE_IS_NOT_WEIGHT",
                "W_WRENCH_FRAME_UNKNOWN",
                "W_DIRECTION_UNKNOWN",
                "W_FORCES_TURNED",
            }
        ),
    ),
    _Kind(
        "nothing contradicts the accelerometer",
        _no_imu,
        _imu_not_compared,
        frozenset(
            {
                "W_IMU_IN_G",
                "W_IMU_NO_GRAVITY",
                "W_IMU_SCALE",
                "W_IMU_TILTED",
                "W_IMU_TURNED",
                "W_IMU_REFUSED",
                "W_FORCES_LACK_A_FOOT",
                "W_FORCES_LEAN",
                "W_FOOT_SCALE",
                "W_MASS_ODD",
                "W_FORCES_DISAGREE",
                "W_FORCES_ASIDE",
            }
        ),
    ),
    _Kind(
        "the legs move as the feet step",
        _no_legs,
        _legs_not_compared,
        frozenset({"W_JOINT_CLOCK", "W_JOINT_VALUES", "W_EFFORT_SIGN"}),
    ),
)
