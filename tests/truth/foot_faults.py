"""Feet outside the usual: flags, scuffs, filters, payloads, several sensors, slips, stumbles."""

from dataclasses import replace

import numpy as np

from tests.truth.recording import Disturbance, FootRecording, Recording, Sensor, at_times, of_feet


@of_feet
def sampled(_: int, foot: FootRecording, rate_hz: float) -> FootRecording:
    """Let the feet's messages come less often."""
    return foot.pick(np.flatnonzero(np.diff(np.floor(foot.time * rate_hz + 1e-9), prepend=-1.0)))


@of_feet
def inverted(_: int, foot: FootRecording) -> FootRecording:
    """Let flags be true in the air and false on the ground."""
    return replace(foot, touching=~foot.touching)


@of_feet
def scuffs(_: int, foot: FootRecording, newtons: float, seconds: float) -> FootRecording:
    """Let feet touch the ground lightly in the middle of each swing."""
    edges = np.flatnonzero(np.diff(foot.touching.astype(np.int8)))
    off, on = edges[:-1], edges[1:]
    middle = ((foot.time[off] + foot.time[on]) / 2.0)[~foot.touching[off + 1]]
    rows = np.asarray((np.abs(foot.time[:, None] - middle) < seconds / 2.0).any(axis=1))
    force = np.where(rows[:, None], [0.0, 0.0, newtons], foot.force)
    return replace(foot, force=force, touching=foot.touching | rows)


@of_feet
def filtered(_: int, foot: FootRecording, cutoff_hz: float) -> FootRecording:
    """Let forces go through a low-pass filter of first order."""
    share = 1.0 - np.exp(-2.0 * np.pi * cutoff_hz * np.diff(foot.time, prepend=0.0))
    force, last = foot.force.copy(), foot.force[0]
    for row, part in enumerate(share.tolist()):
        force[row] = last = last + part * (foot.force[row] - last)
    return replace(foot, force=force)


@of_feet
def payload(_: int, foot: FootRecording, from_s: float, share: float) -> FootRecording:
    """Let the weight be another from a time on."""
    return replace(foot, force=foot.force * np.where(foot.time < from_s, 1.0, share)[:, None])


def held_up(of: str, from_s: float, until_s: float) -> Disturbance:
    """Let a foot stay in the air for a while, and those on the ground carry its load."""

    def change(recording: Recording) -> Recording:
        number = recording.robot.feet.index(of)
        own = recording.feet[number]
        up = (own.time >= from_s) & (own.time < until_s)
        others = sum(each.touching.astype(float) for each in recording.feet) - own.touching
        load = np.where(up & (others > 0), 1.0 / np.maximum(others, 1.0), 0.0)[:, None] * own.force
        feet = [
            replace(each, force=each.force + load * each.touching[:, None])
            for each in recording.feet
        ]
        feet[number] = replace(
            own, force=np.where(up[:, None], 0.0, own.force), touching=own.touching & ~up
        )
        return replace(recording, feet=tuple(feet))

    return change


def treadmill(recording: Recording) -> Recording:
    """Let the ground carry all feet back as fast as the base walks on it."""
    base = recording.base
    way = base.position - base.position[0]
    sway = 0.002 * np.sin(2.0 * np.pi * 1.3 * base.time)
    position = base.position - way + np.outer(sway, (0.3, 1.0, 0.5))
    still = replace(base, position=position, velocity=np.zeros_like(base.velocity))
    return replace(recording, base=still).each_foot(
        lambda _, foot: replace(foot, point=foot.point - at_times(foot.time, base, way))
    )


def without(*feet: str) -> Disturbance:
    """Let feet have no sensor."""

    def change(recording: Recording) -> Recording:
        robot = recording.robot
        rows = [row for row, name in enumerate(robot.feet) if name not in feet]
        return replace(
            recording,
            feet=tuple(recording.feet[row] for row in rows),
            robot=replace(
                robot,
                feet=tuple(robot.feet[row] for row in rows),
                corners_m=tuple(robot.corners_m[row] for row in rows),
            ),
            truth=recording.truth.of_feet(rows),
        )

    return change


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
            name, duty = recording.robot.feet[row], recording.truth.metrics["stance_s"]
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


# Events

CONTACT_N = 60.0


def slip(foot_name: str, at_s: float, metres: float) -> Disturbance:
    """Let a foot slide forward for 40 ms in its stance, and stay there until it leaves it."""

    def change(_: int, foot: FootRecording) -> FootRecording:
        leaves = foot.time[(foot.time > at_s) & ~foot.touching][0]
        slid = np.clip((foot.time - at_s) / 0.04, 0.0, 1.0) * metres
        slid[(foot.time <= at_s) | (foot.time >= leaves)] = 0.0
        return replace(foot, point=foot.point + np.outer(slid, (1.0, 0.0, 0.0)))

    return lambda recording: recording.each_foot(change, foot_name)


def rolling(metres_per_second: float) -> Disturbance:
    """Let contact points go forward through each stance, as those of round feet that roll."""

    def change(_: int, foot: FootRecording) -> FootRecording:
        lands = foot.touching & ~np.roll(foot.touching, 1)
        since = foot.time - np.maximum.accumulate(np.where(lands, foot.time, 0.0))
        rolled = np.where(foot.touching, since * metres_per_second, 0.0)
        return replace(foot, point=foot.point + np.outer(rolled, (1.0, 0.0, 0.0)))

    return lambda recording: recording.each_foot(change)


def contact(foot_name: str, at_s: float, until_s: float | None = None) -> Disturbance:
    """Let a foot in the air touch something, until a time, or until it lands."""

    def change(_: int, foot: FootRecording) -> FootRecording:
        lands = foot.time[(foot.time > at_s) & foot.touching][0]
        leaves = foot.time[(foot.time > lands) & ~foot.touching][0]
        rows = (foot.time >= at_s) & (foot.time < (lands if until_s is None else until_s))
        stays = (foot.time >= at_s) & (foot.time < (leaves if until_s is None else until_s))
        force, point = foot.force.copy(), foot.point.copy()
        force[rows] = (0.0, 0.0, CONTACT_N)
        point[stays] = point[stays][0]
        return replace(foot, touching=foot.touching | rows, force=force, point=point)

    return lambda recording: recording.each_foot(change, foot_name)
