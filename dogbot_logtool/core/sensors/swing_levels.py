"""The level of an unloaded sensor swing by swing, where one level for the whole log will not do.

A sensor that is re-zeroed in the middle of a log, or that warms up, may read as much in later
swings as under load before. A few strides at a time show swing and stance all the same.
"""

from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.geometry.arrays import Floats, Ints, all_finite
from dogbot_logtool.core.geometry.order_statistics import distinct, median_of, percentiles_of
from dogbot_logtool.core.sensors.sensor_level import (
    SensorLevel,
    load_axis,
    noisiest_sd,
    run_numbers,
    visit_s,
    with_loads,
    without_spikes,
)
from dogbot_logtool.core.sensors.sensor_modes import (
    ALTERNATE,
    WIDE,
    Modes,
    Visits,
    judge_modes,
    two_modes,
)
from dogbot_logtool.dataclass import dataclass

STRIDES: Final = 4.0
"""Strides in a window."""
_WINDOW_S: Final = (3.0, 40.0)
"""s, shortest and longest window."""
FEWEST_SWINGS: Final = 4
ALIKE: Final = 0.4
"""Share by which the distance of a window's modes may differ from that of all windows."""
_FEWEST_SAMPLES: Final = 20
_LOW_AND_HIGH: Final = (8.0, 92.0)
"""Percentiles of a stretch that are those of swing and of stance, if it is walked."""
_SAMPLES_A_SWING: Final = 12
"""Samples of a swing that are looked at."""
_SWINGS_A_STRIDE: Final = 3.0
"""Strides last about so many swings."""
_SWING_S: Final = 0.3
"""s, where it is not known."""
MOVED: Final = 0.05
"""Share of the distance of both modes from which a level that moved is followed."""
MOVED_NOISES: Final = 5.0
"""The same in standard deviations of the noise."""
FEWEST_MOVED: Final = 3
"""Swings in a row that lie off the level."""
_LOOK_BACK_NS: Final = 5_000_000_000
"""A step is looked for from so long before the last swing on the level before it."""
ALONE: Final = 0.4
"""Share of a step within which it is the level's, and that the steps beside it do not reach."""
STAYS: Final = 0.4
"""Share of those limits within which a level stays the same."""


def follow_level(log_time: Ints, force: Floats, level: SensorLevel) -> SensorLevel:
    """Return the level of a sensor as its swings have it, where it does not stay what it is.

    Args:
        log_time: (n,) ns, ascending.
        force: (n, 3) N, as recorded; rows that are not finite are left out.
        level: what all samples together show; it is known, and not zero.
    """
    finite = all_finite(force)
    log_time, force = log_time[finite], force[finite]
    swing_s = level.swing_s or _SWING_S
    every = max(int(swing_s / _SAMPLES_A_SWING / (level.interval_s or np.inf)), 1)
    axis = load_axis(force) * (1.0 if level.raises else -1.0)
    whole = log_time, force @ axis
    log_time, force = log_time[::every], force[::every]
    if _stays(log_time, force @ axis, level, axis):
        return level
    stride_s = _SWINGS_A_STRIDE * swing_s
    found = swing_levels(
        log_time, force @ axis, stride_s, raises=level.raises, step=level.resolution_n
    )
    if found is None:
        return level
    time, levels = found.swing.middle(log_time), found.swing.medians(force)
    limit_n = max(MOVED_NOISES * (level.noise_n or 0.0), MOVED * found.interval)
    off = np.abs((levels - level.offset_at(time)) @ axis) > limit_n
    if np.convolve(off, np.ones(FEWEST_MOVED)).max() < FEWEST_MOVED:
        return level
    level = _followed(log_time, force, axis, found, replace(level, drift_n_per_min=None))
    knots = _at_steps(level.knots, level.offset @ axis, *whole, level.noise_n or 0.0)
    return replace(level, knots=knots)


def _stays(log_time: Ints, values: Floats, level: SensorLevel, axis: Floats) -> bool:
    """Tell at a glance whether the lightest loads of each walking stretch are at the level."""
    rows = int(_WINDOW_S[0] * 1e9 / max(float(median_of(np.diff(log_time))), 1.0))
    if rows < _FEWEST_SAMPLES or len(values) < 2 * rows:
        return len(values) < 2 * _FEWEST_SAMPLES
    whole = len(values) // rows * rows
    above = (values[:whole] - level.offset_at(log_time[:whole]) @ axis).reshape(-1, rows)
    low, high = percentiles_of(above, _LOW_AND_HIGH, axis=1)
    limit_n = max(MOVED_NOISES * (level.noise_n or 0.0), MOVED * (level.loaded_n or 0.0))
    walks = high - low > limit_n + (level.loaded_n or 0.0) / 2.0
    return bool((np.abs(low[walks]) <= limit_n).all())


def _followed(
    log_time: Ints, force: Floats, axis: Floats, found: "SwingLevels", level: SensorLevel
) -> SensorLevel:
    """Return a level with knots where its swings are, and the loads above it."""
    time, levels = found.swing.middle(log_time), found.swing.medians(force)
    noise_n = noisiest_sd(found.swing.strays(force))
    limit_n = STAYS * max(MOVED_NOISES * noise_n, MOVED * found.interval)
    knots, offset = knots_of(time, levels, axis, limit_n)
    level = replace(
        level,
        knots=knots,
        offset=offset,
        noise_n=noise_n,
        swing_s=visit_s(found.swing, log_time),
        moved_n=float(np.ptp(offset @ axis)),
    )
    return with_loads(level, log_time, force, axis, found.stance)


