"""The recorded part of a converted log: messages, chunks, attachments, and what is broken."""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest
from mcap.writer import CompressionType

import dogbot_logtool as dl
from dogbot_logtool.writer.chunks import Compression
from tests.commands.test_convert import chunks_of, codes, converted, opening_of
from tests.oracles import base_walks, recorded, small_logs, walks
from tests.oracles.annotated_file import described_robots, read_written, written_loads
from tests.oracles.recorded import FEET, ODOMETRY, S
from tests.oracles.walks import Entry
from tests.paths import TROUBLED, WALK

COPIES: list[tuple[Path, Compression | None, str]] = [
    (TROUBLED, "zstd", "ros1"),
    (TROUBLED, "lz4", "ros1"),
    (WALK, None, "ros2"),
]


def rows(log: Path, profile: str) -> Counter[recorded.Recorded]:
    """The messages of a log or an output; rosbags names the types of ROS 1 as those of ROS 2."""
    found = recorded.read_log(log)
    if profile == "ros1":
        found = [replace(one, type_name=one.type_name.replace("/msg/", "/")) for one in found]
    return Counter(found)


@pytest.mark.parametrize(
    ("log", "compression", "profile"), COPIES, ids=[f"{log.stem}-{c}" for log, c, _ in COPIES]
)
def test_recorded_messages_are_copied_byte_for_byte(
    log: Path, compression: Compression | None, profile: str
) -> None:
    done = converted(log, compression=compression)
    assert rows(log, profile) <= rows(done.path, profile)
    assert done.conversion.copied == len(recorded.read_log(log))
    assert described_robots(done.written) == [(opening_of(log), "dogbot")]
    name = "" if compression == "none" else (compression or "zstd")
    assert set(done.written.chunk_compressions) == {name}
    assert done.written.profile == profile


def test_mcap_extras_are_copied_with_the_messages(tmp_path: Path) -> None:
    """To the byte, also metadata that are no text; a damaged attachment is left out."""
    log = small_logs.write_ros1_mcap(tmp_path / "log.mcap", small_logs.small_walk(), extras=True)
    recorded, written = read_written(log), converted(log, compression="none").written
    assert len(recorded.attachments) == 2
    assert written.attachments == recorded.attachments
    assert written.metadata[:-1] == recorded.metadata
    own = [c for c in written.channels.values() if c.metadata == {"callerid": "/tests"}]
    assert len(own) == 2
    assert {m.sequence for m in written.messages} == {0, 3}
    bare = converted(log, copy=False)
    written = bare.written
    assert (bare.conversion.copied, written.attachments) == (0, [])
    assert [metadata.name for metadata in written.metadata] == ["dogbot_logtool"]

    data = log.read_bytes().replace(b"weather", b"w\xffather")
    log.write_bytes(data.replace(b"here be dragons", b"here be unicorn", 1))
    conversion = dl.convert(log, tmp_path / "odd.mcap")
    lost = [each.what for each in conversion.damage.losses]
    assert sum("the attachment or metadata record at byte" in what for what in lost) == 1
    copied = (tmp_path / "odd.mcap").read_bytes()
    assert b"w\xffather" in copied
    assert b"here be unicorn" not in copied


# --- Chosen topics --------------------------------------------------------------------------------

CONTACT_TOPICS = {
    "/feet/left/contact": small_logs.CONTACTS,
    "/feet/right/contact": small_logs.CONTACTS,
}


@pytest.fixture
def walk(tmp_path: Path) -> Path:
    return small_logs.write_log(
        tmp_path / "walk.mcap", CONTACT_TOPICS, odometry=["/odom"], samples=200
    )


