"""What `stats --json` and the verdict of `report` say of a recording."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from dogbot_logtool.commands.stats import measure
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.report.documents import stats_json
from dogbot_logtool.report.verdict import headline, quality_of
from tests.truth.geometry import Floats
from tests.truth.log_file import write_log
from tests.truth.recording import Recording

_MISSING = object()


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came out."""

    json: Mapping[str, Any]
    headline: str
    quality: str
    """OK, USABLE, DOUBTFUL or DAMAGED."""
    quality_line: str

    def figure(self, key: str) -> Any:
        """Return what stands at a dotted key; None also where something on the way is None.

        Raises:
            KeyError: there is no such figure.
        """
        value: Any = self.json
        for part in key.split("."):
            if value is None:
                return None
            value = value.get(part, _MISSING)
            if value is _MISSING:
                raise KeyError(key)
        return value

    def says(self, pattern: str) -> list[str]:
        """Return codes of the findings whose code or text has a pattern."""
        return [
            each["code"]
            for each in self.json["findings"]
            if re.search(pattern, f"{each['code']} {each['text']}", re.IGNORECASE)
        ]

    def lacks(self, pattern: str) -> bool:
        """Tell whether a pattern is in a reason why some metric is null."""
        reasons = set(self.json["null_because"].values())
        return any(re.search(pattern, each, re.IGNORECASE) for each in reasons)

    def warnings(self) -> list[str]:
        """Return codes of all findings that are more than notes."""
        return [each["code"] for each in self.json["findings"] if each["severity"] != "note"]


def _foot_topics(recording: Recording) -> Mapping[str, str] | None:
    """Name the feet of which one or two have wrench topics, which are not found by name."""
    feet = recording.robot.feet
    if recording.sensors or recording.kind != "wrench" or len(feet) > 2:
        return None
    return {name: recording.robot.topic(foot) for foot, name in enumerate(feet)}


def outcome(recording: Recording, folder: Path) -> Outcome:
    """Write a recording into a log, and measure that."""
    path = write_log(recording, folder / "log.mcap")
    options = {"mass": recording.robot.mass_kg, "foot": _foot_topics(recording)}
    found = measured_log(path, MeasureOptions(**{**options, **recording.given}))
    path.unlink()
    return found


def measured_log(path: Path, topics: MeasureOptions | None = None) -> Outcome:
    """Measure a log."""
    measured = measure(path, topics or MeasureOptions())
    quality = quality_of(measured)
    return Outcome(
        stats_json(measured),
        headline(measured.metrics),
        quality.word,
        quality.line,
    )


def nearest(values: Floats, to: Floats) -> Floats:
    """(n,) the nearest of some values to each of n others; infinite where there are none."""
    known = np.append(values, np.inf)
    return np.asarray(known[np.abs(known - to[:, None]).argmin(axis=1)])
