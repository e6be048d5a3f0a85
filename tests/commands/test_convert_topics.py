"""Topics and transforms of a converted log beside those that are recorded."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.options.convert import ConvertOptions
from tests.commands.conversions import codes, converted
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
    recorded = sum(one.topic == "/tf" for one in read_log(TROT))
    joined = done.written.of("/tf", "ros1")
    assert done.written.topics["/tf"] == len(joined) == recorded + 401
    assert {schema.name for schema, _ in joined} == {"tf2_msgs/TFMessage"}
    assert done.conversion.annotations["/tf"] == 401


def test_a_topic_that_is_taken_twice_is_moved_twice(tmp_path: Path) -> None:
    taken = (load_topic("front_left"), f"/dogbot_logtool{load_topic('front_left')}")
    entries = [Entry(topic, TEXT_TYPE, 10 * S, text("mine")) for topic in taken]
    log = write_bag(tmp_path / "log.bag", [*entries, *small_walk(0.2)])
    conversion = convert(log, tmp_path / "out.mcap", ConvertOptions())
    topic = "/dogbot_logtool/dogbot_logtool/load/front_left"
    assert conversion.annotations[topic] == 51  # with the first time's
    loads = read_written(tmp_path / "out.mcap").decoded(topic)
    assert {load.in_contact for _, load in loads} == {True, False}
    (moved,) = [finding for finding in conversion.findings if finding.code == "TOPIC_MOVED"]
    assert moved.where == topic
    assert "/load/front_left" in moved.text


# --- A second parent ------------------------------------------------------------------------------


@pytest.fixture
def late(tmp_path: Path) -> Path:
    """Sixty chunks, of which one in the middle says where the base is."""

    def entries() -> Iterator[Entry]:
        for index in range(60):
            time = 10 * S + index * 100_000_000
            yield Entry(ODOMETRY, ODOMETRY_TYPE, time, odometry(time))
            state = contact((0.0, 0.0, 50.0))
            yield Entry(contact_topic("front_left"), CONTACTS_TYPE, time + 1, contacts(time, state))
            parent, child = ("/map", "base_link") if index == 21 else ("base_link", "camera")
            yield Entry("/tf", TF_TYPE, time + 2, transform(time, parent, child))
            yield Entry("/filler", TEXT_TYPE, time + 3, text("-" * 300_000))

    return write_bag(tmp_path / "log.bag", entries(), chunk_size=250_000, compression="lz4")


def test_a_second_parent_that_comes_late_is_noticed(late: Path) -> None:
    target = late.with_suffix(".mcap")
    conversion = convert(late, target, ConvertOptions(jobs=2))
    assert not [topic for topic in conversion.annotations if topic.endswith("/tf")]
    assert read_written(target).encodings("/tf") == {"ros1"}
    (finding,) = [f for f in conversion.findings if f.code == "TF_NOT_WRITTEN"]
    assert "base_link a parent (map)" in finding.text
    assert conversion.annotations[arrow_topic("front_left")] == 60
    assert conversion.copied == 240


@pytest.mark.parametrize(
    ("options", "topic"), [({"tf": "always"}, "/dogbot_logtool/tf"), ({"copy": False}, "/tf")]
)
def test_a_parent_that_is_not_copied_is_no_second_one(
    late: Path, options: dict[str, Any], topic: str
) -> None:
    """Nor is one where transforms are written in any case."""
    conversion = convert(late, late.with_suffix(".mcap"), ConvertOptions(**options))
    assert conversion.annotations[topic] == 60
    assert "TF_NOT_WRITTEN" not in codes(conversion)


def test_tf_never_writes_none(folder: Path) -> None:
    done = converted(folder, TROUBLED, tf="never", copy=False)
    assert "/tf" not in done.conversion.annotations
