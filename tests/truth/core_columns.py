"""A recording as the columns that the core measures."""

import numpy as np

from dogbot_logtool.core.base.poses import Odometry
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.settings import FootSettings, WalkSettings
from dogbot_logtool.core.walk import Walk
from tests.analysed import analysed
from tests.truth.recording import Recording


def foot_samples(recording: Recording, foot: int) -> Samples:
    """Return one foot's messages as the reader makes them."""
    messages = recording.feet[foot]
    count = len(messages.time)
    has_points = recording.kind != "wrench"
    touching = messages.touching if has_points else (messages.force != 0.0).any(axis=1)
    unknown = np.where(touching & has_points, 0.0, np.nan)[:, None]
    return Samples(
        foot=np.full(count, foot, np.int64),
        log_time=messages.log_time,
        stamp=messages.stamp,
        in_contact=touching,
        force=np.where(touching[:, None], messages.force, 0.0),
        in_world=np.zeros(count, np.bool_),
        points=(touching & has_points).astype(np.int64),
        position=messages.point + unknown,
        normal=messages.normal + unknown,
    )


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
    return analysed(settings or stats_settings(recording), samples, odometry(recording))
