"""Rows for feet that fall silent, since viewers keep a value until the next one.

This looks back only: what is written does not depend on where batches end.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.geometry.arrays import Ints
from dogbot_logtool.core.geometry.clock import FEWEST_INTERVALS, GAP_INTERVALS, SILENCE_NS
from dogbot_logtool.core.geometry.order_statistics import median_of, percentiles_of
from dogbot_logtool.core.load.loads import Loads, LoadState
from dogbot_logtool.dataclass import dataclass

_USUAL_PERCENT: Final = 95.0
"""Quantile of the intervals between messages that counts as usual."""


@dataclass(frozen=True, slots=True)
class MessageRate:
    """How a foot's messages follow one another."""

    due_ns: int
    """ns after a message at which the next one is due."""
    gap_ns: int
    """ns: a longer interval is a silence."""


@dataclass(frozen=True, slots=True)
class LastContact:
    """The last contact message of a foot."""

    log_time: int
    """ns."""
    stamp: int
    """ns."""
    silent: bool
    """Whether the silence after it is written already."""
    is_message: bool = True
    """Whether there was one; else the log's first time stands for it."""


def message_rate(log_time: Ints, longest_swing_ns: int | None = None) -> MessageRate:
    """Return how a foot's messages follow one another.

    Args:
        log_time: (n,) ns, of its messages in parts of a log.
        longest_swing_ns: ns, a shorter silence may be a swing; None: silence is never one.
    """
    step = np.diff(log_time)
    step = step[step > 0]
    if len(step) < FEWEST_INTERVALS:
        return MessageRate(SILENCE_NS, longest_swing_ns or 20 * SILENCE_NS)
    usual = _two_digits(percentiles_of(step, _USUAL_PERCENT))
    gap = longest_swing_ns or max(SILENCE_NS, round(GAP_INTERVALS * usual))
    return MessageRate(_two_digits(median_of(step)), gap)


def _two_digits(interval: float) -> int:
    """Round to two significant digits: other parts of the log tell the same, but for jitter."""
    return round(float(f"{interval:.1e}"))


def follow_silences(
    samples: Sequence[Samples],
    before: Sequence[LastContact] | None,
    rates: Sequence[MessageRate],
    opening: int,
    end: int | None,
) -> tuple[Loads, tuple[LastContact, ...]]:
    """Return the rows that say where feet fall silent, and each foot's last message.

    Args:
        samples: of one batch.
        before: the last message of each foot before it; None: it is the log's first.
        rates: of each foot.
        opening: ns, the log's first time; a foot that is silent then is unknown from there on.
        end: ns, the latest log time in the batch; None: it is empty.
    """
    rows: list[tuple[int, int, int]] = []
    after: list[LastContact] = []
    for foot, rate in enumerate(rates):
        log_time, stamp = _times(samples, foot)
        nothing = LastContact(opening, opening, silent=False, is_message=False)
        last = nothing if before is None else before[foot]
        log_time = np.concatenate([[last.log_time], log_time])
        stamp = np.concatenate([[last.stamp], stamp])
        gaps = np.flatnonzero(np.diff(log_time) > rate.gap_ns)
        if last.silent:
            gaps = gaps[gaps > 0]
        ends_silent = end is not None and end - int(log_time[-1]) > rate.gap_ns
        if ends_silent and not (last.silent and len(log_time) == 1):
            gaps = np.append(gaps, len(log_time) - 1)
        for row in gaps.tolist():
            # A foot that is silent at the log's first time is unknown from then on.
            due = rate.due_ns if row or last.is_message else 0
            rows.append((foot, int(log_time[row]) + due, int(stamp[row]) + due))
        still = last.silent and len(log_time) == 1
        is_message = last.is_message or len(log_time) > 1
        after.append(
            LastContact(int(log_time[-1]), int(stamp[-1]), ends_silent or still, is_message)
        )
    return _unknown(rows), tuple(after)


def _times(samples: Sequence[Samples], foot: int) -> tuple[Ints, Ints]:
    """Return log times and times of a foot's messages, ns, in the order of the log."""
    picked = [np.flatnonzero(each.foot == foot) for each in samples]
    empty = [np.empty(0, np.int64)]
    pairs = list(zip(samples, picked, strict=True))
    log_time = np.concatenate(empty + [each.log_time[rows] for each, rows in pairs])
    stamp = np.concatenate(empty + [each.time[rows] for each, rows in pairs])
    order = np.argsort(log_time, kind="stable")
    return log_time[order], stamp[order]


def _unknown(rows: Sequence[tuple[int, int, int]]) -> Loads:
    """Return loads of which nothing is known.

    Args:
        rows: foot, log time and stamp, ns.
    """
    foot, log_time, stamp = np.array(rows, np.int64).reshape(-1, 3).T
    nothing = np.full(len(foot), np.nan)
    return Loads(
        foot=foot,
        log_time=log_time,
        stamp=stamp,
        in_contact=np.zeros(len(foot), np.bool_),
        state=np.full(len(foot), LoadState.UNKNOWN, np.int64),
        force=nothing,
        body_weights=nothing,
    )
