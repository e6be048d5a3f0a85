"""Forces of a walking foot with known steps, and the faults of real sensors on top of them."""

from dataclasses import dataclass

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints


@dataclass(frozen=True, slots=True)
class FootForces:
    """What one foot's sensor records, and what is true of it."""

    time: Ints
    """(n,) ns."""
    force: Floats
    """(n, 3) N."""
    load: Floats
    """(n,) N, the true vertical load."""


def walking_foot(
    load_n: float = 400.0,
    *,
    rate_hz: float = 200.0,
    duration_s: float = 20.0,
    period_s: float = 1.0,
    duty: float = 0.6,
    shape: str = "humps",
    seed: int = 1,
) -> FootForces:
    """Return a foot that stands, then steps; `load_n` is what it usually carries."""
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, duration_s, 1.0 / rate_hz)
    phase = time / period_s % 1.0
    within = np.clip(phase / duty, 0.0, 1.0)
    stance = phase < duty
    if shape == "humps":
        profile = np.sin(np.pi * within) + 0.35 * np.sin(3.0 * np.pi * within)
    elif shape == "half-sine":
        profile = np.sin(np.pi * within)
    else:
        profile = np.ones(len(time))
    load = np.where(stance, load_n * profile, 0.0)
    sway = 0.12 * load * np.sin(2.0 * np.pi * 0.7 * time + rng.uniform(0.0, 6.0))
    force = np.stack([sway, 0.4 * sway, load], axis=1)
    return FootForces((time * 1e9).astype(np.int64) + 10**15, force, load)
