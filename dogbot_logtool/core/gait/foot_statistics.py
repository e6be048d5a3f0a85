"""The figures of one foot, as they are reported."""

from collections.abc import Mapping, Sequence

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Aggregate, Floats, Ints, aggregate
from dogbot_logtool.core.base.motion import stride_lengths
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.contact.stances import Cut, Stances
from dogbot_logtool.core.gait.cycle_curves import ForceCurves, force_curves
from dogbot_logtool.core.gait.foot_steps import FootSteps
from dogbot_logtool.core.gait.segments import FootEvents
from dogbot_logtool.core.gait.strides import (
    Strides,
    cut_outside,
)
from dogbot_logtool.core.leg_position import LegPosition
from dogbot_logtool.core.load.load_figures import vertical_impulse_ns
from dogbot_logtool.core.load.slip import slip_m
from dogbot_logtool.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class FootStatistics:
    """Figures of one foot.

    Aggregates are over whole stances or strides; None where there are none, or what they need is
    not known.
    """

    name: str
    topic: str
    leg_position: LegPosition | None
    record: FootHistory
    stances: Stances
    """All stances, those in a fall or a stand marked as cut."""
    strides: Strides
    length_m: Floats
    """(strides) m, horizontal distance of the base over the stride; NaN where not known."""
    slip_m: Floats
    """(stances) m, what `contact_travel_m` exceeds the travel of a rolling foot by."""
    discarded: Mapping[str, int]
    """Stances that begin no whole stride, by reason."""
    touchdown: Ints
    """(t,) ns, touchdowns that were seen."""
    liftoff: Ints
    """(l,) ns, lift-offs that were seen."""
    is_dead: bool
    """Whether its sensor never reports a contact, and nothing says that it is lifted."""
    contact_known: bool
    """Whether its sensor tells contact, and nothing refutes it."""
    spikes: int
    """Lone spikes of its force in whole stances; kept out of the peaks."""
    contact_fraction: float | None
    """Time in contact over time known; None where contact is not known."""
    stance_s: Aggregate | None
    swing_s: Aggregate | None
    stride_period_s: Aggregate | None
    stride_frequency_hz: float | None
    duty_factor: Aggregate | None
    stride_length_m: Aggregate | None
    peak_force_n: Aggregate | None
    """N, highest |F| of each stance."""
    mean_force_n: Aggregate | None
    peak_vertical_force_n: Aggregate | None
    mean_vertical_force_n: Aggregate | None
    vertical_impulse_ns: float | None
    """N s, over all time known."""
    braking_impulse_ns: Aggregate | None
    """N s, size of the impulse against the base's forward axis in a stance."""
    propulsive_impulse_ns: Aggregate | None
    """N s, impulse along the base's forward axis in a stance."""
    force_curves: ForceCurves
    loading_rate_nps: Aggregate | None
    impact_ratio: Aggregate | None
    contact_travel_m: Aggregate | None
    slip_distance_m: Aggregate | None
    """m, net; None also where the rolling of the foot is not known."""
    largest_slip_m: Aggregate | None
    """m, the furthest that the foot is from where it stood at 10 % of the stance."""
    friction_use: Aggregate | None
    slip_source: str | None = None
    """The source of slips: ``contact_points`` or ``foot_frame``; None: not known."""

    @property
    def events(self) -> FootEvents:
        """Strides and touchdowns, for the gait."""
        return FootEvents(self.strides, self.touchdown)


