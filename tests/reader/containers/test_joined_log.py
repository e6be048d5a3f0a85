"""Files of one recording, joined: the same results as of the recording in one file."""

import random
import tempfile
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.option import part_of
from dogbot_logtool.options import ConvertOptions, MeasureOptions
from dogbot_logtool.reader.containers import log
from dogbot_logtool.report.documents import stats_json
from tests.oracles import walks

KIND = "gazebo_msgs/msg/ContactsState"


def in_thirds(entry: walks.Entry) -> str:
    return f"part_{(entry.log_time - walks.START) * 3 // (walks.SAMPLES * walks.STEP)}"


def by_sensor(entry: walks.Entry) -> str:
    """One file a topic: each reaches over the whole time."""
    return entry.topic.strip("/").replace("/", "_")


def by_sensor_late_first(entry: walks.Entry) -> str:
    """The same, and a file that is named first begins last."""
    late = entry.log_time - walks.START > walks.SAMPLES * walks.STEP // 2
    return f"{'a' if late else 'b'}_{by_sensor(entry)}"


def write(folder: Path, ros: int, part: Callable[[walks.Entry], str]) -> list[Path]:
    """Write the walk into several files, with many small chunks."""
    parts: dict[str, list[walks.Entry]] = {}
    for entry in walks.messages(ros, KIND):
        parts.setdefault(part(entry), []).append(entry)
    return sorted(write_file(folder, ros, name, entries) for name, entries in parts.items())


def write_file(folder: Path, ros: int, name: str, entries: list[walks.Entry]) -> Path:
    walk = walks.Walk(ros)
    if ros == 1:
        walks.write_bag(folder / f"{name}.bag", walk, entries)
        return folder / f"{name}.bag"
    walks.write_mcap(folder / f"{name}.mcap", walk, entries, chunk_size=20_000)
    return folder / f"{name}.mcap"


def figures(paths: list[Path]) -> dict[str, Any]:
    topics = MeasureOptions(joined=tuple(paths[1:]))
    done = measure(paths[0], replace(topics, jobs=1))
    found = stats_json(done)
    del found["log"]["path"], found["log"]["container"]
    return found


@cache
def figures_of_whole(ros: int) -> dict[str, Any]:
    """Figures of the walk in one file, measured once."""
    with tempfile.TemporaryDirectory() as folder:
        return figures(write(Path(folder), ros, lambda _: "whole"))


def recorded(path: Path) -> list[tuple[int, str, bytes]]:
    with path.open("rb") as file:
        messages = make_reader(file).iter_messages(log_time_order=False)
        found = [(m.log_time, c.topic, m.data) for _, c, m in messages if not c.metadata]
    return sorted(found)


@pytest.mark.parametrize("part", [in_thirds, by_sensor, by_sensor_late_first])
@pytest.mark.parametrize("ros", [1, 2])
def test_joined_files_give_the_figures_of_the_whole(
    tmp_path: Path,
    ros: int,
    part: Callable[[walks.Entry], str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole = figures_of_whole(ros)
    assert whole["gait"]["name"] == "trot"
    paths = write(tmp_path, ros, part)
    assert figures(paths) == whole
    # Many spans, over which long chunks reach.
    monkeypatch.setattr(log, "BATCH_SIZE", 30_000)
    assert figures(paths) == whole


def later_half_first(entries: list[walks.Entry]) -> list[walks.Entry]:
    return entries[len(entries) // 2 :] + entries[: len(entries) // 2]


def backwards(entries: list[walks.Entry]) -> list[walks.Entry]:
    return entries[::-1]


def late_by_chance(entries: list[walks.Entry]) -> list[walks.Entry]:
    """Each is written up to 0.2 s after it was received."""
    chance = random.Random(1)  # noqa: S311 - no secret
    return sorted(entries, key=lambda entry: entry.log_time + chance.uniform(0.0, 2e8))


def from_both_ends(entries: list[walks.Entry]) -> list[walks.Entry]:
    """First and last, second and last but one ...: all chunks overlap."""
    mixed = [entry for pair in zip(entries, entries[::-1], strict=True) for entry in pair]
    return mixed[: len(entries)]


@pytest.mark.parametrize("order", [later_half_first, backwards, late_by_chance, from_both_ends])
@pytest.mark.parametrize("ros", [1, 2])
@pytest.mark.parametrize("batch_size", [None, 50_000])
def test_a_file_out_of_order_gives_the_figures_of_one_in_order(
    tmp_path: Path,
    ros: int,
    order: Callable[[list[walks.Entry]], list[walks.Entry]],
    batch_size: int | None,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    if batch_size is not None:
        monkeypatch.setattr(log, "BATCH_SIZE", batch_size)
    entries = order(list(walks.messages(ros, KIND)))
    found = figures([write_file(tmp_path, ros, "mixed", entries)])
    notes = [each for each in found["findings"] if each["code"] == "OUT_OF_ORDER"]
    assert len(notes) == 1
    found["findings"].remove(notes[0])
    assert found == figures_of_whole(ros)


def test_messages_out_of_order_are_copied_where_they_stand(tmp_path: Path) -> None:
    entries = list(walks.messages(2, KIND))
    entries[50:60] = entries[59:49:-1]
    path = write_file(tmp_path, 2, "mixed", entries)
    done = convert(path, tmp_path / "out.mcap", ConvertOptions())
    assert [f.code for f in done.findings].count("OUT_OF_ORDER") == 1
    with (tmp_path / "out.mcap").open("rb") as file:
        copied = make_reader(file).iter_messages(log_time_order=False)
        assert [m.data for _, c, m in copied if not c.metadata] == [e.data for e in entries]


def test_the_joined_output_has_every_message_once(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    paths = write(tmp_path / "parts", 2, by_sensor)
    topics = MeasureOptions(joined=tuple(paths[1:]))
    convert(paths[0], tmp_path / "out.mcap", part_of(topics, ConvertOptions))
    expected = sorted(message for path in paths for message in recorded(path))
    assert recorded(tmp_path / "out.mcap") == expected
