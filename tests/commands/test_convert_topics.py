"""Topics and transforms of a converted log beside those that are recorded."""

from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest
from mcap.reader import make_reader

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.options import ConvertOptions
from tests.commands.conversions import MATRIX, codes, converted
from tests.oracles.annotated_file import read_written
from tests.oracles.recorded import (
    CONTACTS_TYPE,
    ODOMETRY,
    ODOMETRY_TYPE,
    TEXT_TYPE,
    TF_TYPE,
    S,
    arrow_topic,
    contact_topic,
    load_topic,
    read_log,
)
from tests.oracles.ros1_logs import (
    contact,
    contacts,
    odometry,
    small_walk,
    text,
    transform,
    write_bag,
)
from tests.oracles.walks import Entry
from tests.paths import TROT, TROUBLED


def test_own_tf_joins_the_log_s_where_type_and_encoding_are_the_same(folder: Path) -> None:
    done = converted(folder, TROT, style="classic", encoding="ros1")
    assert done.written.encodings("/tf") == {"ros1"}
    recorded = [one.data for one in read_log(TROT) if one.topic == "/tf"]
    joined = done.written.of("/tf", "ros1")
    assert len(joined) == len(recorded) + 401
    assert {schema.name for schema, _ in joined} == {"tf2_msgs/TFMessage"}
    assert done.conversion.annotations["/tf"] == 401


def test_every_topic_has_one_type_and_encoding(folder: Path) -> None:
    for log, style, encoding in MATRIX:
        with converted(folder, log, style=style, encoding=encoding).path.open("rb") as stream:
            summary = make_reader(stream).get_summary()
        assert summary is not None
        kinds: dict[str, set[tuple[str, str]]] = defaultdict(set)
        for channel in summary.channels.values():
            name = summary.schemas[channel.schema_id].name
            kinds[channel.topic].add((name, channel.message_encoding))
        assert [topic for topic, found in kinds.items() if len(found) > 1] == []


def test_a_topic_that_is_taken_twice_is_moved_twice(tmp_path: Path) -> None:
    taken = (load_topic("front_left"), f"/dogbot_logtool{load_topic('front_left')}")
    entries = [Entry(topic, TEXT_TYPE, 10 * S, text("mine")) for topic in taken]
    log = write_bag(tmp_path / "log.bag", [*entries, *small_walk(0.2)])
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions())
    topic = "/dogbot_logtool/dogbot_logtool/load/front_left"
    assert conversion.annotations[topic] == 51  # with the first time's
    written = read_written(tmp_path / "out.mcap")
    assert {load.in_contact for _, load in written.decoded(topic)} == {True, False}
    (moved,) = [finding for finding in conversion.findings if finding.code == "TOPIC_MOVED"]
    assert moved.where == topic
    assert "/load/front_left" in moved.text


# --- A second parent ------------------------------------------------------------------------------


def walk_with_late_parent(path: Path) -> Path:
    """Write 60 chunks, of which one in the middle says where the base is."""

    def entries() -> Iterator[Entry]:
        for index in range(60):
            time = 10 * S + index * 100_000_000
            yield Entry(ODOMETRY, ODOMETRY_TYPE, time, odometry(time))
            state = contact((0.0, 0.0, 50.0))
            yield Entry(contact_topic("front_left"), CONTACTS_TYPE, time + 1, contacts(time, state))
            child = "base_link" if index == 21 else "camera"
            parent = "/map" if index == 21 else "base_link"
            yield Entry("/tf", TF_TYPE, time + 2, transform(time, parent, child))
            yield Entry("/filler", TEXT_TYPE, time + 3, text("-" * 300_000))

    return write_bag(path, entries(), chunk_size=250_000, compressed=True)


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_second_parent_that_comes_late_is_noticed(tmp_path: Path, jobs: int) -> None:
    log = walk_with_late_parent(tmp_path / "log.bag")
    target = tmp_path / "out.mcap"
    conversion = convert(log, target, ConvertOptions(jobs=jobs))
    written = read_written(target)
    assert not [topic for topic in conversion.annotations if topic.endswith("/tf")]
    assert {c.message_encoding for c in written.channels.values() if c.topic.endswith("/tf")} == {
        "ros1"
    }
    assert "TF_NOT_WRITTEN" in codes(conversion)
    (finding,) = [f for f in conversion.findings if f.code == "TF_NOT_WRITTEN"]
    assert "base_link a parent (map)" in finding.text
    assert conversion.annotations[arrow_topic("front_left")] == 60
    assert conversion.copied == 240
    assert sorted(file.name for file in tmp_path.iterdir()) == ["log.bag", "out.mcap"]


def test_tf_always_writes_a_second_parent(tmp_path: Path) -> None:
    log = walk_with_late_parent(tmp_path / "log.bag")
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions(tf="always"))
    assert conversion.annotations["/dogbot_logtool/tf"] == 60
    assert "TF_NOT_WRITTEN" not in codes(conversion)


def test_a_parent_that_is_not_copied_is_no_second_one(tmp_path: Path) -> None:
    log = walk_with_late_parent(tmp_path / "log.bag")
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions(copy=False))
    assert conversion.annotations.get("/tf") == 60


def test_tf_never_writes_none(folder: Path) -> None:
    done = converted(folder, TROUBLED, tf="never", copy=False)
    assert "/tf" not in done.conversion.annotations