@pytest.mark.parametrize(
    ("topics", "copied", "said"),
    [
        (("!/feet/*",), {"/odom"}, "400 messages of topics left out of the copy: /feet/left/con"),
        (("/odom", "/feet/*", "!*/right/*"), {"/odom", "/feet/left/contact"}, "200 messages of"),
        (("!/camera/*",), {"/odom", *CONTACT_TOPICS}, "--topics !/camera/* fits no topic of the"),
    ],
)
def test_topics_are_left_out_and_annotations_stay(
    walk: Path, topics: tuple[str, ...], copied: set[str], said: str
) -> None:
    whole, done = converted(walk), converted(walk, topics=topics)
    written = done.written
    missing = {"/odom", *CONTACT_TOPICS} - copied
    expected = {name: n for name, n in whole.written.topics.items() if name not in missing}
    assert written.topics == expected
    assert done.conversion.copied == 200 * len(copied)
    (text,) = [finding.text for finding in done.conversion.findings if finding.code == "COPY"]
    assert text.startswith(said)
    told = written.metadata[-1].metadata
    named = [told.get("topics", ""), *(f"!{each}" for each in told.get("without", "").split())]
    assert " ".join(named).split() == [*topics]


def test_transforms_that_are_left_out_are_written_anew(tmp_path: Path) -> None:
    path = base_walks.write(tmp_path / "walk.mcap", "tf2_msgs/TFMessage", "/tf")
    assert converted(path, topics=("!/tf",)).conversion.annotations["/tf"] > 100


# --- What is missing or broken --------------------------------------------------------------------


def test_feet_only(tmp_path: Path) -> None:
    entries = [entry for entry in small_logs.small_walk() if entry.topic != ODOMETRY]
    conversion = converted(small_logs.write_bag(tmp_path / "log.bag", entries)).conversion
    assert "NO_BASE" in codes(conversion)
    assert conversion.annotations[recorded.arrow_topic("front_left")] == 250
    assert "/tf" not in conversion.annotations
    missing = {f.where for f in conversion.findings if f.code == "NO_MESSAGES"}
    assert missing >= {recorded.contact_topic(foot) for foot in FEET[1:]}


@pytest.mark.parametrize("tf", ["auto", "never"])
def test_odometry_only(tmp_path: Path, tf: str) -> None:
    entries = [entry for entry in small_logs.small_walk() if entry.topic == ODOMETRY]
    conversion = converted(small_logs.write_bag(tmp_path / "log.bag", entries), tf=tf).conversion
    assert "NO_FEET" in codes(conversion)
    written = {topic: count for topic, count in conversion.annotations.items() if count}
    assert written == {recorded.DESCRIPTION: 1} | ({"/tf": 50} if tf == "auto" else {})


def test_malformed_messages_cost_one_message_each(tmp_path: Path) -> None:
    """Transforms are read for all that is measured, whatever is written."""
    sent = [10 * S + index * 20_000_000 for index in range(50)]
    frames = [
        Entry("/tf", recorded.TF_TYPE, time, small_logs.transform(time, "base_link", "leg"))
        for time in sent
    ]
    frames[30] = frames[30]._replace(data=frames[30].data[:-1])
    entries = sorted([*small_logs.small_walk(), *frames], key=lambda entry: entry.log_time)
    broken = next(i for i, e in enumerate(entries) if i > 200 and e.kind == recorded.CONTACTS_TYPE)
    entries[broken] = entries[broken]._replace(data=entries[broken].data[:-3])
    log = small_logs.write_bag(tmp_path / "log.bag", entries)
    done = converted(log)
    conversion, written = done.conversion, done.written
    assert conversion.damage.exit_code == 3
    assert conversion.copied == len(entries)
    lost = conversion.damage.losses
    topics = {recorded.contact_topic("front_left"), "/tf"}
    assert {topic for topic in topics for loss in lost if topic in loss.what} == topics
    assert [loss.messages for loss in lost] == [1, 1]
    loads = written_loads(written, "front_left", "foxglove")
    sound = [e for i, e in enumerate(entries) if e.kind == recorded.CONTACTS_TYPE and i != broken]
    assert [load.log_time for load in loads] == [each.log_time for each in (entries[0], *sound)]
    provenance = written.metadata[-1].metadata
    assert provenance["lost_messages"] == "2"
    assert recorded.contact_topic("front_left") in provenance["damage"]
    assert converted(log, tf="never").conversion.damage.losses == lost


