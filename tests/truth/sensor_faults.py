"""What force sensors add to the force: offset, drift, noise, spikes, steps, and their frame.

A sensor's own faults come after its frame: `in_link_frame` first, then `offset` and the like.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from tests.truth.geometry import Floats, inverse, product, turned
from tests.truth.recording import Disturbance, FootRecording, Recording, of_feet

UP = np.array([0.0, 0.0, 1.0])


def _plus(foot: FootRecording, newtons: Floats) -> FootRecording:
    """Add newtons, (n,), along z."""
    return replace(foot, force=foot.force + np.outer(newtons, UP))


def _some(foot: FootRecording, row: int, fraction: float) -> Floats:
    """Choose messages at random."""
    random = np.random.default_rng((0, row))
    return np.asarray(random.random(len(foot.force)) < fraction)


@of_feet
def offset(_: int, foot: FootRecording, newtons: Sequence[float] | float) -> FootRecording:
    """Add a constant: a vector, or a number along z."""
    vector = np.array(newtons if isinstance(newtons, Sequence) else (0.0, 0.0, newtons))
    return replace(foot, force=foot.force + vector)


@of_feet
def rezeroed(_: int, foot: FootRecording, at_s: float, newtons: float) -> FootRecording:
    """Add a constant along z until the sensors are zeroed."""
    return _plus(foot, np.where(foot.time < at_s, newtons, 0.0))


@of_feet
def warming(_: int, foot: FootRecording, newtons: float, within_s: float) -> FootRecording:
    """Add what comes near a limit along z as a sensor warms up."""
    return _plus(foot, newtons * (1.0 - np.exp(-foot.time / within_s)))


@of_feet
def drift(_: int, foot: FootRecording, newtons_per_minute: float) -> FootRecording:
    """Add a ramp along z that starts at zero."""
    return _plus(foot, foot.time * newtons_per_minute / 60.0)


@of_feet
def noise(row: int, foot: FootRecording, std_n: float, seed: int = 0) -> FootRecording:
    """Add white noise to each component."""
    random = np.random.default_rng((seed, row))
    return replace(foot, force=foot.force + random.normal(0.0, std_n, foot.force.shape))


@of_feet
def spikes(
    row: int, foot: FootRecording, newtons: float, every_s: float, apart: int = 0
) -> FootRecording:
    """Add lone samples of much force along z, at random, or pairs of them some samples apart."""
    random = np.random.default_rng((0, row))
    count = max(1, int(foot.time[-1] / every_s))
    extra = np.zeros(len(foot.time))
    at = 8 * random.choice(len(extra) // 8 - 1, count, replace=False)
    extra[at] = extra[at + apart] = newtons
    return _plus(foot, extra)


@of_feet
def quantised(_: int, foot: FootRecording, step_n: float) -> FootRecording:
    """Round each component to whole steps."""
    return replace(foot, force=np.round(foot.force / step_n) * step_n)


@of_feet
def saturated(_: int, foot: FootRecording, limit_n: float) -> FootRecording:
    """Cut off the force along z at a limit."""
    return _plus(foot, np.minimum(limit_n - foot.force[:, 2], 0.0))


@of_feet
def stuck(_: int, foot: FootRecording, newtons: float) -> FootRecording:
    """Let sensors report one force for ever."""
    return replace(foot, force=np.tile(newtons * UP, (len(foot.time), 1)))


@of_feet
def dead_from(_: int, foot: FootRecording, at_s: float) -> FootRecording:
    """Let sensors feel nothing more from some time on; put it before their noise."""
    alive = foot.time < at_s
    return replace(foot, force=foot.force * alive[:, None], touching=foot.touching & alive)


@of_feet
def frozen_from(_: int, foot: FootRecording, at_s: float) -> FootRecording:
    """Let sensors report for ever what they felt at some time."""
    rows = np.minimum(np.arange(len(foot.time)), np.searchsorted(foot.time, at_s))
    return replace(foot, force=foot.force[rows])


@of_feet
def without_forces(_: int, foot: FootRecording) -> FootRecording:
    """Let contacts have no force, as some physics engines do."""
    return replace(foot, force=np.zeros_like(foot.force))


@of_feet
def not_finite(row: int, foot: FootRecording, fraction: float) -> FootRecording:
    """Let some messages hold a force that is no number."""
    rows = _some(foot, row, fraction)
    return replace(foot, force=np.where(rows[:, None], np.nan, foot.force))


def in_link_frame(recording: Recording) -> Recording:
    """Let sensors report forces in their links' frames, and record those transforms."""

    def change(_: int, foot: FootRecording) -> FootRecording:
        world = product(_attitude_at(recording, foot.time), foot.link)
        return replace(foot, force=turned(inverse(world), foot.force))

    return replace(recording.each_foot(change), has_tf=True)


