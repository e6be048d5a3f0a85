"""Metrics that had another key before schema 3, for a sentence with the new one."""

from collections.abc import Mapping
from typing import Final

RENAMED: Final[Mapping[str, str]] = {
    "settings.time_source": "settings.clock",
    "settings.contact_on_n": "settings.feet.*.contact_on_n",
    "settings.contact_off_n": "settings.feet.*.contact_off_n",
    "settings.debounce_s": "settings.feet.*.debounce_s",
    "settings.sensors.*": "settings.feet.*",
    "base.mean_speed_mps": "base.forward_speed_mps",
    "feet.*.topic": "settings.feet.*.topic",
    "feet.*.place": "settings.feet.*.leg_position",
    "feet.*.messages": "quality.topics.*.messages",
    "feet.*.sampling_interval_s": "quality.topics.*.rate_hz",
    "feet.*.not_finite": "quality.feet.*.not_finite",
    "feet.*.force_offset_n": "quality.feet.*.force_offset_n",
    "feet.*.force_noise_n": "quality.feet.*.force_noise_n",
    "feet.*.force_drift_n_per_min": "quality.feet.*.force_drift_n_per_min",
    "feet.*.discarded_strides": "quality.feet.*.discarded_strides",
    "feet.*.chatter": "quality.feet.*",
    "feet.*.spikes": "quality.feet.*.spikes",
    "feet.*.mean_force_bw": "feet.*.mean_force_n",
    "feet.*.mean_vertical_force_bw": "feet.*.mean_vertical_force_n",
    "feet.*.slip_source": "feet.*.slip_from",
    "feet.*.force_curves": "feet.*",
    "feet.*.liftoff_s": "feet.*.lift_off_s",
    "feet.*.planned.touchdown_delay_s": "feet.*.planned.delay_s",
    "feet.*.planned.contact_agreement": "feet.*.planned.agreement",
    "gait.class": "gait.name",
    "gait.nearest_class": "gait.nearest_name",
    "gait.duty_below_half": "gait.duty_factor",
    "gait.phase_left_hind.*.mean": "gait.phase.*.left_hind",
    "forces.mean_vertical_n": "settings.body_weight_n",
    "forces.weight_n": "settings.body_weight_n",
    "forces.weight_source": "settings.weight_source",
    "forces.load_share.hind": "forces.load_share.fore",
    "forces.load_share.right": "forces.load_share.left",
    "forces.wrench_frame": "settings.wrench_frame",
    "imu.forces.over_accelerometer": "imu.forces_over_accelerometer",
    "legs.feet.*": "feet.*",
    "legs.joints.*.over_stride": "legs.joints.*.position_over_stride",
    "legs.asymmetry_percent.*.range_of_motion": "legs.asymmetry_percent.*",
    "quality.topics.*.interval_s.p95": "quality.topics.*.interval_p95_s",
    "quality.topics.*.interval_s.max": "quality.topics.*.interval_max_s",
    "quality.topics.*.gaps.count": "quality.topics.*.gaps",
    "quality.topics.*.gaps.total_s": "quality.topics.*.gaps_total_s",
    "quality.topics.*.duplicate_stamps": "quality.topics.*.bad_stamps",
    "quality.topics.*.backward_stamps": "quality.topics.*.bad_stamps",
    "quality.topics.*.zero_stamps": "quality.topics.*.bad_stamps",
    "quality.topics.*.stamps_ahead": "quality.topics.*.bad_stamps",
    "quality.topics.*.header_to_log_offset_s": "quality.topics.*.clock_offset_s",
    "quality.topics.*.header_to_log_drift_ppm": "quality.topics.*.clock_drift_ppm",
    "quality.worlds.base_to_feet_m": "quality.base_to_feet_m",
    "quality.worlds.feet_spread_m": "quality.feet_spread_m",
    "quality.lost_messages": "log.lost_messages",
    "quality.lost_bytes": "log.lost_bytes",
}
"""New keys, or what is nearest to them, by those of schema 2. A star stands for a name; what
follows a key stays."""


def new_name(pattern: str) -> str:
    """Return what a pattern of schema 2 is called now; empty where it has no other name.

    Args:
        pattern: path of a metric, with stars or names.
    """
    parts = pattern.split(".")
    for old, new in sorted(RENAMED.items(), key=lambda item: -len(item[0])):
        keys = old.split(".")
        own = parts[: len(keys)]
        if len(own) == len(keys) and all(k in {"*", p} for k, p in zip(keys, own, strict=True)):
            names = iter([part for key, part in zip(keys, own, strict=True) if key == "*"])
            found = [next(names, "*") if key == "*" else key for key in new.split(".")]
            return ".".join([*found, *parts[len(keys) :]])
    return ""
