"""Numbers at the ends of their range: figures or null with a reason, never a crash or Infinity."""

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.commands.info import describe
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.core.prepared import LARGEST
from dogbot_logtool.option import part_of
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.options.info import InfoOptions
from dogbot_logtool.report.documents import stats_json
from tests.oracles import walks
from tests.oracles.mcap_file import write_mcap

GAZEBO = "gazebo_msgs/msg/ContactsState"
SAMPLES = 160
LAST_NS = (1 << 63) - 1
TYPES = {
    "position": "geometry_msgs/msg/Point",
    "rotation": "geometry_msgs/msg/Quaternion",
    "velocity": "geometry_msgs/msg/Twist",
    "force": "geometry_msgs/msg/Wrench",
    "point": "gazebo_msgs/msg/ContactState",
    "normal": "gazebo_msgs/msg/ContactState",
}


class Extreme(walks.Walk):
    """A walk with one number everywhere, or now and then."""

    def __init__(self, where: str, value: float, every: int) -> None:
        super().__init__(2)
        self._where, self._number, self._every = where, value, every
        self._sample = 0

    def odometry(self, sample: int) -> bytes:
        self._sample = sample
        return super().odometry(sample)

    def make(self, kind: str, **fields: Any) -> Any:
        if TYPES[self._where] == kind and self._sample % self._every == 0:
            fields |= self._extreme()
        return super().make(kind, **fields)

    def _extreme(self) -> dict[str, Any]:
        value = self._number
        vector = super().make("geometry_msgs/Vector3", x=value, y=0.0, z=value)
        match self._where:
            case "position":
                return {"x": value, "y": value, "z": value}
            case "rotation":
                return dict.fromkeys("xyzw", value)
            case "velocity":
                return {"linear": vector, "angular": vector}
            case "force":
                return {"force": vector}
            case "point":
                return {"contact_positions": [vector]}
            case _:
                return {"contact_normals": [vector]}


def write(path: Path, walk: walks.Walk, kind: str, log_time: Callable[[int], int]) -> Path:
    entries = []
    for entry in walk.messages(kind):
        sample = (entry.log_time - walks.START) // walks.STEP
        if sample >= SAMPLES:
            break
        entries.append(entry._replace(log_time=log_time(sample)))
    return write_mcap(path, entries, walks.Walk(2).definition, 40_000, "zstd")


def usual(sample: int) -> int:
    return walks.START + sample * walks.STEP


def strict(text: str) -> Any:
    """Read JSON, and nothing that only some readers take for it."""

    def refuse(name: str) -> None:
        raise AssertionError(name)

    return json.loads(text, parse_constant=refuse)


def outputs(folder: Path, path: Path) -> tuple[dict[str, Any], set[str]]:
    """Make all outputs; return the figures and the texts of convert's findings."""
    topics = MeasureOptions(robot=str(walks.robot_file(folder, GAZEBO)))
    done = measure(path, topics)
    figures = strict(json.dumps(stats_json(done)))
    converted = convert(
        path, folder / "out.mcap", replace(part_of(topics, ConvertOptions), style="force")
    )
    assert done.damage.losses == converted.damage.losses == ()
    return figures, {finding.text for finding in converted.findings}


def texts(figures: dict[str, Any]) -> set[str]:
    return {each["text"] for each in figures["findings"]}


NUMBERS = [
    *((where, *each) for where in TYPES for each in ((1e300, 50), (math.inf, 1))),
    *((where, math.nan, 50) for where in ("position", "force", "normal")),
    *((where, 1e300, 1) for where in ("position", "force")),
    *((where, 5e-324, 1) for where in ("rotation", "normal")),
    ("rotation", -0.0, 50),
]


@pytest.mark.parametrize(("where", "value", "every"), NUMBERS)
def test_no_number_is_too_large_or_too_small(
    tmp_path: Path, where: str, value: float, every: int
) -> None:
    path = write(tmp_path / "walk.mcap", Extreme(where, value, every), GAZEBO, usual)
    figures, converted = outputs(tmp_path, path)
    is_said = where in {"position", "velocity", "force", "point"} and value > LARGEST
    for found in (texts(figures), converted):
        is_implausible = any("that no robot reaches" in text for text in found)
        assert is_implausible == (is_said and math.isfinite(value))
    base = figures["base"]
    assert base["path_length_m"] is None or base["path_length_m"] < 10.0
    assert base["froude"] is None or base["froude"] < 10.0


TIMES: dict[str, Callable[[int], int]] = {
    "all zero": lambda _: 0,
    "up to the end": lambda sample: LAST_NS - (SAMPLES - 1 - sample) * walks.STEP,
    "one at the end": lambda sample: LAST_NS if sample == SAMPLES - 1 else usual(sample),
    "from end to end": lambda sample: 0 if sample < SAMPLES // 2 else LAST_NS,
    "beyond the end": lambda sample: LAST_NS + 1 if sample == 80 else usual(sample),
    "a nanosecond apart": lambda sample: sample,
}


@pytest.mark.parametrize("name", TIMES)
def test_times_at_the_ends_of_their_range(tmp_path: Path, name: str) -> None:
    path = write(tmp_path / "walk.mcap", walks.Walk(2), GAZEBO, TIMES[name])
    topics = MeasureOptions(robot=str(walks.robot_file(tmp_path, GAZEBO)))
    for clock in ("header", "log"):
        done = measure(path, replace(topics, set={"clock": clock}))
        strict(json.dumps(stats_json(done)))
    convert(path, tmp_path / "out.mcap", part_of(topics, ConvertOptions))
    describe(path, replace(part_of(topics, InfoOptions), frames=True))
