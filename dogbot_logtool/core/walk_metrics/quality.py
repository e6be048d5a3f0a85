"""Metrics of the recording itself."""

from collections.abc import Sequence

from dogbot_logtool.core.findings.checks import checks_of
from dogbot_logtool.core.metrics import Check, FootQuality, Quality, TopicQuality
from dogbot_logtool.core.quality.quality import TopicQuality as TopicTiming
from dogbot_logtool.core.records import Count
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding


def quality_metrics(stats: Stats, findings: Sequence[Finding]) -> Quality:
    """Return what tells whether a recording can be trusted."""
    worlds = stats.worlds
    return Quality(
        topics={topic.topic: _topic(topic) for topic in stats.topics},
        feet={foot.name: _foot(stats, row) for row, foot in enumerate(stats.feet)},
        overlap_s=stats.overlap_s,
        base_to_feet_m=None if worlds is None else worlds.distance_m,
        feet_spread_m=None if worlds is None else worlds.spread_m,
        checks=tuple(
            Check(each.name, each.outcome.value, each.reason or None)
            for each in checks_of(stats, findings)
        ),
    )


def _topic(topic: TopicTiming) -> TopicQuality:
    intervals = topic.interval_s
    return TopicQuality(
        messages=topic.messages,
        rate_hz=topic.rate_hz,
        interval_p95_s=None if intervals is None else intervals["p95"],
        interval_max_s=None if intervals is None else intervals["max"],
        gaps=topic.gaps,
        gaps_total_s=topic.gaps_total_s,
        bad_stamps=_bad_stamps(topic),
        clock_offset_s=topic.offset_median_s,
        clock_drift_ppm=topic.offset_drift_ppm,
    )


def _bad_stamps(topic: TopicTiming) -> Count:
    """Return how many header stamps cannot be right; None where messages have none."""
    kinds = (
        topic.zero_stamps,
        topic.duplicate_stamps,
        topic.backward_stamps,
        topic.stamps_ahead,
    )
    known = [each for each in kinds if each is not None]
    return sum(known) if len(known) == len(kinds) else None


def _foot(stats: Stats, row: int) -> FootQuality:
    foot, level = stats.feet[row], stats.settings.sensor(row).level
    return FootQuality(
        not_finite=foot.record.not_finite,
        filled_swings=foot.record.filled_swings,
        dropped_stances=foot.record.dropped_stances,
        discarded_strides=dict(foot.discarded),
        spikes=foot.spikes,
        force_offset_n=None if level.reason else tuple(level.offset_n.tolist()),
        force_noise_n=level.noise_n,
        force_drift_n_per_min=level.drift_n_per_min,
    )