def _at_steps(knots: Ints, level: Floats, log_time: Ints, values: Floats, noise_n: float) -> Ints:
    """Return knots moved to both sides of where the sensor was re-zeroed, ns.

    That is a step between two samples, by what the level changes, with no such step beside it.

    Args:
        knots: (k,) ns.
        level: (k,) N, at the knots, along the load's axis.
        log_time: (n,) ns.
        values: (n,) N, along that axis.
        noise_n: N, the sensor's.
    """
    moved = knots.copy()
    steps = np.diff(values)
    for row in np.flatnonzero(np.abs(np.diff(level)) > MOVED_NOISES * noise_n).tolist():
        # A foot that stands may read as much after the step as it did in the air before.
        since = max(int(knots[row]) - _LOOK_BACK_NS, int(knots[max(row - 1, 0)]))
        first, last = np.searchsorted(log_time, [since, knots[row + 1]]).tolist()
        size = level[row + 1] - level[row]
        inside = np.arange(max(first, 1), min(last, len(steps) - 1))
        like = np.abs(steps[inside] - size) < ALONE * abs(size)
        alone = np.maximum(np.abs(steps[inside - 1]), np.abs(steps[inside + 1])) < ALONE * abs(size)
        at = inside[like & alone]
        if len(at) == 1:
            moved[row : row + 2] = log_time[at[0] : at[0] + 2]
    return moved


@dataclass(frozen=True, slots=True)
class SwingLevels:
    """Swings and stances of windows with two clear modes."""

    swing: Visits
    """In order, without their ends."""
    stance: Visits
    interval: float
    """N, usual distance of both modes."""


def swing_levels(
    log_time: Ints,
    values: Floats,
    stride_s: float,
    *,
    raises: bool,
    step: float,
) -> SwingLevels | None:
    """Find the swings of windows of a few strides; None: too few are clear.

    Where those of some windows are clear, those of others need only be as far apart.

    Args:
        log_time: (n,) ns, ascending.
        values: (n,) N, along the load's axis, load being higher.
        stride_s: s, about as long as a stride.
        raises: whether load raises what the sensor reads.
        step: N, in which it counts.
    """
    values, runs = without_spikes(values), run_numbers(log_time)
    length = round(float(np.clip(STRIDES * stride_s, *_WINDOW_S)) * 1e9)
    found: list[tuple[int, Modes]] = []
    unclear: list[tuple[int, Modes]] = []
    for begin in _window_starts(log_time, length // 2):
        first, last = np.searchsorted(log_time, [begin, begin + length]).tolist()
        if last - first < _FEWEST_SAMPLES:
            continue
        part, own = values[first:last], runs[first:last]
        modes = two_modes(part, own)
        width = two_modes(-part, own).swing.width
        reason = judge_modes(modes, width, raises=raises, step=step).reason
        if not reason:
            found.append((first, modes))
        elif reason in {ALTERNATE, WIDE}:
            unclear.append((first, modes))
    if not found:
        return None
    usual = float(median_of(np.array([modes.distance for _, modes in found])))
    windows = sorted((*found, *unclear), key=lambda each: each[0])
    chosen = [each for each in windows if abs(each[1].distance - usual) <= ALIKE * usual]
    swing = _joined([(first, modes.swing.visits) for first, modes in chosen])
    stance = _joined([(first, modes.stance.visits) for first, modes in chosen])
    return SwingLevels(swing, stance, usual) if len(swing) >= FEWEST_SWINGS else None


def _window_starts(log_time: Ints, half: int) -> list[int]:
    """Return where windows of two halves begin, ns, of those that hold a sample.

    There may be decades between two samples, if a clock was set.
    """
    number = distinct((log_time - log_time[0]) // half)
    number = distinct(np.concatenate([np.maximum(number - 1, 0), number]))
    starts: Ints = log_time[0] + half * number
    return [start for start in starts.tolist() if start < log_time[-1]]


def _joined(parts: list[tuple[int, Visits]]) -> Visits:
    """Return the visits of overlapping windows, each once: the longest where several overlap."""
    start = np.concatenate([first + visits.start for first, visits in parts])
    end = np.concatenate([first + visits.end for first, visits in parts])
    order = np.argsort(start, kind="stable")
    start, end = start[order], end[order]
    new = np.concatenate([[True], start[1:] >= np.maximum.accumulate(end)[:-1]])
    group = np.cumsum(new) - 1
    longest = np.lexsort((start - end, group))
    _, at = np.unique(group[longest], return_index=True)
    rows = np.sort(longest[at])
    return Visits(start[rows], end[rows])


def knots_of(time: Ints, levels: Floats, axis: Floats, tolerance_n: float) -> tuple[Ints, Floats]:
    """Reduce the levels of single swings to knots: one level as long as it stays.

    Args:
        time: (v,) ns, ascending.
        levels: (v, 3) N.
        axis: (3,) unit vector along the load.
        tolerance_n: N, differences of a level that stays.

    Returns:
        (k,) ns and (k, 3) N; between levels the way is straight.
    """
    along = without_spikes(levels @ axis)
    groups: list[list[int]] = [[0]]
    for row in range(1, len(time)):
        usual = float(median_of(along[groups[-1]]))
        if abs(along[row] - usual) <= tolerance_n:
            groups[-1].append(row)
        else:
            groups.append([row])
    kept = [group for group in groups if len(group) > 1]
    if not kept:
        return time, levels
    rows = [row for group in kept for row in (group[0], group[-1])]
    usual_of = [median_of(levels[group], axis=0) for group in kept]
    return time[rows], np.repeat(usual_of, 2, axis=0)
