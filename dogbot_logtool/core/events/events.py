"""The table of all events of a log."""

from collections.abc import Iterator, Sequence
from itertools import compress, pairwise
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import (
    Flags,
    Floats,
    Ints,
    median_of,
    median_of_known,
    norms,
    percentiles_of,
)
from dogbot_logtool.core.base.jumps import SMALLEST_JUMP_M
from dogbot_logtool.core.checks.sensors import foot_is_saturated
from dogbot_logtool.core.contact.stances import Cut, Stances
from dogbot_logtool.core.events.event import Event, EventType
from dogbot_logtool.core.gait.classes import IRREGULAR, STAND
from dogbot_logtool.core.gait.feet import FootSteps
from dogbot_logtool.core.gait.segments import LASTING, PERIOD_CHANGE, Segment
from dogbot_logtool.core.loads import LARGEST_FOOT_M, is_stuck
from dogbot_logtool.core.walk import Walk

MARGIN_M: Final = 0.01
"""m below zero that a margin must reach: contact points and poses are not known better."""
LASTING_S: Final = 0.08
"""s, two instants, that it must stay below zero."""
BESIDE_NS: Final = 1_000_000_000
"""ns before and after it is carried in which a robot shows how high it stands."""
LOWER_M: Final = 0.02
"""m below that height from which a robot without contact lies on its body."""
AT_LIMIT: Final = 0.99
"""Share of the highest force from which a stance of a saturated sensor is cut off."""
SLIP_M: Final = 0.005
"""m that a slip is at least longer than the way of a foot that does not slip."""
TIMES: Final = 2.0
"""So many times that way, too."""
FEWEST: Final = 5
"""Stances of a segment that say which way is usual."""
FAR_OUT: Final = 8.0
"""Times the distance from the lower quartile to the median that a slip is above the median: the
lower half of the ways has no slips in it."""
AT_ONCE: Final = 0.7
"""Share of a slip that is in its quick way, if it is over at once."""
QUICK_TIMES: Final = 1.0
"""Times the usual quick way that a quick slip is longer than that."""
EARLY: Final = 0.7
"""Share of the usual swing below which a swing ends early."""
BOUNCE: Final = 0.2
"""Share of the usual swing below which a swing is a bounce, at touchdown or lift-off."""
SHORT_STANCE: Final = 0.5
"""Share of the usual stance below which a contact is no step."""
STRIDE_GOES_ON: Final = 1.4
"""Times the usual swing that two swings and a contact between them last at most, if they are one
swing in which the foot hits something."""
SAMPLES: Final = 2.0
"""Sampling intervals by which a swing must be too short."""
NEIGHBOURS: Final = 5
"""Swings before, and after, that say what is usual."""
FEWEST_SWINGS: Final = 3
_RANK: Final = {kind: rank for rank, kind in enumerate(EventType)}


def find_events(walk: Walk) -> tuple[Event, ...]:
    """Return all events of a log, in the order of time."""
    found = [*_spans(walk), *_carried(walk), *gait_changes(walk.segments), *_margins(walk)]
    walks = [segment for segment in walk.segments if segment.strides]
    for row, foot in enumerate(walk.feet):
        found += scuffs(row, foot, walks)
        early = list(early_touchdowns(row, foot, walks))
        stumbles = [each.onset for each in early if each.type is EventType.STUMBLE]
        found += early
        if not walk.settings.base_from_legs:  # by which no foot slips
            found += slips(row, foot, walks, walk.settings.foot_rolling_m, stumbles)
        found += _sensor_faults(walk, row)
        found += (Event(time, 0, EventType.TOUCHDOWN, row) for time in foot.touchdown.tolist())
        found += (Event(time, 0, EventType.LIFT_OFF, row) for time in foot.liftoff.tolist())
    return tuple(sorted(found, key=_order))


def _order(event: Event) -> tuple[int, int, int]:
    return event.onset, _RANK[event.type], -1 if event.foot is None else event.foot


