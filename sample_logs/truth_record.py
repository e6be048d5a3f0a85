"""What the generator knows about a log, as the JSON written beside it (see README.md).

Everything follows from the closed-form walk, not from the messages. Integrals are Gauss-Legendre
sums between the instants at which a load changes its formula, so they are exact to rounding.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from gait_model import (
    FEET,
    FRICTION_COEFFICIENT,
    GRAVITY_MPS2,
    MASS_KG,
    RAMP_S,
    WEIGHT_N,
    Gait,
    base_motion,
    ground_forces,
    pad_travel,
)
from joint_torques import legs_truth
from ros_messages import NS_PER_S
from scenario import (
    COMMAND_TOPIC,
    MAX_JITTER_NS,
    ODOMETRY_TOPIC,
    TWIST_NOISE_STD,
    contact_topic,
    transport_delay_ns,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from leg_kinematics import Array
    from scenario import Damage, LoggedMessage, Scenario

Json = dict[str, Any]

_DECIMALS = 9
_QUADRATURE_POINTS = 24
_PEAK_SAMPLES = 20_001
_TRAVEL_FRACTION = 0.8


def truth_of(scenario: Scenario, messages: Sequence[LoggedMessage]) -> Json:
    """Return the truth about a scenario's log, ready for JSON."""
    gait, duration_s = scenario.gait, scenario.duration_s
    truth = {
        "log": _log_truth(scenario, messages),
        "robot": {
            "mass_kg": MASS_KG,
            "gravity_mps2": GRAVITY_MPS2,
            "weight_n": WEIGHT_N,
            "forward_axis": "+y",
            "friction_coefficient": FRICTION_COEFFICIENT,
        },
        "gait": {
            "class": gait.gait_class,
            "sequence": list(gait.sequence),
            "period_s": gait.period_s,
            "stride_frequency_hz": 1 / gait.period_s,
            "duty_factor": gait.duty_factor,
            "stance_s": gait.stance_s,
            "swing_s": gait.period_s - gait.stance_s,
            "phase": gait.phases,
            "stride_length_m": gait.speed_mps * gait.period_s,
            "support_fraction": _support_fractions(gait, duration_s),
        },
        "base": _base_truth(gait, duration_s),
        "command": _command_truth(gait),
        "forces": _force_truth(scenario),
        "feet": {foot: _foot_truth(scenario, foot) for foot in FEET},
        "legs": legs_truth(gait),
        "damage": _damage_truth(scenario.damage),
    }
    rounded: Json = _rounded(truth)
    return rounded


def _log_truth(scenario: Scenario, messages: Sequence[LoggedMessage]) -> Json:
    counts = Counter(message.topic for message in messages)
    return {
        "name": scenario.name,
        "ros_version": scenario.ros_version,
        "start_stamp_s": scenario.start_ns / NS_PER_S,
        "duration_s": scenario.duration_s,
        "first_log_time_ns": min(message.log_time_ns for message in messages),
        "last_log_time_ns": max(message.log_time_ns for message in messages),
        "messages": dict(sorted(counts.items())),
        "log_delay_s": {topic: transport_delay_ns(topic) / NS_PER_S for topic in sorted(counts)},
        "log_jitter_max_s": MAX_JITTER_NS / NS_PER_S,
        "physics_step_s": scenario.physics_step_ns / NS_PER_S,
        "physics_steps_per_contact_message": scenario.steps_per_contact_message,
        "contact_interval_s": scenario.contact_interval_ns / NS_PER_S,
        "odometry_interval_s": scenario.odometry_interval_ns / NS_PER_S,
        "world_frame_id": scenario.world_frame_id,
        "base_frame_id": scenario.base_frame_id,
        "contact_frame_id": scenario.contact_frame_id,
    }


def _base_truth(gait: Gait, duration_s: float) -> Json:
    knots_s = _knots(gait, 0.0, duration_s)
    height_integral_ms = _integral(
        lambda time_s: base_motion(gait, time_s).position_m[:, 2], knots_s
    )
    return {
        "forward_speed_mps": gait.speed_mps,
        "path_length_m": gait.speed_mps * duration_s,
        "heading_rad": gait.heading_rad,
        "yaw_change_rad": 0.0,
        "mean_height_m": height_integral_ms / duration_s,
        "twist_frame": "world",
        "twist_noise_std": TWIST_NOISE_STD,
    }


def _command_truth(gait: Gait) -> Json:
    """Say what is commanded all the time; the base does it at once."""
    return {"topic": COMMAND_TOPIC, "along": "+y", "speed_mps": gait.speed_mps}


def _force_truth(scenario: Scenario) -> Json:
    return {
        "wrench_frame": scenario.wrench_frame,
        "foot_as_collision2": scenario.second_body_foot,
        "two_point_foot": scenario.pad_foot,
        "vertical_sum_n": WEIGHT_N,
        "horizontal_sum_n": 0.0,
        "vertical_impulse_over_weight": sum(
            _vertical_impulse_ns(scenario.gait, foot, 0.0, scenario.duration_s) for foot in FEET
        )
        / (WEIGHT_N * scenario.duration_s),
    }


