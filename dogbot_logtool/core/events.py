"""What happened in a log: types of events, how they are found, their order, and events in words."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from enum import StrEnum
from itertools import pairwise
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import (
    Floats,
    Ints,
    median_of,
    norms,
)
from dogbot_logtool.core.base.poses import SMALLEST_JUMP_M
from dogbot_logtool.core.checks.sensors import foot_is_saturated
from dogbot_logtool.core.contact.stances import Cut, FootTrack, Stances
from dogbot_logtool.core.gait.classes import IRREGULAR, STAND
from dogbot_logtool.core.gait.segments import PERIOD_CHANGE, Segment
from dogbot_logtool.core.loads import is_stuck
from dogbot_logtool.core.metrics import Event, Foot, WalkMetrics
from dogbot_logtool.core.walk import Walk


class EventType(StrEnum):
    """Type of an event; of events at one time the first of these comes first."""

    FALL = "fall"
    """descent from standing to lying, until the robot lies no more"""
    TIPPING = "tipping"
    """roll or pitch leaves its usual range and the recording ends"""
    CARRIED = "carried"
    """no foot is down for longer than a leap takes, and the base is as high as it stands, or higher
    (value: by how much)"""
    STUMBLE = "stumble"
    """a foot in mid-swing touches something and swings on (value: part of the swing before it)"""
    SLIP = "slip"
    """the contact point of a loaded foot goes three times as far as in the foot's other stances, or
    as `settings.foot_rolling_m` where that is less, and 5 mm more (value: how much further)"""
    EARLY_CONTACT = "early_contact"
    """a swing ends before 0.7 of the foot's usual swing and the foot stays down (value: how much
    too early)"""
    MARGIN_BELOW_ZERO = "margin_below_zero"
    """the base's projection leaves the support polygon by more than 1 cm for at least 80 ms (value:
    least margin)"""
    GAIT_CHANGE = "gait_change"
    """the class or the stride period changes for at least two strides, or a stand begins or ends
    (value: new stride frequency)"""
    POSE_JUMP = "pose_jump"
    """a step of the pose that the base's speed does not explain"""
    SENSOR_FAULT = "sensor_fault"
    """what findings call stuck, dead, saturated or a lone spike"""
    GAP = "gap"
    """silence of a foot's sensor or of the odometry that ends what is known"""
    TOUCHDOWN = "touchdown"
    """a foot comes down"""
    LIFT_OFF = "lift_off"
    """a foot leaves the ground"""


STEPS = frozenset({EventType.TOUCHDOWN, EventType.LIFT_OFF})
"""Events of every stride, which call for no look."""
_RANK: Final = {kind.value: rank for rank, kind in enumerate(EventType)}

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
"""Stances, or swings, of a segment that say what is usual."""
EARLY: Final = 0.7
"""Share of the usual swing below which a swing ends early."""
BOUNCE: Final = 0.2
"""Share of the usual swing below which a swing is a bounce, at touchdown or lift-off."""
SHORT_STANCE: Final = 0.5
"""Share of the usual stance below which a contact is no step."""
SAMPLES: Final = 2.0
"""Sampling intervals by which a swing must be too short."""


def find_events(walk: Walk) -> tuple[Event, ...]:
    """Return the events of a log, in the order of time; see `with_steps` for all of them."""
    found = [*_spans(walk), *_carried(walk), *_gait_changes(walk), *_margins(walk)]
    for row in range(len(walk.feet)):
        early = list(_early_touchdowns(walk, row))
        stumbles = [each.onset_s for each in early if each.type == EventType.STUMBLE]
        found += [*early, *_scuffs(walk, row), *_slips(walk, row, stumbles)]
        found += _sensor_faults(walk, row)
    return in_order(found)


def _event(
    walk: Walk,
    kind: EventType,
    span: tuple[int, int],
    foot: int | None = None,
    value: float | None = None,
    unit: str | None = None,
    code: str | None = None,
) -> Event:
    """Return an event.

    Args:
        walk: that it is of.
        kind: its type.
        span: ns, from and to; twice the same for an instant.
        foot: its index; None: of the whole robot.
        value: its size; None: nothing is measured of it.
        unit: of the value.
        code: of the finding about it; of a change of the gait both classes, ``trot>walk``.
    """
    onset, end = span
    name = None if foot is None else walk.feet[foot].name
    onset_s, lasts_s = (onset - walk.origin) / 1e9, (end - onset) / 1e9
    return Event(onset_s, lasts_s, kind.value, name, value, unit, code)


