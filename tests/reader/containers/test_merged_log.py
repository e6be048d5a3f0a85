"""Files of one recording, merged: the same results as of the recording in one file."""

import random
import tempfile
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from mcap import records
from mcap.reader import make_reader
from mcap.writer import Writer

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.option import part_of
from dogbot_logtool.options import ConvertOptions, MeasureOptions
from dogbot_logtool.reader import opening
from dogbot_logtool.reader.containers import log, merged_log
from dogbot_logtool.reader.containers.mcap.records import read_extra
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
    # Many windows of time, over which long chunks reach.
    monkeypatch.setattr(merged_log, "BATCH_SIZE", 30_000)
    assert figures(paths) == whole


def later_half_first(entries: list[walks.Entry]) -> list[walks.Entry]:
    return entries[len(entries) // 2 :] + entries[: len(entries) // 2]


def backwards(entries: list[walks.Entry]) -> list[walks.Entry]:
    return entries[::-1]


def late_by_chance(entries: list[walks.Entry]) -> list[walks.Entry]:
    """Each is written up to 0.2 s after it was received."""
    chance = random.Random(1)  # noqa: S311 - no secret
    return sorted(entries, key=lambda entry: entry.log_time + chance.uniform(0.0, 2e8))


@pytest.mark.parametrize("order", [later_half_first, backwards, late_by_chance])
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
        for module in (log, merged_log):
            monkeypatch.setattr(module, "BATCH_SIZE", batch_size)
    entries = order(list(walks.messages(ros, KIND)))
    found = figures([write_file(tmp_path, ros, "mixed", entries)])
    notes = [each for each in found["findings"] if each["code"] == "OUT_OF_ORDER"]
    assert len(notes) == 1
    found["findings"].remove(notes[0])
    assert found == figures_of_whole(ros)


def test_few_messages_out_of_order_are_copied_where_they_stand(tmp_path: Path) -> None:
    entries = list(walks.messages(2, KIND))
    entries[50:60] = entries[59:49:-1]
    path = write_file(tmp_path, 2, "mixed", entries)
    done = convert(path, tmp_path / "out.mcap", ConvertOptions())
    assert [f.code for f in done.findings].count("OUT_OF_ORDER") == 1
    with (tmp_path / "out.mcap").open("rb") as file:
        copied = make_reader(file).iter_messages(log_time_order=False)
        assert [m.data for _, c, m in copied if not c.metadata] == [e.data for e in entries]


def test_a_file_out_of_order_keeps_its_channels_and_records(tmp_path: Path) -> None:
    """Also two senders on one topic, which are one channel of several files."""
    path = tmp_path / "mixed.mcap"
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=100)
        writer.start("ros1")
        writer.add_metadata("notes", {"robot": "walks"})
        schema = writer.register_schema("std_msgs/String", "ros1msg", b"string data")
        senders = [
            writer.register_channel("/words", "ros1", schema, {"callerid": name}) for name in "ab"
        ]
        for second in (8, 9, 1, 2):
            for number in senders:
                writer.add_message(number, second * 10**9, bytes(80), second * 10**9)
        writer.finish()
    with closing(opening.open_joined([path])) as opened, closing(opening.open_log(path)) as whole:
        assert opened.is_reordered
        assert opened.channels == whole.channels
        assert opened.container == whole.container
        (notes,) = opened.extras
        found = read_extra(notes)
        assert found is not None
        assert found[1] == records.Metadata("notes", {"robot": "walks"})
        (span,) = opened.spans()
        times = (opened.read(span).messages.log_time / 1e9).tolist()
        assert times == [1, 1, 2, 2, 8, 8, 9, 9]


def test_damage_in_a_file_out_of_order_is_said_as_in_any_other(tmp_path: Path) -> None:
    path = write_file(tmp_path, 2, "mixed", later_half_first(list(walks.messages(2, KIND))))
    data = bytearray(path.read_bytes())
    with closing(opening.open_joined([path])) as sound:
        assert sound.is_reordered
    with closing(opening.open_log(path)) as whole:
        third = whole.chunks[2]
    data[third.data_offset + 100] ^= 0xFF
    path.write_bytes(data)
    with closing(opening.open_joined([path])) as opened, closing(opening.open_log(path)) as whole:
        losses = [loss for span in opened.spans() for loss in opened.read(span).losses]
        assert losses == list(whole.read((third,)).losses) != []


def test_chunks_that_all_overlap_are_read_as_they_stand(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Messages from first and last, second and last but one ...: memory would grow with the log."""
    monkeypatch.setattr(opening, "_MOST_AT_ONCE", 100_000)
    entries = list(walks.messages(2, KIND))
    mixed = [e for pair in zip(entries, entries[::-1], strict=True) for e in pair][: len(entries)]
    path = write_file(tmp_path, 2, "mixed", mixed)
    with closing(opening.open_joined([path])) as opened:
        assert not opened.is_in_order()
        assert not opened.is_reordered


def test_the_joined_output_has_every_message_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(merged_log, "BATCH_SIZE", 30_000)
    (tmp_path / "parts").mkdir()
    paths = write(tmp_path / "parts", 2, by_sensor)
    topics = MeasureOptions(joined=tuple(paths[1:]))
    convert(paths[0], tmp_path / "out.mcap", part_of(topics, ConvertOptions))
    expected = sorted(message for path in paths for message in recorded(path))
    assert recorded(tmp_path / "out.mcap") == expected
