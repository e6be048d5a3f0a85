"""A walk has the same figures in every container, however it is cut into chunks, and read."""

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest
from rosbags.rosbag2.enums import StoragePlugin

from dogbot_logtool.commands.stats import measure
from dogbot_logtool.pipeline.measuring.plan import make_plan
from dogbot_logtool.pipeline.options import StatsOptions
from dogbot_logtool.pipeline.topics.annotated import open_recorded
from dogbot_logtool.reader.recording import read_recording
from dogbot_logtool.reader.workers import Start
from dogbot_logtool.report.documents.stats_json import stats_json
from tests.oracles.repacked import Recorded, read_bag, write_bag, write_mcap, write_rosbag2
from tests.paths import SAMPLE_LOGS

TROT: Final = SAMPLE_LOGS / "dogbot_trot.bag"
recorded = cache(read_bag)


def figures(path: Path, jobs: int = 1) -> dict[str, Any]:
    found = measure(path, StatsOptions(jobs=jobs))
    document: dict[str, Any] = stats_json(found)
    del document["log"]
    kept = [each for each in document["findings"] if each["code"] != "N_OUT_OF_ORDER"]
    return {**document, "findings": kept}


@cache
def expected() -> dict[str, Any]:
    return figures(TROT)


def out_of_order() -> Recorded:
    return recorded(TROT).out_of_order()


WRITERS: Final[dict[str, Callable[[Path], Path]]] = {
    "bag": lambda folder: write_bag(folder / "x.bag", recorded(TROT), "", 10_000),
    "bag lz4": lambda folder: write_bag(folder / "x.bag", recorded(TROT), "lz4", 768 << 10),
    "bag bz2": lambda folder: write_bag(folder / "x.bag", recorded(TROT), "bz2", 10_000_000),
    "bag out of order": lambda folder: write_bag(folder / "x.bag", out_of_order(), "", 20_000),
    "mcap ros1": lambda folder: write_mcap(folder / "x.mcap", recorded(TROT), "ros1", 10_000),
    "mcap ros2": lambda folder: write_mcap(folder / "x.mcap", recorded(TROT), "ros2", 10_000_000),
    "mcap out of order": lambda folder: write_mcap(
        folder / "x.mcap", out_of_order(), "ros2", 20_000
    ),
    "rosbag2 mcap": lambda folder: write_rosbag2(folder / "x", recorded(TROT), StoragePlugin.MCAP),
    "rosbag2 sqlite": lambda folder: write_rosbag2(
        folder / "x", recorded(TROT), StoragePlugin.SQLITE3
    ),
}


@pytest.mark.parametrize("written", WRITERS)
def test_every_container_and_chunking_gives_the_same_figures(tmp_path: Path, written: str) -> None:
    assert figures(WRITERS[written](tmp_path)) == expected()


@pytest.mark.parametrize("jobs", [2, 5])
def test_any_number_of_processes_gives_the_same_figures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, jobs: int
) -> None:
    monkeypatch.setattr("dogbot_logtool.reader.containers.log.BATCH_SIZE", 300_000)
    log = write_mcap(tmp_path / "x.mcap", recorded(TROT), "ros1", 100_000)
    assert figures(log, jobs) == expected()


@pytest.mark.parametrize("start", ["fork", "spawn", "threads"])
def test_however_processes_start_they_read_the_same(
    monkeypatch: pytest.MonkeyPatch, start: Start
) -> None:
    monkeypatch.setattr("dogbot_logtool.reader.containers.log.BATCH_SIZE", 2_000_000)
    log = open_recorded(TROT)
    try:
        wanted = make_plan(log, StatsOptions()).wanted
        alone = read_recording(log, wanted, 1).recording
        together = read_recording(log, wanted, 2, start=start).recording
    finally:
        log.close()
    for one, other in zip(alone.feet, together.feet, strict=True):
        for name in ("foot", "log_time", "stamp", "force", "position", "normal"):
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    np.testing.assert_array_equal(alone.base.position, together.base.position)
    assert alone.topics.keys() == together.topics.keys()
    assert alone.links == together.links
