"""A foot's steps over a whole log, and its metrics over the log or a part of it."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Final, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Ints, aggregate, percentiles_of
from dogbot_logtool.core.base.ground import Footfalls, MovingGround
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.contact.stances import Cut, StanceFigures, Stances
from dogbot_logtool.core.gait.strides import Standing, Strides, strides_of, walked_stances
from dogbot_logtool.core.loads import (
    fore_aft_ns,
    slip_m,
    vertical_impulse_ns,
)
from dogbot_logtool.core.metrics import Foot
from dogbot_logtool.core.records import Curve, Numbers, Shape, fields_of, unknown
from dogbot_logtool.core.settings import LegPosition, WalkSettings

CYCLE: Final = np.linspace(0.0, 1.0, 51)
"""The points of a curve over a stride, as shares of it."""
STRAIGHT_RAD: Final = np.radians(10.0)
"""The base turns by less in a straight stride."""
FEWEST_STANCES: Final = 8
"""Stances of all feet from which it is told how far they push the robot on."""
_METRICS: Final = frozenset(field.name for field in fields_of(Foot))
FIGURES: Final = tuple(name for name in StanceFigures._fields if name in _METRICS)
"""Figures of stances that are metrics of a foot."""


class FootSteps(NamedTuple):
    """Stances and strides of a foot over the whole log, and what is measured of each."""

    name: str
    topic: str
    leg_position: LegPosition | None
    record: FootHistory
    stances: Stances
    """All stances, those in a fall or a stand marked as cut."""
    strides: Strides
    discarded: Mapping[str, int]
    """Stances that begin no whole stride, by reason."""
    touchdown: Ints
    """(t,) ns, touchdowns that were seen."""
    liftoff: Ints
    """(l,) ns, lift-offs that were seen."""
    of_stances: Mapping[str, Floats]
    """(stances,) each, by the name of the metric; NaN where not known."""
    of_strides: Mapping[str, Floats]
    """(strides,) each, likewise; also what is no metric of a foot: the work of its leg, and how far
    the base goes."""
    length_from: str
    """What stride lengths are measured by: ``points``, ``foot_frame``, or ``base``."""
    slip_from: str
    """What slips are measured by, where they are known: ``points`` or ``foot_frame``."""
    is_dead: bool
    """Whether its sensor never reports a contact, and nothing says that it is lifted."""
    contact_known: bool
    """Whether its sensor tells contact, and nothing refutes it."""
    heading: Floats
    """(stances,) rad, of the base's forward axis in the middle of each stance; NaN: not known."""
    stood: Footfalls
    """Where it stands."""

    @property
    def length_m(self) -> Floats:
        """(strides,) m, from each place of the foot to its next one; NaN where not known."""
        return self.of_strides["stride_length_m"]

    @property
    def known(self) -> Ints:
        """(k, 2) ns, the time about which its sensor says something; none of a dead one."""
        return timespans.no_spans() if self.is_dead else self.record.known

    @property
    def spikes(self) -> Ints:
        """(s,) samples of its track with lone spikes of the force, in whole stances."""
        touchdown, liftoff, whole = self.stances.touchdown, self.stances.liftoff, self.stances.whole
        spans, spikes = np.stack([touchdown, liftoff], axis=1)[whole], self.record.spikes
        return spikes[timespans.covers(spans, self.record.track.time[spikes])]


def foot_steps(
    settings: WalkSettings,
    row: int,
    record: FootHistory,
    stood: Footfalls,
    base: BaseHistory,
    fallen: Ints,
    standing: Standing,
    *,
    ground: MovingGround | None = None,
    is_dead: bool = False,
) -> FootSteps:
    """Find the steps of a foot.

    Args:
        settings: what decides the metrics.
        row: of the foot.
        record: its stances and track.
        stood: where it stands.
        base: poses.
        fallen: (f, 2) ns, spans in which the robot lies.
        standing: spans without steps.
        ground: how the ground moves; None: it rests.
        is_dead: whether its sensor never reports a contact, and nothing says that it is lifted.
    """
    foot, rolling_m = settings.feet[row], settings.foot_rolling_m
    stances = walked_stances(record.stances, fallen, standing.without_steps)
    strides, discarded = strides_of(stances, record.gaps, fallen)
    figures = stances.figures
    heading = base.yaw_at(stances.middle) + settings.forward_rad
    braking, propulsive = fore_aft_ns(record, heading)
    of_stances = {name: getattr(figures, name) for name in FIGURES} | {
        "stance_s": stances.duration_s,
        "slip_m": slip_m(figures.contact_travel_m, rolling_m),
        "slip_largest_m": slip_m(figures.contact_reach_m, rolling_m),
        "braking_impulse_ns": braking,
        "propulsive_impulse_ns": propulsive,
    }
    way = base.position_at(strides.end) - base.position_at(strides.touchdown)
    travelled = np.hypot(way[:, 0], way[:, 1])
    length, length_from = _own_lengths(stood, ground, strides), "points"
    if not np.isfinite(length).any():
        # A stride in which the base hardly turns is as long for all of its feet.
        turn = base.yaw_at(strides.end) - base.yaw_at(strides.touchdown)
        is_straight = np.abs(turn) < STRAIGHT_RAD
        length, length_from = np.where(is_straight, travelled, np.nan), "base"
    of_strides = {
        "swing_s": (strides.end - strides.liftoff) / 1e9,
        "stride_period_s": strides.period_s,
        "duty_factor": strides.duty_factor,
        "stride_length_m": length,
        "base_displacement_m": travelled,
    }
    # A sensor that is taken to read zero without load, on a robot that moves without steps.
    is_refuted = bool(foot.level.reason and len(standing.moving))
    return FootSteps(
        name=foot.name,
        topic=foot.topic,
        leg_position=foot.leg_position,
        record=record,
        stances=stances,
        strides=strides,
        discarded=discarded,
        touchdown=_seen(stances.touchdown, record, Cut.LOG_START, stances),
        liftoff=_seen(stances.liftoff, record, Cut.LOG_END, stances),
        of_stances=of_stances,
        of_strides=of_strides,
        length_from=length_from,
        slip_from="points",
        is_dead=is_dead,
        contact_known=record.start is not None and not (is_dead or is_refuted),
        heading=heading,
        stood=stood,
    )


