"""The whole strides of a log, a row each: what CSV and Parquet hold."""

import numpy as np

from dogbot_logtool.core.geometry.arrays import Floats
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.results import StrideTable


def stride_table(stats: Stats) -> StrideTable:
    """Gather the strides of all feet."""
    names: list[str] = []
    parts: list[dict[str, Floats]] = []
    for foot in stats.feet:
        strides, stances = foot.strides, foot.stances
        row = strides.stance
        names += [foot.name] * len(row)
        parts.append(
            {
                "start_s": (strides.touchdown - stats.origin) / 1e9,
                "stance_s": strides.stance_s,
                "swing_s": strides.swing_s,
                "duty_factor": strides.duty_factor,
                "length_m": foot.length_m,
                "peak_force_n": stances.figures.peak_n[row],
                "vertical_impulse_ns": stances.figures.vertical_impulse_ns[row],
                "slip_m": foot.slip_m[row],
            }
        )
    return StrideTable(
        tuple(names),
        {name: np.concatenate([np.empty(0), *(part[name] for part in parts)]) for name in COLUMNS},
    )


COLUMNS = (
    "start_s",
    "stance_s",
    "swing_s",
    "duty_factor",
    "length_m",
    "peak_force_n",
    "vertical_impulse_ns",
    "slip_m",
)
"""Columns of figures."""
