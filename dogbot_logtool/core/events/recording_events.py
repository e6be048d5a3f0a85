"""Events of the recording: gaps, and sensors at fault."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.checks.sensors import foot_is_saturated
from dogbot_logtool.core.events.event import Event, EventType
from dogbot_logtool.core.gait.foot_steps import FootSteps
from dogbot_logtool.core.load.load_figures import is_stuck
from dogbot_logtool.core.load.spikes import has_lone_spikes
from dogbot_logtool.core.statistics import Stats

AT_LIMIT: Final = 0.99
"""Share of the highest force from which a stance of a saturated sensor is cut off."""


def gaps(stats: Stats) -> Iterator[Event]:
    """Yield the gaps of each foot's sensor, and of the base's poses."""
    yield from _gaps(stats.base_history.gaps, None)
    for row, foot in enumerate(stats.feet):
        yield from _gaps(timespans.subtract(foot.record.gaps, foot.record.stopped), row)


def _gaps(spans: Ints, foot: int | None) -> Iterator[Event]:
    for start, end in spans.tolist():
        lasts = end - start
        yield Event(start, lasts, EventType.GAP, foot, lasts / 1e9, "s", "GAPS")


def sensor_faults(stats: Stats) -> Iterator[Event]:
    """Yield what findings call a fault of a foot's sensor, with the time that shows it."""
    for row, foot in enumerate(stats.feet):
        others = [other.record for other in stats.feet if other is not foot]
        record, stances = foot.record, foot.record.stances
        stopped = () if is_stuck(record, others) else record.stopped.tolist()
        never = foot.is_dead and not len(record.stopped)
        if never and record.start is not None and record.end is not None:
            yield _fault(record.start, record.end, row, "DEAD")
        if is_stuck(record, others):
            yield _fault(int(stances.touchdown[0]), int(stances.liftoff[-1]), row, "STUCK")
        for start, end in stopped:
            yield _fault(start, end, row, "STOPPED")
        if foot_is_saturated(stats, row) and np.isfinite(stances.figures.peak_n).any():
            limit = float(np.nanmax(stances.figures.peak_n))
            cut_off = np.flatnonzero(stances.figures.peak_n >= AT_LIMIT * limit)
            times = int(stances.touchdown[cut_off[0]]), int(stances.liftoff[cut_off[-1]])
            yield _fault(*times, row, "SATURATED", limit)
        yield from _spikes(row, foot)


def _spikes(row: int, foot: FootSteps) -> Iterator[Event]:
    """Yield the stances with lone spikes, at the highest of them."""
    stances = foot.record.stances
    for stance in np.flatnonzero(has_lone_spikes(foot.stances) & foot.stances.whole).tolist():
        share = float(foot.stances.figures.spike_phase[stance])
        onset = int(stances.touchdown[stance])
        at = onset + round(share * (int(stances.liftoff[stance]) - onset))
        yield _fault(at, at, row, "SPIKES", float(stances.figures.peak_n[stance]))


def _fault(start: int, end: int, foot: int, code: str, newtons: float | None = None) -> Event:
    unit = "" if newtons is None else "N"
    return Event(start, end - start, EventType.SENSOR_FAULT, foot, newtons, unit, code)
