"""A walk whose topics a test shifts, measured with the times of its messages."""

from dataclasses import replace

from dogbot_logtool.core.base.poses import Odometry
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.walk import Walk as MeasuredWalk
from tests.analysed import analysed
from tests.oracles.straight_walk import SETTINGS, Walk

WALK = Walk(seconds=16.0)
S = 10**9


def feet() -> list[Samples]:
    return [WALK.samples(foot) for foot in range(4)]


def late(samples: Samples, seconds: float) -> Samples:
    return replace(samples, stamp=samples.stamp + round(seconds * S))


def measure(
    samples: list[Samples], odometry: Odometry, time_source: TimeSource | None = None
) -> MeasuredWalk:
    settings = replace(SETTINGS, time_source=time_source, odometry_topic="/odom")
    return analysed(settings, samples, odometry)
