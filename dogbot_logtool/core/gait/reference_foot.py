"""Which foot's strides the figures of all feet rest on."""

from collections.abc import Sequence

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.gait.foot_steps import FootSteps
from dogbot_logtool.core.gait.segments import FootEvents, GaitInput
from dogbot_logtool.core.gait.standing import Standing, steps_apart
from dogbot_logtool.core.gait.strides import (
    Strides,
    cut_by_fall,
    cut_by_standing,
    no_strides,
    strides_of,
)
from dogbot_logtool.core.gait.support_pattern import Support
from dogbot_logtool.core.leg_position import legs_in_order


def any_strides(records: Sequence[FootHistory], fallen: Ints, standing: Ints) -> Ints:
    """(s, 2) ns, the strides of the first foot that has any.

    Args:
        records: of all feet.
        fallen: (f, 2) ns, spans in which the robot lies.
        standing: (s, 2) ns, spans without steps, as far as they are known.
    """
    for record in records:
        stances = cut_by_fall(record.stances, fallen)
        stances = cut_by_standing(stances, steps_apart(standing, stances))
        strides, _ = strides_of(stances, record.gaps, fallen)
        if len(strides.stance):
            return strides.spans
    return timespans.no_spans()


def reference_strides(feet: Sequence[FootSteps]) -> Strides:
    """Return the whole strides of the first foot that has any."""
    return next((foot.strides for foot in feet if len(foot.strides.stance)), no_strides())


def gait_input(
    feet: Sequence[FootSteps], standing: Standing, supported: Support | None
) -> GaitInput:
    """Choose the feet that phases are measured against."""
    leg_positions = [foot.leg_position for foot in feet]
    order = legs_in_order(leg_positions)
    walking = [row for row in order or range(len(feet)) if len(feet[row].strides.stance)]
    hind = leg_positions.index(("back", "left")) if ("back", "left") in leg_positions else None
    return GaitInput(
        feet=tuple(FootEvents(foot.strides, foot.touchdown) for foot in feet),
        reference=walking[0] if walking else 0,
        hind_reference=hind if hind in walking else None,
        order=order,
        standing=standing,
        support=supported,
    )
