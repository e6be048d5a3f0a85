"""A recording as the columns that the core measures."""

import numpy as np

from dogbot_logtool.core.base.poses import Odometry
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.settings import FootSettings, WalkSettings
from dogbot_logtool.core.walk import Walk
from tests import analysed
from tests.truth.recording import Recording


def foot_samples(recording: Recording, foot: int) -> Samples:
    """Return one foot's messages."""
    messages = recording.feet[foot]
    if recording.kind == "wrench":
        touching, point = (messages.force != 0.0).any(axis=1), np.full_like(messages.point, np.nan)
    else:
        touching, point = messages.touching, messages.point
    times = messages.stamp, messages.log_time
    return analysed.foot_samples(foot, *times, touching, messages.force, point, messages.normal)


def odometry(recording: Recording) -> Odometry:
    """Return the base's messages as the reader makes them."""
    base = recording.base
    return Odometry(
        base.log_time,
        base.stamp,
        base.position,
        base.orientation,
        base.velocity,
        np.zeros_like(base.velocity),
    )


def stats_settings(recording: Recording, **changes: object) -> WalkSettings:
    """Return settings that are true of the recording, but for what is changed."""
    robot = recording.robot
    lists = recording.kind != "wrench"
    feet = tuple(
        FootSettings(name, robot.topic(row), _position(name), lists_contacts=lists)
        for row, name in enumerate(robot.feet)
    )
    known: dict[str, object] = {
        "mass_kg": robot.mass_kg,
        "wrench_frame": WrenchFrame.WORLD,
        "odometry_topic": robot.odometry_topic,
    }
    return WalkSettings(feet, **{**known, **changes})  # type: ignore[arg-type]


def _position(name: str) -> tuple[str, str] | None:
    end, _, side = name.partition("_")
    return (end, side) if side else None


def measure(recording: Recording, settings: WalkSettings | None = None) -> Walk:
    """Analyse a recording."""
    samples = [foot_samples(recording, foot) for foot in range(len(recording.feet))]
    return analysed.analysed(settings or stats_settings(recording), samples, odometry(recording))
