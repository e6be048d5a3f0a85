"""ROS 2 bags as rosbags writes them, and as recorders and their crashes leave them."""

import random
import shutil
import sqlite3
from itertools import islice
from pathlib import Path

import pytest
import zstandard
from rosbags.rosbag2 import Writer as Rosbag2Writer
from rosbags.rosbag2.enums import CompressionFormat, CompressionMode, StoragePlugin

from dogbot_logtool.errors import LogError, LogtoolError
from dogbot_logtool.reader.opening import open_log
from tests.oracles.walks import Entry, Walk, write_entries
from tests.reader.mcap_bytes import small_mcap
from tests.reader.mutation import random_mutation
from tests.reader.reading import Read, read_bytes, read_file

PLUGINS = tuple(StoragePlugin)
MODES = (CompressionMode.NONE, CompressionMode.FILE, CompressionMode.MESSAGE)
KIND = "gazebo_msgs/msg/ContactsState"
WALK = Walk(2)
ENTRIES = list(islice(WALK.messages(KIND), 400))


def write(
    path: Path,
    plugin: StoragePlugin = StoragePlugin.SQLITE3,
    mode: CompressionMode = CompressionMode.NONE,
    entries: list[Entry] = ENTRIES,
) -> Path:
    writer = Rosbag2Writer(path, version=9, storage_plugin=plugin)
    if mode is not CompressionMode.NONE:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        write_entries(writer, WALK.store, entries)
    return path


def expected(entries: list[Entry] = ENTRIES) -> list[Read]:
    return [Read(entry.topic, entry.log_time, entry.data) for entry in entries]


def database(path: Path) -> Path:
    (file,) = path.glob("*.db3")
    return file


def change(path: Path, *statements: str) -> None:
    connection = sqlite3.connect(path)
    with connection:
        for statement in statements:
            connection.execute(statement)
    connection.close()


def split(folder: Path, plugin: StoragePlugin) -> Path:
    """Make eleven files without metadata, whose names sort otherwise than their numbers."""
    whole = folder / "whole"
    whole.mkdir()
    for number in range(11):
        run = ENTRIES[number * 40 : (number + 1) * 40]
        part = write(folder / f"part{number}", plugin, entries=run)
        (file,) = [file for file in part.iterdir() if file.name != "metadata.yaml"]
        shutil.copy(file, whole / f"walk_{number}{file.suffix}")
    return whole


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("plugin", PLUGINS)
def test_every_message_comes_out(
    tmp_path: Path, plugin: StoragePlugin, mode: CompressionMode
) -> None:
    reading = read_file(write(tmp_path / "bag", plugin, mode))
    assert list(reading.messages) == expected()
    assert reading.losses == ()
    assert sum(reading.counts.values()) == len(ENTRIES)
    assert reading.times == (ENTRIES[0].log_time, ENTRIES[-1].log_time)
    assert reading.profile == "ros2"


@pytest.mark.parametrize("plugin", PLUGINS)
def test_split_files_are_one_log(tmp_path: Path, plugin: StoragePlugin) -> None:
    whole = split(tmp_path, plugin)
    reading = read_file(whole)
    assert list(reading.messages) == expected()
    assert [loss.messages for loss in reading.losses] == [0]
    assert "metadata.yaml" in reading.sentences
    assert len(reading.topics) == 5


def test_what_a_file_lacks_ends_where_the_next_one_begins(tmp_path: Path) -> None:
    whole = split(tmp_path, StoragePlugin.MCAP)
    first = whole / "walk_0.mcap"
    first.write_bytes(first.read_bytes()[:-2000])
    losses = [loss for loss in read_file(whole).losses if loss.file == first.name]
    assert {loss.end_time for loss in losses} == {ENTRIES[40].log_time}


@pytest.mark.parametrize("column", ["message_definitions", "schema"])
def test_definitions_are_known_where_the_log_has_none(tmp_path: Path, column: str) -> None:
    bag = write(tmp_path / "bag")
    change(database(bag), f"DROP TABLE {column}")
    log = open_log(bag)
    kinds = {channel.type_name: channel.schema for channel in log.channels.values()}
    log.close()
    assert set(kinds) == {"nav_msgs/Odometry", "gazebo_msgs/ContactsState"}
    assert all(schema and b"Header header" in schema.data for schema in kinds.values())


@pytest.mark.parametrize(
    "how", ["DROP TABLE messages", "DROP TABLE topics", "ALTER TABLE messages RENAME data TO raw"]
)
def test_what_only_looks_like_a_bag_is_refused(tmp_path: Path, how: str) -> None:
    bag = write(tmp_path / "bag")
    change(database(bag), how)
    with pytest.raises(LogError, match="ROS 2 bag"):
        open_log(bag)