@pytest.mark.parametrize(
    ("kind", "bad", "batch"),
    [
        ("gazebo_msgs/msg/ContactsState", {"/odom", "/front_left/contact"}, 1),
        ("unitree_go/msg/LowState", {"/odom", "/feet"}, 0),
        ("champ_msgs/msg/ContactsStamped", {"/odom", "/feet"}, 2),
    ],
)
def test_a_batch_of_which_nothing_can_be_decoded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str, bad: set[str], batch: int
) -> None:
    monkeypatch.setattr("dogbot_logtool.reader.containers.log.BATCH_SIZE", 1)
    walk, path = walks.Walk(2), tmp_path / "log.mcap"
    entries = walks.messages(2, kind)
    first, last = (walks.START + n * 200 * walks.STEP for n in (batch, batch + 1))
    lost = [each for each in entries if each.topic in bad and first <= each.log_time < last]
    cut = [each._replace(data=each.data[:11]) if each in lost else each for each in entries]
    walks.write_mcap(path, walk, cut, chunk_size=20_000)
    conversion = converted(path, robot=str(walks.robot_file(tmp_path, kind))).conversion
    assert sum(loss.messages or 0 for loss in conversion.damage.losses) == len(lost)
    assert all("could not be decoded" in loss.what for loss in conversion.damage.losses)


@pytest.mark.parametrize(
    ("times_ms", "end_ms", "unknown_ms"),
    [
        ([10, 20, 30, 200, 210], 215, [40]),
        ([300, 310], 320, [0]),
        (range(0, 4000, 200), 4500, []),
        (range(0, 4000, 200), 6000, [4000]),
    ],
)
def test_a_load_is_unknown_from_when_the_next_message_is_due(
    tmp_path: Path, times_ms: Sequence[int], end_ms: int, unknown_ms: list[int]
) -> None:
    """It is known from the log's first time on if the first message is near to that."""
    state, start = small_logs.contact((0.0, 0.0, 50.0)), 10 * S
    topics = [(ODOMETRY, recorded.ODOMETRY_TYPE, [0, end_ms])]
    topics.append((recorded.contact_topic("front_left"), recorded.CONTACTS_TYPE, [*times_ms]))
    entries = [
        Entry(
            topic,
            kind,
            time,
            small_logs.odometry(time) if topic == ODOMETRY else small_logs.contacts(time, state),
        )
        for topic, kind, times in topics
        for time in (start + 1_000_000 * each for each in times)
    ]
    log = small_logs.write_bag(tmp_path / "log.bag", sorted(entries, key=lambda e: e.log_time))
    loads = written_loads(converted(log).written, "front_left", "foxglove")
    unknown = [load for load in loads if load.state == "unknown"]
    assert all(math.isnan(load.force) for load in unknown)
    assert [(load.log_time - start) // 1_000_000 for load in unknown] == unknown_ms
    assert loads[0].log_time == start


def test_a_chunk_whose_checksum_fails_is_left_out(tmp_path: Path) -> None:
    none = CompressionType.NONE
    log = small_logs.write_ros1_mcap(
        tmp_path / "log.mcap", small_logs.small_walk(), compression=none, chunk_size=40_000
    )
    count, data = len(chunks_of(log)), bytearray(log.read_bytes())
    data[data.index(b"ground_plane", len(data) // 2)] ^= 1
    log.write_bytes(data)
    done = converted(log, compression="none")
    conversion = done.conversion
    assert conversion.damage.exit_code == 3
    (loss,) = conversion.damage.losses
    assert loss.messages
    assert conversion.copied == 500 - loss.messages
    assert "checksum" in loss.what
    kept = [c for c in chunks_of(done.path) if c in chunks_of(log)]
    assert len(kept) == count - 1
