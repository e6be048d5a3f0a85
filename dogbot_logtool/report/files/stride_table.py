"""The whole strides of a log, a row each: what CSV and Parquet hold."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.checks.voids import void_columns
from dogbot_logtool.core.legs.swings import STEPS, SWINGS
from dogbot_logtool.core.metrics import Stride
from dogbot_logtool.core.records import fields_of
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.results import StrideTable


def stride_table(stats: Stats, void: Sequence[str] = ()) -> StrideTable:
    """Gather the strides of all feet.

    Args:
        stats: what was worked out of a log.
        void: patterns of metrics that are void.
    """
    names = [foot.name for foot in stats.feet for _ in foot.strides.stance]
    feet = [foot_strides(stats, row, void) for row in range(len(stats.feet))]
    columns = {
        field.name: np.concatenate([np.empty(0), *(foot[field.name] for foot in feet)])
        for field in fields_of(Stride)
    }
    return StrideTable(tuple(names), columns)


def foot_strides(stats: Stats, row: int, void: Sequence[str] = ()) -> Mapping[str, Floats]:
    """Return the metrics of each stride of a foot, (strides,) by name; NaN where not known."""
    foot = stats.feet[row]
    strides, figures = foot.strides, foot.stances.figures
    columns = {
        "start_s": (strides.touchdown - stats.origin) / 1e9,
        "stance_s": strides.stance_s,
        "swing_s": strides.swing_s,
        "duty_factor": strides.duty_factor,
        "length_m": foot.length_m,
        "peak_force_n": figures.peak_n[strides.stance],
        "vertical_impulse_ns": figures.vertical_impulse_ns[strides.stance],
        "slip_m": foot.slip_m[strides.stance],
    }
    legs = stats.legs
    unknown = np.full(len(strides.stance), np.nan)
    for name in _OF_LEG:
        found = unknown if legs is None else legs.feet[row].strides[name]
        # One NaN for all: tables are compared to the bit.
        columns[name] = np.where(np.isnan(found), np.nan, found)
    return void_columns(columns, foot.name, void)


_OF_LEG: Final = (*SWINGS, *STEPS, "positive_work_j", "absolute_work_j")
"""Metrics of a stride that its leg tells."""
