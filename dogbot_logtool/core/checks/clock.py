"""Checks of clocks and of the timing of topics."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from dogbot_logtool.core.checks.wording import counted
from dogbot_logtool.core.consistency.heave import Delay
from dogbot_logtool.core.corrections.clock import ClockDifference, TimeSource
from dogbot_logtool.core.quality.quality import TopicQuality
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding

FAR_S: Final = 10.0
"""s: stamps further from log time are on another clock, not only delayed."""
OTHER_SPEED_PPM: Final = 1e4
"""Millionths by which a clock may run faster or slower than log time."""


def clock_set(stats: Stats) -> Iterator[Finding]:
    """Yield why stamps are not used, and where the clock was set."""
    settings = stats.settings
    if settings.time_source_reason:
        text = f"{settings.time_source_reason}: everything is measured on log time"
        yield Finding("LOG_TIME_USED", text, "settings.time_source")
    on_log_time = settings.clock is TimeSource.LOG
    steps = {step: topic.topic for topic in stats.topics for step in topic.clock_steps}
    for step, topic in steps.items():
        back = "back" if step.by_ns < 0 else "forward"
        at = f" at {stats.seconds(np.array([step.after]))[0]:.2f} s" if on_log_time else ""
        text = f"{topic}: its clock was set {back} by {abs(step.by_ns) / 1e9:.2f} s{at}"
        yield Finding("CLOCK_SET", text, "settings.time_source")


def clocks_differ(stats: Stats) -> Iterator[Finding]:
    """Yield topics whose clocks differ from that of the feet, by stamps or by physics."""
    for each in stats.clocks:
        if each.is_apart:
            yield _clock(stats, each)
    if stats.base_delay is not None:
        yield _heave(stats.settings.odometry_topic, stats.base_delay)


def _clock(stats: Stats, difference: ClockDifference) -> Finding:
    topic = difference.topic
    where = "behind" if difference.behind_s > 0.0 else "ahead of"
    text = (
        f"{topic}: its clock is {abs(difference.behind_s):.3f} s {where} that of the feet "
        f"(header stamps against log time, +- {difference.jitter_s:.3f} s)"
    )
    if abs(difference.drift_s) > max(difference.jitter_s, 0.5 * abs(difference.behind_s)):
        text += f", drifting by {difference.drift_s:+.3f} s over the log"
    if topic not in stats.clocks_apart:
        text += "; that is little of a stride"
        return Finding("CLOCK_OFFSET", text, topic, cases=("little",))
    case = "base" if topic == stats.settings.odometry_topic else "feet"
    return Finding("CLOCK_OFFSET", text, topic, cases=(case,))


def _heave(topic: str, delay: Delay) -> Finding:
    where = "after" if delay.delay_s > 0.0 else "before"
    text = (
        f"{topic}: the base goes up and down {abs(delay.delay_s):.3f} s {where} the feet's forces "
        f"drive it ({delay.low_s:+.2f} to {delay.high_s:+.2f} s, correlation "
        f"{delay.correlation:.2f}), whatever the stamps say"
    )
    return Finding("CLOCK_OFFSET", text, topic, cases=("base",))


def feet_silent(stats: Stats) -> Iterator[Finding]:
    """Yield time in which no foot tells anything, though the odometry does."""
    if not len(stats.all_silent):
        return
    starts = stats.seconds(stats.all_silent[:, 0])
    lengths = (stats.all_silent[:, 1] - stats.all_silent[:, 0]) / 1e9
    times = counted(len(starts), "time")
    text = (
        f"all feet are silent at once, {times}, first at {starts[0]:.2f} s, {lengths.sum():.2f} s "
        "in all, while the odometry goes on"
    )
    yield Finding("ALL_FEET_SILENT", text, "feet")


def topics_timed(stats: Stats) -> Iterator[Finding]:
    """Yield what is odd in the timing of topics; commands may pause while no one steers."""
    for topic in stats.topics:
        if topic.gaps and topic.topic != stats.settings.command_topic:
            gaps = counted(topic.gaps, "gap")
            text = f"{topic.topic}: {gaps}, {topic.gaps_total_s:.2f} s in all, the longest "
            yield Finding("GAPS", f"{text}{topic.longest_gap_s:.2f} s", topic.topic)
        yield from _stamps(topic)
        yield from _against_log_time(topic)


def _stamps(topic: TopicQuality) -> Iterator[Finding]:
    """Yield how many of a topic's times are bad, by kind."""
    for code, count, what in (
        ("BAD_STAMPS", topic.zero_stamps, "with a zero header stamp"),
        ("BAD_STAMPS", topic.stamps_ahead, "with a header stamp later than those that follow"),
        ("BAD_STAMPS", topic.backward_stamps, "with a header stamp that goes backwards"),
        ("BAD_STAMPS", topic.duplicate_stamps, "with the header stamp of the one before"),
        ("OUT_OF_ORDER", topic.backward_log_times, "logged out of order"),
        ("OUT_OF_ORDER", topic.duplicate_log_times, "with the log time of the one before"),
    ):
        if count:
            messages = counted(topic.messages, "message")
            yield Finding(code, f"{topic.topic}: {count} of {messages} {what}", topic.topic)


def _against_log_time(topic: TopicQuality) -> Iterator[Finding]:
    name, offset_s, drift_ppm = topic.topic, topic.offset_median_s, topic.offset_drift_ppm
    if offset_s is not None and abs(offset_s) > FAR_S:
        where = "before" if offset_s > 0.0 else "after"
        text = f"{name}: its stamps lie {abs(offset_s):.1f} s {where} log time"
        yield Finding("CLOCK_OFFSET", text, name, cases=("little",))
    if drift_ppm is not None and abs(drift_ppm) > OTHER_SPEED_PPM:
        rate = 1.0 / (1.0 + drift_ppm / 1e6)
        text = f"{name}: its stamps run at {rate:.2f} times the speed of log time"
        yield Finding("CLOCK_OFFSET", text, name, cases=("little",))
