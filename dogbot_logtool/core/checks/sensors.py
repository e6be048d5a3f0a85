"""Checks of the feet's sensors: what they read without load, and whether they work."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Ints, interpolated, median_of
from dogbot_logtool.core.base.motion import down_spans
from dogbot_logtool.core.checks.base import HALF, STAYS_M, feet_agree, rest_in_the_air
from dogbot_logtool.core.clock import SLOWEST_S
from dogbot_logtool.core.loads import is_stuck, mean_impulses
from dogbot_logtool.core.sensors import HEAVILY_FILTERED
from dogbot_logtool.core.settings import GRAVITY_MPS2
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding, Words, found

PLAIN: Final = 0.02
"""Share of the weight from which an offset is worth a finding."""
MOVES: Final = 0.2
"""Share of the usual load by which a level that drifts is told."""
WHOLE_WEIGHT: Final = 0.005
"""Share of the weight by which forces that nothing cuts off may miss it."""
FLAT: Final = 0.8
"""Mean over highest force of a nearly rectangular stance; that of half a sine is 0.64."""
ONCE_A_STANCE: Final = 1.25
"""Swings filled and stances dropped for each stance, up to which a foot may just bounce."""
SOME_S: Final = 0.1
"""s, time in contact without poses from which that is worth a warning."""


def unloaded_levels(walk: Walk) -> Iterator[Finding]:
    """Yield feet whose contact cannot be told, and offsets of sensors."""
    weight_n = walk.settings.body_weight_n or walk.settings.estimated_weight_n
    for foot in walk.settings.feet:
        level, why, name = foot.level, foot.rule.unusable, foot.name
        where = f"feet.{name}.force_offset_n"
        if why and why != HEAVILY_FILTERED:
            unknown = f"feet.{name}.contact_fraction"
            yield found("CONTACT_UNKNOWN", where=unknown, feet=(name,), why=why)
        if level.reason:
            if not level.hides_contact:
                say = "unknown"
                yield found("SENSOR_OFFSET", say=say, where=where, foot=name, why=level.reason)
            continue
        moved_n = float(np.linalg.norm(np.ptp(level.offset, axis=0)))
        if moved_n > MOVES * (level.loaded_n or np.inf):
            yield found("SENSOR_OFFSET", where=where, say="moves", foot=name, newtons=moved_n)
        newtons = float(np.linalg.norm(level.offset_n))
        scale_n = weight_n or level.loaded_n
        if scale_n and newtons > PLAIN * scale_n:
            share, of = newtons / scale_n, "weight" if weight_n else "usual load"
            words: Words = {"newtons": newtons, "share": share, "scale": of, "origin": level.origin}
            yield found("SENSOR_OFFSET", where=where, foot=name, **words)


def filtered(walk: Walk) -> Iterator[Finding]:
    """Yield which forces went through a low-pass filter."""
    filters = [(foot.name, foot.low_pass) for foot in walk.settings.feet if foot.low_pass]
    for say, resolved in (("plain", True), ("heavy", False)):
        some = {name: each.tau_s for name, each in filters if each.resolved is resolved}
        if some:
            tau_s, cases = max(some.values()), () if resolved else ("heavy",)
            hertz, names = 1.0 / (2.0 * np.pi * tau_s), ", ".join(some)
            words: Words = {"names": names, "milliseconds": 1e3 * tau_s, "hertz": hertz}
            yield found("FORCE_FILTERED", *cases, where="feet", say=say, feet=[*some], **words)


def silent_feet(walk: Walk) -> Iterator[Finding]:
    """Yield feet with a topic of which no message tells, or none that can be used."""
    for row, foot in enumerate(walk.feet):
        record = foot.record
        unusable = record.start is None and not walk.settings.feet[row].rule.unusable
        if foot.topic and (not record.messages or unusable):
            say = "unusable" if record.messages else "plain"
            yield found("NO_MESSAGES", "foot", say=say, feet=(foot.name,), topic=foot.topic)


def some_feet(walk: Walk) -> Iterator[Finding]:
    """Yield that the robot has other feet, of which the log does not tell."""
    if walk.settings.lacks_feet and any(foot.record.messages for foot in walk.feet):
        names = ", ".join(foot.name for foot in walk.feet)
        yield found("NO_MESSAGES", "others", where="gait", say="others", names=names)


def broken(walk: Walk) -> Iterator[Finding]:
    """Yield sensors that show one constant force under load, have stopped, or never feel ground."""
    for foot in walk.feet:
        if foot.record.start is None:
            continue
        feet, spans = (foot.name,), foot.record.stopped
        if is_stuck(foot.record, walk.records):
            cases = () if len(foot.stances.touchdown) > 1 else ("never_lifts",)
            yield found("STUCK", *cases, feet=feet)
        elif len(spans):
            # Less than a stride tells nothing of a foot.
            throughout = foot.is_dead or not len(foot.strides.stance)
            cases = ("throughout",) if throughout else ()
            start, end = walk.seconds(spans.ravel()[[0, -1]])
            seconds = timespans.total(spans) / 1e9
            yield found("STOPPED", *cases, feet=feet, start=start, end=end, seconds=seconds)
        elif foot.is_dead:
            yield found("DEAD", feet=feet)


def odd_forces(walk: Walk) -> Iterator[Finding]:
    """Yield sensors that are cut off at a limit, have lone spikes, flicker, or are too slow."""
    for row, foot in enumerate(walk.feet):
        if not len(foot.stances.touchdown):
            continue
        name, record, whole = foot.name, foot.record, foot.stances.whole
        if foot_is_saturated(walk, row):
            limit_n = walk.settings.feet[row].level.limit_n
            yield found("SATURATED", feet=(name,), limit_n=limit_n)
        if spikes := len(foot.spikes):
            where = f"feet.{name}.peak_force_n"
            yield found("SPIKES", where=where, foot=name, spikes=spikes)
        flickers = record.filled_swings + record.dropped_stances
        if flickers > max(2.0, 0.2 * len(whole)):
            # A stiff foot bounces at each touchdown.
            cases = ("once",) if flickers <= ONCE_A_STANCE * len(whole) else ()
            yield found("CHATTER", *cases, where=f"feet.{name}.chatter", foot=name, record=record)
        rates = foot.stances.figures.loading_rate_nps[whole]
        if whole.any() and record.has_force and not np.isfinite(rates).any():
            where = f"feet.{name}.loading_rate_nps"
            yield found("SAMPLED_SLOWLY", "loading", where=where, feet=(name,))


def foot_is_saturated(walk: Walk, row: int) -> bool:
    """Tell whether an axis of a foot's sensor is cut off at a limit.

    Flat forces that carry the whole weight, as some simulators make them, are not.
    """
    figures = walk.feet[row].record.stances.figures
    share = (figures.mean_force_n / figures.peak_force_n)[figures.peak_force_n > 0.0]
    is_flat = len(share) > 0 and float(median_of(share)) >= FLAT
    ratio = walk.loads.vertical_impulse_over_weight
    carries_all = is_flat and ratio is not None and abs(ratio - 1.0) <= WHOLE_WEIGHT
    return walk.settings.feet[row].level.limit_n is not None and not carries_all


def samples_left_out(walk: Walk) -> Iterator[Finding]:
    """Yield how many messages of feet are left out, and contact that no pose is near to."""
    for row, foot in enumerate(walk.feet):
        record, name = foot.record, foot.name
        if not len(foot.stances.touchdown):
            continue
        if count := record.not_finite:
            what = "with a force that is not finite"
            if walk.settings.feet[row].level.drops_out:
                what = "without a force (lone zeros under load)"
            yield found("NOT_FINITE", say="feet", foot=name, messages=count, what=what)
        if count := record.not_advancing:
            yield found("BAD_STAMPS", say="left_out", foot=name, messages=count)
        seconds = walk.poses.unplaced(record.in_contact) / 1e9
        if len(walk.base_history.time) and seconds > SOME_S and not walk.base_by_feet:
            yield found("GAPS", say="no_pose", foot=name, seconds=seconds)


FLIES: Final = 0.05
"""Share of the time in flight, or with all feet down, from which there is some."""
SHORT: Final = 0.4
"""Usual contact fraction below which no robot walks, with or without flight."""
STANDS_FROUDE: Final = 1e-3
WALKS_FROUDE: Final = 0.06
"""Froude numbers between which robots walk and do not run; on the spot they may hop."""
LEG_M, HEAVY_KG = 0.2, 20.0
"""m, the leg of a robot of 1 kg; of others it grows with the cube root of their mass. The mass that
is assumed where none is known."""
FREE_FALL: Final = 0.5
"""Share of gravity from which a base falls freely."""
FALLS_S: Final = (0.03, 0.6)
"""s, how long a base that walks or runs falls, at least and at most."""
UNLIKE: Final = 0.3
"""By which the contact fraction of a foot differs from that of all others, if it is inverted."""
ALIKE: Final = 0.08
"""By which those of the others, and what is left of its own, differ at most."""
UNCERTAIN: Final = 0.1
"""Sampling interval over stride from which duty and phase are not known."""
CHANGES: Final = 0.06
"""Share of the weight by which it changes when a load is put on or taken off."""
LENGTHS_CHANGE: Final = 0.15
"""The same, where only the size of forces is known: feet also push against each other."""
OVER_NOISE: Final = 5.0
"""Times the scatter of the weight over strides that it must change by."""
FEWEST_WEIGHTS: Final = 6


def flags_inverted(walk: Walk) -> Iterator[Finding]:
    """Yield that contact flags seem to be true in the air and false on the ground."""
    feet = [foot.name for foot in walk.feet if not foot.record.has_force and len(foot.touchdown)]
    if not feet or walk.ground is not None or len(walk.frozen):
        return
    all_flags = len(feet) == len(walk.feet)
    if all_flags and _falls(walk, timespans.intersect([f.record.in_contact for f in walk.feet])):
        why = "the base falls freely when all feet would be down"
    else:
        why = _why_all_inverted(walk)
    if not why:
        feet = [name for name in _odd_feet(walk) if name in feet][:1]
        why = "its flag is down when those of the other feet are up"
    if feet:
        yield found("FLAGS_INVERTED", where="feet", feet=feet, names=", ".join(feet), why=why)


def _why_all_inverted(walk: Walk) -> str:
    """Return why all flags seem to be inverted; empty if they do not.

    Flags that are true for most of a stride would be less likely the other way round.
    """
    if rest_in_the_air(walk):
        return "the feet would travel on the ground, and rest in the air"
    if walk.support is None:
        return ""
    flight, *_, all_down = walk.support.feet_down
    usual = float(median_of(np.array([foot.record.contact_fraction() for foot in walk.feet])))
    is_short = usual < SHORT or (usual < HALF and flight >= FLIES)
    speed = (walk.base.forward_speed_mps if walk.base else None) or 0.0
    leg_m = LEG_M * (walk.settings.mass_kg or HEAVY_KG) ** (1.0 / 3.0)
    walks = STANDS_FROUDE < speed**2 / (GRAVITY_MPS2 * leg_m) < WALKS_FROUDE
    # The other way round, a robot that has all feet down at times would fly then.
    hops = all_down > FLIES
    hops |= _falls(walk, walk.support.in_flight)
    if is_short and walks and not hops and not feet_agree(walk):
        return f"feet would be up so long, {flight:.0%} of the time all at once, at {speed:.2f} m/s"
    for span in walk.standing.lifted:
        if _is_as_high_as_in_steps(walk, span):
            at = walk.seconds(span)[0]
            return f"no foot would be down from {at:.1f} s on, while the base stands"
    return ""


def _falls(walk: Walk, spans: Ints) -> bool:
    """Tell whether the base's height bends as gravity bends it in some short spans, (s, 2) ns."""
    poses, seconds = walk.poses, np.diff(spans)[:, 0] / 1e9
    spans = spans[(seconds > FALLS_S[0]) & (seconds < FALLS_S[1])]
    if not len(spans) or len(poses.time) < 2:
        return False
    thirds = np.stack([spans[:, 0], spans.sum(axis=1) // 2, spans[:, 1]], axis=1)
    first, middle, last = interpolated(thirds, poses.time, poses.position[:, 2:])[:, :, 0].T
    falls_m = GRAVITY_MPS2 * (np.diff(spans)[:, 0] / 1e9) ** 2 / 8.0
    bends_m = middle - (first + last) / 2.0
    return float(bends_m @ falls_m) > FREE_FALL * float(falls_m @ falls_m)


def _is_as_high_as_in_steps(walk: Walk, span: Ints) -> bool:
    """Tell whether the base stays in its place in a span, ns, as high as while the feet step."""
    time, position = walk.poses.time, walk.poses.position
    inside = position[timespans.covers(span[None], time)]
    height = position[timespans.covers(timespans.merge(walk.strides), time), 2]
    if len(inside) < 2 or not len(height) or np.ptp(inside[:, :2], axis=0).max() > STAYS_M:
        return False
    return bool(abs(median_of(inside[:, 2]) - median_of(height)) < STAYS_M)


def _odd_feet(walk: Walk) -> Iterator[str]:
    """Yield the names of feet whose flags are up as long as those of all others are down."""
    fractions = [foot.record.contact_fraction() for foot in walk.feet]
    if len(fractions) < 3 or None in fractions:
        return
    for row, foot in enumerate(walk.feet):
        own, *others = np.roll(np.array(fractions, np.float64), -row)
        usual = float(median_of(others))
        agree = float(np.ptp(others)) < ALIKE and abs(1.0 - own - usual) < ALIKE
        if agree and abs(own - usual) > UNLIKE:
            yield foot.name


def sampled_slowly(walk: Walk) -> Iterator[Finding]:
    """Yield feet of which contact is known too rarely in a stride, or force in a touchdown."""
    samples = {
        foot.name: (walk.period_s or np.inf) / foot.record.median_interval_s
        for foot in walk.feet
        if foot.record.median_interval_s and len(foot.strides.stance)
    }
    feet = tuple(name for name, number in samples.items() if number < 1.0 / UNCERTAIN)
    if feet:
        least = min(samples.values())
        words: Words = {"names": ", ".join(feet), "least": least, "share": 1.0 / least}
        yield found("SAMPLED_SLOWLY", "contact", where="feet", feet=feet, **words)
    slow = [
        foot.name
        for foot in walk.feet
        if foot.record.has_force and (foot.record.median_interval_s or 0.0) > SLOWEST_S
    ]
    if slow and not walk.settings.contact_from:
        yield found("SAMPLED_SLOWLY", "impact", where="feet", feet=slow, names=", ".join(slow))


def payload(walk: Walk) -> Iterator[Finding]:
    """Yield that the feet's sum changes lastingly: a load is put on, or taken off."""
    time, weight = _weights(walk)
    if len(weight) < FEWEST_WEIGHTS:
        return
    # The stride in which it changes belongs to neither part.
    shift = np.abs(np.cumsum(weight - weight.mean()))
    row = FEWEST_WEIGHTS // 2 - 1 + int(shift[FEWEST_WEIGHTS // 2 - 1 : -2].argmax())
    parts = weight[:row], weight[row + 2 :]
    before, after = (float(each.mean()) for each in parts)
    scatter = float(np.sqrt(np.mean(np.concatenate([parts[0] - before, parts[1] - after]) ** 2)))
    share = CHANGES if walk.vertical_known else LENGTHS_CHANGE
    if abs(after - before) >= max(share * max(before, after), OVER_NOISE * scatter):
        since, load = walk.seconds(time[row + 1 : row + 2])[0], abs(after - before)
        verb = "taken off" if after < before else "put on"
        yield found(
            "PAYLOAD", where="forces", before=before, after=after, since=since, load=load, verb=verb
        )


def _weights(walk: Walk) -> tuple[Ints, Floats]:
    """Return when, and the feet's mean load over each stride then, (k,) N; none: not known."""
    records, track = walk.records, walk.track
    if not walk.period_s or not walk.contacts_known or not all(each.has_force for each in records):
        return np.empty(0, np.int64), np.empty(0)
    half = round(walk.period_s * 5e8)
    # The belly of a robot that lies carries it.
    down = [walk.fallen, down_spans(track.history, records, track.height_m)]
    known = timespans.intersect([each.known for each in records])
    known = timespans.subtract(known, timespans.merge(np.concatenate(down)))
    time = timespans.ticks(known, 2 * half)
    time = time[timespans.hold_window(known, time, half, half)]
    kind = "vertical_impulse" if walk.vertical_known else "force_impulse"
    return time, np.asarray(mean_impulses(records, kind, time, half).sum(axis=1))
