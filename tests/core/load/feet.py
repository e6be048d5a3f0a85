"""Feet whose loads are known in closed form, for tests of what rests on them."""

from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.contact.contact_rule import ContactRule
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.foot_history import FootHistory, foot_history
from dogbot_logtool.core.corrections.clock import TimeSource

WEIGHT_N: Final = 200.0
PERIOD_S: Final = 0.8
DUTY: Final = 0.6
RATE_HZ: Final = 250.0
TROT: Final = (0.0, 0.5, 0.5, 0.0)
RULE: Final = ContactRule(0.05 * WEIGHT_N, 0.0, 0.020)


def seconds(duration_s: float) -> Floats:
    return np.arange(round(duration_s * RATE_HZ) + 1) / RATE_HZ


def stance_phase(time: Floats, phase: float, duty: float = DUTY) -> Floats:
    """0 to 1 in stance, more in swing; touchdowns lie half a sample off the grid."""
    return np.asarray((((time - 0.002) / PERIOD_S - phase) % 1.0) / duty)


def half_sine(stance: Floats, mean_n: float) -> Floats:
    """Vertical force of a stance whose mean is given; 0 in swing."""
    return np.where(stance < 1.0, mean_n * np.pi / 2.0 * np.sin(np.pi * stance), 0.0)


def vertical(time: Floats, phase: float, share: float = 0.25, duty: float = DUTY) -> Floats:
    """Vertical force of a foot that carries a share of the weight over whole strides."""
    return half_sine(stance_phase(time, phase, duty), share * WEIGHT_N / duty)


def samples_of(time: Floats, force: Floats, point: Floats | None = None, foot: int = 0) -> Samples:
    """Samples of a foot.

    Args:
        time: (n,) s.
        force: (n,) N upwards, or (n, 3) N.
        point: (n, 3) m; None: the origin.
        foot: index of the foot.
    """
    count = len(time)
    if force.ndim == 1:
        force = force[:, None] * np.array([0.0, 0.0, 1.0])
    touching = (force != 0.0).any(axis=1)
    hidden = np.where(touching, 0.0, np.nan)[:, None]
    stamp: Ints = 1_000_000_000 + np.round(time * 1e9).astype(np.int64)
    return Samples(
        foot=np.full(count, foot, np.int64),
        log_time=stamp,
        stamp=stamp,
        in_contact=touching,
        force=force,
        in_world=np.zeros(count, np.bool_),
        points=touching.astype(np.int64),
        position=(np.zeros((count, 3)) if point is None else point) + hidden,
        normal=np.tile([0.0, 0.0, 1.0], (count, 1)) + hidden,
    )


def history(samples: Samples, *, world: bool = True) -> FootHistory:
    return foot_history(samples, RULE, TimeSource.HEADER, force_in_world=world)


def foot(
    time: Floats, force: Floats, point: Floats | None = None, *, world: bool = True
) -> FootHistory:
    """A foot that was recorded at some times, s, with a force, N."""
    return history(samples_of(time, force, point), world=world)
