"""Findings about the timing of a topic."""

from dataclasses import replace

import numpy as np
import pytest

from dogbot_logtool.core.checks.clock import topics_timed
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.quality.quality import topic_quality, topic_times
from tests.core.checks.measured_walk import WALK, feet, measure

MS = 1_000_000
START = 1_700_000_000_000 * MS


@pytest.mark.parametrize(("stamp_ms", "rate"), [(5, "0.50"), (25, "2.50"), (10, None)])
def test_stamps_that_run_at_another_speed(stamp_ms: int, rate: str | None) -> None:
    count = np.arange(4000, dtype=np.int64)
    times = topic_times("/foot", START + 10 * MS * count, START + stamp_ms * MS * count)
    stats = replace(
        measure(feet(), WALK.odometry()), topics=(topic_quality(times, TimeSource.HEADER),)
    )
    found = topics_timed(stats)
    texts = [each.text for each in found if "stamps run" in each.text]
    wanted = [f"/foot: its stamps run at {rate} times the speed of log time"] if rate else []
    assert texts == wanted
