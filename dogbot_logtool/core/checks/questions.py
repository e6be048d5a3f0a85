"""Questions about a recording before it is trusted, and those that it does not answer.

Which findings a question fails with stands in ``findings.toml``.
"""

from collections.abc import Iterable, Sequence

import numpy as np

from dogbot_logtool.core.imu import Reading
from dogbot_logtool.core.loads import vertical_is_known
from dogbot_logtool.core.metrics import Check
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding, Severity


def checks_of(walk: Walk, findings: Iterable[Finding]) -> tuple[Check, ...]:
    """Return all questions with their answers.

    A question fails by a finding, does not apply where the log holds no data of its kind, and is
    not made where it holds too little.

    Args:
        walk: all that is measured.
        findings: about that, and about the log.
    """
    said = [each for each in findings if each.severity is not Severity.NOTE]
    made = []
    for name, lack, obstacle in _questions(walk):
        against = next((each.text for each in said if name in each.fails), "")
        answers = ("failed", against), ("does not apply", lack), ("not made", obstacle)
        outcome, reason = next((each for each in answers if each[1]), ("passed", None))
        made.append(Check(name, outcome, reason))
    return tuple(made)


def _questions(walk: Walk) -> Sequence[tuple[str, str, str]]:
    """Return each question, what the log lacks for it, and why else it cannot be answered."""
    records = [foot.record for foot in walk.feet]
    forced = [row for row, each in enumerate(records) if each.has_force]
    assumed = [walk.settings.sensor(row).level.reason for row in forced]
    legs = walk.legs.feet if walk.legs else ()
    seen, posed = any(each.start is not None for each in records), len(walk.base_history.time)
    pointed = any(np.isfinite(each.track.point).any() for each in records)
    no_feet = "" if seen else "the log has no usable messages of feet"
    no_poses = "" if posed else "the log has no usable poses"
    no_points = "" if pointed else "the sensors report no contact points"
    no_forces = "" if forced else "the sensors report no forces"
    no_worlds = "" if walk.worlds else "two feet are not seen to touch near poses for a second each"
    no_legs = "" if walk.legs else "nothing tells of the legs"
    no_stamps, one_clock, few_stamps = _clocks(walk)
    return (
        ("every foot's sensor works", no_feet, ""),
        ("what sensors read without load is known", no_forces, _first(assumed)),
        ("the base's poses are sound", no_poses, ""),
        ("header stamps are sound", no_stamps, ""),
        ("all topics have one clock", one_clock, few_stamps),
        ("no topic is silent for long", "", ""),
        ("contacts are where the base is", no_poses or no_points, no_worlds),
        ("the base moves as the feet step", no_feet or no_poses, ""),
        ("the feet carry the weight", no_forces, _weight_not_compared(walk)),
        ("nothing contradicts the accelerometer", *_accelerometer(walk, no_poses)),
        ("the legs move as the feet step", no_legs, _first([leg.reason for leg in legs])),
    )


def _first(reasons: Sequence[str]) -> str:
    return next((each for each in reasons if each), "")


def _clocks(walk: Walk) -> tuple[str, str, str]:
    """Say that there are no stamps, no two clocks, or too few stamps to compare clocks."""
    topics = {foot.topic for foot in walk.feet if foot.record.start is not None}
    if len(walk.base_history.time):
        topics.add(walk.settings.odometry_topic)
    used = [topic for topic in walk.topics if topic.topic in topics]
    bare = ", ".join(topic.topic for topic in used if topic.zero_stamps is None)
    apart = ", ".join(sorted(topics - {each.topic for each in walk.clocks}))
    no_stamps = f"messages of {bare} have no header stamps" if bare else ""
    one_clock = no_stamps
    if len(topics) < 2:
        one_clock = "there is only one topic"
    elif used and all(topic.offset_median_s == 0.0 for topic in used):
        one_clock = "log times are the header stamps"
    few_stamps = f"too little time with header stamps in common: {apart}" if apart else ""
    return no_stamps, one_clock, few_stamps


def _weight_not_compared(walk: Walk) -> str:
    if walk.loads.vertical_impulse_over_weight is not None:
        return ""
    if walk.settings.mass_kg is None:
        return "the mass is not known"
    if not all(vertical_is_known(foot.record) for foot in walk.feet):
        return "vertical forces are not known"
    return "the vertical load of every foot is not known for long enough"


def _accelerometer(walk: Walk, no_poses: str) -> tuple[str, str]:
    if not walk.settings.imu_topic:
        return "the log has no accelerometer of the base", ""
    if walk.imu is None:
        return no_poses, "accelerometer and poses are not known together for 2 s"
    reading = walk.imu.mounting.reading
    unsure = "the accelerometer does not follow the base's attitude"
    lack = "all accelerations are zero" if reading is Reading.NOTHING else no_poses
    return lack, unsure if reading is Reading.UNCLEAR else ""