def _spans(walk: Walk) -> Iterator[Event]:
    """Yield falls, tipping, jumps of the pose and gaps: what is known as spans already.

    A fall lasts from the beginning of the descent until the robot lies no more; a jump from the
    pose before it to the one after.
    """
    for start, end in walk.fallen.tolist():
        yield Event(start, end - start, EventType.FALL, code="FALL")
    found, poses = walk.tipping, walk.base_history
    if found is not None and not len(walk.fallen):
        lasts = int(poses.time[-1]) - found.since
        yield Event(found.since, lasts, EventType.TIPPING, None, found.last_rad, "rad", "FALL")
    sizes, turns = norms(walk.jumps.size_m).tolist(), walk.jumps.turn_rad.tolist()
    for (start, end), size, turn in zip(walk.jumps.spans.tolist(), sizes, turns, strict=True):
        value, unit = (size, "m") if size > SMALLEST_JUMP_M else (abs(turn), "rad")
        yield Event(start, end - start, EventType.POSE_JUMP, None, value, unit, "POSE_JUMP")
    gaps: list[tuple[int | None, Ints]] = [(None, poses.gaps)]
    for row, foot in enumerate(walk.feet):
        gaps.append((row, timespans.subtract(foot.record.gaps, foot.record.stopped)))
    for who, silent in gaps:
        for start, end in silent.tolist():
            seconds = (end - start) / 1e9
            yield Event(start, end - start, EventType.GAP, who, seconds, "s", "GAPS")


def _carried(walk: Walk) -> Iterator[Event]:
    """Yield when no foot is down, and the base is as high as while it stands, or higher."""
    lifted = [each.spans for each in walk.segments if each.is_lifted]
    down = [foot.record.in_contact for foot in walk.feet if len(foot.record.in_contact)]
    if not lifted or not down:
        return
    time, z = walk.base_history.time, walk.base_history.position[:, 2]
    stands = timespans.covers(timespans.merge(np.concatenate(down)), time)
    for start, end in timespans.merge(np.concatenate(lifted)).tolist():
        inside = (time >= start) & (time < end)
        near = (time >= start - BESIDE_NS) & (time < end + BESIDE_NS)
        beside = stands & near & ~inside
        jumps = timespans.touches(walk.jumps.spans, np.array([start]), np.array([end])).any()
        if jumps or not beside.any() or not inside.any():
            continue
        rises_m = float(median_of(z[inside]) - median_of(z[beside]))
        if rises_m > -LOWER_M:
            yield Event(start, end - start, EventType.CARRIED, None, rises_m, "m")


def gait_changes(segments: Sequence[Segment]) -> Iterator[Event]:
    """Yield each change from one gait to another, also between gaits and stands.

    It happens half-way between the last stride of the gait before and the first of the next, or
    where the stand begins or ends. Irregular strides between two gaits are no gait of their own.
    """
    for before, after in pairwise(_gaits(segments)):
        if before.gait.name == after.gait.name and not _faster_or_slower(before, after):
            continue
        onset = (before.end + after.start) // 2
        if after.gait.name == STAND:
            onset = after.start
        elif before.gait.name == STAND:
            onset = before.end
        frequency = after.stride_frequency_hz
        unit = "" if frequency is None else "Hz"
        code = f"{before.gait.name}>{after.gait.name}"
        yield Event(onset, 0, EventType.GAIT_CHANGE, None, frequency, unit, code)


def _gaits(segments: Sequence[Segment]) -> list[Segment]:
    """Return stands and gaits, without what is too irregular or too short to be one."""
    known = [each for each in segments if each.gait.name is not None]
    names = [STAND, *(each.gait.name for each in known), STAND]
    beside = zip(names[:-2], names[2:], strict=True)
    gaits = [
        each
        for each, around in zip(known, beside, strict=True)
        if each.gait.name != IRREGULAR or {STAND, IRREGULAR}.issuperset(around)
    ]
    lasting = [not _is_passing(*three) for three in zip(gaits, gaits[1:], gaits[2:], strict=False)]
    return list(compress(gaits, [True, *lasting, True]))


def _is_passing(before: Segment, segment: Segment, after: Segment) -> bool:
    """Tell whether a gait goes on as it was, before it could be said to have changed."""
    frequency = before.stride_frequency_hz
    if segment.gait.name == STAND or frequency is None or before.gait.name != after.gait.name:
        return False
    lasts_s = (segment.end - segment.start) / 1e9
    return lasts_s * frequency <= LASTING and not _faster_or_slower(before, after)


def _faster_or_slower(before: Segment, after: Segment) -> bool:
    first, then = before.stride_frequency_hz, after.stride_frequency_hz
    if first is None or then is None:
        return False
    return abs(1.0 / then - 1.0 / first) > PERIOD_CHANGE / first


def _margins(walk: Walk) -> Iterator[Event]:
    """Yield the times in which the base's projection is clearly outside the support polygon.

    After a jump of the pose it is not known where the base is among the feet; a robot that lies
    does not lose its balance.
    """
    if walk.instants is None:
        return
    jump = walk.jumps.spans[0, 0] if len(walk.jumps.spans) else walk.end
    below, least = walk.instants.unstable()
    counts = (below[:, 1] - below[:, 0] >= LASTING_S * 1e9) & (least < -MARGIN_M)
    counts &= (below[:, 0] < jump) & ~timespans.covers(walk.fallen, below[:, 0])
    for (start, end), value in zip(below[counts].tolist(), least[counts].tolist(), strict=True):
        yield Event(start, end - start, EventType.MARGIN_BELOW_ZERO, None, value, "m")