def _spans(walk: Walk) -> Iterator[Event]:
    """Yield falls, tipping, jumps of the pose and gaps: what is known as spans already.

    A fall lasts from the beginning of the descent until the robot lies no more; a jump from the
    pose before it to the one after.
    """
    for span in walk.fallen.tolist():
        yield _event(walk, EventType.FALL, span, code="FALL")
    found, poses = walk.tipping, walk.base_history
    if found is not None and not len(walk.fallen):
        span = found.since, int(poses.time[-1])
        yield _event(walk, EventType.TIPPING, span, None, found.last_rad, "rad", "FALL")
    sizes, turns = norms(walk.jumps.size_m).tolist(), walk.jumps.turn_rad.tolist()
    for span, size, turn in zip(walk.jumps.spans.tolist(), sizes, turns, strict=True):
        value, unit = (size, "m") if size > SMALLEST_JUMP_M else (abs(turn), "rad")
        yield _event(walk, EventType.POSE_JUMP, span, None, value, unit, "POSE_JUMP")
    heard = [timespans.subtract(each.gaps, each.stopped) for each in walk.records]
    for who, silent in zip([None, *range(len(heard))], [poses.gaps, *heard], strict=True):
        for start, end in silent.tolist():
            yield _event(walk, EventType.GAP, (start, end), who, (end - start) / 1e9, "s", "GAPS")


def _carried(walk: Walk) -> Iterator[Event]:
    """Yield when no foot is down, and the base is as high as while it stands, or higher."""
    down = [timespans.no_spans(), *(foot.record.in_contact for foot in walk.feet)]
    time, z = walk.base_history.time, walk.base_history.position[:, 2]
    stands = timespans.covers(timespans.merge(np.concatenate(down)), time)
    lifted = walk.standing.lifted
    for start, end in lifted[~timespans.touches(walk.jumps.spans, *lifted.T)].tolist():
        inside = (time >= start) & (time < end)
        near = (time >= start - BESIDE_NS) & (time < end + BESIDE_NS)
        # Nothing is higher than a height that is not known.
        rises_m = float(median_of(z[inside]) - median_of(z[stands & near & ~inside]))
        if rises_m > -LOWER_M:
            yield _event(walk, EventType.CARRIED, (start, end), None, rises_m, "m")


def _gait_changes(walk: Walk) -> Iterator[Event]:
    """Yield each change from one gait to another, also between gaits and stands.

    It happens half-way between the last stride of the gait before and the first of the next, or
    where the stand begins or ends. Irregular strides between two gaits are no gait of their own.
    """
    gaits = [each for each in walk.segments if each.gait.name not in {None, IRREGULAR}]
    for before, after in pairwise(gaits):
        if before.gait.name == after.gait.name and not _faster_or_slower(before, after):
            continue
        onset = (before.end + after.start) // 2
        if after.gait.name == STAND:
            onset = after.start
        elif before.gait.name == STAND:
            onset = before.end
        frequency = after.gait.stride_frequency_hz
        unit = None if frequency is None else "Hz"
        code = f"{before.gait.name}>{after.gait.name}"
        yield _event(walk, EventType.GAIT_CHANGE, (onset, onset), None, frequency, unit, code)


def _faster_or_slower(before: Segment, after: Segment) -> bool:
    first, then = (each.gait.stride_frequency_hz for each in (before, after))
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
    for span, value in zip(below[counts].tolist(), least[counts].tolist(), strict=True):
        yield _event(walk, EventType.MARGIN_BELOW_ZERO, span, None, value, "m")


