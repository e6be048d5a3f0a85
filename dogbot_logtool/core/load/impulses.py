"""Mean forces of feet over any time, from the running totals of their tracks."""

from collections.abc import Sequence

import numpy as np

from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.geometry.arrays import Floats, Ints
from dogbot_logtool.core.geometry.runs import added_within


def mean_impulses(feet: Sequence[FootHistory], impulse: str, time: Ints, half_ns: int) -> Floats:
    """(m, feet) N, means over a window about each time.

    Args:
        feet: histories of all feet.
        impulse: ``vertical_impulse`` or ``force_impulse`` of their tracks.
        time: (m,) ns.
        half_ns: half of the window.
    """
    columns = [np.zeros(len(time)) for _ in feet]
    for row, foot in enumerate(feet):
        track = foot.track
        if len(track.time):
            since = (track.time - track.time[0]).astype(np.float64)
            at, total = (time - track.time[0]).astype(np.float64), getattr(track, impulse)
            added = added_within(total[:, None], since, at, half_ns)[:, 0]
            columns[row] = added / (2e-9 * half_ns)
    return np.stack(columns, axis=1)