def _own_lengths(stood: Footfalls, ground: MovingGround | None, strides: Strides) -> Floats:
    """(strides,) m, horizontal distances from each place where a foot stands to its next one."""
    place = stood.position
    if ground is not None:
        place = place - ground.displacement_at(stood.time)
    displacement = place[strides.stance + 1] - place[strides.stance]
    return np.asarray(np.hypot(displacement[:, 0], displacement[:, 1]))


def _seen(time: Ints, record: FootHistory, unseen: Cut, stances: Stances) -> Ints:
    """Leave out the events that the log's ends or a gap hide."""
    seen: Ints = time[(stances.cut != unseen) & ~np.isin(time, record.gaps[:, 1])]
    if len(stances.cut) == 1:
        # A stance may last from the log's first sample to its last.
        seen = seen[(seen != record.start) & (seen != record.end)]
    return seen


def foot_metrics(foot: FootSteps, weight_n: float | None, origin: int, within: Ints) -> Foot:
    """Return the metrics of a foot.

    Args:
        foot: its steps.
        weight_n: N, what forces in body weights are divided by; None: not known.
        origin: ns, what times are counted from.
        within: (w, 2) ns, a part of the log; its stances and strides are those with their middle in
            it.
    """
    inside, strides = foot.strides.rows_within(within), foot.strides.within(within)
    whole = foot.stances.whole & timespans.covers(within, foot.stances.middle)
    per_weight = np.nan if weight_n is None else 1.0 / weight_n
    in_weights = {
        f"peak_{name}_bw": foot.of_stances[f"peak_{name}_n"] * per_weight
        for name in ("force", "vertical_force")
    }
    found: dict[str, Any] = {}
    for name, values in {**foot.of_stances, **in_weights}.items():
        found[name] = aggregate(values[whole])
    for name, values in foot.of_strides.items():
        found[name] = aggregate(values[inside])
    found |= {
        "contact_fraction": foot.record.contact_fraction(within),
        "strides": len(strides.stance),
        "stride_frequency_hz": strides.frequency_hz,
        "stride_length_from": None if found["stride_length_m"] is None else foot.length_from,
        "slip_from": None if found["slip_m"] is None else foot.slip_from,
        "touchdown_s": _seconds(foot.touchdown, origin, within),
        "lift_off_s": _seconds(foot.liftoff, origin, within),
        "vertical_impulse_ns": vertical_impulse_ns(foot.record, within),
        "vertical_over_stride_n": stride_curve(foot, strides, forward=False),
        "forward_over_stride_n": stride_curve(foot, strides, forward=True),
    }
    return replace(unknown(Foot), **{name: found[name] for name in found.keys() & _METRICS})


def _seconds(time: Ints, origin: int, within: Ints) -> Numbers:
    """Return times as seconds since the log's start, to the nanosecond."""
    inside = time[timespans.covers(within, time)]
    return tuple(each / 1e9 for each in (inside - origin).tolist())


def stride_curve(foot: FootSteps, strides: Strides, *, forward: bool) -> Shape:
    """Return the usual force over a stride, straight from its samples; None where none is known.

    Args:
        foot: its steps.
        strides: some of them.
        forward: the force along the base's forward axis, not the vertical one.
    """
    track = foot.record.track
    own = strides.stance[np.isfinite(foot.stances.figures.mean_vertical_force_n[strides.stance])]
    if not len(own):
        return None
    begin, end = (foot.stances.touchdown[rows, None] for rows in (own, own + 1))
    time = begin + (end - begin) * CYCLE
    if not forward:
        return cycle_curve(np.interp(time, track.time, track.vertical_force))
    x, y = (np.interp(time, track.time, column) for column in track.horizontal_force.T)
    heading = foot.heading[own, None]
    return cycle_curve(x * np.cos(heading) + y * np.sin(heading))


def cycle_curve(values: Floats) -> Shape:
    """Return the quartiles of those curves, (n, points), that are known; None of none."""
    known = values[np.isfinite(values).all(axis=1)]
    if not len(known):
        return None
    parts = (100.0 * CYCLE, *percentiles_of(known, (25.0, 50.0, 75.0), axis=0))
    return Curve(*(tuple(each.tolist()) for each in parts))


def net_push(feet: Sequence[FootSteps]) -> float | None:
    """Return how far the feet push the robot on over whole stances, as a share of the weight.

    Braking and propulsion cancel out unless the robot speeds up, or something pulls at it.

    Args:
        feet: steps of all feet.

    Returns:
        None where the direction of forces is not known, or few stances tell.
    """
    parts = [np.empty((2, 0))]
    for foot in feet:
        pushed = foot.of_stances["propulsive_impulse_ns"] - foot.of_stances["braking_impulse_ns"]
        both = np.stack([pushed, foot.stances.figures.vertical_impulse_ns])
        parts.append(both[:, foot.stances.whole & np.isfinite(both).all(axis=0)])
    pushed, carried = np.concatenate(parts, axis=1)
    if len(carried) < FEWEST_STANCES or carried.sum() <= 0.0:
        return None
    return float(pushed.sum() / carried.sum())
