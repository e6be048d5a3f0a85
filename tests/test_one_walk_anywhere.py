"""A walk is measured and drawn alike in every container, however it is cut, and by any workers."""

from collections import Counter
from collections.abc import Callable, Sequence
from functools import cache
from itertools import cycle, islice
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


Log = Path | Sequence[Path]
"""A file, or several that are one recording."""


def is_joined(log: Log) -> bool:
    return not isinstance(log, Path)


def figures(log: Log, jobs: int = 1) -> dict[str, Any]:
    document = dl.measure(log, jobs=jobs, join=is_joined(log)).stats
    for key in ("path", "container", "profile"):
        del document["log"][key]
    kept = [each for each in document["findings"] if each["code"] != "OUT_OF_ORDER"]
    return {**document, "findings": kept}


@cache
def expected() -> dict[str, Any]:
    return figures(trot())


def disordered(ros: int) -> Walked:
    walk, entries = messages(ros)
    return walk, out_of_order(entries)


def thirds(entries: list[Entry]) -> list[list[Entry]]:
    size = len(entries) // 3
    return [entries[:size], entries[size : 2 * size], entries[2 * size :]]


def by_topic(entries: list[Entry]) -> list[list[Entry]]:
    """Each part reaches over the whole time."""
    topics = dict.fromkeys(entry.topic for entry in entries)
    return [[entry for entry in entries if entry.topic == topic] for topic in topics]


def late_first(entries: list[Entry]) -> list[list[Entry]]:
    """By topics, and the part that is named first begins last."""
    half = len(entries) // 2
    return [*by_topic(entries[half:]), *by_topic(entries[:half])]


def from_both_ends(entries: list[Entry]) -> list[list[Entry]]:
    """First and last, second and last but one ...: all chunks overlap."""
    mixed = (entry for pair in zip(entries, entries[::-1], strict=True) for entry in pair)
    return [[*islice(mixed, len(entries))]]


def write_parts(
    path: Path, ros: int, cut: Callable[[list[Entry]], list[list[Entry]]]
) -> list[Path]:
    walk, entries = messages(ros)
    path.mkdir()
    parts = enumerate(cut(entries))
    write = write_bag if ros == 1 else write_mcap
    return [write(path / str(number), walk, part, 20_000) for number, part in parts]


WRITERS: Final[dict[str, Callable[[Path], Log]]] = {
    "bag lz4": lambda path: write_bag(path, *messages(1), 768 << 10, "lz4"),
    "bag out of order": lambda path: write_bag(path, *disordered(1), 20_000),
    "mcap ros1": lambda path: write_mcap(path, *messages(1), 10_000),
    "mcap ros2": lambda path: write_mcap(path, *messages(2), 10_000_000),
    "mcap out of order": lambda path: write_mcap(path, *disordered(2), 20_000),
    "rosbag2 mcap": lambda path: write_rosbag2(path, *messages(2), StoragePlugin.MCAP),
    "bag from both ends": lambda path: write_parts(path, 1, from_both_ends)[0],
    "mcaps in thirds": lambda path: write_parts(path, 2, thirds),
    "bags by topic": lambda path: write_parts(path, 1, by_topic),
    "mcaps by topic, late first": lambda path: write_parts(path, 2, late_first),
    "rosbag2 sqlite": lambda path: write_rosbag2(path, *messages(2), StoragePlugin.SQLITE3),
}


# --- Annotations ----------------------------------------------------------------------------------

Annotation = tuple[str, int, int, bytes]
"""Topic, log time and publish time, ns, and payload."""


def annotations(
    folder: Path, log: Log, encoding: str, jobs: int = 1, *, copy: bool = False
) -> list[Annotation]:
    """Every message that is added to a log, or stands in it, too."""
    target, join = folder / "annotated.mcap", is_joined(log)
    dl.convert(log, target, encoding=encoding, copy=copy, jobs=jobs, overwrite=True, join=join)
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
    monkeypatch: pytest.MonkeyPatch,
    expected_annotations: dict[str, list[Annotation]],
    written: str,
    encoding: str,
) -> None:
    log = WRITERS[written](tmp_path / "log")
    if is_joined(log) or written.endswith("order"):  # Long chunks reach over many spans.
        monkeypatch.setattr("dogbot_logtool.reader.containers.log.BATCH_SIZE", 150_000)
    assert figures(log) == expected()
    assert annotations(tmp_path, log, encoding) == expected_annotations[encoding]


@pytest.mark.parametrize("written", ["mcap out of order", "mcaps by topic, late first"])
def test_every_message_is_copied_once(
    tmp_path: Path, expected_annotations: dict[str, list[Annotation]], written: str
) -> None:
    found = annotations(tmp_path, WRITERS[written](tmp_path / "log"), "ros2", copy=True)
    copied = [(topic, at, data) for topic, at, _, data in found]
    recorded = [(entry.topic, entry.log_time, entry.data) for entry in messages(2)[1]]
    assert Counter(copied) >= Counter(recorded)
    assert len(copied) == len(recorded) + len(expected_annotations["ros2"])


@pytest.mark.parametrize(("jobs", "start"), [(5, "fork"), (2, "spawn"), (5, "threads")])
def test_any_workers_give_the_same_figures_and_annotations(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    expected_annotations: dict[str, list[Annotation]],
    jobs: int,
    start: Start,
) -> None:
    """Nor do columns that grow in a file, as large ones do."""
    monkeypatch.setattr("dogbot_logtool.reader.recording.LARGEST_IN_MEMORY", 1000)
    monkeypatch.setattr("dogbot_logtool.reader.containers.log.BATCH_SIZE", 300_000)
    monkeypatch.setattr("dogbot_logtool.conversion.annotate.SPAN_ROWS", 1000)
    monkeypatch.setattr("dogbot_logtool.reader.workers.start_method", lambda _log: start)
    log = write_mcap(tmp_path / "x.mcap", *messages(1), 100_000)
    assert figures(log, jobs) == expected()
    assert annotations(tmp_path, log, "foxglove", jobs) == expected_annotations["foxglove"]
