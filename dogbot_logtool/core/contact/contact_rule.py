"""When is a foot on the ground? The thresholds of contact, and its detection and debouncing.

Contact is a Schmitt trigger on |F|: on from one threshold, off below a lower one, or as soon as
the sensor itself says that nothing touches (a message without states). Unless a lower threshold
is set, only the sensor's word ends a contact: a walking foot may carry next to nothing for a
tenth of a second and yet stay where it is, and bumpers are silent in swing. Then swings
shorter than the debounce time are filled, and after that stances shorter than it are dropped (a
foot that brushes the ground). Stances are joined that a foot bounces between at touchdown, again
and again. Two thresholds and minimum durations are practice in biomechanics (Kinetics Toolkit,
`detect_cycles`) and in state estimation for legged robots (pronto's stance estimator).
"""

from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints, flagged_runs, latched, percentiles_of
from dogbot_logtool.core.corrections.clock import SILENCE_NS
from dogbot_logtool.core.corrections.modes import ALTERNATE, NOISY, WIDE
from dogbot_logtool.core.corrections.sensor import Origin, SensorLevel
from dogbot_logtool.core.timespans import covers

ZERO_ON: Final = 0.05
"""Share of the weight from which a foot is in contact whose sensor reads zero in swing."""
ZERO_OFF: Final = 1e-4
"""Share of the weight below which that contact ends."""
NOISY_ON, NOISY_OFF = 0.08, 0.04
"""The same of any other sensor, where two feet carry the robot."""
FEET_THAT_CARRY: Final = 2.0
"""Feet whose usual load is the weight for those thresholds; of a foot that carries less, as one of
six does, they are shares of so many times its usual load."""
ON_NOISES, OFF_NOISES = 5.0, 3.0
"""Thresholds are at least so many standard deviations of the noise."""
ON_WOBBLES: Final = 1.25
"""Times the furthest that an unloaded sensor strays, by a leg's inertia."""
ON_TO_OFF: Final = 0.8
"""Contact then ends at the furthest itself, or at this share of `on` at most."""
MOST_OF_LOAD: Final = 0.5
"""Largest share of the usual load that may be needed to detect contact."""
STEPS_UNCLEAR: Final = frozenset({ALTERNATE, NOISY, WIDE})
"""Reasons of an unknown level with which a load that comes and goes is no sure contact."""
HEAVILY_FILTERED: Final = "its forces went through a low-pass filter that hides contact"
DEBOUNCE_S: Final = 0.020
DEBOUNCE_INTERVALS: Final = 1.5
"""Shorter swings and stances are no longer than one sample."""
BOUNCE: Final = 0.2
"""Share of a foot's usual swing below which a swing is a bounce, if it is shorter than
`LONGEST_BOUNCE_S`."""
LONGEST_BOUNCE_S: Final = 0.08
FEWEST_BOUNCES: Final = 3
"""Bounces of a foot in a log, at least."""
MOST_DEBOUNCE_S: Final = 10.0
"""No foot steps more slowly: such intervals are those of stamps gone wrong."""
ANY_FORCE_N: Final = 1e-9
"""Threshold where no force was ever seen, so that nothing tells what a load is."""
LONGEST_RISE_S: Final = 0.1
"""s: a touchdown is dated back by no more."""


class ContactRule(NamedTuple):
    """The thresholds of contact."""

    on_n: float
    """N: |F| from which a foot is in contact."""
    off_n: float
    """N: |F| below which contact ends; it always ends at 0. 0: only there."""
    debounce_s: float
    """s: shorter swings are filled, then shorter stances dropped."""
    origin: Origin = "default"
    """The origin of the thresholds."""
    by_flag: bool = False
    """Whether the message's own contact flag decides, whatever the force."""
    unusable: str = ""
    """Why the sensor cannot tell contact; empty: it can."""


class Thresholds(NamedTuple):
    """The settings of contact by a user or the robot's file; None: not given."""

    on_n: float | None = None
    off_n: float | None = None
    debounce_s: float | None = None
    origin: Origin = "option"


