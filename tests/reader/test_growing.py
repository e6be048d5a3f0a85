"""Columns that grow are those that were added, in memory and in a file."""

from pathlib import Path

import numpy as np
import pytest

from dogbot_logtool.commands.stats import measure
from dogbot_logtool.core.contact.contacts import Samples, no_samples
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.reader import recording
from dogbot_logtool.reader.growing import GrowingColumns
from dogbot_logtool.report.documents import stats_json
from tests.paths import SAMPLE_LOGS
from tests.truth.core_columns import foot_samples
from tests.truth.walking import Walk


@pytest.mark.parametrize("on_disk", [False, True])
@pytest.mark.parametrize("size", [1, 7, 400, 10_000])
def test_parts_are_joined_in_order(size: int, *, on_disk: bool) -> None:
    samples = foot_samples(Walk(seconds=2.0).recorded(), 0)
    columns = GrowingColumns[Samples](on_disk=on_disk)
    count = len(samples.log_time)
    for first in range(0, count, size):
        columns.add(samples.pick(np.arange(first, min(first + size, count))))
    joined = columns.finish(no_samples())
    for name in ("log_time", "stamp", "force", "in_contact", "position"):
        np.testing.assert_array_equal(getattr(joined, name), getattr(samples, name))


@pytest.mark.parametrize("on_disk", [False, True])
def test_columns_without_rows_are_empty(*, on_disk: bool) -> None:
    nothing = no_samples()
    columns = GrowingColumns[Samples](on_disk=on_disk)
    assert columns.finish(nothing) is nothing
    columns.add(nothing)
    assert columns.finish(nothing).force.shape == (0, 3)


@pytest.mark.parametrize("name", ["dogbot_walk.mcap", "dogbot_troubled.bag"])
def test_a_walk_in_a_file_has_the_same_figures(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, name: str
) -> None:
    in_memory = figures(SAMPLE_LOGS / name)
    monkeypatch.setattr(recording, "LARGEST_IN_MEMORY", 100_000)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    assert figures(SAMPLE_LOGS / name) == in_memory
    assert not list(tmp_path.iterdir())


def figures(path: Path) -> object:
    found = measure(path, MeasureOptions())
    return stats_json(found)