def _foot_truth(scenario: Scenario, foot: str) -> Json:
    gait, duration_s = scenario.gait, scenario.duration_s
    touchdown_s = gait.touchdown(foot, 0)
    force_n = _stance_force(gait, foot)
    magnitude_n = np.linalg.norm(force_n, axis=1)
    horizontal_n = np.linalg.norm(force_n[:, :2], axis=1)
    stance_impulse_ns = _vertical_impulse_ns(gait, foot, touchdown_s, touchdown_s + gait.stance_s)
    impulse_ns = _vertical_impulse_ns(gait, foot, 0.0, duration_s)
    return {
        "touchdown_s": gait.events(foot, duration_s, 0.0),
        "liftoff_s": gait.events(foot, duration_s, gait.stance_s),
        "contact_fraction": _contact_time(gait, foot, duration_s) / duration_s,
        "peak_force_n": magnitude_n.max(),
        "least_force_n": magnitude_n.min(),
        "peak_vertical_force_n": force_n[:, 2].max(),
        "mean_force_n": _mean_magnitude(gait, foot),
        "mean_vertical_force_n": stance_impulse_ns / gait.stance_s,
        "peak_friction_use": (horizontal_n / force_n[:, 2]).max(),
        "vertical_impulse_ns": impulse_ns,
        "load_share": impulse_ns / (WEIGHT_N * duration_s),
        "contact_travel_m": pad_travel(_TRAVEL_FRACTION) if foot == scenario.pad_foot else 0.0,
    }


def _damage_truth(damage: Damage) -> Json:
    """List the damages by kind; kinds that did not happen are left out."""
    truth: Json = {}
    if damage.dead_foot:
        truth["dead_foot"] = damage.dead_foot
    if damage.silence:
        truth["silence"] = {
            "topic": contact_topic(damage.silence.foot),
            "start_s": damage.silence.start_s,
            "duration_s": damage.silence.duration_s,
        }
    if damage.zero_stamps:
        truth["zero_stamps"] = True
    per_foot = {
        "nan_force": damage.nan_force,
        "infinite_position": damage.infinite_position,
        "backward_log_time": damage.backward_log_time,
    }
    per_odometry = {
        "zero_quaternion": damage.zero_quaternion,
        "duplicate_log_time": damage.duplicate_log_time,
    }
    by_kind = {
        kind: {contact_topic(foot): list(numbers) for foot, numbers in messages.items()}
        for kind, messages in per_foot.items()
        if messages
    }
    by_kind |= {
        kind: {ODOMETRY_TOPIC: list(numbers)} for kind, numbers in per_odometry.items() if numbers
    }
    if damage.backward_log_time:
        truth["backward_step_s"] = damage.backward_step_ns / NS_PER_S
    return truth | by_kind


def _stance_force(gait: Gait, foot: str) -> Array:
    """Force on the foot, sampled densely over one stance: ``(n, 3)``, newtons."""
    touchdown_s = gait.touchdown(foot, 0)
    margin_s = 1e-9
    time_s = np.linspace(
        touchdown_s + margin_s, touchdown_s + gait.stance_s - margin_s, _PEAK_SAMPLES
    )
    return ground_forces(gait, time_s)[foot]


def _vertical_impulse_ns(gait: Gait, foot: str, start_s: float, end_s: float) -> float:
    knots_s = _knots(gait, start_s, end_s)
    return _integral(lambda time_s: ground_forces(gait, time_s)[foot][:, 2], knots_s)


def _mean_magnitude(gait: Gait, foot: str) -> float:
    """Mean of the force's magnitude over a stance, in newtons."""
    touchdown_s = gait.touchdown(foot, 0)
    knots_s = _knots(gait, touchdown_s, touchdown_s + gait.stance_s)
    impulse_ns = _integral(
        lambda time_s: np.linalg.norm(ground_forces(gait, time_s)[foot], axis=1), knots_s
    )
    return impulse_ns / gait.stance_s


def _contact_time(gait: Gait, foot: str, duration_s: float) -> float:
    knots_s = _knots(gait, 0.0, duration_s)
    return _integral(lambda time_s: gait.in_stance(foot, time_s).astype(float), knots_s)


def _support_fractions(gait: Gait, duration_s: float) -> dict[str, float]:
    """Fractions of the log's time by the number of feet on the ground."""
    total_s: dict[str, float] = defaultdict(float)
    for start_s, end_s in pairwise(_knots(gait, 0.0, duration_s)):
        middle_s = np.array([(start_s + end_s) / 2])
        feet_down = sum(int(gait.in_stance(foot, middle_s)[0]) for foot in FEET)
        total_s[str(feet_down)] += end_s - start_s
    return {feet_down: total_s[feet_down] / duration_s for feet_down in sorted(total_s)}


def _knots(gait: Gait, start_s: float, end_s: float) -> list[float]:
    """Start, end and every instant between them at which some foot's load changes its formula."""
    delays_s = (0.0, RAMP_S, gait.stance_s - RAMP_S, gait.stance_s)
    inside_s = {
        time_s
        for foot in FEET
        for delay_s in delays_s
        for time_s in gait.events(foot, end_s + gait.period_s, delay_s)
        if start_s < time_s < end_s
    }
    return [start_s, *sorted(inside_s), end_s]


def _integral(function: Callable[[Array], Array], knots_s: Sequence[float]) -> float:
    """Integrate over time, by Gauss-Legendre quadrature between neighbouring knots."""
    nodes, weights = np.polynomial.legendre.leggauss(_QUADRATURE_POINTS)
    starts_s, ends_s = np.array(knots_s[:-1]), np.array(knots_s[1:])
    half_s = (ends_s - starts_s)[:, None] / 2
    time_s = (starts_s[:, None] + half_s * (1 + nodes)).ravel()
    return float(np.sum((half_s * weights).ravel() * function(time_s)))


def _rounded(value: Any) -> Any:  # noqa: ANN401
    """Round every number in nested JSON, so that the text is the same on every machine."""
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_rounded(item) for item in value]
    return round(float(value), _DECIMALS) if isinstance(value, float | np.floating) else value