def contact_rule(
    level: SensorLevel,
    weight_n: float | None,
    given: Thresholds = Thresholds(),
    interval_s: float | None = None,
) -> ContactRule:
    """Return what counts as contact for a sensor.

    Args:
        level: how it reads with and without load.
        weight_n: N, the robot's; None: not known, then the foot's own usual load stands for it.
        given: thresholds that are not to be chosen here.
        interval_s: s, usual sampling interval; None: not known.
    """
    scale = weight_n or level.loaded_n or 0.0
    noise = level.noise_n or 0.0
    if level.zero_in_swing:
        on, off = ZERO_ON * scale, ZERO_OFF * scale
    else:
        carried = min(scale, FEET_THAT_CARRY * (level.loaded_n or scale))
        on = max(NOISY_ON * carried, ON_NOISES * noise, ON_WOBBLES * level.wobble_n)
        off = max(NOISY_OFF * carried, OFF_NOISES * noise, min(level.wobble_n, ON_TO_OFF * on))
    on = given.on_n or max(on, ANY_FORCE_N)
    off = min(given.off_n or off, on)
    usual_s = max(DEBOUNCE_S, DEBOUNCE_INTERVALS * (interval_s or 0.0))
    estimated = weight_n is None or level.origin == "estimated"
    return ContactRule(
        on_n=on,
        off_n=off,
        debounce_s=min(usual_s, MOST_DEBOUNCE_S) if given.debounce_s is None else given.debounce_s,
        origin=given.origin if given.on_n else "estimated" if estimated else "default",
        unusable="" if given.on_n else _why_unusable(level, on, off),
    )


def _why_unusable(level: SensorLevel, on_n: float, off_n: float) -> str:
    """Say why a sensor cannot tell contact with some thresholds, N; empty where it can."""
    if level.refuted:
        return level.reason
    loaded, lightest = level.loaded_n, level.lightest_n
    if loaded is None:
        return ""
    if on_n > MOST_OF_LOAD * loaded:
        return (
            f"contact would need {on_n:.3g} N, more than half of the {loaded:.3g} N that "
            "the foot usually carries"
        )
    if level.reason in STEPS_UNCLEAR and lightest is not None and lightest < off_n:
        return (
            f"its load comes and goes, but what it reads without load is not known: {level.reason}"
        )
    return ""


def schmitt(force: Floats, rule: ContactRule) -> Flags:
    """Trigger with two thresholds: between them, the state stays what it was, at first off.

    Args:
        force: (n,) N.
        rule: thresholds.

    Returns:
        (n,) bool.
    """
    return latched(force >= rule.on_n, (force < rule.off_n) | (force == 0.0))


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


def joined_bounces(time: Ints, starts: Ints, ends: Ints) -> tuple[Ints, Ints]:
    """Join stances of a foot that bounces between them.

    Usual is what is as long as three quarters of all are, since a foot may bounce each time.

    Args:
        time: (n,) ns, strictly increasing.
        starts: (k,) the first row of each stance in contact.
        ends: (k,) the first row after it.

    Returns:
        the same of the stances that remain.
    """
    swings = (time[starts[1:]] - time[ends[:-1]]) / 1e9
    if not len(swings):
        return starts, ends
    longest_s = min(BOUNCE * float(percentiles_of(swings, 75.0)), LONGEST_BOUNCE_S)
    # Of a swing that begins with a silence it is not known that it is short.
    apart = (swings >= longest_s) | silent_before(time)[ends[:-1]]
    if (~apart).sum() < FEWEST_BOUNCES:
        return starts, ends
    return starts[np.append(True, apart)], ends[np.append(apart, True)]


def find_stances(time: Ints, contact: Flags, debounce_s: float) -> tuple[Ints, Ints, int, int]:
    """Fill swings that are too short, then drop stances that are.

    Args:
        time: (n,) ns, strictly increasing.
        contact: (n,) state of the Schmitt trigger.
        debounce_s: s, below which swings and stances are too short.

    Returns:
        (k,) the first row of each stance in contact, (k,) the first row after it that is not, or
        the last row where the log ends in the stance; how many swings were filled, how many
        stances dropped.
    """
    silent, shortest_ns = silent_before(time), round(debounce_s * 1e9)
    begins, breaks = flagged_runs(contact).T
    runs = len(begins)
    # Of a swing that begins with a silence it is not known that it is short.
    parts = (time[begins[1:]] - time[breaks[:-1]] >= shortest_ns) | silent[breaks[:-1]]
    starts = begins[np.append(True, parts)[:runs]]
    ends = breaks[np.append(parts, True)[:runs]]
    # Where the log ends in a stance, its last sample ends it.
    last = np.minimum(ends, len(time) - 1)
    # Swings that were filled do not count.
    total = np.concatenate([[0], np.cumsum(np.diff(time) * contact[:-1])])
    brief = (total[last] - total[starts] < shortest_ns) & ~silent[starts]
    # A short one at the log's end may be part of a longer one.
    brief &= ends < len(time)
    return starts[~brief], last[~brief], runs - len(starts), int(brief.sum())


def rows_in_stances(starts: Ints, ends: Ints, contact: Flags) -> Flags:
    """(n,) whether rows are in stances; the last one is where the log ends in contact."""
    down = covers(np.stack([starts, ends], axis=1), np.arange(len(contact)))
    down[-1:] |= contact[-1:]
    return down
