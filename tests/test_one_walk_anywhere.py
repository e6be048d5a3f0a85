"""A walk is measured and drawn alike in every container, however it is cut, and by any workers."""

from collections.abc import Callable
from functools import cache
from itertools import cycle
from pathlib import Path
from typing import Any, Final

import pytest
from rosbags.rosbag2.enums import StoragePlugin

import dogbot_logtool as dl
from dogbot_logtool.reader.workers import Start
from dogbot_logtool.writer.encodings.registry import ENCODINGS
from tests.oracles.annotated_file import read_written
from tests.oracles.recorded import out_of_order, unpacked
from tests.oracles.small_logs import first_seconds
from tests.oracles.walks import Entry, Walk, write_bag, write_mcap, write_rosbag2
from tests.paths import TROT

Walked = tuple[Walk, list[Entry]]


@cache
def trot() -> Path:
    return first_seconds(TROT, 4.0)


def messages(ros: int) -> Walked:
    return unpacked(trot(), ros)


def figures(path: Path, jobs: int = 1) -> dict[str, Any]:
    document = dl.measure(path, jobs=jobs).stats
    del document["log"]
    kept = [each for each in document["findings"] if each["code"] != "OUT_OF_ORDER"]
    return {**document, "findings": kept}


@cache
def expected() -> dict[str, Any]:
    return figures(trot())


def disordered(ros: int) -> Walked:
    walk, entries = messages(ros)
    return walk, out_of_order(entries)


WRITERS: Final[dict[str, Callable[[Path], Path]]] = {
    "bag lz4": lambda path: write_bag(path, *messages(1), 768 << 10, "lz4"),
    "bag out of order": lambda path: write_bag(path, *disordered(1), 20_000),
    "mcap ros1": lambda path: write_mcap(path, *messages(1), 10_000),
    "mcap ros2": lambda path: write_mcap(path, *messages(2), 10_000_000),
    "mcap out of order": lambda path: write_mcap(path, *disordered(2), 20_000),
    "rosbag2 mcap": lambda path: write_rosbag2(path, *messages(2), StoragePlugin.MCAP),
    "rosbag2 sqlite": lambda path: write_rosbag2(path, *messages(2), StoragePlugin.SQLITE3),
}


# --- Annotations ----------------------------------------------------------------------------------

Annotation = tuple[str, int, int, bytes]
"""Topic, log time and publish time, ns, and payload."""


def annotations(folder: Path, log: Path, encoding: str, jobs: int = 1) -> list[Annotation]:
    """Every message that is added to a log."""
    target = folder / "annotated.mcap"
    dl.convert(log, target, encoding=encoding, copy=False, jobs=jobs, overwrite=True)
    written = read_written(target)
    return sorted(
        (written.channels[each.channel_id].topic, each.log_time, each.publish_time, each.data)
        for each in written.messages
    )


@pytest.fixture(scope="module")
def expected_annotations(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[Annotation]]:
    folder = tmp_path_factory.mktemp("expected")
    return {encoding: annotations(folder, trot(), encoding) for encoding in ENCODINGS}


@pytest.mark.parametrize(("written", "encoding"), [*zip(WRITERS, cycle(ENCODINGS))])
def test_every_container_and_chunking_gives_the_same_figures_and_annotations(
    tmp_path: Path,
    expected_annotations: dict[str, list[Annotation]],
    written: str,
    encoding: str,
) -> None:
    log = WRITERS[written](tmp_path / "log")
    assert figures(log) == expected()
    assert annotations(tmp_path, log, encoding) == expected_annotations[encoding]


@pytest.mark.parametrize(("jobs", "start"), [(5, "fork"), (2, "spawn"), (5, "threads")])
def test_any_workers_give_the_same_figures_and_annotations(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    expected_annotations: dict[str, list[Annotation]],
    jobs: int,
    start: Start,
) -> None:
    monkeypatch.setattr("dogbot_logtool.reader.containers.log.BATCH_SIZE", 300_000)
    monkeypatch.setattr("dogbot_logtool.conversion.annotate.SPAN_ROWS", 1000)
    monkeypatch.setattr("dogbot_logtool.reader.workers.start_method", lambda _log: start)
    log = write_mcap(tmp_path / "x.mcap", *messages(1), 100_000)
    assert figures(log, jobs) == expected()
    assert annotations(tmp_path, log, "foxglove", jobs) == expected_annotations["foxglove"]
