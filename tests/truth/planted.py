"""Events planted in a recording: slips, stumbles, contacts that come too early."""

from dataclasses import replace

import numpy as np

from tests.truth.recording import Disturbance, FootRecording

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
