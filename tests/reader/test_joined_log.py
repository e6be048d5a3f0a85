"""One recording in several files, and in files out of order: the results of one in order."""

import random
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any, Final

import pytest
from mcap.reader import make_reader

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.reader.containers import log
from dogbot_logtool.report.documents import stats_json
from tests.oracles import walks

KIND: Final = "gazebo_msgs/msg/ContactsState"
Entries = Sequence[walks.Entry]


@cache
def recorded(ros: int) -> Entries:
    return list(walks.messages(ros, KIND))


def whole(entries: Entries) -> list[Entries]:
    return [entries]


def in_thirds(entries: Entries) -> list[Entries]:
    size = len(entries) // 3
    return [entries[:size], entries[size : 2 * size], entries[2 * size :]]


def by_sensor(entries: Entries) -> list[Entries]:
    """One file a topic: each reaches over the whole time."""
    topics = {entry.topic: [e for e in entries if e.topic == entry.topic] for entry in entries}
    return [*topics.values()]


def by_sensor_late_first(entries: Entries) -> list[Entries]:
    """The same, and a file that is named first begins last."""
    half = len(entries) // 2
    return [*by_sensor(entries[half:]), *by_sensor(entries[:half])]


def late_by_chance(entries: Entries) -> list[Entries]:
    """Each is written up to 0.2 s after it was received."""
    chance = random.Random(1)  # noqa: S311 - no secret
    return [sorted(entries, key=lambda entry: entry.log_time + chance.uniform(0.0, 2e8))]


def from_both_ends(entries: Entries) -> list[Entries]:
    """First and last, second and last but one ...: all chunks overlap."""
    mixed = [entry for pair in zip(entries, entries[::-1], strict=True) for entry in pair]
    return [mixed[: len(entries)]]


JOINED: Final = (in_thirds, by_sensor, by_sensor_late_first)
OUT_OF_ORDER: Final = (late_by_chance, from_both_ends)


def write(folder: Path, ros: int, parts: list[Entries]) -> list[Path]:
    """Write each part into a file with many small chunks."""
    paths = []
    for number, entries in enumerate(parts):
        (folder / f"part_{number}").mkdir(exist_ok=True)
        paths.append(walks.write_log(folder / f"part_{number}", walks.Walk(ros), entries, 20_000))
    return paths


def figures(paths: list[Path]) -> dict[str, Any]:
    found = stats_json(measure(paths[0], MeasureOptions(joined=tuple(paths[1:]), jobs=1)))
    del found["log"]["path"], found["log"]["container"]
    return found


figures_of_whole = cache(lambda folder, ros: figures(write(folder, ros, whole(recorded(ros)))))


@pytest.mark.parametrize("arranged", [*JOINED, *OUT_OF_ORDER])
@pytest.mark.parametrize("ros", [1, 2])
def test_the_figures_are_those_of_one_file_in_order(
    tmp_path: Path,
    tmp_path_factory: pytest.TempPathFactory,
    monkeypatch: pytest.MonkeyPatch,
    ros: int,
    arranged: Callable[[Entries], list[Entries]],
) -> None:
    expected = figures_of_whole(tmp_path_factory.getbasetemp(), ros)
    assert expected["gait"]["name"] == "trot"
    paths = write(tmp_path, ros, arranged(recorded(ros)))
    # Then many spans, over which long chunks reach.
    for batch_size in (log.BATCH_SIZE, 30_000):
        monkeypatch.setattr(log, "BATCH_SIZE", batch_size)
        found = figures(paths)
        kept = [each for each in found["findings"] if each["code"] != "OUT_OF_ORDER"]
        assert len(found["findings"]) - len(kept) == (arranged in OUT_OF_ORDER)
        assert {**found, "findings": kept} == expected


def messages(path: Path) -> list[tuple[int, str, bytes]]:
    with path.open("rb") as file:
        read = make_reader(file).iter_messages(log_time_order=False)
        return [(m.log_time, c.topic, m.data) for _, c, m in read if {*c.metadata} <= {"callerid"}]


@pytest.mark.parametrize("arranged", [by_sensor, late_by_chance])
def test_the_output_has_every_message_once(
    tmp_path: Path, arranged: Callable[[Entries], list[Entries]]
) -> None:
    parts = arranged(recorded(2))
    paths = write(tmp_path, 2, parts)
    convert(paths[0], tmp_path / "out.mcap", ConvertOptions(joined=tuple(paths[1:])))
    copied = messages(tmp_path / "out.mcap")
    if len(parts) == 1:
        assert copied == messages(paths[0])
    assert sorted(copied) == sorted((e.log_time, e.topic, e.data) for e in recorded(2))
