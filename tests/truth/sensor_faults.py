"""What force sensors add to the force: offset, drift, noise, spikes, steps, and their frame.

A sensor's own faults come after its frame: `in_link_frame` first, then `offset` and the like.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tests.truth.recording import (
    Disturbance,
    Floats,
    FootRecording,
    Recording,
    inverse,
    product,
    turned,
)


def as_force_sensors(recording: Recording) -> Recording:
    """Let sensors report a force all the time, and no contact."""
    return replace(recording, kind="wrench")


def offset(newtons: Sequence[float] | float, *only: str) -> Disturbance:
    """Add a constant: a vector, or a number along z."""
    vector = np.array(newtons if isinstance(newtons, Sequence) else (0.0, 0.0, newtons))
    return lambda recording: recording.each_foot(
        lambda _, foot: replace(foot, force=foot.force + vector), *only
    )


def rezeroed(at_s: float, newtons: float, *only: str) -> Disturbance:
    """Add a constant along z until the sensors are zeroed."""

    def change(_: int, foot: FootRecording) -> FootRecording:
        before = np.outer(foot.time < at_s, (0.0, 0.0, newtons))
        return replace(foot, force=foot.force + before)

    return lambda recording: recording.each_foot(change, *only)


def warming(newtons: float, within_s: float) -> Disturbance:
    """Add what comes near a limit along z as a sensor warms up."""

    def change(_: int, foot: FootRecording) -> FootRecording:
        part = 1.0 - np.exp(-foot.time / within_s)
        return replace(foot, force=foot.force + np.outer(part, (0.0, 0.0, newtons)))

    return lambda recording: recording.each_foot(change)


def drift(newtons_per_minute: float, *only: str) -> Disturbance:
    """Add a ramp along z that starts at zero."""

    def change(_: int, foot: FootRecording) -> FootRecording:
        ramp = np.outer(foot.time * newtons_per_minute / 60.0, (0.0, 0.0, 1.0))
        return replace(foot, force=foot.force + ramp)

    return lambda recording: recording.each_foot(change, *only)


def noise(std_n: float, seed: int = 0) -> Disturbance:
    """Add white noise to each component."""

    def change(row: int, foot: FootRecording) -> FootRecording:
        random = np.random.default_rng((seed, row))
        return replace(foot, force=foot.force + random.normal(0.0, std_n, foot.force.shape))

    return lambda recording: recording.each_foot(change)


def spikes(newtons: float, every_s: float, seed: int = 0) -> Disturbance:
    """Add lone samples of much force along z, at random."""

    def change(row: int, foot: FootRecording) -> FootRecording:
        random = np.random.default_rng((seed, row))
        count = max(1, int(foot.time[-1] / every_s))
        force = foot.force.copy()
        force[random.choice(len(force), count, replace=False), 2] += newtons
        return replace(foot, force=force)

    return lambda recording: recording.each_foot(change)


def quantised(step_n: float) -> Disturbance:
    """Round each component to whole steps."""
    return lambda recording: recording.each_foot(
        lambda _, foot: replace(foot, force=np.round(foot.force / step_n) * step_n)
    )


def saturated(limit_n: float) -> Disturbance:
    """Cut off the force along z at a limit."""

    def change(_: int, foot: FootRecording) -> FootRecording:
        force = foot.force.copy()
        force[:, 2] = np.minimum(force[:, 2], limit_n)
        return replace(foot, force=force)

    return lambda recording: recording.each_foot(change)


def stuck(newtons: float, *only: str) -> Disturbance:
    """Let sensors report one force for ever."""
    return lambda recording: recording.each_foot(
        lambda _, foot: replace(foot, force=np.tile((0.0, 0.0, newtons), (len(foot.time), 1))),
        *only,
    )


def dead_from(at_s: float, *only: str) -> Disturbance:
    """Let sensors feel nothing more from some time on; put it before their noise."""

    def change(_: int, foot: FootRecording) -> FootRecording:
        alive = foot.time < at_s
        return replace(foot, force=foot.force * alive[:, None], touching=foot.touching & alive)

    return lambda recording: recording.each_foot(change, *only)


def frozen_from(at_s: float, *only: str) -> Disturbance:
    """Let sensors report for ever what they felt at some time."""

    def change(_: int, foot: FootRecording) -> FootRecording:
        row = int(np.searchsorted(foot.time, at_s))
        force = foot.force.copy()
        force[row:] = force[row]
        return replace(foot, force=force)

    return lambda recording: recording.each_foot(change, *only)


def without_forces(recording: Recording) -> Recording:
    """Let contacts have no force, as some physics engines do."""
    return recording.each_foot(lambda _, foot: replace(foot, force=np.zeros_like(foot.force)))


def not_finite(fraction: float, seed: int = 0) -> Disturbance:
    """Let some messages hold a force that is no number."""

    def change(row: int, foot: FootRecording) -> FootRecording:
        random = np.random.default_rng((seed, row))
        force = foot.force.copy()
        force[random.random(len(force)) < fraction] = np.nan
        return replace(foot, force=force)

    return lambda recording: recording.each_foot(change)


def touching_itself(recording: Recording) -> Recording:
    """Let bumpers report in swing a contact with the robot's own body."""
    return replace(recording, touches_itself=True)