@of_feet
def stiff_legs(_: int, foot: FootRecording) -> FootRecording:
    """Let the transforms of the links be those of legs that never move."""
    return replace(foot, link=np.tile([0.0, 0.0, 0.0, 1.0], (len(foot.time), 1)))


@of_feet
def leaning(_: int, foot: FootRecording, rotation: Floats) -> FootRecording:
    """Let all forces be turned."""
    return replace(foot, force=turned(np.tile(rotation, (len(foot.time), 1)), foot.force))


@of_feet
def scaled(_: int, foot: FootRecording, factor: float) -> FootRecording:
    """Let sensors report a multiple of the force."""
    return replace(foot, force=factor * foot.force)


@of_feet
def lone_zeros(row: int, foot: FootRecording, fraction: float) -> FootRecording:
    """Let some messages hold zeros in place of a measurement."""
    rows = _some(foot, row, fraction)
    return replace(foot, force=np.where(rows[:, None], 0.0, foot.force))


@of_feet
def inertia(row: int, foot: FootRecording, newtons: float) -> FootRecording:
    """Let feet in the air feel the inertia of moving legs."""
    swing = np.where(foot.touching, 0.0, newtons * np.sin(8.2 * foot.time + row))
    return replace(foot, force=foot.force + np.outer(swing, (0.3, 0.0, 1.0)))


def wobble(newtons: float) -> Disturbance:
    """Let feet feel in each swing the legs' inertia, which adds up to nothing.

    Args:
        newtons: about the largest force along z; a third of it goes forward.
    """

    def change(recording: Recording, foot: FootRecording) -> FootRecording:
        ends = np.flatnonzero(foot.touching[:-1] & ~foot.touching[1:]) + 1
        swing = np.searchsorted(ends, np.arange(len(foot.time)), side="right") - 1
        known = ~foot.touching & (swing >= 0)
        since = foot.time - foot.time[ends[np.maximum(swing, 0)]]
        part = np.pi * np.clip(since / recording.truth.metrics["swing_s"], 0.0, 1.0)
        force = np.where(known, newtons * np.sin(part) * np.sin(2.0 * part), 0.0)
        return replace(foot, force=foot.force + np.outer(force, (0.3, 0.0, 1.0)))

    return lambda recording: recording.each_foot(lambda _, foot: change(recording, foot))


@of_feet
def hysteresis(_: int, foot: FootRecording, part: float) -> FootRecording:
    """Let the force along z stick within a band, so wide against its largest."""
    half, force, held = part * foot.force[:, 2].max() / 2.0, foot.force.copy(), 0.0
    for number, true in enumerate(foot.force[:, 2].tolist()):
        held = force[number, 2] = min(max(held, true - half), true + half)
    return replace(foot, force=force)


@of_feet
def clipped(_: int, foot: FootRecording) -> FootRecording:
    """Let sensors tell the force along z only, and none below zero."""
    return replace(foot, force=np.maximum(foot.force * UP, 0.0))


def user_gives(**options: Any) -> Disturbance:
    """Let the user give another mass, or none, or set a field of the robot's file."""
    return lambda recording: replace(recording, given={**recording.given, **options})


def _attitude_at(recording: Recording, time: Floats) -> Floats:
    """(n, 4) the base's orientation at the nearest pose."""
    base = recording.base
    nearest = np.searchsorted((base.time[1:] + base.time[:-1]) / 2.0, time)
    return base.orientation[nearest]
