"""Load curves of a short time in full detail, whatever the length of the log."""

from dataclasses import replace
from pathlib import Path
from typing import Final

from dogbot_logtool.core.curves import CurveDetail, LoadCurves
from dogbot_logtool.stats import Measurement, Progress, StatsOptions, TimeSourceOption, measure

ENOUGH_BINS: Final = 1000
"""Bins over a window from which its curves need no second look."""


def load_curves_within(
    path: Path,
    options: StatsOptions,
    measured: Measurement,
    window: tuple[float, float],
    progress: Progress | None = None,
) -> tuple[LoadCurves | None, ...]:
    """Return the load curves of all feet; reads the log again where theirs are too coarse.

    Args:
        path: the log.
        options: those that it was measured with.
        measured: its figures.
        window: s since the log's start, from and to.
        progress: is told bytes done and in all.

    Returns:
        a foot: at least the curves over the window; None where it tells no force.

    Raises:
        LogError: the log cannot be read any more.
    """
    stats = measured.stats
    curves = tuple(foot.record.curves for foot in stats.feet)
    start, end = (stats.origin + round(each * 1e9) for each in window)
    if options.curves and all(
        each.bin_ns == 1 or each.bin_ns * ENOUGH_BINS <= end - start for each in curves if each
    ):
        return curves
    clock: TimeSourceOption = stats.settings.clock.value
    closer = replace(options, curves=CurveDetail(window=(start, end)), time_source=clock)
    again = measure(path, closer, progress)
    return tuple(foot.record.curves for foot in again.stats.feet)
