"""Checks of feet as they are: flags that are slow or inverted, and loads that change."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Ints, median_of
from dogbot_logtool.core.base.falls import down_spans
from dogbot_logtool.core.gait.feet import FootSteps
from dogbot_logtool.core.gait.strides import any_strides
from dogbot_logtool.core.loads import mean_impulses
from dogbot_logtool.core.settings import GRAVITY_MPS2
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding

FEWEST_DOWN: Final = 1.2
"""Feet of four or more that must be down on average, unless the robot flies."""
MOST_FLIGHT: Final = 0.02
FLIES: Final = 0.05
HALF: Final = 0.5
"""Duty factor of feet above which a stride is a walk's."""
STANDS_FROUDE: Final = 1e-3
WALKS_FROUDE: Final = 0.06
"""Froude numbers between which robots walk and do not run; on the spot they may hop."""
LEG_M, HEAVY_KG = 0.2, 20.0
"""m, the leg of a robot of 1 kg; of others it grows with the cube root of their mass. The mass that
is assumed where none is known."""
DANGLES_S: Final = 1.0
"""s without a foot on the ground; no gait flies for so long."""
STAYS_M: Final = 0.03
"""m that a base moves at most while it stands."""
TRAVELS: Final = 0.5
"""Share of its stride that no foot travels while it stands on the ground."""
UNLIKE: Final = 0.3
"""By which the contact fraction of a foot differs from that of all others, if it is inverted."""
ALIKE: Final = 0.08
"""By which those of the others, and what is left of its own, differ at most."""
UNCERTAIN: Final = 0.1
"""Sampling interval over stride from which duty and phase are not known."""
CHANGES: Final = 0.06
"""Share of the weight by which it changes when a load is put on or taken off."""
OVER_NOISE: Final = 5.0
"""Times the scatter of the weight over strides that it must change by."""
FEWEST_WEIGHTS: Final = 6


def flags_inverted(walk: Walk) -> Iterator[Finding]:
    """Yield that contact flags seem to be true in the air and false on the ground."""
    feet = [foot for foot in walk.feet if not foot.record.has_force and len(foot.touchdown)]
    if not feet or walk.ground is not None or walk.frozen is not None:
        return
    why = _all_inverted(walk, feet)
    names = tuple(foot.name for foot in feet)
    if not why:
        odd = _odd_foot(walk)
        if odd is None:
            return
        names, why = (odd.name,), "its flag is down when those of the other feet are up"
    text = (
        f"contact flags of {', '.join(names)} seem to be inverted, true in the air: {why}; in a "
        'robot\'s file, sign = "-" beside field turns a flag round'
    )
    yield Finding("FLAGS_INVERTED", text, feet=names)


def _all_inverted(walk: Walk, feet: list[FootSteps]) -> str:
    """Return why all flags seem to be inverted; empty if they do not."""
    supported = walk.support
    if len(feet) == len(walk.feet) >= 4 and supported is not None:
        down = sum(number * share for number, share in enumerate(supported.feet_down))
        if down < FEWEST_DOWN and supported.flight_fraction < MOST_FLIGHT:
            return f"{down:.1f} of {len(feet)} feet would be down on average, without any flight"
    travels = [_travel_share(foot) for foot in feet]
    known = [each for each in travels if np.isfinite(each)]
    if known and float(median_of(known)) > TRAVELS:
        return "the feet would travel on the ground, and rest in the air"
    if supported is not None and _flies_slowly(walk, supported.flight_fraction):
        share, speed = (
            100.0 * supported.flight_fraction,
            walk.base and walk.base.forward_speed_mps,
        )
        return f"the robot would fly for {share:.0f} % of the time at {speed or 0.0:.2f} m/s"
    if supported is not None and (at := _dangles(walk, supported.in_flight)) is not None:
        return f"no foot would be down from {walk.seconds(at)[0]:.1f} s on, while the base stands"
    return ""


def _flies_slowly(walk: Walk, flight: float) -> bool:
    """Tell whether a robot would fly at a speed at which none does, by its size.

    Flags that are true for most of a stride would be less likely the other way round.
    """
    speed = None if walk.base is None else walk.base.forward_speed_mps
    fractions = [foot.record.contact_fraction() or 0.0 for foot in walk.feet]
    if speed is None or flight < FLIES or float(median_of(np.array(fractions))) >= HALF:
        return False
    leg_m = LEG_M * (walk.settings.mass_kg or HEAVY_KG) ** (1.0 / 3.0)
    froude = speed**2 / (GRAVITY_MPS2 * leg_m)
    return bool(STANDS_FROUDE < froude < WALKS_FROUDE)


def _travel_share(foot: FootSteps) -> float:
    """Return how far a foot travels in its stances, as a share of its stride; NaN: not known."""
    travel = foot.stances.figures.contact_travel_m[foot.stances.whole]
    both = travel[np.isfinite(travel)], foot.length_m[np.isfinite(foot.length_m)]
    if not all(map(len, both)) or not (length := float(median_of(both[1]))) > STAYS_M:
        return np.nan
    return float(median_of(both[0])) / length


