"""All figures of `stats` as plain data: the shape that `stats.schema.json` describes."""

import json
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, Final

from dogbot_logtool import __version__
from dogbot_logtool.core.base.base_motion import BaseMotion
from dogbot_logtool.core.gait.foot_statistics import FootFigures
from dogbot_logtool.core.gait.gait import diagonality
from dogbot_logtool.core.gait.segments import Segment
from dogbot_logtool.core.geometry.aggregates import Aggregate
from dogbot_logtool.core.load.load_figures import grouped_shares, symmetry_index_percent
from dogbot_logtool.core.quality.quality import TopicQuality
from dogbot_logtool.core.remarks import remarks
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.listing import listed
from dogbot_logtool.io.plain_json import not_finite, only_finite
from dogbot_logtool.results import LogFacts

SCHEMA_VERSION: Final = 1
"""Grows with every change of meaning."""
LOADING_RATE_METHOD: Final = "slope from 20 % to 80 % of the rise to the first peak"

Json = dict[str, Any]


@cache
def stats_schema() -> Json:
    """Return the JSON Schema of `stats_json`."""
    file = Path(__file__).with_name("stats.schema.json")
    schema: Json = json.loads(file.read_text(encoding="utf-8"))
    return schema


def stats_json(stats: Stats, log: LogFacts) -> Json:
    """Return all figures of one log as plain data; what is not known is None."""
    document = _document(stats, log)
    if overflowed := list(not_finite(document)):
        text = f"figures that are too large for a number are null: {listed(overflowed)}"
        document["notes"].append({"code": "N_OVERFLOW", "text": text, "where": ""})
    finite: Json = only_finite(document)
    return finite


def _document(stats: Stats, log: LogFacts) -> Json:
    said = [*remarks(stats), *log.findings]
    warnings = [_finding(each) for each in said if not each.code.startswith("N_")]
    notes = [_finding(each) for each in said if each.code.startswith("N_")]
    return {
        "schema_version": SCHEMA_VERSION,
        "tool": {"name": "dogbot-logtool", "version": __version__},
        "log": {
            "path": log.path,
            "container": log.container,
            "profile": log.profile,
            "start_s": log.start_s,
            "duration_s": log.duration_s,
            "messages": log.messages,
        },
        "settings": _settings(stats),
        "notes": notes,
        "base": _base(stats.base),
        "feet": {foot.name: _foot(stats, foot) for foot in stats.feet},
        "gait": _gait(stats),
        "forces": _forces(stats),
        "stability": _stability(stats),
        "quality": {
            "topics": {topic.topic: _topic(stats, topic) for topic in stats.topics},
            "overlap_s": stats.overlap_s,
            "lost_messages": log.lost_messages,
            "lost_bytes": log.lost_bytes,
            "losses": list(log.losses),
            "findings": sorted(warnings, key=lambda each: not each["code"].startswith("E_")),
        },
    }


def _finding(each: Finding) -> Json:
    return {"code": each.code, "text": each.text, "where": each.where}


def _aggregate(value: Aggregate | None, scale: float = 1.0) -> Json | None:
    if value is None:
        return None
    std = None if value.std is None else value.std * scale
    return {
        "n": value.n,
        "mean": value.mean * scale,
        "std": std,
        "median": value.median * scale,
        "min": value.min * scale,
        "max": value.max * scale,
    }


def _settings(stats: Stats) -> Json:
    settings, rule = stats.settings, stats.settings.rule
    return {
        "time_source": str(settings.clock),
        "time_source_forced": settings.time_source is not None and not settings.time_source_reason,
        "time_origin_ns": stats.origin,
        "mass_kg": settings.mass_kg,
        "body_weight_n": settings.body_weight_n,
        "forward_axis": settings.forward_axis,
        "wrench_frame": str(settings.wrench_frame),
        "contact_on_n": rule.on_n,
        "contact_off_n": rule.off_n,
        "contact_on_counts": settings.contact_on_counts,
        "debounce_s": rule.debounce_s,
        "foot_rolling_m": settings.foot_rolling_m,
        "reference_foot": stats.feet[stats.reference].name if stats.feet else None,
        "odometry_topic": settings.odometry_topic or None,
        "loading_rate_method": LOADING_RATE_METHOD,
    }


