"""The gait as it changes, in logs where there is none."""

from dogbot_logtool.core.accumulator import StatsAccumulator
from dogbot_logtool.core.events.log_messages import event_messages, gait_states
from dogbot_logtool.core.settings import StatsSettings


def test_a_log_without_feet_has_no_gait() -> None:
    stats = StatsAccumulator(StatsSettings(feet=())).finish()
    assert gait_states(stats) == ()
    assert event_messages(stats) == ()
