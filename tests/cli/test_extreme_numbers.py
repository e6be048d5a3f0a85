"""Numbers at the ends of their range: metrics or null with a reason, never a crash or Infinity."""

import json
import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import pytest

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.commands.info import describe
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.core.recording import LARGEST
from dogbot_logtool.io.plain_json import to_json
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.options.info import InfoOptions
from dogbot_logtool.report.documents import stats_json
from tests.measured import measured
from tests.paths import TROT
from tests.truth.log_file import write_log
from tests.truth.recording import START_NS, BaseRecording, FootRecording, Recording
from tests.truth.walking import Walk

RATE_HZ = 100.0
SAMPLES = 161
LAST_NS = (1 << 63) - 1
OF_BASE, OF_FEET = ("position", "orientation", "velocity"), ("force", "point", "normal")
Messages = TypeVar("Messages", BaseRecording, FootRecording)


@cache
def walk() -> Recording:
    return Walk(seconds=(SAMPLES - 1) / RATE_HZ).recorded(RATE_HZ, RATE_HZ)


NUMBERS = [
    *((name, *each) for name in (*OF_BASE, *OF_FEET) for each in ((1e300, 50), (math.inf, 1))),
    *((name, math.nan, 50) for name in ("position", "force", "normal")),
    *((name, 1e300, 1) for name in ("position", "force")),
    *((name, 5e-324, 1) for name in ("orientation", "normal")),
    ("orientation", -0.0, 50),
]


@pytest.mark.parametrize(("name", "value", "every"), NUMBERS)
def test_no_number_is_too_large_or_too_small(
    tmp_path: Path, name: str, value: float, every: int
) -> None:
    def with_extremes(messages: Messages) -> Messages:
        column = getattr(messages, name).copy()
        column[::every] = value
        return replace(messages, **{name: column})

    if name in OF_BASE:
        recording = replace(walk(), base=with_extremes(walk().base))
    else:
        recording = walk().each_foot(lambda _, foot: with_extremes(foot))
    path = write_log(recording, tmp_path / "walk.mcap")
    done = measure(path, MeasureOptions())
    metrics = stats_json(done)
    json.dumps(metrics, allow_nan=False)
    options = ConvertOptions(style="force", set={"wrench_frame": "world"})
    converted = convert(path, tmp_path / "out.mcap", options)
    assert done.damage.losses == converted.damage.losses == ()
    is_said = name in {"position", "velocity", "force", "point"} and value > LARGEST
    said = {each["text"] for each in metrics["findings"]}
    for found in (said, {finding.text for finding in converted.findings}):
        is_implausible = any("that no robot reaches" in text for text in found)
        assert is_implausible == (is_said and math.isfinite(value))
    base = metrics["base"]
    assert base["path_length_m"] is None or base["path_length_m"] < 10.0
    assert base["froude"] is None or base["froude"] < 10.0


def usual(sample: int) -> int:
    return START_NS + round(sample * 1e9 / RATE_HZ)


TIMES: dict[str, Callable[[int], int]] = {
    "all zero": lambda _: 0,
    "up to the end": lambda sample: LAST_NS - usual(SAMPLES - 1) + usual(sample),
    "one at the end": lambda sample: LAST_NS if sample == SAMPLES - 1 else usual(sample),
    "from end to end": lambda sample: 0 if sample < SAMPLES // 2 else LAST_NS,
    "beyond the end": lambda sample: LAST_NS + 1 if sample == 80 else usual(sample),
    "a nanosecond apart": lambda sample: sample,
}


@pytest.mark.parametrize("name", TIMES)
def test_times_at_the_ends_of_their_range(tmp_path: Path, name: str) -> None:
    # Beyond the end, no int64 holds them.
    times: Any = np.array([TIMES[name](sample) for sample in range(SAMPLES)], np.object_)
    recording = replace(walk(), base=replace(walk().base, log_time=times))
    recording = recording.each_foot(lambda _, foot: replace(foot, log_time=times))
    path = write_log(recording, tmp_path / "walk.mcap")
    for clock in ("header", "log"):
        done = measure(path, MeasureOptions(set={"clock": clock}))
        json.dumps(stats_json(done), allow_nan=False)
    convert(path, tmp_path / "out.mcap", ConvertOptions())
    describe(path, InfoOptions(frames=True))


def test_a_metric_that_is_too_large_is_null_and_named() -> None:
    done = measured(TROT)
    base = replace(done.metrics.base, path_length_m=math.inf)
    walk = replace(done.walk, metrics=replace(done.metrics, base=base))
    found = stats_json(replace(done, walk=walk))
    assert found["base"]["path_length_m"] is None
    assert found["null_because"]["base.path_length_m"] == "NOT_FINITE"


def test_json_has_null_for_what_is_not_finite() -> None:
    value = {"a": [math.nan, 1.5, (math.inf,)], "b": -math.inf}
    expected = {"a": [None, 1.5, [None]], "b": None}
    assert json.loads(to_json(value)) == json.loads(to_json(value, indent=2)) == expected
