"""A foot's steps over a whole log, and its metrics over the log or a part of it."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import (
    Flags,
    Floats,
    Ints,
    aggregate,
    percentiles_of,
    rows_of_runs,
    trapezoids,
)
from dogbot_logtool.core.base.foot_path import FootPath, places_on_path
from dogbot_logtool.core.base.motion import FORWARD_ANGLES, stride_lengths
from dogbot_logtool.core.base.moving_ground import MovingGround
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.contact.places import stance_places
from dogbot_logtool.core.contact.stance_samples import PARTS
from dogbot_logtool.core.contact.stances import Cut, Stances
from dogbot_logtool.core.gait.strides import (
    Strides,
    cut_by_fall,
    cut_by_standing,
    cut_outside,
    strides_of,
)
from dogbot_logtool.core.gait.support import Standing, steps_apart
from dogbot_logtool.core.leg_position import LegPosition
from dogbot_logtool.core.loads import has_lone_spikes, slip_m, vertical_impulse_ns, without_spikes
from dogbot_logtool.core.metrics import Foot
from dogbot_logtool.core.records import Curve, Numbers, Shape, unknown
from dogbot_logtool.core.rotations import along_heading
from dogbot_logtool.core.settings import StatsSettings
from dogbot_logtool.dataclass import dataclass

CYCLE_POINTS: Final = 51
"""Points of a curve over a stride: 0, 2, ... 100 %."""
QUARTILES: Final = (25.0, 50.0, 75.0)


@dataclass(frozen=True, slots=True)
class CycleCurve:
    """A force over the gait cycle, (n,) each."""

    percent: Floats
    """% of the stride."""
    lower: Floats
    """N, lower quartile over strides; also `median` and `upper`."""
    median: Floats
    upper: Floats
    number: int
    """Strides."""


@dataclass(frozen=True, slots=True)
class ForeAftImpulses:
    """Fore-aft impulses of a foot's stances, along the base's forward axis at mid-stance."""

    braking: Floats
    """(n,) N s, at least 0: what slows the robot; NaN where direction or heading is not known."""
    propulsive: Floats
    """(n,) N s, at least 0: what drives it forward."""


def forward_forces(foot: FootHistory, heading: Floats) -> Floats:
    """(stances, PARTS) N, mean force along a heading, (stances,) rad, in each part of a stance."""
    x, y = foot.stance_forces[:, 0], foot.stance_forces[:, 1]
    forward: Floats = x * np.cos(heading)[:, None] + y * np.sin(heading)[:, None]
    return forward


def stance_headings(stances: Stances, base: BaseHistory, forward_axis: str) -> Floats:
    """(stances,) rad, where the base's forward axis points in the middle of each stance."""
    middle = stances.touchdown + (stances.liftoff - stances.touchdown) // 2
    heading: Floats = base.angles_at(middle)[:, 2] + FORWARD_ANGLES[forward_axis]
    return heading


def fore_aft_impulses(foot: FootHistory, heading: Floats) -> ForeAftImpulses:
    """Integrate the braking and the propulsive part of the force over each stance.

    Each sample counts by its own sign.

    Args:
        foot: its history.
        heading: (stances,) rad; see `stance_headings`.
    """
    track, stances = foot.track, foot.stances
    braking, propulsive = np.full((2, len(heading)), np.nan)
    known = np.isfinite(heading) & np.isfinite(foot.stance_forces).all(axis=(1, 2))
    if not known.any():
        return ForeAftImpulses(braking, propulsive)
    before = np.maximum(np.searchsorted(track.time, stances.touchdown[known]) - 1, 0)
    # A foot that stopped to speak in a stance has no sample at its end.
    behind = np.minimum(np.searchsorted(track.time, stances.liftoff[known]) + 1, len(track.time))
    rows, stance, first = rows_of_runs(before, behind)
    force = track.horizontal_force[rows].astype(np.float64)
    along, _ = along_heading(force, heading[known][stance])
    time = (track.time[rows] - track.time[0]) / 1e9
    braking[known] = -trapezoids(np.minimum(along, 0.0), time, first)
    propulsive[known] = trapezoids(np.maximum(along, 0.0), time, first)
    return ForeAftImpulses(braking, propulsive)


