"""Feet outside the usual: slow or inverted flags, scuffs, filters, payloads, several sensors."""

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from tests.truth.recording import Disturbance, FootRecording, Recording, Sensor


def as_flags(recording: Recording) -> Recording:
    """Let one topic tell contact of all feet, and nothing else."""
    return replace(recording, kind="flags")


def _feet(change: Callable[[int, FootRecording], FootRecording], *only: str) -> Disturbance:
    return lambda recording: recording.each_foot(change, *only)


def sampled(rate_hz: float) -> Disturbance:
    """Let the feet's messages come less often."""

    def change(_: int, foot: FootRecording) -> FootRecording:
        ticks = np.floor(foot.time * rate_hz + 1e-9)
        return foot.pick(np.flatnonzero(np.diff(ticks, prepend=-1.0) > 0.0))

    return _feet(change)


def inverted(*only: str) -> Disturbance:
    """Let flags be true in the air and false on the ground."""
    return _feet(lambda _, foot: replace(foot, touching=~foot.touching), *only)


def scuffs(newtons: float, seconds: float, *only: str) -> Disturbance:
    """Let feet touch the ground lightly in the middle of each swing."""

    def change(_: int, foot: FootRecording) -> FootRecording:
        edges = np.flatnonzero(np.diff(foot.touching.astype(np.int8)))
        force, touching = foot.force.copy(), foot.touching.copy()
        for off, on in itertools.pairwise(edges):
            if foot.touching[off + 1]:
                continue
            middle = (foot.time[off] + foot.time[on]) / 2.0
            rows = np.abs(foot.time - middle) < seconds / 2.0
            force[rows], touching[rows] = (0.0, 0.0, newtons), True
        return replace(foot, force=force, touching=touching)

    return _feet(change, *only)


def filtered(cutoff_hz: float) -> Disturbance:
    """Let forces go through a low-pass filter of first order."""

    def change(_: int, foot: FootRecording) -> FootRecording:
        share = 1.0 - np.exp(-2.0 * np.pi * cutoff_hz * np.diff(foot.time, prepend=0.0))
        force, last = foot.force.copy(), foot.force[0]
        for row, part in enumerate(share.tolist()):
            last = last + part * (foot.force[row] - last)
            force[row] = last
        return replace(foot, force=force)

    return _feet(change)


def payload(from_s: float, share: float) -> Disturbance:
    """Let the weight be another from a time on."""

    def change(_: int, foot: FootRecording) -> FootRecording:
        return replace(foot, force=foot.force * np.where(foot.time < from_s, 1.0, share)[:, None])

    return _feet(change)


def treadmill(recording: Recording) -> Recording:
    """Let the ground carry all feet back as fast as the base walks on it."""
    base = recording.base
    way = base.position - base.position[0]
    feet = tuple(
        replace(
            foot,
            point=foot.point
            - np.stack([np.interp(foot.time, base.time, axis) for axis in way.T], axis=1),
        )
        for foot in recording.feet
    )
    sway = 0.002 * np.sin(2.0 * np.pi * 1.3 * base.time)
    position = base.position - way + np.outer(sway, (0.3, 1.0, 0.5))
    still = replace(base, position=position, velocity=np.zeros_like(base.velocity))
    return replace(recording, feet=feet, base=still)


def without(*feet: str) -> Disturbance:
    """Let feet have no sensor."""
    return lambda recording: replace(recording, unrecorded=tuple(feet))


def several(*names: str, share_frames: bool = False, reach_m: float = 0.1) -> Disturbance:
    """Let each foot have sensors from heel to toe, over which the load rolls in each stance.

    Args:
        names: of their topics, from heel to toe, with ``{foot}`` for the foot.
        share_frames: whether their frames are the foot's, and not their own.
        reach_m: of the first behind the foot's point, and of the last ahead of it.
    """

    def change(recording: Recording) -> Recording:
        sensors = []
        for row, foot in enumerate(recording.feet):
            name, duty = recording.robot.feet[row], recording.truth.feet[row].stance_s or 1.0
            began = np.flatnonzero(np.diff(foot.touching.astype(np.int8), prepend=0) > 0)
            since = (
                foot.time
                - foot.time[began[np.searchsorted(began, np.arange(len(foot.time)), "right") - 1]]
            )
            # Where the load is between the first sensor and the last one.
            load = np.clip(1.4 * since / duty - 0.2, 0.0, 1.0) * (len(names) - 1)
            of_foot = []
            for number, each in enumerate(names):
                part = np.clip(1.0 - np.abs(load - number), 0.0, 1.0)
                ahead = reach_m * (2.0 * number / (len(names) - 1) - 1.0)
                columns = replace(
                    foot,
                    force=foot.force * part[:, None],
                    touching=foot.touching & (part > 0.0),
                    point=foot.point + np.array([ahead, 0.0, 0.0]),
                )
                topic = each.format(foot=name)
                own = topic.strip("/").replace("/", "_")
                frame = f"{name if share_frames else own}_link"
                of_foot.append(Sensor(topic, frame, columns))
            sensors.append(tuple(of_foot))
        return replace(recording, sensors=tuple(sensors))

    return change
