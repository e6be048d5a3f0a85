"""Load curves of a short time in full detail, whatever the length of the log."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.commands.stats import measure
from dogbot_logtool.core.contact.curves import Curve, CurveDetail, LoadCurves
from dogbot_logtool.core.geometry.arrays import Ints
from dogbot_logtool.errors import CallError, LogError
from dogbot_logtool.io.storage import Location
from dogbot_logtool.pipeline.options import StatsOptions, TimeSourceOption
from dogbot_logtool.results import Measurement
from dogbot_logtool.run.in_order import OnProgress

ENOUGH_BINS: Final = 1000
"""Bins over a window from which its curves need no second look."""
MARGIN_S: Final = 5.0
"""s before and after the window that are read as well, when only a part of the log is."""

FeetCurves = tuple[LoadCurves | None, ...]
"""Load curves of each foot; None where it tells no force."""


def load_curves_within(
    path: Location,
    options: StatsOptions,
    measured: Measurement,
    window: tuple[float, float],
    progress: OnProgress | None = None,
) -> FeetCurves:
    """Return the load curves of all feet; reads the log again where theirs are too coarse.

    Only the part around the window is read, if that gives all the points that are known already;
    else, where the clocks drift or frames are recorded only at the log's start, the whole log is.

    Args:
        path: the log.
        options: those that it was measured with.
        measured: its figures.
        window: s since the log's start, from and to.
        progress: called with bytes done and bytes in all.

    Returns:
        at least the curves over the window.

    Raises:
        LogError: the log cannot be read any more.
    """
    stats = measured.stats
    known = tuple(foot.record.curves for foot in stats.feet)
    start, end = (stats.origin + round(each * 1e9) for each in window)
    if options.curves and all(
        each.bin_ns == 1 or each.bin_ns * ENOUGH_BINS <= end - start for each in known if each
    ):
        return known
    clock: TimeSourceOption = stats.settings.clock.value
    closer = replace(options, curves=CurveDetail(window=(start, end)), time_source=clock)
    if options.curves:
        try:
            found = _curves(path, _narrowed(closer, measured, (start, end)), progress)
        except (CallError, LogError):
            found = ()
        if _hold(found, known, (start, end)):
            return found
    return _curves(path, closer, progress)


def with_detail(
    path: Location,
    options: StatsOptions,
    measured: Measurement,
    window: tuple[float, float],
    progress: OnProgress | None = None,
) -> Measurement:
    """Return the figures with load curves that are in full detail over a window."""
    stats = measured.stats
    known = tuple(foot.record.curves for foot in stats.feet)
    widest = max((each.bin_ns for each in known if each), default=1)
    first, last = (stats.origin + round(each * 1e9) for each in window)
    # Whole bins, so that each is either replaced or kept.
    start, end = first // widest * widest, -(-last // widest) * widest - 1
    aligned = (start - stats.origin) / 1e9, (end - stats.origin) / 1e9
    closer = load_curves_within(path, options, measured, aligned, progress)
    if all(one is other for one, other in zip(closer, known, strict=True)):
        return measured
    feet = tuple(
        replace(foot, record=replace(foot.record, curves=_merged(coarse, fine, (start, end))))
        for foot, coarse, fine in zip(stats.feet, known, closer, strict=True)
    )
    return replace(measured, stats=replace(stats, feet=feet))


def _curves(path: Location, options: StatsOptions, progress: OnProgress | None) -> FeetCurves:
    return tuple(foot.record.curves for foot in measure(path, options, progress).stats.feet)


def _narrowed(
    options: StatsOptions, measured: Measurement, window: tuple[int, int]
) -> StatsOptions:
    """Limit the reading to the log times at which the window was recorded, as far as is known."""
    stats, log_start_s = measured.stats, measured.facts.start_s or 0.0
    offsets = [each.offset_median_s or 0.0 for each in stats.topics] or [0.0]
    on_log_time = stats.settings.clock.value == "log"
    early, late = (0.0, 0.0) if on_log_time else (min(offsets), max(offsets))
    start = window[0] / 1e9 + early - log_start_s - MARGIN_S
    end = window[1] / 1e9 + late - log_start_s + MARGIN_S
    return replace(
        options,
        start_s=max(start, options.start_s or 0.0, 0.0),
        end_s=end if options.end_s is None else min(end, options.end_s),
    )


def _hold(found: FeetCurves, known: FeetCurves, window: tuple[int, int]) -> bool:
    """Tell whether curves have every point over the window that is known already."""
    pairs = zip(_each(found), _each(known), strict=False)
    return len(found) == len(known) and all(_holds(*pair, window) for pair in pairs)


def _each(curves: FeetCurves) -> Sequence[Curve | None]:
    return [curve for foot in curves for curve in ((foot.force, foot.vertical) if foot else ())]


def _holds(found: Curve | None, known: Curve | None, window: tuple[int, int]) -> bool:
    times = _times(known)
    times = times[(times >= window[0]) & (times <= window[1])]
    return bool(np.isin(times, _times(found)).all())


def _times(curve: Curve | None) -> Ints:
    if curve is None:
        return np.empty(0, np.int64)
    return np.concatenate([curve.low_time, curve.high_time])


def _merged(
    coarse: LoadCurves | None, fine: LoadCurves | None, window: tuple[int, int]
) -> LoadCurves | None:
    if coarse is None or fine is None:
        return coarse
    return LoadCurves(
        _refined(coarse.force, fine.force, window), _refined(coarse.vertical, fine.vertical, window)
    )


def _refined(coarse: Curve | None, fine: Curve | None, window: tuple[int, int]) -> Curve | None:
    return coarse if coarse is None or fine is None else coarse.refined(fine, window)
