"""A recording is the same in every container, and as columns; the page lists all kinds."""

import csv
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.analysed import feet_of
from tests.truth import core_columns, sensor_faults, time_faults
from tests.truth.cases import all_cases
from tests.truth.log_file import write_log
from tests.truth.outcome import measured_log
from tests.truth.recording import Recording, disturbed
from tests.truth.validate import TABLE
from tests.truth.walking import Walk

KINDS: dict[str, Callable[[], Recording]] = {
    "bumpers": lambda: Walk().recorded(200.0),
    "new Gazebo": lambda: disturbed(Walk().recorded(200.0), time_faults.silent_in_swing),
    "force sensors": lambda: disturbed(Walk().recorded(200.0), sensor_faults.as_force_sensors),
    "link frames": lambda: disturbed(Walk().recorded(200.0), sensor_faults.in_link_frame),
}


@pytest.mark.parametrize("record", KINDS.values(), ids=KINDS)
def test_bags_and_mcaps_hold_the_same(record: Callable[[], Recording], tmp_path: Path) -> None:
    recording = record()
    logs = [write_log(recording, tmp_path / name) for name in ("log.bag", "log.mcap")]
    bag, mcap = (measured_log(log).json for log in logs)
    assert bag["feet"] == mcap["feet"]
    assert bag["base"] == mcap["base"]
    assert bag["log"]["messages"] == mcap["log"]["messages"] > 5000


def test_columns_are_what_the_log_holds(tmp_path: Path) -> None:
    recording = Walk().recorded(200.0)
    log = measured_log(write_log(recording, tmp_path / "log.mcap"))
    stats = core_columns.measure(recording)
    for foot, measured in zip(stats.feet, feet_of(stats), strict=True):
        found = log.figure(f"feet.{foot.name}.touchdown_s")
        assert stats.seconds(foot.touchdown) == pytest.approx(found, abs=1e-6)
        assert measured.duty_factor is not None
        assert measured.duty_factor.mean == pytest.approx(
            log.figure(f"feet.{foot.name}.duty_factor.mean"), abs=1e-6
        )
    assert stats.loads.vertical_impulse_over_weight == pytest.approx(1.0, abs=0.01)


def test_the_table_has_every_kind() -> None:
    with TABLE.open(encoding="utf-8") as file:
        names = {row["log"] for row in csv.DictReader(file)}
    missing = [case.name for case in all_cases() if case.name not in names]
    assert missing == [], "run: make validate"
