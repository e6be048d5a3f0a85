"""Tables of metrics: which column shows what, and how; and the table of strides."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np

from dogbot_logtool.core.arrays import Aggregate, Floats
from dogbot_logtool.core.checks.voids import void_columns, void_patterns
from dogbot_logtool.core.metrics import Foot, Phase, Stride, WalkMetrics
from dogbot_logtool.core.records import MetricPath, fields_of
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.report.numbers import NOTHING
from dogbot_logtool.results import StrideTable

S = TypeVar("S")


# Without slots, which `Column[...](...)` cannot be called with before Python 3.12.
@dataclass(frozen=True)
class Column(Generic[S]):
    """A column of a table."""

    heading: str
    of: Callable[[S], Any]
    """Takes its value from the source of a row; of an aggregate the median is shown."""
    form: str = ","
    """How a number is written."""
    scale: float = 1
    """Multiplies the number, for a unit that is easier to read."""

    def cell(self, source: S) -> str:
        """Return the value of a row as text."""
        value = self.of(source)
        value = value.median if isinstance(value, Aggregate) else value
        if value is None or isinstance(value, str):
            return value or NOTHING
        return format(value * self.scale, self.form)


class FootRow(NamedTuple):
    """The source of a foot's row."""

    foot: Foot
    phase: Phase
    load_share: float | None


def foot_rows(metrics: WalkMetrics) -> dict[str, FootRow]:
    """Return the source of each foot's row, by its name."""
    shares = metrics.forces.load_share.feet or {}
    return {
        name: FootRow(foot, metrics.gait.phase[name], shares.get(name))
        for name, foot in metrics.feet.items()
    }


def why_null(metrics: WalkMetrics, path: MetricPath) -> str:
    """Return why a metric is null, as a few words."""
    because = metrics.null_because.get(str(path), "not known")
    found = next((each.text for each in metrics.findings if each.code == because), "")
    return found.split(": ")[0] or because


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
