"""Columns that are too large for memory lie in a file."""

from pathlib import Path

import pytest

from dogbot_logtool.commands.stats import measure
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.reader import recording
from dogbot_logtool.report.documents import stats_json
from tests.paths import SAMPLE_LOGS


@pytest.mark.parametrize("name", ["dogbot_walk.mcap", "dogbot_troubled.bag"])
def test_a_walk_in_a_file_has_the_same_figures(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, name: str
) -> None:
    in_memory = figures(SAMPLE_LOGS / name)
    monkeypatch.setattr(recording, "LARGEST_IN_MEMORY", 1000)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    assert figures(SAMPLE_LOGS / name) == in_memory
    assert not list(tmp_path.iterdir())


def figures(path: Path) -> object:
    found = measure(path, MeasureOptions())
    return stats_json(found)
