"""When is a foot on the ground? Contact detection and debouncing of whole columns of samples.

Contact is a Schmitt trigger on |F|: on from one threshold, off below a lower one, or as soon as
the sensor itself says that nothing touches (a message without states). Unless a lower threshold
is set, only the sensor's word ends a contact: a walking foot may carry next to nothing for a
tenth of a second and yet stay where it is, and bumpers are silent in swing. Then swings
shorter than the debounce time are filled (a foot that bounces at touchdown), and after that
stances shorter than it are dropped (a foot that brushes the ground). Two thresholds and minimum
durations are practice in biomechanics (Kinetics Toolkit, `detect_cycles`) and in state estimation
for legged robots (pronto's stance estimator).
"""

from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints
from dogbot_logtool.core.contact.contact_rule import ContactRule
from dogbot_logtool.core.corrections.clock import SILENCE_NS

LONGEST_RISE_S: Final = 0.1
"""s: a touchdown is dated back by no more."""


def schmitt(force: Floats, rule: ContactRule) -> Flags:
    """Trigger with two thresholds: between them, the state stays what it was, at first off.

    Args:
        force: (n,) N.
        rule: thresholds.

    Returns:
        (n,) bool.
    """
    loaded = force >= rule.on_n
    says = loaded | (force < rule.off_n) | (force == 0.0)
    last = np.maximum.accumulate(np.where(says, np.arange(len(force)), -1))
    return (last >= 0) & loaded[last]


def silent_before(time: Ints) -> Flags:
    """(n,) tell whether nothing is known just before: the first sample, or one after a silence.

    Args:
        time: (n,) ns, strictly increasing.
    """
    silent: Flags = np.diff(time, prepend=time[:1]) > SILENCE_NS
    silent[:1] = True
    return silent


def backdated(contact: Flags, time: Ints, force: Floats, off_n: float) -> Flags:
    """Date touchdowns back to where the force rose above the off threshold.

    A rise lasts `LONGEST_RISE_S` at most and does not reach over a silence.

    Args:
        contact: (n,) state of the Schmitt trigger.
        time: (n,) ns, strictly increasing.
        force: (n,) N.
        off_n: N, the off threshold.

    Returns:
        (n,) bool.
    """
    begins = np.flatnonzero(contact[1:] & ~contact[:-1]) + 1
    # The row after the last low one, or the last after a silence, up to each touchdown.
    rises = silent_before(time)
    rises[1:] |= ((force < off_n) | (force == 0.0))[:-1]
    edges = np.flatnonzero(rises)
    since = edges[np.searchsorted(edges, begins, side="right") - 1]
    earliest = np.searchsorted(time, time[begins] - round(LONGEST_RISE_S * 1e9))
    change = np.zeros(len(contact) + 1, np.int32)
    np.add.at(change, np.minimum(np.maximum(since, earliest), begins), 1)
    np.add.at(change, begins, -1)
    return contact | (np.cumsum(change[:-1], dtype=np.int32) > 0)


def find_stances(time: Ints, contact: Flags, rule: ContactRule) -> tuple[Ints, Ints, int, int]:
    """Fill swings that are too short, then drop stances that are.

    Args:
        time: (n,) ns, strictly increasing.
        contact: (n,) state of the Schmitt trigger.
        rule: what is too short.

    Returns:
        (k,) the first row of each stance in contact, (k,) the first row after it that is not, or
        the last row where the log ends in the stance; how many swings were filled, how many
        stances dropped.
    """
    silent, fill_ns = silent_before(time), round(rule.fill_s * 1e9)
    edges = np.flatnonzero(np.diff(contact, prepend=False, append=False))
    runs, begins, breaks = len(edges) // 2, edges[::2], edges[1::2]
    # Of a swing that begins with a silence it is not known that it is short.
    parts = (time[begins[1:]] - time[breaks[:-1]] >= fill_ns) | silent[breaks[:-1]]
    starts = begins[np.append(True, parts)[:runs]]
    ends = breaks[np.append(parts, True)[:runs]]
    # Where the log ends in a stance, its last sample ends it.
    last = np.minimum(ends, len(time) - 1)
    # Swings that were filled do not count. A single sample stands for no more than the interval
    # before it: the next may be lost.
    step = np.diff(time)
    total = np.concatenate([[0], np.cumsum(step * contact[:-1])])
    loaded_ns = total[last] - total[starts]
    single = np.flatnonzero((last - starts == 1) & (starts > 0))
    loaded_ns[single] = np.minimum(loaded_ns[single], step[starts[single] - 1])
    brief = (loaded_ns < round(rule.debounce_s * 1e9)) & ~silent[starts]
    # A short one at the log's end may be part of a longer one.
    brief &= (ends < len(time)) & (silent[last] | (time[-1:] - time[last] >= fill_ns))
    return starts[~brief], last[~brief], runs - len(starts), int(brief.sum())