def _sensor_faults(walk: Walk, row: int) -> Iterator[Event]:
    """Yield what findings call a fault of a foot's sensor, with the time that shows it."""

    def fault(start: int, end: int, code: str, newtons: float | None = None) -> Event:
        unit = "" if newtons is None else "N"
        return Event(start, end - start, EventType.SENSOR_FAULT, row, newtons, unit, code)

    foot = walk.feet[row]
    record, stances, figures = foot.record, foot.record.stances, foot.record.stances.figures
    if foot.is_dead and not len(record.stopped):
        yield fault(record.start or 0, record.end or 0, "DEAD")
    if is_stuck(record, [other.record for other in walk.feet if other is not foot]):
        yield fault(int(stances.touchdown[0]), int(stances.liftoff[-1]), "STUCK")
    else:
        yield from (fault(start, end, "STOPPED") for start, end in record.stopped.tolist())
    if foot_is_saturated(walk, row) and np.isfinite(figures.peak_force_n).any():
        limit = float(np.nanmax(figures.peak_force_n))
        first, last = np.flatnonzero(figures.peak_force_n >= AT_LIMIT * limit)[[0, -1]].tolist()
        yield fault(int(stances.touchdown[first]), int(stances.liftoff[last]), "SATURATED", limit)
    for stance in np.flatnonzero(foot.has_spikes & foot.stances.whole).tolist():
        onset, end = int(stances.touchdown[stance]), int(stances.liftoff[stance])
        at = onset + round(float(figures.spike_phase[stance]) * (end - onset))
        yield fault(at, at, "SPIKES", float(figures.peak_force_n[stance]))


def slips(
    foot: int,
    steps: FootSteps,
    walks: Sequence[Segment],
    rolling_m: float | None,
    stumbles: Sequence[int],
) -> Iterator[Event]:
    """Yield the stances in which a foot slips.

    Args:
        foot: its index.
        steps: its stances.
        walks: segments with strides.
        rolling_m: m, way of the contact point of a foot that does not slip; None: not known.
        stumbles: ns, touchdowns of contacts that are no steps.
    """
    stances, known = steps.stances, steps.stances.figures
    counts = stances.whole & ~np.isin(stances.touchdown, stumbles)
    way, quick = (
        np.where(counts, each, np.nan) for each in (known.loaded_reach_m, known.quick_way_m)
    )
    is_far = way > LARGEST_FOOT_M
    if rolling_m is not None:
        is_far = way - rolling_m > max(SLIP_M, TIMES * rolling_m)
    usual = _usual_m(stances, way, walks, TIMES)
    excess = way - np.where(np.isnan(usual) & is_far, rolling_m or 0.0, usual)
    quick_excess = quick - _usual_m(stances, quick, walks, QUICK_TIMES)
    # Of a slip that is over at once, the quick way tells the time best, noise or not.
    at_once = quick_excess >= np.where(np.isnan(excess), 0.0, AT_ONCE * excess)
    metres = np.where(np.isnan(excess), quick_excess, excess)
    begins_s = np.where(at_once, known.quick_begins_s, known.reach_begins_s)
    ends_s = np.where(at_once, known.quick_ends_s, known.reach_ends_s)
    for row in np.flatnonzero(np.isfinite(metres)).tolist():
        begins, ends = int(stances.touchdown[row]), int(stances.liftoff[row])
        # Where samples are few it is the whole stance.
        if np.isfinite(begins_s[row] + ends_s[row]):
            ends = begins + round(float(ends_s[row]) * 1e9)
            begins += round(float(begins_s[row]) * 1e9)
        unknown = rolling_m is None and np.isnan(usual[row]) and np.isfinite(excess[row])
        code = "SLIPS" if unknown else ""
        yield Event(begins, ends - begins, EventType.SLIP, foot, float(metres[row]), "m", code)


def _usual_m(stances: Stances, way: Floats, walks: Sequence[Segment], times: float) -> Floats:
    """(stances,) m, the usual way in the segment of stances that are unlike it; else NaN.

    Args:
        stances: of a foot.
        way: (stances,) m; NaN where it does not count.
        walks: segments with strides.
        times: the usual way by which a way that is unlike it is longer.
    """
    usual = np.full(len(way), np.nan)
    for segment in walks:
        rows = (stances.touchdown >= segment.start) & (stances.touchdown < segment.end)
        rows &= np.isfinite(way)
        if rows.sum() >= FEWEST:
            low, median = percentiles_of(way[rows], (25.0, 50.0))
            far = max(FAR_OUT * (median - low), times * median, SLIP_M)
            usual[rows & (way - median > far)] = median
    return usual