def stride_curve(force: Floats, strides: Strides) -> CycleCurve | None:
    """Return the usual force over a stride, 0 in its swing; None where none is known.

    Args:
        force: (n, PARTS) N, mean force in each part of each of the foot's stances.
        strides: of the same foot.
    """
    of_strides = force[strides.stance]
    rows = np.flatnonzero(np.isfinite(of_strides).all(axis=1))
    phase: Floats = np.arange(CYCLE_POINTS) / float(CYCLE_POINTS - 1)
    stance_phase = phase[None, :] / strides.duty_factor[rows][:, None]
    part = np.minimum((stance_phase * PARTS).astype(np.int64), PARTS - 1)
    known = np.where(stance_phase < 1.0, np.take_along_axis(of_strides[rows], part, axis=1), 0.0)
    return cycle_curve(phase * 100.0, known)


def cycle_curve(percent: Floats, values: Floats) -> CycleCurve | None:
    """Return the quartiles of curves, (n, points)."""
    if len(values) == 0:
        return None
    lower, median, upper = percentiles_of(values, QUARTILES, axis=0)
    return CycleCurve(percent, lower, median, upper, len(values))


def curve_of(curve: CycleCurve | None) -> Shape:
    """Return a curve as a metric."""
    if curve is None:
        return None
    parts = (curve.percent, curve.lower, curve.median, curve.upper)
    return Curve(*(tuple(each.tolist()) for each in parts))


FEWEST_STANCES: Final = 8
"""Stances of all feet from which it is told how far they push the robot on."""


@dataclass(frozen=True, slots=True)
class FootSteps:
    """Stances and strides of a foot over the whole log, and the forces in them."""

    name: str
    topic: str
    leg_position: LegPosition | None
    record: FootHistory
    stances: Stances
    """All stances, those in a fall or a stand marked as cut; peaks are without lone spikes."""
    strides: Strides
    discarded: Mapping[str, int]
    """Stances that begin no whole stride, by reason."""
    touchdown: Ints
    """(t,) ns, touchdowns that were seen."""
    liftoff: Ints
    """(l,) ns, lift-offs that were seen."""
    length_m: Floats
    """(strides) m, from each place of the foot to its next one; NaN where not known."""
    length_from: str
    """What lengths are measured by: ``points``, ``foot_frame``, or ``base``."""
    base_way_m: Floats
    """(strides) m, horizontal distance of the base over the stride; NaN where not known."""
    slip_m: Floats
    """(stances) m, net slip; NaN where not known."""
    slip_largest_m: Floats
    """(stances) m, the furthest that the foot slips from where it stood."""
    slip_from: str | None
    """What slips are measured by: ``points`` or ``foot_frame``; None: not known."""
    is_dead: bool
    """Whether its sensor never reports a contact, and nothing says that it is lifted."""
    contact_known: bool
    """Whether its sensor tells contact, and nothing refutes it."""
    has_spikes: Flags
    """(stances,) which have lone spikes."""
    vertical: Floats
    """(stances, PARTS) N, mean vertical force in each part of each stance; NaN: not known."""
    forward: Floats
    """(stances, PARTS) N, the same along the base's forward axis."""
    fore_aft: ForeAftImpulses
    """N s, along that axis, in each stance."""

    @property
    def spikes(self) -> int:
        """Lone spikes of its force in whole stances; kept out of the peaks."""
        return int(self.stances.figures.spikes[self.has_spikes & self.stances.whole].sum())

    @property
    def vertical_over_stride(self) -> CycleCurve | None:
        """The usual vertical force over a stride; None: not known."""
        return stride_curve(self.vertical, self.strides)

    @property
    def forward_over_stride(self) -> CycleCurve | None:
        """The usual force along the base's forward axis over a stride; None: not known."""
        return stride_curve(self.forward, self.strides)


