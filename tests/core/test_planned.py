"""A foot that follows its plan late, in closed form."""

import pytest

from dogbot_logtool.core import timespans
from dogbot_logtool.core.gait.foot_statistics import FootStatistics, foot_statistics
from dogbot_logtool.core.gait.foot_steps import foot_steps
from dogbot_logtool.core.gait.standing import Standing
from dogbot_logtool.core.planned import follow_plan
from dogbot_logtool.core.settings import FootSettings
from tests.core.consistency.poses import base
from tests.core.load.feet import PERIOD_S, foot, seconds, vertical

LATE_S = 0.04


def statistics(late_s: float, scale: float = 1.0) -> FootStatistics:
    time = seconds(8.0)
    force = scale * vertical(time - late_s, 0.25)
    poses = base(8.0, 0.0)
    steps = foot_steps(
        FootSettings("foot", "/plan"),
        foot(time, force),
        poses,
        forward_axis="+x",
        fallen=timespans.no_spans(),
        standing=Standing(*[timespans.no_spans()] * 3),
    )
    return foot_statistics(steps, poses, None)


def test_a_foot_that_is_late() -> None:
    followed = follow_plan(statistics(LATE_S), statistics(0.0))
    found = followed.metrics
    assert found.delay_s is not None
    assert found.delay_s.median == pytest.approx(LATE_S)
    assert (followed.early, found.missed, found.unplanned) == (0, 0, 0)
    assert followed.late == followed.touchdowns > 7
    # Twice a period, for as long as it is late, one says contact and the other does not.
    assert followed.metrics.agreement == pytest.approx(1.0 - 2.0 * LATE_S / PERIOD_S, abs=0.01)


def test_a_foot_that_follows() -> None:
    followed = follow_plan(statistics(0.0), statistics(0.0, scale=0.8))
    assert (followed.early, followed.late) == (0, 0)
    # The lighter force may be told a sample later.
    assert followed.metrics.agreement == pytest.approx(1.0, abs=0.01)
