"""A recording is the same in every container, and as columns; the page lists all kinds."""

import csv
from collections.abc import Callable
from pathlib import Path

import pytest
from mcap.reader import make_reader

from tests.analysed import feet_of
from tests.oracles.mcap_file import write_mcap
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


@pytest.mark.parametrize("compression", ["", "zstd"])
def test_the_library_of_mcap_reads_what_was_written(compression: str, tmp_path: Path) -> None:
    entries = [
        (
            10**9 + 1_000 * (row // 2),
            f"/{'ab'[row % 2]}",
            f"std_msgs/msg/{'AB'[row % 2]}",
            bytes([row] * row),
        )
        for row in range(100)
    ]
    path = write_mcap(tmp_path / "log.mcap", entries, str.lower, 500, compression)
    with path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        read = list(reader.iter_messages(log_time_order=False))
        summary = reader.get_summary()
    assert [(m.log_time, c.topic, s and s.name, m.data) for s, c, m in read] == entries
    assert {s.data for s, _, _ in read if s} == {b"std_msgs/msg/a", b"std_msgs/msg/b"}
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_count == 100
    assert summary.statistics.chunk_count == len(summary.chunk_indexes) > 5
    assert sorted(summary.statistics.channel_message_counts.values()) == [50, 50]


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
