"""A foot that follows its plan late, in closed form."""

import pytest

from dogbot_logtool.core import timespans
from dogbot_logtool.core.gait.feet import FootSteps, foot_steps
from dogbot_logtool.core.gait.support import Standing
from dogbot_logtool.core.planned import follow_plan
from dogbot_logtool.core.settings import FootSettings, StatsSettings
from tests.core.consistency.poses import base
from tests.core.load.feet import PERIOD_S, foot, seconds, vertical

LATE_S = 0.04


def steps_of(late_s: float, scale: float = 1.0) -> FootSteps:
    time = seconds(8.0)
    force = scale * vertical(time - late_s, 0.25)
    poses = base(8.0, 0.0)
    none = timespans.no_spans()
    settings = StatsSettings((FootSettings("foot", "/plan"),))
    return foot_steps(settings, 0, foot(time, force), poses, none, Standing(none, none, none))


def test_a_foot_that_is_late() -> None:
    followed = follow_plan(steps_of(LATE_S), steps_of(0.0))
    found = followed.metrics
    assert found.delay_s is not None
    assert found.delay_s.median == pytest.approx(LATE_S)
    assert (followed.early, found.missed, found.unplanned) == (0, 0, 0)
    assert followed.late == followed.touchdowns > 7
    # Twice a period, for as long as it is late, one says contact and the other does not.
    assert followed.metrics.agreement == pytest.approx(1.0 - 2.0 * LATE_S / PERIOD_S, abs=0.01)


def test_a_foot_that_follows() -> None:
    followed = follow_plan(steps_of(0.0), steps_of(0.0, scale=0.8))
    assert (followed.early, followed.late) == (0, 0)
    # The lighter force may be told a sample later.
    assert followed.metrics.agreement == pytest.approx(1.0, abs=0.01)