def _dangles(walk: Walk, in_flight: Ints) -> Ints | None:
    """Return a long time without contact in which the base stands as high as in its steps."""
    poses = walk.poses
    steps = timespans.merge(any_strides(walk.records, walk.fallen, timespans.no_spans()))
    walking = poses.position[timespans.covers(steps, poses.time), 2]
    if not len(walking):
        return None
    long = in_flight[in_flight[:, 1] - in_flight[:, 0] > DANGLES_S * 1e9]
    for start in range(len(long)):
        span: Ints = long[start]
        inside = poses.position[timespans.covers(span[None, :], poses.time)]
        if len(inside) < 2 or float(np.ptp(inside[:, :2], axis=0).max()) > STAYS_M:
            continue
        if abs(float(median_of(inside[:, 2])) - float(median_of(walking))) < STAYS_M:
            return span
    return None


def _odd_foot(walk: Walk) -> FootSteps | None:
    """Return the one foot whose flag is up as long as those of all others are down."""
    fractions = [foot.record.contact_fraction() for foot in walk.feet]
    known = np.array([np.nan if each is None else each for each in fractions])
    if len(known) < 3 or not np.isfinite(known).all():
        return None
    for row, own in enumerate(known.tolist()):
        others = np.delete(known, row)
        usual = float(median_of(others))
        agree = float(np.ptp(others)) < ALIKE and abs(1.0 - own - usual) < ALIKE
        if agree and abs(own - usual) > UNLIKE and not walk.feet[row].record.has_force:
            return walk.feet[row]
    return None


def sampled_slowly(walk: Walk) -> Iterator[Finding]:
    """Yield feet of which contact is known too rarely in a stride."""
    period_s = walk.period_s
    slow = {}
    for foot in walk.feet:
        interval_s = foot.record.median_interval_s
        if period_s and interval_s and len(foot.strides.stance):
            slow[foot.name] = period_s / interval_s
    slow = {name: number for name, number in slow.items() if number < 1.0 / UNCERTAIN}
    if not slow:
        return
    least = min(slow.values())
    text = (
        f"contact of {', '.join(slow)} is told {least:.1f} times a stride: duty and phase are "
        f"uncertain by {100.0 / least:.0f} % of a stride"
    )
    yield Finding("SAMPLED_SLOWLY", text, cases=("contact",), feet=tuple(slow))


def payload(walk: Walk) -> Iterator[Finding]:
    """Yield that the feet's sum changes lastingly: a load is put on, or taken off."""
    found = _weights(walk)
    if found is None:
        return
    time, weight = found
    best: tuple[float, int] | None = None
    for row in range(FEWEST_WEIGHTS // 2 - 1, len(weight) - FEWEST_WEIGHTS // 2 + 1):
        # The stride in which it changes belongs to neither.
        first, second = weight[:row], weight[row + 1 :]
        rest = float(((first - first.mean()) ** 2).sum() + ((second - second.mean()) ** 2).sum())
        if best is None or rest < best[0]:
            best = rest, row
    if best is None:
        return
    before, after = float(weight[: best[1]].mean()), float(weight[best[1] + 1 :].mean())
    scatter = float(np.sqrt(best[0] / max(len(weight) - 2, 1)))
    if abs(after - before) < max(CHANGES * max(before, after), OVER_NOISE * scatter):
        return
    verb = "taken off" if after < before else "put on"
    since = walk.seconds(time[best[1] : best[1] + 1])[0]
    text = (
        f"the feet carry {before:.0f} N and, from {since:.1f} s on, {after:.0f} N: a load of "
        f"{abs(after - before):.0f} N is {verb}, or sensors change"
    )
    yield Finding("PAYLOAD", text, "forces")


def _weights(walk: Walk) -> tuple[Ints, Floats] | None:
    """Return the feet's mean load over each stride, (k,) N, and when; None: not known."""
    period_s = walk.period_s
    if (
        not period_s
        or walk.settings.lacks_feet
        or not all(each.has_force for each in walk.records)
        or walk.feet_clocks_are_apart
    ):
        return None
    known = timespans.intersect([each.known for each in walk.records])
    # The belly of a robot that lies carries it.
    track = walk.track
    down = down_spans(track.history, walk.records, track.height_m)
    known = timespans.subtract(known, timespans.merge(np.concatenate([walk.fallen, down])))
    half = round(period_s * 5e8)
    time = timespans.ticks(known, 2 * half)
    time = time[timespans.hold_window(known, time, half, half)]
    if len(time) < FEWEST_WEIGHTS:
        return None
    kind = "vertical_impulse" if walk.vertical_known else "force_impulse"
    weight = mean_impulses(walk.records, kind, time, half).sum(axis=1)
    return time, np.asarray(weight)