def _base(base: BaseMotion | None) -> Json | None:
    if base is None:
        return None
    return {
        "duration_s": base.duration_s,
        "path_length_m": base.path_length_m,
        "net_displacement_m": base.net_displacement_m,
        "mean_speed_mps": base.mean_speed_mps,
        "forward_speed_mps": base.forward_speed_mps,
        "lateral_speed_mps": base.lateral_speed_mps,
        "yaw_change_rad": base.yaw_change_rad,
        "height_m": _aggregate(base.height_m),
        "roll_rad": _aggregate(base.roll_rad),
        "pitch_rad": _aggregate(base.pitch_rad),
        "froude": base.froude,
        "twist_frame": base.twist_frame,
    }


def _foot(stats: Stats, foot: FootFigures) -> Json:
    weight = stats.settings.body_weight_n
    per_weight = None if weight is None else 1.0 / weight

    def in_weights(value: Aggregate | None) -> Json | None:
        return None if per_weight is None else _aggregate(value, per_weight)

    record = foot.record
    return {
        "topic": foot.topic,
        "place": None if foot.place is None else list(foot.place),
        "messages": record.messages,
        "not_finite": record.not_finite,
        "not_advancing": record.not_advancing,
        "contact_fraction": foot.contact_fraction,
        "strides": len(foot.strides.stance),
        "discarded_strides": dict(foot.discarded),
        "chatter": {
            "filled_swings": record.filled_swings,
            "dropped_stances": record.dropped_stances,
        },
        "stance_s": _aggregate(foot.stance_s),
        "swing_s": _aggregate(foot.swing_s),
        "stride_period_s": _aggregate(foot.stride_period_s),
        "stride_frequency_hz": foot.stride_frequency_hz,
        "duty_factor": _aggregate(foot.duty_factor),
        "stride_length_m": _aggregate(foot.stride_length_m),
        "peak_force_n": _aggregate(foot.peak_force_n),
        "peak_force_bw": in_weights(foot.peak_force_n),
        "mean_force_n": _aggregate(foot.mean_force_n),
        "mean_force_bw": in_weights(foot.mean_force_n),
        "peak_vertical_force_n": _aggregate(foot.peak_vertical_force_n),
        "peak_vertical_force_bw": in_weights(foot.peak_vertical_force_n),
        "mean_vertical_force_n": _aggregate(foot.mean_vertical_force_n),
        "mean_vertical_force_bw": in_weights(foot.mean_vertical_force_n),
        "vertical_impulse_ns": foot.vertical_impulse_ns,
        "loading_rate_nps": _aggregate(foot.loading_rate_nps),
        "impact_ratio": _aggregate(foot.impact_ratio),
        "contact_travel_m": _aggregate(foot.contact_travel_m),
        "slip_m": _aggregate(foot.slip_distance_m),
        "friction_use": _aggregate(foot.friction_use),
        "contact_without_odometry_s": stats.contact_without_pose_s[stats.feet.index(foot)],
        "touchdown_s": stats.seconds(foot.touchdown),
        "liftoff_s": stats.seconds(foot.liftoff),
    }


def _gait(stats: Stats) -> Json:
    main = stats.main
    gait = _segment(stats, main) if main else dict.fromkeys(_SEGMENT_KEYS)
    del gait["start_s"], gait["end_s"], gait["strides"]
    supported = stats.support
    return {
        **gait,
        "segments": [_segment(stats, segment) for segment in stats.segments],
        "support": None
        if supported is None
        else {str(number): share for number, share in enumerate(supported.feet_down)},
        "support_sets": None
        if supported is None
        else [
            {"feet": [stats.feet[foot].name for foot in feet], "fraction": share}
            for feet, share in supported.sets
        ],
        "flight_fraction": None if supported is None else supported.flight_fraction,
    }


_SEGMENT_KEYS: Final = (
    "start_s",
    "end_s",
    "strides",
    "class",
    "sequence",
    "nearest_class",
    "class_distance",
    "running",
    "duty_factor",
    "stride_frequency_hz",
    "diagonality",
    "phase",
)


