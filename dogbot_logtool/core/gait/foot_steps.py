"""A foot's steps over a whole log, and what is known of the sensor that tells of them."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.contact.stances import Stances
from dogbot_logtool.core.gait.cycle_curves import (
    ForeAftImpulses,
    fore_aft_impulses,
    forward_forces,
    stance_headings,
)
from dogbot_logtool.core.gait.standing import Standing, steps_apart
from dogbot_logtool.core.gait.strides import Strides, cut_by_fall, cut_by_standing, strides_of
from dogbot_logtool.core.load.spikes import has_lone_spikes, without_spikes
from dogbot_logtool.core.settings import FootSettings
from dogbot_logtool.dataclass import dataclass

FEWEST_STANCES: Final = 8
"""Stances of all feet from which it is told how far they push the robot on."""


@dataclass(frozen=True, slots=True)
class FootSteps:
    """Stances and strides of a foot over the whole log, and the forces in them."""

    settings: FootSettings
    record: FootHistory
    stances: Stances
    """All stances, those in a fall or a stand marked as cut; peaks are without lone spikes."""
    strides: Strides
    discarded: Mapping[str, int]
    """Stances that begin no whole stride, by reason."""
    has_spikes: Flags
    """(stances,) which have lone spikes."""
    vertical: Floats
    """(stances, PARTS) N, mean vertical force in each part of each stance; NaN: not known."""
    forward: Floats
    """(stances, PARTS) N, the same along the base's forward axis."""
    fore_aft: ForeAftImpulses
    """N s, along that axis, in each stance."""


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


def foot_steps(
    settings: FootSettings,
    record: FootHistory,
    base: BaseHistory,
    *,
    forward_axis: str,
    fallen: Ints,
    standing: Standing,
) -> FootSteps:
    """Find the steps of a foot.

    Args:
        settings: of the foot.
        record: its stances and track.
        base: poses.
        forward_axis: the body's axis that points forward.
        fallen: (f, 2) ns, spans in which the robot lies.
        standing: spans without steps.
    """
    stances = without_spikes(cut_by_fall(record.stances, fallen))
    stances = cut_by_standing(stances, steps_apart(standing.without_steps, stances))
    strides, discarded = strides_of(stances, record.gaps, fallen)
    heading = stance_headings(record.stances, base, forward_axis)
    return FootSteps(
        settings=settings,
        record=record,
        stances=stances,
        strides=strides,
        discarded=discarded,
        has_spikes=has_lone_spikes(stances),
        vertical=record.stance_forces[:, 2],
        forward=forward_forces(record, heading),
        fore_aft=fore_aft_impulses(record, heading),
    )
