"""ROS 2 bags as rosbags writes them, and as recorders and their crashes leave them."""

import os
import shutil
import sqlite3
from pathlib import Path

import numpy as np
import pytest
import zstandard
from rosbags.rosbag2 import Reader as Rosbag2Reader
from rosbags.rosbag2.enums import CompressionMode, StoragePlugin

from dogbot_logtool.commands.compare import compare
from dogbot_logtool.errors import CallError, LogError, LogtoolError
from dogbot_logtool.options import CompareOptions
from dogbot_logtool.reader.containers.log import BATCH_SIZE
from dogbot_logtool.reader.containers.mcap.records import read_extra
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.reader.messages.contact_messages import read_contacts
from dogbot_logtool.reader.messages.feet import FootChannels
from dogbot_logtool.reader.opening import open_log
from tests.oracles.walks import LEGS, Entry, foot_topic, write_mcap
from tests.reader.containers.rosbag2.bags import (
    ENTRIES,
    MODES,
    PLUGINS,
    WALK,
    change,
    database,
    expected,
    split,
    write,
)
from tests.reader.mcap_bytes import attachment, metadata, small_mcap
from tests.reader.reading import Read, Reading, read_file


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


def test_quality_of_service_does_not_matter(tmp_path: Path) -> None:
    bag = write(tmp_path / "bag")
    change(database(bag), "UPDATE topics SET offered_qos_profiles = 'other'")
    assert list(read_file(bag).messages) == expected()


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
    ("kind", "fields"),
    [
        ("ros_gz_interfaces/msg/Contacts", b"ros_gz_interfaces/JointWrench[] wrenches"),
        ("champ_msgs/msg/ContactsStamped", b"bool[] contacts"),
        ("unitree_go/msg/LowState", b"int16[4] foot_force"),
        ("unitree_go/msg/SportModeState", b"int16[4] foot_force"),
    ],
)
def test_contact_messages_are_known_where_the_log_has_no_definitions(
    tmp_path: Path, kind: str, fields: bytes
) -> None:
    bag = write(tmp_path / "bag")
    renamed = "UPDATE topics SET type = 'KIND' WHERE name != '/odom'"
    change(database(bag), "DELETE FROM message_definitions", renamed.replace("KIND", kind))
    log = open_log(bag)
    texts = {c.schema.data for c in log.channels.values() if c.schema and c.topic != "/odom"}
    log.close()
    (text,) = texts
    assert fields in text


@pytest.mark.parametrize(
    "kind", ["ros_gz_interfaces/msg/Contacts", "champ_msgs/msg/ContactsStamped"]
)
def test_shipped_definitions_say_what_the_recorded_ones_do(tmp_path: Path, kind: str) -> None:
    """Their recorded definitions are the tests' own."""
    entries = list(WALK.messages(kind))[:300]
    bag = write(tmp_path / "bag", entries=entries)
    told = []
    for _ in range(2):
        log = open_log(bag)
        channels = [c for c in log.channels.values() if c.topic != "/odom"]
        feet = FootChannels(
            tuple(Foot(leg, foot_topic(kind, leg), element=n) for n, leg in enumerate(LEGS)),
            {
                c.id: tuple(n for n, leg in enumerate(LEGS) if foot_topic(kind, leg) == c.topic)
                for c in channels
            },
            1.0,
        )
        (read,) = [
            one for span in log.spans() for one in read_contacts(log.read(span), channels, feet)
        ]
        log.close()
        told.append(read.reduced.samples)
        assert not read.messages.malformed
        change(database(bag), "DELETE FROM message_definitions")
    for field in ("foot", "log_time", "stamp", "in_contact", "force"):
        np.testing.assert_array_equal(getattr(told[0], field), getattr(told[1], field))
    assert told[0].in_contact.any()


@pytest.mark.parametrize("mode", MODES)
def test_the_same_in_every_container_compares_the_same(
    tmp_path: Path, mode: CompressionMode
) -> None:
    write_mcap(tmp_path / "walk.mcap", WALK, ENTRIES)
    logs = [tmp_path / "walk.mcap"]
    logs += [write(tmp_path / f"{plugin.name}", plugin, mode) for plugin in PLUGINS]
    logs += [split(tmp_path, StoragePlugin.MCAP)]
    for log in logs[1:]:
        for one, other in ((logs[0], log), (log, logs[0]), (log, log)):
            done = compare(one, other, CompareOptions())
            assert done.differences == []
            assert sum(t.expected for t in done.tallies if t.name.startswith("/")) == len(ENTRIES)


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


def test_large_logs_are_read_in_batches(tmp_path: Path) -> None:
    data = ENTRIES[0].data + bytes(300_000)
    entries = [Entry("/odom", "nav_msgs/msg/Odometry", time, data) for time in range(1, 81)]
    log = open_log(write(tmp_path / "bag", entries=entries))
    spans = list(log.spans())
    sizes = [len(log.read(span).buffer) for span in spans]
    assert len(spans) > 2
    assert max(sizes) < BATCH_SIZE + (2 << 20)
    assert sum(len(log.read(span).messages) for span in log.spans(start=11, end=20)) >= 10
    log.close()


def test_a_write_ahead_log_is_read(tmp_path: Path) -> None:
    bag = write(tmp_path / "bag")
    file = database(bag)
    connection = sqlite3.connect(file, isolation_level=None)
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("INSERT INTO messages (topic_id, timestamp, data) VALUES (1, 7, x'00')")
    crashed = tmp_path / "crashed"
    shutil.copytree(bag, crashed)
    connection.close()
    assert read_file(crashed).messages[-1] == Read(ENTRIES[0].topic, 7, b"\0")


@pytest.mark.parametrize(
    "statement",
    [
        "UPDATE messages SET data = 'text' WHERE id = 3",
        "UPDATE messages SET timestamp = -5 WHERE id = 3",
        "UPDATE messages SET timestamp = 'then' WHERE id = 3",
        "UPDATE messages SET topic_id = 77 WHERE id = 3",
        "UPDATE messages SET topic_id = -9223372036854775808 WHERE id = 3",
    ],
)
def test_a_row_that_is_no_message_is_counted(tmp_path: Path, statement: str) -> None:
    bag = write(tmp_path / "bag")
    change(database(bag), statement)
    reading = read_file(bag)
    assert list(reading.messages) == expected([*ENTRIES[:2], *ENTRIES[3:]])
    assert reading.lost == 1


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


def test_rosbags_agrees(tmp_path: Path) -> None:
    bag = write(tmp_path / "bag")
    with Rosbag2Reader(bag) as reader:
        theirs = [Read(c.topic, time, bytes(data)) for c, time, data in reader.messages()]
    assert sorted(read_file(bag).messages) == sorted(theirs)


@pytest.mark.parametrize("name", [b"\xff.db3", b"a b%41?mode=rw#.db3"])
def test_a_database_may_have_any_name(tmp_path: Path, name: bytes) -> None:
    whole = write(tmp_path / "whole")
    path = Path(os.fsdecode(bytes(tmp_path) + b"/" + name))
    shutil.copy(database(whole), path)
    assert list(read_file(path).messages) == expected()
