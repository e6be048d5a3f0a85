"""The strides of a walk as a table."""

from collections.abc import Mapping

import numpy as np

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.checks.voids import void_columns, void_patterns
from dogbot_logtool.core.metrics import Stride
from dogbot_logtool.core.records import fields_of
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.results import StrideTable


def stride_table(walk: Walk) -> StrideTable:
    """Gather the strides of all feet; what findings void is NaN."""
    void = void_patterns(walk.findings)
    feet = [
        void_columns(_strides_of(walk, row), foot.name, void) for row, foot in enumerate(walk.feet)
    ]
    columns = {
        field.name: np.concatenate([np.empty(0), *(foot[field.name] for foot in feet)])
        for field in fields_of(Stride)
    }
    names = [foot.name for foot in walk.feet for _ in foot.strides.stance]
    return StrideTable(tuple(names), columns)


def _strides_of(walk: Walk, row: int) -> Mapping[str, Floats]:
    """Return the metrics of each stride of a foot, (strides,) by name; NaN where not known."""
    foot = walk.feet[row]
    strides, stances = foot.strides, foot.stances.figures
    columns = {
        "start_s": (strides.touchdown - walk.origin) / 1e9,
        "stance_s": strides.stance_s,
        "swing_s": strides.swing_s,
        "duty_factor": strides.duty_factor,
        "length_m": foot.length_m,
        "peak_force_n": stances.peak_force_n[strides.stance],
        "vertical_impulse_ns": stances.vertical_impulse_ns[strides.stance],
        "slip_m": foot.slip_m[strides.stance],
    }
    unknown = np.full(len(strides.stance), np.nan)
    of_leg = {} if walk.legs is None else walk.legs.feet[row].strides
    for field in fields_of(Stride)[len(columns) :]:
        found = of_leg.get(field.name, unknown)
        # One NaN for all: tables are compared to the bit.
        columns[field.name] = np.where(np.isnan(found), np.nan, found)
    return columns