def foot_statistics(
    steps: FootSteps,
    base: BaseHistory,
    foot_rolling_m: float | None,
    within: Ints | None = None,
    *,
    is_dead: bool = False,
    is_refuted: bool = False,
) -> FootStatistics:
    """Aggregate what was recorded of one foot.

    Args:
        steps: of the foot.
        base: poses.
        foot_rolling_m: m, travel of the contact point of a foot that rolls without slipping; None:
            not known.
        within: (w, 2) ns, a part of the log; its stances and strides are those with their middle in
            it. None: all of it.
        is_dead: whether its sensor never reports a contact, and nothing says that it is lifted.
        is_refuted: whether its contacts are no steps of a robot that moves.
    """
    record, stances, strides = steps.record, steps.stances, steps.strides
    if within is not None:
        stances, strides = cut_outside(stances, within), strides.within(within)
    length = stride_lengths(base, strides.touchdown, strides.end)
    slip = slip_m(stances.figures.contact_travel_m, foot_rolling_m)
    largest_slip = slip_m(stances.figures.contact_reach_m, foot_rolling_m)
    whole = stances.whole
    figures = stances.figures
    # A spike of a leaning force is as large as all that brakes.
    clean = whole & ~(stances.figures.spikes > 0)
    return FootStatistics(
        name=steps.settings.name,
        topic=steps.settings.topic,
        leg_position=steps.settings.leg_position,
        record=record,
        stances=stances,
        strides=strides,
        length_m=length,
        slip_m=slip,
        discarded=steps.discarded,
        touchdown=_seen(stances.touchdown, record, Cut.LOG_START, stances),
        liftoff=_seen(stances.liftoff, record, Cut.LOG_END, stances),
        is_dead=is_dead,
        contact_known=record.start is not None and not (is_dead or is_refuted),
        spikes=int(stances.figures.spikes[steps.has_spikes & whole].sum()),
        contact_fraction=record.contact_fraction(within),
        stance_s=aggregate(stances.duration_s[whole]),
        swing_s=aggregate(strides.swing_s),
        stride_period_s=aggregate(strides.period_s),
        stride_frequency_hz=strides.frequency_hz,
        duty_factor=aggregate(strides.duty_factor),
        stride_length_m=aggregate(length),
        peak_force_n=aggregate(figures.peak_n[whole]),
        mean_force_n=aggregate(figures.mean_n[whole]),
        peak_vertical_force_n=aggregate(figures.peak_vertical_n[whole]),
        mean_vertical_force_n=aggregate(figures.mean_vertical_n[whole]),
        vertical_impulse_ns=vertical_impulse_ns(record, within),
        braking_impulse_ns=aggregate(steps.fore_aft.braking[clean]),
        propulsive_impulse_ns=aggregate(steps.fore_aft.propulsive[clean]),
        force_curves=force_curves(steps.vertical, steps.forward, strides),
        loading_rate_nps=aggregate(figures.loading_rate_nps[whole]),
        impact_ratio=aggregate(figures.impact_ratio[whole]),
        contact_travel_m=aggregate(figures.contact_travel_m[whole]),
        slip_distance_m=aggregate(slip[whole]),
        largest_slip_m=aggregate(largest_slip[whole]),
        friction_use=aggregate(figures.friction_use[whole]),
        slip_source="contact_points" if np.isfinite(slip[whole]).any() else None,
    )


def _seen(time: Ints, record: FootHistory, unseen: Cut, stances: Stances) -> Ints:
    """Leave out the events that the log's ends or a gap hide."""
    seen: Ints = time[(stances.cut != unseen) & ~np.isin(time, record.gaps[:, 1])]
    # A stance may last from the log's first sample to its last.
    outside = (record.start, record.end) if len(stances.cut) == 1 else ()
    return seen[~np.isin(seen, [each for each in outside if each is not None])]


def contact_time_without_pose_s(record: FootHistory, base: BaseHistory) -> float:
    """Return the time in contact, s, that lies further than 0.1 s from every pose of the base."""
    return base.unplaced(record.in_contact) / 1e9


def overlap(feet: Sequence[FootHistory], base: BaseHistory) -> Ints:
    """Return the time known to all feet that have samples, and to the base if it has poses."""
    known = [foot.known for foot in feet if foot.start is not None]
    if len(base.time):
        known.append(base.known)
    return timespans.intersect(known)
