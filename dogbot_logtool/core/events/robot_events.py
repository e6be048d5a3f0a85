"""Events of the whole robot: falls, being carried, changes of the gait, lost balance."""

from collections.abc import Iterator, Sequence
from itertools import compress, pairwise
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints, median_of, norms
from dogbot_logtool.core.events.event import Event, EventType
from dogbot_logtool.core.gait.gait import IRREGULAR, STAND
from dogbot_logtool.core.gait.segments import LASTING, PERIOD_CHANGE, Segment
from dogbot_logtool.core.statistics import Stats

MARGIN_M: Final = 0.01
"""m below zero that a margin must reach: contact points and poses are not known better."""
LASTING_S: Final = 0.08
"""s, two instants, that it must stay below zero."""
BESIDE_S: Final = 1.0
"""s before and after it is carried in which a robot shows how high it stands."""
LOWER_M: Final = 0.02
"""m below that height from which a robot without contact lies on its body."""


def falls(stats: Stats) -> Iterator[Event]:
    """Yield each fall, from the beginning of the descent until the robot lies no more."""
    yield from _spans(stats.fallen, EventType.FALL, "FALL")


def tipping(stats: Stats) -> Iterator[Event]:
    """Yield how the robot tips as the recording ends, without a fall."""
    found = stats.tipping
    if found is not None and not len(stats.fallen):
        lasts = int(stats.base_history.time[-1]) - found.since
        yield Event(found.since, lasts, EventType.TIPPING, None, found.last_rad, "rad", "FALL")


def carried(stats: Stats) -> Iterator[Event]:
    """Yield when no foot is down, and the base is as high as while it stands, or higher."""
    lifted = [each.spans for each in stats.segments if each.is_lifted]
    spans = timespans.merge(np.concatenate(lifted)) if lifted else timespans.no_spans()
    for start, end in spans.tolist():
        rises_m = _rise_m(stats, start, end)
        if rises_m is not None and rises_m > -LOWER_M:
            yield Event(start, end - start, EventType.CARRIED, None, rises_m, "m")


def _rise_m(stats: Stats, start: int, end: int) -> float | None:
    """Return how much higher the base is in a span than beside it; None: it is not known."""
    base, beside = stats.base_history, round(BESIDE_S * 1e9)
    feet = [foot.record.in_contact for foot in stats.feet if len(foot.record.in_contact)]
    if not feet or timespans.touches(stats.jumps.spans, *np.array([[start], [end]])).any():
        return None
    down = timespans.covers(timespans.merge(np.concatenate(feet)), base.time)
    near = (base.time >= start - beside) & (base.time < end + beside)
    inside = (base.time >= start) & (base.time < end)
    stands = down & near & ~inside
    if not stands.any() or not inside.any():
        return None
    z = base.position[:, 2]
    return float(median_of(z[inside]) - median_of(z[stands]))


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


def margins_below_zero(stats: Stats) -> Iterator[Event]:
    """Yield the times in which the base's projection is clearly outside the support polygon.

    After a jump of the pose it is not known where the base is among the feet; a robot that lies
    does not lose its balance.
    """
    if stats.unstable is None:
        return
    jump = stats.jumps.spans[0, 0] if len(stats.jumps.spans) else stats.end
    below, least = stats.unstable.spans, stats.unstable.least_margin_m
    counts = (below[:, 1] - below[:, 0] >= LASTING_S * 1e9) & (least < -MARGIN_M)
    counts &= (below[:, 0] < jump) & ~timespans.covers(stats.fallen, below[:, 0])
    for row in np.flatnonzero(counts).tolist():
        start, end = below[row].tolist()
        value = float(least[row])
        yield Event(start, end - start, EventType.MARGIN_BELOW_ZERO, None, value, "m")


def pose_jumps(stats: Stats) -> Iterator[Event]:
    """Yield each jump of the base's pose, from the pose before it to the one after."""
    sizes = norms(stats.jumps.size_m).tolist()
    for (start, end), size in zip(stats.jumps.spans.tolist(), sizes, strict=True):
        yield Event(start, end - start, EventType.POSE_JUMP, None, size, "m", "POSE_JUMP")


def _spans(spans: Ints, kind: EventType, code: str) -> Iterator[Event]:
    for start, end in spans.tolist():
        yield Event(start, end - start, kind, code=code)
