"""Checks of clocks and of the timing of topics."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from dogbot_logtool.core.consistency import all_silent
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding, Words, found

FAR_S: Final = 10.0
"""s: stamps further from log time are on another clock, not only delayed."""
OTHER_SPEED_PPM: Final = 1e4
"""Millionths by which a clock may run faster or slower than log time."""
_ODD_TIMES: Final = (
    ("BAD_STAMPS", "zero_stamps", "with a zero header stamp"),
    ("BAD_STAMPS", "stamps_ahead", "with a header stamp later than those that follow"),
    ("BAD_STAMPS", "backward_stamps", "with a header stamp that goes backwards"),
    ("BAD_STAMPS", "duplicate_stamps", "with the header stamp of the one before"),
    ("OUT_OF_ORDER", "backward_log_times", "logged out of order"),
    ("OUT_OF_ORDER", "duplicate_log_times", "with the log time of the one before"),
)
"""Code, count among a topic's timing, and what is counted."""


def clock_set(walk: Walk) -> Iterator[Finding]:
    """Yield why stamps are not used, and where the clock was set."""
    settings, where = walk.settings, "settings.time_source"
    if settings.time_source_reason:
        yield found("LOG_TIME_USED", where=where, why=settings.time_source_reason)
    on_log_time = settings.clock is TimeSource.LOG
    steps = {step: each.topic for each in walk.corrected.topics for step in each.clock_steps}
    for step, topic in steps.items():
        at = f" at {walk.seconds(np.array([step.after]))[0]:.2f} s" if on_log_time else ""
        way, seconds = "back" if step.by_ns < 0 else "forward", abs(step.by_ns) / 1e9
        yield found("CLOCK_SET", where=where, topic=topic, way=way, seconds=seconds, at=at)


def clocks_differ(walk: Walk) -> Iterator[Finding]:
    """Yield topics whose clocks differ from that of the feet, by stamps or by physics."""
    base_topic, delay = walk.settings.odometry_topic, walk.base_delay
    feet = walk.feet_on_poses
    for each in walk.corrected.clocks:
        if not each.is_apart:
            continue
        case = "base" if each.topic == base_topic else "feet"
        case = case if each.topic in walk.clocks_apart else "little"
        steady_s = max(each.jitter_s, 0.5 * abs(each.behind_s))
        drifts = f", drifting by {each.drift_s:+.3f} s over the log"
        drifts = drifts if abs(each.drift_s) > steady_s else ""
        seconds, way = abs(each.behind_s), "behind" if each.behind_s > 0.0 else "ahead of"
        words: Words = {"topic": each.topic, "seconds": seconds, "way": way, "drifts": drifts}
        yield found("CLOCK_OFFSET", case, feet=feet, clock=each, **words)
    if delay is not None:
        seconds, way = abs(delay.delay_s), "after" if delay.delay_s > 0.0 else "before"
        words = {"topic": base_topic, "seconds": seconds, "way": way}
        yield found("CLOCK_OFFSET", "base", say="heave", feet=feet, delay=delay, **words)


def feet_silent(walk: Walk) -> Iterator[Finding]:
    """Yield time in which no foot tells anything, though the odometry does."""
    silent = all_silent(walk.records, walk.poses)
    if len(silent):
        first, seconds = walk.seconds(silent[:, 0])[0], np.diff(silent).sum() / 1e9
        words: Words = {"times": len(silent), "first": first, "seconds": seconds}
        yield found("GAPS", say="all_feet", where="feet", **words)


def topics_timed(walk: Walk) -> Iterator[Finding]:
    """Yield what is odd in the timing of topics; commands may pause while no one steers."""
    for each in walk.corrected.topics:
        topic, offset_s, drift_ppm = each.topic, each.clock_offset_s, each.clock_drift_ppm
        if each.gaps and topic != walk.settings.command_topic:
            yield found("GAPS", where=topic, timing=each)
        for code, field, what in _ODD_TIMES:
            if count := getattr(each, field):
                yield found(code, topic=topic, count=count, messages=each.messages, what=what)
        if offset_s is not None and abs(offset_s) > FAR_S:
            way, seconds = "before" if offset_s > 0.0 else "after", abs(offset_s)
            yield found("CLOCK_OFFSET", "little", say="far", topic=topic, seconds=seconds, way=way)
        if drift_ppm is not None and abs(drift_ppm) > OTHER_SPEED_PPM:
            rate = 1.0 / (1.0 + drift_ppm / 1e6)
            yield found("CLOCK_OFFSET", "little", say="speed", topic=topic, rate=rate)
