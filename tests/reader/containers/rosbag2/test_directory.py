"""ROS 2 bags as rosbags writes them, and as recorders and their crashes leave them."""

from pathlib import Path

import numpy as np
import pytest
import zstandard
from rosbags.rosbag2.enums import CompressionMode, StoragePlugin

from dogbot_logtool.errors import CallError, LogError, LogtoolError
from dogbot_logtool.reader.containers.mcap.records import read_extra
from dogbot_logtool.reader.opening import open_log
from tests.oracles.walks import Entry
from tests.reader.containers.rosbag2.bags import (
    ENTRIES,
    MODES,
    PLUGINS,
    change,
    database,
    expected,
    split,
    write,
)
from tests.reader.mcap_bytes import attachment, metadata, small_mcap
from tests.reader.reading import Reading, read_file


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
def test_a_single_file_is_a_log(tmp_path: Path, plugin: StoragePlugin) -> None:
    bag = write(tmp_path / "bag", plugin)
    (file,) = [file for file in bag.iterdir() if file.name != "metadata.yaml"]
    assert list(read_file(file).messages) == expected()


@pytest.mark.parametrize("plugin", PLUGINS)
def test_split_files_are_one_log(tmp_path: Path, plugin: StoragePlugin) -> None:
    whole = split(tmp_path, plugin)
    reading = read_file(whole)
    assert list(reading.messages) == expected()
    assert [loss.messages for loss in reading.losses] == [0]
    assert "metadata.yaml" in reading.sentences
    assert len(reading.topics) == 5
    assert len({chunk.chunk.offset for chunk in reading.chunks}) == len(reading.chunks)


@pytest.mark.parametrize("column", ["message_definitions", "schema"])
def test_definitions_are_known_where_the_log_has_none(tmp_path: Path, column: str) -> None:
    bag = write(tmp_path / "bag")
    change(database(bag), f"DROP TABLE {column}")
    log = open_log(bag)
    kinds = {channel.type_name: channel.schema for channel in log.channels.values()}
    log.close()
    assert set(kinds) == {"nav_msgs/Odometry", "gazebo_msgs/ContactsState"}
    assert all(schema and b"Header header" in schema.data for schema in kinds.values())


def test_metadata_and_attachments_of_all_files_are_read(tmp_path: Path) -> None:
    bag = tmp_path / "bag"
    bag.mkdir()
    for number in range(2):
        mcap = small_mcap()
        mcap.extras = [metadata("notes", {"file": str(number)}), attachment(f"{number}.txt", b"x")]
        (bag / f"walk_{number}.mcap").write_bytes(mcap.build())
    log = open_log(bag)
    read = [read_extra(extra) for extra in log.extras]
    log.close()
    values = [one and getattr(one[1], "metadata", None) for one in read]
    names = [one and getattr(one[1], "name", None) for one in read]
    assert values == [{"file": "0"}, None, {"file": "1"}, None]
    assert names == ["notes", "0.txt", "notes", "1.txt"]


def test_a_type_that_nobody_knows_is_still_a_topic(tmp_path: Path) -> None:
    bag = write(tmp_path / "bag")
    change(
        database(bag),
        "DELETE FROM message_definitions",
        "UPDATE topics SET type = 'strange_msgs/msg/Thing' WHERE name = '/odom'",
    )
    log = open_log(bag)
    (odometry,) = [c for c in log.channels.values() if c.topic == "/odom"]
    log.close()
    assert odometry.type_name == "strange_msgs/Thing"
    assert odometry.schema
    assert (odometry.schema.encoding, odometry.schema.data) == ("", b"")


@pytest.mark.parametrize(
    "statements",
    [
        ("DROP TABLE messages",),
        ("DROP TABLE topics",),
        (
            "DROP TABLE messages",
            """CREATE VIEW messages AS
            WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x FROM n)
            SELECT x AS id, 1 AS topic_id, 2 AS timestamp, zeroblob(1000000) AS data FROM n""",
        ),
        (
            "DROP TABLE messages",
            """CREATE TABLE messages (id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER,
            data BLOB GENERATED ALWAYS AS (zeroblob(900000000)))""",
            "INSERT INTO messages (topic_id, timestamp) VALUES (1, 1)",
        ),
    ],
)
def test_what_only_looks_like_a_bag_is_refused(tmp_path: Path, statements: tuple[str, ...]) -> None:
    bag = write(tmp_path / "bag")
    change(database(bag), *statements)
    with pytest.raises(LogError, match="ROS 2 bag"):
        open_log(bag)


def test_a_message_that_swells_is_lost(tmp_path: Path) -> None:
    bomb = zstandard.ZstdCompressor(level=19).compress(bytes(200 << 20))
    entries = [*ENTRIES[:5], Entry("/odom", "nav_msgs/msg/Odometry", ENTRIES[5].log_time, bomb)]
    reading = read_file(write(tmp_path / "bag", entries=entries))
    assert list(reading.messages) == expected(ENTRIES[:5])
    assert reading.lost == 1


def test_damage_anywhere_gives_a_sentence_or_losses(tmp_path: Path) -> None:
    file = database(write(tmp_path / "bag"))
    data = file.read_bytes()
    random = np.random.default_rng(7)
    harmed_file = tmp_path / "harmed.db3"
    for _ in range(60):
        harmed = bytearray(data)
        for place in random.integers(16, len(data), 20).tolist():
            harmed[place] ^= int(random.integers(1, 256))
        cut = int(random.integers(len(data) // 2, 2 * len(data)))
        harmed_file.write_bytes(bytes(harmed[:cut]))
        try:
            reading: Reading = read_file(harmed_file)
        except LogtoolError as error:
            assert "\n" not in str(error)  # noqa: PT017
            continue
        assert len(reading.messages) <= 2 * len(ENTRIES)


def test_directories_without_logs_are_refused(tmp_path: Path) -> None:
    with pytest.raises(CallError, match="is a directory"):
        open_log(tmp_path)
    (tmp_path / "metadata.yaml").write_text(
        "rosbag2_bagfile_information:\n  relative_file_paths: []"
    )
    with pytest.raises(LogError, match="names no files"):
        open_log(tmp_path)


def test_any_log_may_be_packed_once(tmp_path: Path) -> None:
    path = tmp_path / "walk.mcap.zstd"
    packed = zstandard.ZstdCompressor().compress(small_mcap().build())
    path.write_bytes(packed)
    assert len(read_file(path).messages) > 0
    path.write_bytes(zstandard.ZstdCompressor().compress(packed))
    with pytest.raises(LogError, match="twice"):
        open_log(path)
