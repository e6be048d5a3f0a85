"""Findings about topics that contradict one another: their clocks, their worlds, their silences."""

from collections.abc import Iterator

from dogbot_logtool.core.consistency.worlds import Worlds
from dogbot_logtool.core.findings.wording import counted
from dogbot_logtool.core.geometry.delay import Delay
from dogbot_logtool.core.quality.clocks import ClockDifference
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding


def contradiction_findings(stats: Stats) -> Iterator[Finding]:
    """Yield where the log's topics contradict one another."""
    for each in stats.clocks:
        if each.is_apart:
            yield _clock(stats, each)
    if stats.base_delay is not None:
        yield _heave(stats.settings.odometry_topic, stats.base_delay)
    if stats.worlds is not None and stats.worlds_differ:
        yield _worlds(stats.worlds, loses_way=stats.loses_way)
    if len(stats.all_silent):
        yield _silence(stats)


def why_feet_and_base_are_apart(stats: Stats) -> str:
    """Say why figures of feet and base together are null; empty where nothing parts them."""
    if stats.feet_clocks_are_apart:
        return "the clocks of the feet's topics differ"
    if stats.base_clock_is_apart:
        return "the clocks of odometry and feet differ"
    if stats.worlds_differ:
        return "contact points and odometry are not in one world"
    return ""


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
        return Finding("N_CLOCK_OFFSET", f"{text}; that is little of a stride", topic)
    null = "stride lengths and stability"
    if topic != stats.settings.odometry_topic:
        null = "the gait, support and stability"
    return Finding("W_CLOCK_OFFSET", f"{text}: {null} are null", topic)


def _heave(topic: str, delay: Delay) -> Finding:
    where = "after" if delay.delay_s > 0.0 else "before"
    text = (
        f"{topic}: the base goes up and down {abs(delay.delay_s):.3f} s {where} the feet's forces "
        f"drive it ({delay.low_s:+.2f} to {delay.high_s:+.2f} s, correlation "
        f"{delay.correlation:.2f}), whatever the stamps say: stride lengths and stability are null"
    )
    return Finding("W_CLOCK_OFFSET", text, topic)


def _worlds(worlds: Worlds, *, loses_way: bool) -> Finding:
    text = (
        "contact points and odometry are not in one world, or one drifts: the base is "
        f"{worlds.distance_m:.2f} m from the centroid of the feet (at most {worlds.largest_m:.2f} "
        f"m), which are {worlds.spread_m:.2f} m from it; from the log's start to its end that "
        f"changes by {max(worlds.change_m, worlds.drift_m):.2f} m"
    )
    null = "no stability"
    if loses_way:
        null += ", path, speeds, stride lengths, swings and tracking of commanded speeds"
    return Finding("W_WORLDS_DIFFER", f"{text}; {null}", "stability")


def _silence(stats: Stats) -> Finding:
    starts = stats.seconds(stats.all_silent[:, 0])
    lengths = (stats.all_silent[:, 1] - stats.all_silent[:, 0]) / 1e9
    times = counted(len(starts), "time")
    text = (
        f"all feet are silent at once, {times}, first at {starts[0]:.2f} s, {lengths.sum():.2f} s "
        "in all, while the odometry goes on"
    )
    return Finding("W_ALL_FEET_SILENT", text, "feet")
