"""The gait diagram of the terminal."""

import pytest

from dogbot_logtool.commands.stats import measure
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.report.text.gait_diagram import STRIDES_SHOWN, default_window
from tests.paths import SAMPLE_LOGS


@pytest.mark.parametrize("seconds", [2.5, 3.5, 8.0])
def test_the_window_lies_in_the_log(seconds: float) -> None:
    options = MeasureOptions(end=seconds)
    stats = measure(SAMPLE_LOGS / "dogbot_trot.bag", options).walk
    begin, end = default_window(stats)

    assert stats.main is not None
    assert stats.main.stride_frequency_hz is not None
    wanted = STRIDES_SHOWN / stats.main.stride_frequency_hz
    assert 0.0 <= begin < end <= seconds + 0.01
    assert end - begin == pytest.approx(min(wanted, seconds), abs=0.02)