BOMB = zstandard.ZstdCompressor(level=19).compress(bytes(200 << 20))


@pytest.mark.parametrize(
    "data", [BOMB, zstandard.compress(b"x" * 999)[:-3]], ids=["swells", "cut off"]
)
def test_a_message_that_swells_or_is_cut_off_is_lost(tmp_path: Path, data: bytes) -> None:
    entries = [*ENTRIES[:5], Entry("/odom", "nav_msgs/msg/Odometry", ENTRIES[5].log_time, data)]
    reading = read_file(write(tmp_path / "bag", entries=entries))
    assert list(reading.messages) == expected(ENTRIES[:5])
    assert reading.lost == 1


def test_damage_anywhere_gives_a_sentence_or_losses(tmp_path: Path) -> None:
    data = database(write(tmp_path / "bag")).read_bytes()
    chance = random.Random(7)  # noqa: S311 - no secret
    for number in range(60):
        harmed = data
        for _ in range(1 + number % 20):
            harmed = random_mutation(chance, len(data)).apply(harmed)
        try:
            reading = read_bytes(tmp_path, data[:16] + harmed[16:])
        except LogtoolError as error:
            assert "\n" not in str(error)  # noqa: PT017
            continue
        assert len(reading.messages) <= 2 * len(ENTRIES)


def test_files_that_metadata_does_not_name_are_said(tmp_path: Path) -> None:
    bag = write(tmp_path / "bag")
    data = database(bag).read_bytes()
    (bag / "other_0.db3").write_bytes(data)
    (bag / "other_1.db3.zstd").write_bytes(data)
    # Made by this program, and the same file in another form: neither is missing from the log.
    (bag / "walk.annotated.mcap").write_bytes(small_mcap().build())
    (bag / "bag.db3.zstd").write_bytes(zstandard.compress(data))
    reading = read_file(bag)
    assert list(reading.messages) == expected()
    assert sorted(loss.what for loss in reading.losses) == [
        "metadata.yaml does not name other_0.db3, so it was left out",
        "metadata.yaml does not name other_1.db3.zstd, so it was left out",
    ]
    assert reading.lost is None


YAML_BOMB = "".join(
    f"a{n}: &a{n} [{', '.join([f'*a{n - 1}' if n else 'x'] * 10)}]\n" for n in range(9)
)


def metadata(*files: str, count: int | None = None) -> str:
    names = "".join(f"    - {file}\n" for file in files)
    # The counts of single files stand deeper.
    others = "  files:\n    - path: gone.db3\n      message_count: 70\n"
    total = "" if count is None else f"  message_count: {count}\n"
    return f"rosbag2_bagfile_information:\n  relative_file_paths:\n{names}{others}{total}"


COUNTS = "metadata.yaml counts {} messages, but 400 were found"
UNUSABLE = "metadata.yaml cannot be used (it {}); the files were taken by their names"
UNNAMED = UNUSABLE.format("does not name the files")
METADATA: dict[str, tuple[str, str, int | None]] = {
    "elsewhere": (metadata("elsewhere/bag.db3"), "", 0),
    "more messages": (metadata("bag.db3", count=5000), COUNTS.format(5000), 4600),
    "fewer messages": (metadata("bag.db3", count=300), COUNTS.format(300), 0),
    "a missing file": (
        metadata("bag.db3", "../bag_9.db3"),
        "metadata.yaml names bag_9.db3, which is not there",
        None,
    ),
    # Its messages are counted once.
    "a missing file of 70 messages": (
        metadata("gone.db3", "bag.db3", count=470),
        f"metadata.yaml names gone.db3, which is not there; {COUNTS.format(470)}",
        70,
    ),
    "empty": ("", UNNAMED, 0),
    "no text": ("\0", UNNAMED, 0),
    "deep": ("[" * 400_000, UNNAMED, 0),
    "swelling": (
        f"{YAML_BOMB}rosbag2_bagfile_information: {{relative_file_paths: *a8}}",
        UNNAMED,
        0,
    ),
    "large": ("a" * 600_000, UNUSABLE.format("is larger than 512 kB"), 0),
    "renamed": (
        metadata("other.db3"),
        UNUSABLE.format("names none of the files that are there"),
        0,
    ),
}
"""Its text, what is said of it, and how many messages are lost."""


@pytest.mark.parametrize("name", METADATA)
def test_metadata_that_tells_otherwise_is_said(tmp_path: Path, name: str) -> None:
    text, says, lost = METADATA[name]
    bag = write(tmp_path / "bag")
    (bag / "metadata.yaml").write_text(text)
    reading = read_file(bag)
    assert list(reading.messages) == expected()
    assert (reading.sentences, reading.lost) == (says, lost)