def in_link_frame(recording: Recording) -> Recording:
    """Let sensors report forces in their links' frames, and record those transforms."""

    def change(_: int, foot: FootRecording) -> FootRecording:
        world = product(_attitude_at(recording, foot.time), foot.link)
        return replace(foot, force=turned(inverse(world), foot.force))

    return replace(recording.each_foot(change), has_tf=True)


def stiff_legs(recording: Recording) -> Recording:
    """Let the transforms of the links be those of legs that never move."""
    straight = np.array([0.0, 0.0, 0.0, 1.0])
    return recording.each_foot(
        lambda _, foot: replace(foot, link=np.tile(straight, (len(foot.time), 1)))
    )


def without_tf(recording: Recording) -> Recording:
    """Leave out the transforms."""
    return replace(recording, has_tf=False)


def scaled(factor: float, *only: str) -> Disturbance:
    """Let sensors report a multiple of the force."""
    return lambda recording: recording.each_foot(
        lambda _, foot: replace(foot, force=factor * foot.force), *only
    )


def inverted(recording: Recording) -> Recording:
    """Mount the sensors the other way round."""
    return recording.each_foot(lambda _, foot: replace(foot, force=-foot.force))


def lone_zeros(fraction: float, seed: int = 0) -> Disturbance:
    """Let some messages hold zeros in place of a measurement."""

    def change(row: int, foot: FootRecording) -> FootRecording:
        random = np.random.default_rng((seed, row))
        force = foot.force.copy()
        force[random.random(len(force)) < fraction] = 0.0
        return replace(foot, force=force)

    return lambda recording: recording.each_foot(change)


def inertia(newtons: float) -> Disturbance:
    """Let feet in the air feel the inertia of moving legs."""

    def change(row: int, foot: FootRecording) -> FootRecording:
        swing = np.where(foot.touching, 0.0, newtons * np.sin(8.2 * foot.time + row))
        return replace(foot, force=foot.force + np.outer(swing, (0.3, 0.0, 1.0)))

    return lambda recording: recording.each_foot(change)


def wobble(newtons: float, turns: int = 2) -> Disturbance:
    """Let feet feel in each swing the legs' inertia, which adds up to nothing.

    Args:
        newtons: largest force along z; a third of it goes forward.
        turns: half waves in a swing, at least two.
    """

    def change(foot: FootRecording, swing_s: float) -> FootRecording:
        ends = np.flatnonzero(foot.touching[:-1] & ~foot.touching[1:]) + 1
        swing = np.searchsorted(ends, np.arange(len(foot.time)), side="right") - 1
        known = ~foot.touching & (swing >= 0)
        since = foot.time - foot.time[ends[np.maximum(swing, 0)]]
        part = np.pi * np.clip(since / swing_s, 0.0, 1.0)
        force = np.where(known, newtons * np.sin(part) * np.sin(turns * part), 0.0)
        return replace(foot, force=foot.force + np.outer(force, (0.3, 0.0, 1.0)))

    return lambda recording: recording.each_foot(
        lambda row, foot: change(foot, recording.truth.feet[row].swing_s or np.inf)
    )


def spike_pairs(newtons: float, every_s: float, apart: int, seed: int = 0) -> Disturbance:
    """Add two lone samples of much force along z, some samples apart, at random."""

    def change(row: int, foot: FootRecording) -> FootRecording:
        random = np.random.default_rng((seed, row))
        count = int(foot.time[-1] / every_s)
        at = random.integers(5, len(foot.time) - 5 - apart, count)
        force = foot.force.copy()
        force[at, 2] += newtons
        force[at + apart, 2] += newtons
        return replace(foot, force=force)

    return lambda recording: recording.each_foot(change)


def hysteresis(part: float) -> Disturbance:
    """Let the force along z stick within a band, so wide against its largest."""

    def change(_: int, foot: FootRecording) -> FootRecording:
        half, force, held = part * foot.force[:, 2].max() / 2.0, foot.force.copy(), 0.0
        for row, true in enumerate(foot.force[:, 2].tolist()):
            held = force[row, 2] = min(max(held, true - half), true + half)
        return replace(foot, force=force)

    return lambda recording: recording.each_foot(change)


def clipped(recording: Recording) -> Recording:
    """Let sensors tell the force along z only, and none below zero."""
    up = np.array([0.0, 0.0, 1.0])
    return recording.each_foot(
        lambda _, foot: replace(foot, force=np.maximum(foot.force * up, 0.0))
    )


def wrong_mass(mass_kg: float | None) -> Disturbance:
    """Let the user give another mass, or none."""
    return lambda recording: replace(recording, given={**recording.given, "mass_kg": mass_kg})


def _attitude_at(recording: Recording, time: Floats) -> Floats:
    """(n, 4) the base's orientation at the nearest pose."""
    base = recording.base
    nearest = np.searchsorted((base.time[1:] + base.time[:-1]) / 2.0, time)
    return base.orientation[nearest]
