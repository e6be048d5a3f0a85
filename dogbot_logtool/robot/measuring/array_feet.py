"""Which leg each element of an array of feet is of, by the motion of the legs."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import permutations
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints, all_finite, norms
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.finding import Finding, found
from dogbot_logtool.io.printable import shell_joined
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.recording import read_recording
from dogbot_logtool.robot.score import word_of
from dogbot_logtool.robot.selection import Selection, select_topics

MOST_FEET: Final = 6
"""Feet whose every order is tried."""
LIKELY: Final = 0.3
"""Mean correlation of load and contact from which an order is one."""
CLEAR: Final = 0.15
"""By which it must lead before any other, a foot."""


def named_by_legs(
    log: Log, options: MeasureOptions, selection: Selection, samples: Sequence[Samples]
) -> Finding | None:
    """Name the fields that may be feet, with the call that measures with them.

    Args:
        log: the log.
        options: of the call.
        selection: with the fields that may be feet, and the feet that legs tell.
        samples: contacts of these feet, estimated from the legs.

    Returns:
        None where no fields may be feet, they have names, or no order of them fits the legs.
    """
    offered = selection.possible_feet[0] if selection.possible_feet else None
    if offered is None or len(offered.feet) != len(samples) or len(samples) > MOST_FEET:
        return None
    if any(foot.leg_position is not None for foot in offered.feet):
        return None
    chosen = select_topics(log, replace(options, foot=None, feet=offered.feet))
    read = read_recording(log, chosen.wanted(), 1).recording.feet
    likeness = _likeness(read, samples)
    orders = sorted(
        ((float(likeness[range(len(order)), order].mean()), order))
        for order in permutations(range(len(samples)))
    )
    best, order = orders[-1]
    if not best >= LIKELY:
        return None
    names = [foot.name for foot in selection.robot.feet]
    named = [f"{names[leg]}={word_of(foot)}" for foot, leg in zip(offered.feet, order, strict=True)]
    words = [word for each in named for word in ("--foot", each)]
    call = shell_joined(["dogbot-logtool", "stats", *log.words, *words])
    near = [other for lead, other in orders[:-1] if best - lead < CLEAR]
    rows = {row for other in near for row in range(len(order)) if other[row] != order[row]}
    alike = ", ".join(sorted(names[order[row]] for row in rows))
    unsure = f"; {alike} move too much alike to be told apart surely" if alike else ""
    told = found(
        "FEET_UNSURE",
        "possible",
        say="by_legs",
        type=offered.type_name,
        named=", ".join(named),
        unsure=unsure,
        call=call,
    )
    return replace(told, command=call)


def _likeness(read: Sequence[Samples], samples: Sequence[Samples]) -> Floats:
    """(fields, legs) correlation of the load that a field tells with the contact of a leg."""
    time = samples[0].log_time
    loads = np.stack([_load_at(each, time) for each in read], axis=1)
    down = np.stack([each.in_contact for each in samples], axis=1)
    # While all stand, or none, nothing is told apart.
    steps = down.any(axis=1) & ~down.all(axis=1) & all_finite(loads)
    products = _standardised(loads[steps]).T @ _standardised(down[steps])
    return np.asarray(products / max(int(steps.sum()), 1))


def _load_at(samples: Samples, time: Ints) -> Floats:
    known = np.flatnonzero(all_finite(samples.force))
    if not len(known):
        return np.full(len(time), np.nan)
    load = norms(samples.force[known]) if samples.force.any() else samples.in_contact[known]
    return np.asarray(np.interp(time - time[0], samples.log_time[known] - time[0], load))


def _standardised(values: Floats | Flags) -> Floats:
    away = values - values.mean(axis=0)
    spread = away.std(axis=0)
    return np.asarray(away / np.where(spread > 0.0, spread, np.inf))
