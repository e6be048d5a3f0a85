"""Poses of a base that goes along x, for tests of what feet and base say together."""

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.base.poses import BaseHistory


def base(seconds: float, speed_mps: float, start_s: float = 1.0) -> BaseHistory:
    """Poses at 100 Hz, level, 0.4 m above the ground."""
    time = np.arange(round(seconds * 100.0) + 1) / 100.0
    flat = np.zeros_like(time)
    return BaseHistory(
        messages=len(time),
        not_usable=0,
        not_advancing=0,
        time=np.round((start_s + time) * 1e9).astype(np.int64),
        position=np.column_stack([speed_mps * time, flat, flat + 0.4]),
        angles=np.zeros((len(time), 3)),
        gaps=timespans.no_spans(),
    )
