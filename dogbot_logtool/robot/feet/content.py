"""Whether values look like those of feet: on and off, in turns, together the weight."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, median_of, norms, percentiles_of
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.dataclass import dataclass

FEWEST: Final = 20
"""Samples of a foot from which its values mean something."""
FEWEST_CHANGES: Final = 8
"""The same where each tells that a contact begins or ends."""
_MOSTLY: Final = 0.9
"""Share of a foot's messages that tell another state than the one before, if all shall."""
_FEWEST_CHANGES: Final = 2
_LARGEST_STATE: Final = 3.0
"""Whole numbers up to this are states of a contact: open, closed, slipping."""
_FEWEST_DOWN: Final = 0.8
"""Share of the time in which at least one foot of a walking robot is down."""
_SAME: Final = 0.98
"""Share of the time from which two feet that agree are one signal."""
_STEADY: Final = 0.25
"""Largest spread of the sum of all loads, as a share of its mean."""
_UNSTEADY: Final = 1.5
"""Each foot's spread is at least so many times that of the sum."""
_BOTH_WAYS: Final = 0.5
"""Share of the larger that the smaller of push and pull is, from which a number is no load."""
_NO_FOOT: Final = -10
"""Points of what cannot be feet, whatever else is true of it."""
_NOT_UNLOADED: Final = 0.5
"""Share of what each foot reads with load that it reads without, from which numbers are no forces:
those of air pressure, or of a sensor that was never set to zero."""
_TENTH: Final = (10.0, 90.0)
"""Percentiles of what a foot reads without and with load."""
_ENDS: Final = (2.0, 98.0)
"""The same of feet that are hardly ever in the air."""
_ON: Final = 0.2
"""Share of the way between them from which it is on; with all feet down each bears little."""


@dataclass(frozen=True, slots=True)
class Content:
    """Content of the values of feet: flags, forces, counts."""

    points: int
    reasons: tuple[str, ...]
    is_contact: bool
    """Whether the values only tell contact, and no force."""
    thresholds: tuple[float, ...] = ()
    """Threshold of each foot; empty: values are near zero without load."""


def judge_content(own: Sequence[Samples]) -> Content | None:
    """Judge values that were read as forces; None: too few were seen.

    Args:
        own: samples of each foot, by log time.
    """
    on_change = bool(own) and all(map(_always_changes, own))
    signed = _side_by_side(own, on_change=on_change)
    if signed is None:
        return None
    values = np.abs(signed)
    is_contact = bool((values <= _LARGEST_STATE).all() and (values == np.round(values)).all())
    low, high = percentiles_of(values, _TENTH, axis=0)
    down = values > 0.0 if is_contact else values > low + _ON * (high - low)
    changes = np.count_nonzero(np.diff(down, axis=0), axis=0)
    found = [_on_and_off(changes), _in_turns(down)]
    if on_change:
        found.append((2, "each message tells another state: they are published on change"))
    if not is_contact:
        found += [_together(values), _one_way(signed)]
    thresholds: tuple[float, ...] = ()
    is_number = not is_contact and not any(each.force[:, :2].any() for each in own)
    low, high = percentiles_of(values, _ENDS, axis=0)
    if is_number and bool((signed > 0.0).all()) and bool((low > _NOT_UNLOADED * high).all()):
        thresholds = tuple((low + _ON * (high - low)).tolist())
        found.append((0, "none reads near zero without load: they tell contact, not newtons"))
    return Content(
        sum(points for points, _ in found),
        tuple(reason for _, reason in found if reason),
        is_contact,
        thresholds,
    )


def _always_changes(foot: Samples) -> bool:
    """Tell whether a foot's messages come when its contact changes, and only then."""
    states = norms(foot.force)
    if len(states) < FEWEST_CHANGES or not np.isin(states, (0.0, 1.0)).all():
        return False
    return float((np.diff(states) != 0.0).mean()) >= _MOSTLY


def _side_by_side(own: Sequence[Samples], *, on_change: bool) -> Floats | None:
    """Return (n, feet) at the samples of the first foot, or of all; None: too few.

    A number keeps its sign; of vectors, their magnitudes.

    Args:
        own: samples of each foot.
        on_change: whether a foot's samples only tell when its contact changes.
    """
    fewest = FEWEST_CHANGES if on_change else FEWEST
    if min((len(each.log_time) for each in own), default=0) < fewest:
        return None
    told = own if on_change else own[:1]
    time = np.sort(np.concatenate([each.log_time for each in told]))
    columns = []
    for each in own:
        before = np.searchsorted(each.log_time, time, side="right") - 1
        column = norms(each.force) if each.force[:, :2].any() else each.force[:, 2]
        columns.append(column[np.maximum(before, 0)])
    return np.stack(columns, axis=1)


def _on_and_off(changes: Sequence[int] | Floats) -> tuple[int, str]:
    stepping = int(np.count_nonzero(np.asarray(changes) >= _FEWEST_CHANGES))
    total = len(changes)
    if stepping == total:
        return 2, f"all {total} go on and off, {int(np.min(changes))} times and more"
    if not stepping:
        return -3, "none goes on and off"
    return -1, f"only {stepping} of {total} go on and off"


def _in_turns(down: Flags) -> tuple[int, str]:
    feet = down.shape[1]
    alike = [
        float((down[:, one] == down[:, other]).mean())
        for one in range(feet)
        for other in range(one)
    ]
    some = float(down.any(axis=1).mean())
    every = float(down.all(axis=1).mean())
    if not alike or min(alike) > _SAME:
        return -2, "all are the same signal"
    if some >= _FEWEST_DOWN and every < some:
        return 2, f"in turns: at least one is on {some:.0%} of the time, all at once {every:.0%}"
    return 0, f"at least one is on {some:.0%} of the time"


def _together(values: Floats) -> tuple[int, str]:
    total = values.sum(axis=1)
    mean = float(total.mean())
    if mean <= 0.0:
        return 0, ""
    spread = float(total.std()) / mean
    own = float(median_of(values.std(axis=0) / np.maximum(values.mean(axis=0), 1e-12)))
    if spread <= _STEADY and own >= _UNSTEADY * spread:
        return 3, f"together they stay within {spread:.0%} of {mean:.4g}, as a weight does"
    return 0, f"their sum varies by {spread:.0%}"


def _one_way(signed: Floats) -> tuple[int, str]:
    """The ground pushes and does not pull."""
    low, high = percentiles_of(signed, _TENTH, axis=0)
    opposite = (low < 0.0) & (high > 0.0)
    smaller, larger = np.minimum(-low, high), np.maximum(-low, high)
    both = int(np.count_nonzero(opposite & (smaller > _BOTH_WAYS * larger)))
    if both:
        return (
            _NO_FOOT,
            f"{both} of {signed.shape[1]} read as much below zero as above, as no foot does",
        )
    return 0, ""
