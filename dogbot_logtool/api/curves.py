"""Forces over the gait cycle: an array stride by percent."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.api.table import Table
from dogbot_logtool.core.arrays import Floats

POINTS: Final = 101
"""Points of a curve: 0, 1, ... 100 %."""
COLUMNS: Final = ("force_n", "force_x_n", "force_y_n", "force_z_n")
"""Columns of samples that curves are made of."""


@dataclass(frozen=True, slots=True, eq=False)
class Curves:
    """Curves of a foot over its whole strides; `curves["force_z_n"]` is an array, (n, p)."""

    foot: str
    percent: Floats
    """(p,) % of the stride, from touchdown to the next touchdown."""
    start_s: Floats
    """(n,) s since the walk's `start_ns`, touchdown of each stride."""
    values: Mapping[str, Floats]
    """(n, p) each, the unit at the end of the name; NaN where not known. Read-only."""

    def __post_init__(self) -> None:
        for array in (self.percent, self.start_s, *self.values.values()):
            array.flags.writeable = False

    def __len__(self) -> int:
        return len(self.start_s)

    def __getitem__(self, name: str) -> Floats:
        """Return the curves of a quantity, (n, p).

        Raises:
            KeyError: there is no such quantity; the message lists those there are.
        """
        try:
            return self.values[name]
        except KeyError:
            raise KeyError(f"{name!r}: there are {', '.join(self.values)}") from None


def curves_of(foot: str, samples: Table, start_s: Floats, period_s: Floats, points: int) -> Curves:
    """Interpolate samples linearly at equal parts of each stride.

    Args:
        foot: its name.
        samples: of the foot, in the order of time; see `Walk.samples`.
        start_s: (n,) s, touchdowns of whole strides.
        period_s: (n,) s, to the next touchdown.
        points: of each curve, at least 2.
    """
    phase: Floats = np.linspace(0.0, 1.0, points)
    time = start_s[:, None] + period_s[:, None] * phase
    # Samples that repeat a time or step back belong to no figure, either.
    latest = np.maximum.accumulate(samples["time_s"])
    forward = np.concatenate([[True], samples["time_s"][1:] > latest[:-1]])[: len(samples)]
    values: dict[str, Floats] = {
        name: np.interp(time, samples["time_s"][forward], samples[name][forward])
        if len(time)
        else np.empty(time.shape)
        for name in COLUMNS
    }
    return Curves(foot, phase * 100.0, start_s, values)