def _sensor_faults(walk: Walk, row: int) -> Iterator[Event]:
    """Yield what findings call a fault of a foot's sensor, with the time that shows it."""

    def fault(start: int, end: int, code: str, newtons: float | None = None) -> Event:
        unit = None if newtons is None else "N"
        return _event(walk, EventType.SENSOR_FAULT, (start, end), row, newtons, unit, code)

    foot = walk.feet[row]
    record, stances, figures = foot.record, foot.record.stances, foot.record.stances.figures
    if foot.is_dead and not len(record.stopped):
        yield fault(record.start or 0, record.end or 0, "DEAD")
    if is_stuck(record, walk.records):
        yield fault(int(stances.touchdown[0]), int(stances.liftoff[-1]), "STUCK")
    else:
        yield from (fault(start, end, "STOPPED") for start, end in record.stopped.tolist())
    if foot_is_saturated(walk, row) and np.isfinite(figures.peak_force_n).any():
        limit = float(np.nanmax(figures.peak_force_n))
        first, last = np.flatnonzero(figures.peak_force_n >= AT_LIMIT * limit)[[0, -1]].tolist()
        yield fault(int(stances.touchdown[first]), int(stances.liftoff[last]), "SATURATED", limit)
    for spike in foot.spikes.tolist():
        at = int(record.track.time[spike])
        yield fault(at, at, "SPIKES", float(record.track.force[spike]))


def _slips(walk: Walk, row: int, stumbles: Sequence[float]) -> Iterator[Event]:
    """Yield the stances in which a foot slips: none of a base that is known by its feet.

    Args:
        walk: with its segments.
        row: of the foot.
        stumbles: s, touchdowns of contacts that are no steps.
    """
    if walk.settings.base_from_legs:
        return
    stances, figures = walk.feet[row].stances, walk.feet[row].stances.figures
    rolling_m, touchdown_s = walk.settings.foot_rolling_m, walk.seconds(stances.touchdown)
    counts = stances.whole & ~np.isin(touchdown_s, stumbles)
    travel = np.where(counts, figures.contact_reach_m, np.nan)
    usual = _usual(walk, stances.touchdown, stances.liftoff, travel)
    usual = np.fmin(usual, np.inf if rolling_m is None else rolling_m)
    further = travel - usual
    for slip in np.flatnonzero(further > np.maximum(SLIP_M, TIMES * usual)).tolist():
        stance = int(stances.touchdown[slip]), int(stances.liftoff[slip])
        span = _sliding(walk.records[row].track, *stance)
        yield _event(walk, EventType.SLIP, span, row, float(further[slip]), "m")


def _sliding(track: FootTrack, start: int, end: int) -> tuple[int, int]:
    """Return when the contact point goes most of its way from 10 % to 90 % of a stance, ns."""
    time, point = track.contact_points
    edges = start + (end - start) // 10, end - (end - start) // 10
    rows = slice(*np.searchsorted(time, edges))
    time, away = time[rows], norms(point[rows] - point[rows][:1])
    most = away.max(initial=0.0)
    before_half = np.logical_and.accumulate(away < 0.5 * most)
    rests = np.flatnonzero(before_half & (away <= 0.1 * most))
    if not len(rests):
        # Where samples are few, it is the whole stance.
        return start, end
    return int(time[rests[-1]]), int(time[(away >= 0.9 * most).argmax()])


def _usual(walk: Walk, start: Ints, end: Ints, values: Floats) -> Floats:
    """(n,) the median in the segment that each value is of; NaN of few, and outside of strides.

    Args:
        walk: with its segments.
        start: (n,) ns, from when each value is.
        end: (n,) ns, until when.
        values: (n,) any unit; NaN: does not count.
    """
    usual = np.full(len(values), np.nan)
    for segment in walk.segments:
        inside = (start >= segment.start) & (end <= segment.end) & bool(segment.strides)
        known = values[inside & np.isfinite(values)]
        if len(known) >= FEWEST:
            usual[inside] = median_of(known)
    return usual


def _early_touchdowns(walk: Walk, row: int) -> Iterator[Event]:
    """Yield the touchdowns of a foot that come well before its usual swing is over.

    The foot hits something in mid-swing and swings on: a stumble. Or it stays on the ground: an
    early contact. A foot that bounces as it lands, or as it leaves, does neither.
    """
    steps = walk.feet[row]
    stances, stance = steps.stances, steps.stances.duration_s
    swing = _swings_s(stances, steps.record.gaps)
    lifted = np.append(stances.touchdown[:1], stances.liftoff[:-1])
    usual_swing = _usual(walk, lifted, stances.touchdown, swing)
    whole = np.where(stances.whole, stance, np.nan)
    usual_stance = _usual(walk, stances.touchdown, stances.liftoff, whole)
    short = stance < SHORT_STANCE * usual_stance
    early = (swing > BOUNCE * usual_swing) & (swing < EARLY * usual_swing) & stances.whole
    # Feet that are told rarely seem to touch down early by up to two samples.
    early &= usual_swing - swing > SAMPLES * (steps.record.median_interval_s or 0.0)
    # After a contact that is no step, a short swing is the rest of the swing before it.
    early[1:] &= ~short[:-1]
    whole_swing = swing + stance + np.append(swing[1:], np.nan)
    for at in np.flatnonzero(early & (~short | np.isfinite(whole_swing))).tolist():
        onset, end = int(stances.touchdown[at]), int(stances.liftoff[at])
        if short[at]:
            done = float(swing[at] / whole_swing[at])
            yield _event(walk, EventType.STUMBLE, (onset, end), row, done, "swing")
        else:
            by_s = float(usual_swing[at] - swing[at])
            yield _event(walk, EventType.EARLY_CONTACT, (onset, onset), row, by_s, "s")


