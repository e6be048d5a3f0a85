"""Findings about clocks and the timing of topics."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from dogbot_logtool.core.findings.wording import counted
from dogbot_logtool.core.geometry.clock import TimeSource
from dogbot_logtool.core.quality.quality import TopicQuality
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding

FAR_S: Final = 10.0
"""s: stamps further from log time are on another clock, not only delayed."""


def clock_findings(stats: Stats) -> Iterator[Finding]:
    """Yield what is to be said of the clock that is measured on."""
    settings = stats.settings
    if settings.time_source_reason:
        text = f"{settings.time_source_reason}: everything is measured on log time"
        yield Finding("W_LOG_TIME_USED", text, "settings.time_source")
    on_log_time = settings.clock is TimeSource.LOG
    steps = {step: topic.topic for topic in stats.topics for step in topic.clock_steps}
    for step, topic in steps.items():
        back = "back" if step.by_ns < 0 else "forward"
        at = f" at {stats.seconds(np.array([step.after]))[0]:.2f} s" if on_log_time else ""
        text = f"{topic}: its clock was set {back} by {abs(step.by_ns) / 1e9:.2f} s{at}"
        yield Finding("W_CLOCK_SET", text, "settings.time_source")


def topic_findings(topic: TopicQuality, *, may_pause: bool) -> Iterator[Finding]:
    """Yield what is odd in the timing of a topic.

    Args:
        topic: its timing.
        may_pause: whether it is silent now and then, as commands are while no one steers.
    """
    name = topic.topic
    if topic.gaps and not may_pause:
        gaps = counted(topic.gaps, "gap")
        text = f"{gaps}, {topic.gaps_total_s:.2f} s in all, the longest {topic.longest_gap_s:.2f} s"
        yield Finding("W_GAPS", f"{name}: {text}", name)
    for code, count, what in (
        ("W_ZERO_STAMPS", topic.zero_stamps, "with a zero header stamp"),
        ("W_STAMPS_AHEAD", topic.stamps_ahead, "with a header stamp later than those that follow"),
        ("W_BACKWARD_STAMPS", topic.backward_stamps, "with a header stamp that goes backwards"),
        ("W_DUPLICATE_STAMPS", topic.duplicate_stamps, "with the header stamp of the one before"),
        ("W_BACKWARD_LOG_TIMES", topic.backward_log_times, "logged out of order"),
        ("N_DUPLICATE_LOG_TIMES", topic.duplicate_log_times, "with the log time of the one before"),
    ):
        if count:
            messages = counted(topic.messages, "message")
            yield Finding(code, f"{name}: {count} of {messages} {what}", name)
    if topic.offset_median_s is not None and abs(topic.offset_median_s) > FAR_S:
        where = "before" if topic.offset_median_s > 0.0 else "after"
        text = f"{name}: its stamps lie {abs(topic.offset_median_s):.1f} s {where} log time"
        yield Finding("N_STAMPS_FAR", text, name)
    if topic.offset_drift_ppm is not None and abs(topic.offset_drift_ppm) > 1e4:
        rate = 1.0 / (1.0 + topic.offset_drift_ppm / 1e6)
        text = f"{name}: its stamps run at {rate:.2f} times the speed of log time"
        yield Finding("N_CLOCKS_DIFFER", text, name)