def foot_steps(
    settings: StatsSettings,
    row: int,
    record: FootHistory,
    base: BaseHistory,
    fallen: Ints,
    standing: Standing,
    *,
    path: FootPath | None = None,
    ground: MovingGround | None = None,
    is_dead: bool = False,
) -> FootSteps:
    """Find the steps of a foot.

    Args:
        settings: what decides the figures.
        row: of the foot.
        record: its stances and track.
        base: poses.
        fallen: (f, 2) ns, spans in which the robot lies.
        standing: spans without steps.
        path: of the foot in the world, where its messages tell its places in the base's axes.
        ground: how the ground moves; None: it rests.
        is_dead: whether its sensor never reports a contact, and nothing says that it is lifted.
    """
    foot, rolling_m = settings.feet[row], settings.foot_rolling_m
    stances = without_spikes(cut_by_fall(record.stances, fallen))
    stances = cut_by_standing(stances, steps_apart(standing.without_steps, stances))
    strides, discarded = strides_of(stances, record.gaps, fallen)
    heading = stance_headings(record.stances, base, settings.forward_axis)
    at, place = stance_places(record) if path is None else places_on_path(path, stances)
    if ground is not None:
        place = place - ground.way_at(at)
    length, length_from = own_lengths(place, strides), "points"
    if not np.isfinite(length).any():
        length, length_from = straight_lengths(base, strides), "base"
    slip = slip_m(stances.figures.contact_travel_m, rolling_m)
    # A sensor that is taken to read zero without load, on a robot that moves without steps.
    is_refuted = bool(settings.sensor(row).level.reason and len(standing.moving))
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
        length_m=length,
        length_from=length_from,
        base_way_m=stride_lengths(base, strides.touchdown, strides.end),
        slip_m=slip,
        slip_largest_m=slip_m(stances.figures.contact_reach_m, rolling_m),
        slip_from="points" if np.isfinite(slip[stances.whole]).any() else None,
        is_dead=is_dead,
        contact_known=record.start is not None and not (is_dead or is_refuted),
        has_spikes=has_lone_spikes(stances),
        vertical=record.stance_forces[:, 2],
        forward=forward_forces(record, heading),
        fore_aft=fore_aft_impulses(record, heading),
    )


def own_lengths(place: Floats, strides: Strides) -> Floats:
    """(strides,) m, horizontal distances from a foot's places, (stances, 3) m, to its next ones."""
    if not len(strides.stance):
        return np.empty(0)
    way = place[strides.stance + 1] - place[strides.stance]
    return np.asarray(np.hypot(way[:, 0], way[:, 1]))


STRAIGHT_RAD: Final = np.radians(10.0)
"""A stride in which the base turns by less is as long for all of its feet."""


def straight_lengths(base: BaseHistory, strides: Strides) -> Floats:
    """(strides,) m, how far the base goes in each stride; NaN where it turns."""
    turn = base.angles_at(strides.end)[:, 2] - base.angles_at(strides.touchdown)[:, 2]
    length = stride_lengths(base, strides.touchdown, strides.end)
    with np.errstate(invalid="ignore"):
        return np.where(np.abs(turn) < STRAIGHT_RAD, length, np.nan)


def _seen(time: Ints, record: FootHistory, unseen: Cut, stances: Stances) -> Ints:
    """Leave out the events that the log's ends or a gap hide."""
    seen: Ints = time[(stances.cut != unseen) & ~np.isin(time, record.gaps[:, 1])]
    # A stance may last from the log's first sample to its last.
    outside = (record.start, record.end) if len(stances.cut) == 1 else ()
    return seen[~np.isin(seen, [each for each in outside if each is not None])]