def _scuffs(walk: Walk, row: int) -> Iterator[Event]:
    """Yield touches of the ground in mid-swing that are too short and light to be stances."""
    spans, stances = walk.feet[row].record.scuffs, walk.feet[row].stances
    for onset, end in spans.tolist():
        after = int(np.searchsorted(stances.touchdown, onset))
        if 0 < after < len(stances.touchdown):
            lifted, lands = int(stances.liftoff[after - 1]), int(stances.touchdown[after])
            done = (onset - lifted) / (lands - lifted)
            yield _event(walk, EventType.STUMBLE, (onset, end), row, done, "swing")


def _swings_s(stances: Stances, gaps: Ints) -> Floats:
    """(stances,) s, swing before each stance; NaN where it was not seen from end to end."""
    swing = np.full(len(stances.touchdown), np.nan)
    swing[1:] = (stances.touchdown[1:] - stances.liftoff[:-1]) / 1e9
    broken = stances.cut != Cut.WHOLE
    swing[broken | np.isin(stances.touchdown, gaps[:, 1])] = np.nan
    swing[1:][broken[:-1]] = np.nan
    return swing


def in_order(events: Iterable[Event]) -> tuple[Event, ...]:
    """Return events, of each type in the order of feet, in the order of time, then of types."""
    return tuple(sorted(events, key=lambda each: (each.onset_s, _RANK[each.type])))


def with_steps(metrics: WalkMetrics) -> tuple[Event, ...]:
    """Return all events of a walk: those of its metrics, and touchdowns and lift-offs."""
    steps = [each for name, foot in metrics.feet.items() for each in _steps(name, foot)]
    return in_order([*metrics.events, *steps])


def _steps(name: str, foot: Foot) -> Iterable[Event]:
    columns = (EventType.TOUCHDOWN, foot.touchdown_s), (EventType.LIFT_OFF, foot.lift_off_s)
    for kind, times in columns:
        yield from (Event(time, 0.0, kind.value, name, None, None, None) for time in times or ())


WARNING: Final = 3
"""How much most events matter, as log panels filter them."""
LEVELS: Final[Mapping[str, int]] = {
    EventType.FALL: 4,
    EventType.GAIT_CHANGE: 2,
    **dict.fromkeys(STEPS, 1),
}
"""The same of the others: an error, information, and steps that are for looking closely only."""


def text_of(event: Event) -> str:
    """Return an event in words; log panels show its foot beside them."""
    code, is_change = event.code or "", event.type == EventType.GAIT_CHANGE
    parts = [
        event.type.replace("_", " "),
        code.replace(">", " to ") if is_change else "",
        "" if event.value is None else f"{event.value:.3g} {event.unit}",
        f"for {event.duration_s:.3f} s" if event.duration_s and event.unit != "s" else "",
        "" if is_change else code,
    ]
    return ", ".join(filter(None, parts))


def to_log_time(tracks: Sequence[FootTrack], time: Ints, start: int, end: int) -> Ints:
    """Return when times on the clock that was measured on were recorded.

    As long after as the sample around it of the foot that has the most.

    Args:
        tracks: of all feet.
        time: (n,) ns, ascending.
        start: ns, log time of its first message.
        end: ns, of its last.

    Returns:
        (n,) ns, ascending, within the log.
    """
    track = max(tracks, key=lambda each: len(each.row), default=None)
    if track is not None and len(track.row):
        row = np.minimum(np.searchsorted(track.time, time), len(track.time) - 1)
        time = time + (track.log_time - track.time)[row]
    recorded: Ints = np.maximum.accumulate(np.clip(time, start, end))
    return recorded
