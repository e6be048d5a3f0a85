"""Conversion of logs in which something is missing or broken."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import pytest
from mcap.writer import CompressionType

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.results import Conversion
from tests.commands.conversions import chunks_of, codes
from tests.oracles import walks
from tests.oracles.annotated_file import Written, read_written, written_loads
from tests.oracles.recorded import (
    CONTACTS_TYPE,
    DESCRIPTION,
    FEET,
    ODOMETRY,
    ODOMETRY_TYPE,
    TF_TYPE,
    S,
    arrow_topic,
    contact_topic,
    load_topic,
)
from tests.oracles.ros1_logs import (
    contact,
    contacts,
    odometry,
    small_walk,
    transform,
    write_bag,
    write_ros1_mcap,
)
from tests.oracles.walks import Entry


def done(log: Path, options: ConvertOptions = ConvertOptions()) -> tuple[Conversion, Written]:  # noqa: B008 - frozen
    """Convert a log; the file has all that the result counts."""
    target = log.with_name("out.mcap")
    conversion = convert(log, target, options)
    written = read_written(target)
    annotated = sum(conversion.annotations.values())
    assert len(written.messages) == conversion.copied + annotated
    return conversion, written


def test_a_damaged_attachment_is_left_out(tmp_path: Path) -> None:
    log = write_ros1_mcap(tmp_path / "log.mcap", small_walk(0.1), extras=True)
    data = log.read_bytes()
    assert data.count(b"here be dragons") == 100
    log.write_bytes(data.replace(b"here be dragons", b"here be unicorn", 1))
    conversion, written = done(log)
    assert [attachment.name for attachment in written.attachments] == ["empty"]
    assert conversion.damage.exit_code == 3


def test_feet_only(tmp_path: Path) -> None:
    entries = [entry for entry in small_walk() if entry.topic != ODOMETRY]
    conversion, _ = done(write_bag(tmp_path / "log.bag", entries))
    assert "NO_BASE" in codes(conversion)
    assert conversion.annotations[arrow_topic("front_left")] == 250
    assert "/tf" not in conversion.annotations
    missing = {f.where for f in conversion.findings if f.code == "NO_MESSAGES"}
    assert missing >= {contact_topic(foot) for foot in FEET[1:]}


@pytest.mark.parametrize("tf", ["auto", "never"])
def test_odometry_only(tmp_path: Path, tf: Literal["auto", "never"]) -> None:
    entries = [entry for entry in small_walk() if entry.topic == ODOMETRY]
    conversion, _ = done(write_bag(tmp_path / "log.bag", entries), ConvertOptions(tf=tf))
    assert "NO_FEET" in codes(conversion)
    written = {topic: count for topic, count in conversion.annotations.items() if count}
    assert written == {DESCRIPTION: 1} | ({"/tf": 50} if tf == "auto" else {})


def test_a_malformed_message_costs_one_message(tmp_path: Path) -> None:
    entries = list(small_walk())
    broken = next(i for i, e in enumerate(entries) if i > 200 and e.kind == CONTACTS_TYPE)
    entries[broken] = entries[broken]._replace(data=entries[broken].data[:-3])
    conversion, written = done(write_bag(tmp_path / "log.bag", entries))
    assert conversion.damage.exit_code == 3
    assert conversion.copied == len(entries)
    assert conversion.annotations[load_topic("front_left")] == 249 + 1
    loads = written_loads(written, "front_left", "foxglove")
    sound = [e for i, e in enumerate(entries) if e.kind == CONTACTS_TYPE and i != broken]
    assert [load.log_time for load in loads] == [each.log_time for each in (entries[0], *sound)]
    (loss,) = conversion.damage.losses
    assert contact_topic("front_left") in loss.what
    assert loss.messages == 1
    provenance = written.metadata[-1].metadata
    assert provenance["lost_messages"] == "1"
    assert contact_topic("front_left") in provenance["damage"]


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
    conversion, _ = done(path, ConvertOptions(robot=str(walks.robot_file(tmp_path, kind))))
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
    state, start = contact((0.0, 0.0, 50.0)), 10 * S
    topics = [(ODOMETRY, ODOMETRY_TYPE, [0, end_ms])]
    topics.append((contact_topic("front_left"), CONTACTS_TYPE, [*times_ms]))
    entries = [
        Entry(topic, kind, time, odometry(time) if topic == ODOMETRY else contacts(time, state))
        for topic, kind, times in topics
        for time in (start + 1_000_000 * each for each in times)
    ]
    _, written = done(write_bag(tmp_path / "log.bag", sorted(entries, key=lambda e: e.log_time)))
    loads = written_loads(written, "front_left", "foxglove")
    unknown = [load for load in loads if load.state == "unknown"]
    assert all(math.isnan(load.force) for load in unknown)
    assert [(load.log_time - start) // 1_000_000 for load in unknown] == unknown_ms
    assert loads[0].log_time == start


def test_transforms_that_cannot_be_decoded_are_counted(tmp_path: Path) -> None:
    """They are read for all that is measured, whatever is written."""
    sent = [10 * S + index * 20_000_000 for index in range(50)]
    frames = [Entry("/tf", TF_TYPE, time, transform(time, "base_link", "leg")) for time in sent]
    frames[30] = frames[30]._replace(data=frames[30].data[:-1])
    entries = sorted([*small_walk(), *frames], key=lambda entry: entry.log_time)
    log = write_bag(tmp_path / "log.bag", entries)
    conversion, _ = done(log)
    assert conversion.copied == len(entries)
    (loss,) = conversion.damage.losses
    assert loss.messages == 1
    assert "/tf" in loss.what
    never, _ = done(log, ConvertOptions(tf="never", overwrite=True))
    assert never.damage.losses == conversion.damage.losses


def test_a_chunk_whose_checksum_fails_is_left_out(tmp_path: Path) -> None:
    none = CompressionType.NONE
    log = write_ros1_mcap(tmp_path / "log.mcap", small_walk(), compression=none, chunk_size=40_000)
    count, data = len(chunks_of(log)), bytearray(log.read_bytes())
    data[data.index(b"ground_plane", len(data) // 2)] ^= 1
    log.write_bytes(data)
    conversion, _ = done(log, ConvertOptions(compression="none"))
    assert conversion.damage.exit_code == 3
    (loss,) = conversion.damage.losses
    assert loss.messages
    assert conversion.copied == 500 - loss.messages
    assert "checksum" in loss.what
    kept = [c for c in chunks_of(tmp_path / "out.mcap") if c in chunks_of(log)]
    assert len(kept) == count - 1
