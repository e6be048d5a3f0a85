"""Findings about the timing of a topic."""

import numpy as np
import pytest

from dogbot_logtool.core.checks.clock import topic_findings
from dogbot_logtool.core.geometry.clock import TimeSource
from dogbot_logtool.core.quality.quality import topic_quality, topic_times

MS = 1_000_000
START = 1_700_000_000_000 * MS


@pytest.mark.parametrize(("stamp_ms", "rate"), [(5, "0.50"), (25, "2.50"), (10, None)])
def test_stamps_that_run_at_another_speed(stamp_ms: int, rate: str | None) -> None:
    count = np.arange(4000, dtype=np.int64)
    times = topic_times("/foot", START + 10 * MS * count, START + stamp_ms * MS * count)
    found = topic_findings(topic_quality(times, TimeSource.HEADER), may_pause=False)
    texts = [each.text for each in found if each.code == "CLOCK_OFFSET"]
    wanted = [f"/foot: its stamps run at {rate} times the speed of log time"] if rate else []
    assert texts == wanted