def _segment(stats: Stats, segment: Segment) -> Json:
    corners = [segment.phases[foot] for foot in stats.corners or ()]
    phases = [phase.mean for phase in corners if phase is not None]
    start, end = (each / 1e9 for each in (segment.spans[0] - stats.origin).tolist())
    duty = segment.duty_factor
    return {
        "start_s": start,
        "end_s": end,
        "strides": segment.strides,
        "class": segment.gait.name,
        "sequence": segment.gait.sequence,
        "nearest_class": segment.gait.nearest,
        "class_distance": segment.gait.distance,
        "running": None if duty is None else duty < 0.5,
        "duty_factor": duty,
        "stride_frequency_hz": segment.stride_frequency_hz,
        "diagonality": diagonality(phases) if len(phases) == 4 else None,
        "phase": {
            foot.name: None
            if phase is None
            else {"mean": phase.mean, "consistency": phase.consistency}
            for foot, phase in zip(stats.feet, segment.phases, strict=True)
        },
    }


def _forces(stats: Stats) -> Json:
    loads = stats.loads
    shares: Json | None = None
    if loads.shares is not None:
        each = {foot.name: share for foot, share in zip(stats.feet, loads.shares, strict=True)}
        shares = {
            "feet": each,
            **grouped_shares(loads.shares, [foot.place for foot in stats.feet]),
        }
    return {
        "vertical_impulse_over_weight": loads.vertical_impulse_over_weight,
        "known_s": loads.known_s,
        "load_share_of": loads.share_of,
        "load_share": shares,
        "symmetry_index_percent": symmetry(stats),
        "wrench_frame": str(stats.settings.wrench_frame),
    }


def symmetry(stats: Stats) -> Json | None:
    """Return symmetry indices of the fore and the hind pair; None unless it is a quadruped."""
    if stats.corners is None:
        return None
    feet = [stats.feet[foot] for foot in stats.corners]
    return {
        name: {
            key: symmetry_index_percent(_mean(left, key), _mean(right, key))
            for key in ("stance_s", "duty_factor", "peak_force_n")
        }
        for name, left, right in (("fore", feet[0], feet[1]), ("hind", feet[2], feet[3]))
    }


def _mean(foot: FootFigures, key: str) -> float | None:
    value: Aggregate | None = getattr(foot, key)
    return None if value is None else value.mean


def _stability(stats: Stats) -> Json | None:
    figures = stats.stability
    if figures is None:
        return None
    return {
        "static_margin_m": _aggregate(figures.static_margin_m),
        "undefined_fraction": figures.undefined_fraction,
        "unstable_fraction": figures.unstable_fraction,
        "centre_of_pressure_forward_m": _aggregate(figures.pressure_forward_m),
        "centre_of_pressure_left_m": _aggregate(figures.pressure_left_m),
    }


def _topic(stats: Stats, topic: TopicQuality) -> Json:
    # A topic on another clock than the figures counts from its own first message.
    origin = stats.origin if topic.clock is stats.settings.clock else topic.first
    return {
        "messages": topic.messages,
        "clock": str(topic.clock),
        "first_s": (topic.first - origin) / 1e9,
        "last_s": (topic.last - origin) / 1e9,
        "rate_hz": topic.rate_hz,
        "median_rate_hz": topic.median_rate_hz,
        "interval_s": topic.interval_s,
        "gaps": {
            "count": topic.gaps,
            "total_s": topic.gaps_total_s,
            "longest": [
                {"start_s": (gap.start - origin) / 1e9, "length_s": gap.length_s}
                for gap in topic.longest_gaps
            ],
        },
        "duplicate_stamps": topic.duplicate_stamps,
        "backward_stamps": topic.backward_stamps,
        "zero_stamps": topic.zero_stamps,
        "duplicate_log_times": topic.duplicate_log_times,
        "backward_log_times": topic.backward_log_times,
        "header_to_log_offset_s": topic.offset_median_s,
        "header_to_log_drift_ppm": topic.offset_drift_ppm,
        "frame_ids": list(topic.frame_ids),
    }


def several_logs(results: Sequence[Mapping[str, Any]]) -> Any:  # noqa: ANN401 - JSON
    """Return one object for one log, a list for several."""
    return results[0] if len(results) == 1 else list(results)