def early_touchdowns(foot: int, steps: FootSteps, walks: Sequence[Segment]) -> Iterator[Event]:
    """Yield the touchdowns of a foot that come well before its usual swing is over.

    The foot hits something in mid-swing and swings on: a stumble. Or it stays on the ground: an
    early contact. A foot that bounces as it lands, or as it leaves, does neither.

    Args:
        foot: its index.
        steps: its stances and strides.
        walks: segments with strides; elsewhere no swing is usual.
    """
    stances, stance = steps.stances, steps.stances.duration_s
    if len(stance) < FEWEST_SWINGS + 2:
        return
    swing = _swings_s(stances, steps.record.gaps)
    usual_swing = _usual(swing, np.fmin)
    usual_stance = _usual(np.where(stances.whole, stance, np.nan), np.fmax)
    short = stance < SHORT_STANCE * usual_stance
    early = (swing > BOUNCE * usual_swing) & (swing < EARLY * usual_swing) & stances.whole
    # Feet that are told rarely seem to touch down early by up to two samples.
    early &= usual_swing - swing > SAMPLES * (steps.record.median_interval_s or 0.0)
    # After a contact that is no step, a short swing is the rest of the swing before it.
    early[1:] &= ~short[:-1]
    early &= _inside(walks, stances.touchdown)
    rest = np.append(swing[1:], np.nan)
    whole_swing = swing + stance + rest
    goes_on = (rest > BOUNCE * usual_swing) & (whole_swing < STRIDE_GOES_ON * usual_swing)
    for row in np.flatnonzero(early & (goes_on | ~short)).tolist():
        onset, lasts = int(stances.touchdown[row]), round(stance[row] * 1e9)
        if short[row]:
            done = float(swing[row] / whole_swing[row])
            yield Event(onset, lasts, EventType.STUMBLE, foot, done, "swing")
        else:
            by_s = float(usual_swing[row] - swing[row])
            yield Event(onset, 0, EventType.EARLY_CONTACT, foot, by_s, "s")


def scuffs(foot: int, steps: FootSteps, walks: Sequence[Segment]) -> Iterator[Event]:
    """Yield touches of the ground in mid-swing that are too short and light to be stances."""
    spans, stances = steps.record.scuffs, steps.stances
    inside = _inside(walks, spans[:, 0])
    for onset, end in spans[inside].tolist():
        after = int(np.searchsorted(stances.touchdown, onset))
        if 0 < after < len(stances.touchdown):
            lifted, lands = int(stances.liftoff[after - 1]), int(stances.touchdown[after])
            done = (onset - lifted) / max(lands - lifted, 1)
            yield Event(onset, end - onset, EventType.STUMBLE, foot, done, "swing")


def _swings_s(stances: Stances, gaps: Ints) -> Floats:
    """(stances,) s, swing before each stance; NaN where it was not seen from end to end."""
    swing = np.full(len(stances.touchdown), np.nan)
    swing[1:] = (stances.touchdown[1:] - stances.liftoff[:-1]) / 1e9
    broken = stances.cut != Cut.WHOLE
    swing[broken | np.isin(stances.touchdown, gaps[:, 1])] = np.nan
    swing[1:][broken[:-1]] = np.nan
    return swing


def _usual(values: Floats, of: np.ufunc) -> Floats:
    """(n,) the median of the values before each one, or of those after it; NaN of too few.

    Where both are known, `of` chooses between them: a gait that changes is no event of one foot.
    """
    unknown = np.full(NEIGHBOURS, np.nan)
    padded = np.concatenate([unknown, np.where(np.isfinite(values), values, np.nan), unknown])
    windows = np.lib.stride_tricks.sliding_window_view(padded, NEIGHBOURS)
    usual: Floats = of(_medians(windows[: len(values)]), _medians(windows[NEIGHBOURS + 1 :]))
    return usual


def _medians(windows: Floats) -> Floats:
    """(n,) the median of what each row, (n, w), knows; NaN of fewer than `FEWEST_SWINGS`."""
    few = np.isfinite(windows).sum(axis=1) < FEWEST_SWINGS
    return np.where(few, np.nan, median_of_known(windows, axis=1))


def _inside(segments: Sequence[Segment], time: Ints) -> Flags:
    inside = np.zeros(len(time), np.bool_)
    for each in segments:
        inside |= (time > each.start) & (time <= each.end)
    return inside