def foot_metrics(
    foot: FootSteps, weight_n: float | None, origin: int, within: Ints | None = None
) -> Foot:
    """Return the metrics of a foot but for what its leg tells of its swings.

    Args:
        foot: its steps.
        weight_n: N, what forces in body weights are divided by; None: not known.
        origin: ns, what times are counted from.
        within: (w, 2) ns, a part of the log; its stances and strides are those with their middle in
            it. None: all of it.
    """
    stances, strides, record, lengths = foot.stances, foot.strides, foot.record, foot.length_m
    if within is not None:
        lengths = lengths[strides.rows_within(within)]
        stances, strides = cut_outside(stances, within), strides.within(within)
    whole, figures = stances.whole, stances.figures
    slip = aggregate(foot.slip_m[whole])
    # A spike of a leaning force is as large as all that brakes.
    clean = whole & ~(figures.spikes > 0)
    length = aggregate(lengths)
    per_weight = np.nan if weight_n is None else 1.0 / weight_n
    return replace(
        unknown(Foot),
        contact_fraction=record.contact_fraction(within),
        strides=len(strides.stance),
        stance_s=aggregate(stances.duration_s[whole]),
        swing_s=aggregate(strides.swing_s),
        stride_period_s=aggregate(strides.period_s),
        duty_factor=aggregate(strides.duty_factor),
        stride_frequency_hz=strides.frequency_hz,
        stride_length_m=length,
        stride_length_from=None if length is None else foot.length_from,
        contact_travel_m=aggregate(figures.contact_travel_m[whole]),
        slip_m=slip,
        slip_largest_m=aggregate(foot.slip_largest_m[whole]),
        slip_from=foot.slip_from if slip or foot.slip_from == "foot_frame" else None,
        touchdown_s=_seconds(foot.touchdown, origin, within),
        lift_off_s=_seconds(foot.liftoff, origin, within),
        peak_force_n=aggregate(figures.peak_n[whole]),
        peak_force_bw=aggregate(figures.peak_n[whole] * per_weight),
        mean_force_n=aggregate(figures.mean_n[whole]),
        peak_vertical_force_n=aggregate(figures.peak_vertical_n[whole]),
        peak_vertical_force_bw=aggregate(figures.peak_vertical_n[whole] * per_weight),
        mean_vertical_force_n=aggregate(figures.mean_vertical_n[whole]),
        vertical_impulse_ns=vertical_impulse_ns(record, within),
        braking_impulse_ns=aggregate(foot.fore_aft.braking[clean]),
        propulsive_impulse_ns=aggregate(foot.fore_aft.propulsive[clean]),
        loading_rate_nps=aggregate(figures.loading_rate_nps[whole]),
        impact_ratio=aggregate(figures.impact_ratio[whole]),
        friction_use=aggregate(figures.friction_use[whole]),
        vertical_over_stride_n=curve_of(stride_curve(foot.vertical, strides)),
        forward_over_stride_n=curve_of(stride_curve(foot.forward, strides)),
    )


def _seconds(time: Ints, origin: int, within: Ints | None) -> Numbers:
    """Return times as seconds since the log's start, to the nanosecond."""
    if within is not None:
        time = time[timespans.covers(within, time)]
    return tuple(each / 1e9 for each in (time - origin).tolist())


def net_push(feet: Sequence[FootSteps]) -> float | None:
    """Return how far the feet push the robot on over whole stances, as a share of the weight.

    Braking and propulsion cancel out unless the robot speeds up, or something pulls at it.

    Args:
        feet: steps of all feet.

    Returns:
        None where the direction of forces is not known, or few stances tell.
    """
    parts = [_impulses(foot) for foot in feet]
    pushed, carried = np.concatenate([np.empty((2, 0)), *parts], axis=1)
    if len(carried) < FEWEST_STANCES or carried.sum() <= 0.0:
        return None
    return float(pushed.sum() / carried.sum())


def _impulses(foot: FootSteps) -> Floats:
    """(2, k) N s, along the forward axis and upwards, of the whole stances that tell both."""
    duration = foot.stances.duration_s
    both = np.stack([each.mean(axis=1) * duration for each in (foot.forward, foot.vertical)])
    known: Floats = both[:, foot.stances.whole & np.isfinite(both).all(axis=0)]
    return known
