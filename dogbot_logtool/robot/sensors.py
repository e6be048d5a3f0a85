"""How each foot's sensor reads with and without load, learnt from the columns of a recording."""

from dataclasses import replace

import numpy as np

from dogbot_logtool.core.arrays import all_finite, median_of, norms
from dogbot_logtool.core.contact.contact_rule import FootSensor, Thresholds, contact_rule
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import usual_interval_s
from dogbot_logtool.core.corrections.modes import CONSTANT
from dogbot_logtool.core.corrections.moving_level import follow_level
from dogbot_logtool.core.corrections.sensor import (
    Origin,
    SensorLevel,
    estimate_level,
    zero_level,
)
from dogbot_logtool.core.corrections.weighed_levels import (
    turned_levels,
    weighed_levels,
    weight_of_levels,
)
from dogbot_logtool.core.settings import body_weight_n
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.robot.probe import Probe
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.topics.selection import Selection


@dataclass(frozen=True, slots=True)
class LearntSensors:
    """How all feet's sensors read."""

    feet: tuple[FootSensor, ...]
    """In the order of the robot's feet."""
    estimated_weight_n: float | None
    """N, the feet's mean sum of loads, where no mass is given and thresholds rest on it."""


def learn_sensors(
    selection: Selection,
    probe: Probe,
    *,
    mass_is_given: bool = False,
) -> LearntSensors:
    """Learn how each foot's sensor reads with and without load, and what counts as contact.

    Args:
        selection: the feet.
        probe: what the recording tells; the samples of its feet are looked at.
        mass_is_given: whether the user tells the mass.
    """
    weight = body_weight_n(selection.robot.mass_kg)
    # A mass that is only guessed from the topics tells nothing of levels.
    trusted = None if selection.robot_is_guessed and not mass_is_given else weight
    alone = [_level(selection, samples, foot) for foot, samples in enumerate(probe.feet)]
    levels = weighed_levels(turned_levels(alone, trusted), trusted)
    estimated = weight_of_levels(levels) if weight is None else None
    thresholds = _thresholds(selection.robot)
    feet = []
    for foot, level in enumerate(levels):
        rule = contact_rule(level, weight or estimated, thresholds)
        if selection.has_flags(foot):
            rule = replace(rule, by_flag=True, backdates=False, unusable="")
        elif _is_stuck(level) and any(each.loaded_n and not _is_stuck(each) for each in levels):
            rule = replace(rule, unusable="its sensor reads one constant force while others vary")
        feet.append(FootSensor(level, rule))
    return LearntSensors(tuple(feet), estimated)


def _is_stuck(level: SensorLevel) -> bool:
    """Tell whether a sensor reads one force throughout."""
    return level.reason == CONSTANT and bool(level.loaded_n)


def _level(selection: Selection, samples: Samples, foot: int) -> SensorLevel:
    """Estimate a foot's level, or take the one that is given."""
    robot = selection.robot
    is_given = robot.is_given(f"tare.{robot.feet[foot].name}")
    takes_offsets = robot.tare != "none"
    known = robot.feet[foot].offset_n if takes_offsets or is_given else None
    if known is None and (level := _zero(selection, samples, foot)) is not None:
        return level
    if known is None and takes_offsets:
        level = estimate_level(samples.log_time, samples.force)
        if level.zero_in_swing or level.reason:
            return level
        return follow_level(samples.log_time, samples.force, level)
    offset = np.array([known or (0.0, 0.0, 0.0)])
    rest = estimate_level(samples.log_time, samples.force - offset)
    origin: Origin = "robot" if known is not None and not is_given else "option"
    return replace(rest, knots=np.zeros(1, np.int64), offset=offset, origin=origin, reason="")


def _zero(selection: Selection, samples: Samples, foot: int) -> SensorLevel | None:
    """Return the level of a foot whose sensor reads zero in swing; None: it does not."""
    sources = selection.sources_of(foot)
    force = samples.force[all_finite(samples.force)]
    interval_s = usual_interval_s(samples.log_time)
    zero = SensorLevel(zero_in_swing=True)
    if any(source.silent_in_swing for source in sources):
        # Its samples are those in contact only, and their mean is no mean over strides.
        level = zero_level(np.concatenate([np.zeros((len(force) + 3, 3)), force]), interval_s)
        return replace(level or zero, mean_n=None)
    if not selection.knows_force(foot):
        return replace(zero, interval_s=interval_s)
    if not len(force):
        return None
    level = zero_level(force, interval_s)
    if level is None and all(source.lists_contacts for source in sources):
        # A foot that is down throughout: its messages would say if it were not.
        mean = float(median_of(norms(force)))
        return replace(zero, loaded_n=mean, mean_n=mean, interval_s=interval_s)
    return level


def _thresholds(robot: Robot) -> Thresholds:
    """Return the thresholds of the robot's file, or of this call; None: to be chosen."""
    is_given = robot.is_given("contact_on_n")
    return Thresholds(
        robot.contact_on_n,
        robot.contact_off_n,
        robot.debounce_s,
        origin="option" if is_given else "robot",
    )
