"""Topics, transforms and events of a converted log."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.conversion import annotated_log
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.report.documents import stats_json
from dogbot_logtool.writer.encodings.foxglove import FoxgloveEncoding
from tests.commands.test_convert import codes, converted
from tests.measured import measured
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


# --- Events and gaits -----------------------------------------------------------------------------


STEPS = {"touchdown", "lift_off"}


def messages_of(log: Path, encoding: str, topic: str) -> list[tuple[int, Any]]:
    return converted(log, copy=False, encoding=encoding).written.decoded(topic)


def troubled_events() -> list[dict[str, Any]]:
    """What `stats` says, with log times: the stamps of this log are zero."""
    origin, found = measured(TROUBLED).walk.origin, stats_json(measured(TROUBLED))["events"]
    return [{**each, "log_time": origin + round(each["onset_s"] * 1e9)} for each in found]


def log_line(event: dict[str, Any]) -> str:
    """What a log panel shows behind the source: each fact once."""
    parts = [event["type"].replace("_", " ")]
    if event["value"] is not None:
        parts.append(f"{event['value']:.3g} {event['unit']}")
    if event["duration_s"] and event["unit"] != "s":
        parts.append(f"for {event['duration_s']:.3f} s")
    return ", ".join([*parts, *filter(None, [event["code"]])])


@pytest.mark.parametrize(
    ("encoding", "text", "warning"),
    [("foxglove", "message", 3), ("ros1", "msg", 4), ("ros2", "msg", 30)],
)
def test_every_event_is_a_log_message_at_its_log_time(
    encoding: str, text: str, warning: int
) -> None:
    found = messages_of(TROUBLED, encoding, "/events")
    for (log_time, message), event in zip(found, troubled_events(), strict=True):
        assert log_time == event["log_time"]
        assert getattr(message, text) == log_line(event)
        assert message.name == (event["foot"] or "robot")
        assert (message.level >= warning) is (event["type"] not in STEPS)


def test_onsets_on_stamps_are_written_at_log_times() -> None:
    track = measured(TROT).walk.feet[0].record.track
    recorded = dict(zip(track.time.tolist(), track.log_time.tolist(), strict=True))
    found = [
        (message.timestamp.ToNanoseconds(), log_time)
        for log_time, message in messages_of(TROT, "foxglove", "/events")
    ]
    at_samples = [each for each in found if each[0] in recorded]
    assert len(at_samples) > 20
    assert set(at_samples) <= recorded.items()
    assert all(0 < log_time - stamp < 5e6 for stamp, log_time in found)


def test_events_are_spans_where_the_schemas_have_them() -> None:
    pytest.importorskip("foxglove_schemas_protobuf.Event_pb2")
    found = messages_of(TROUBLED, "foxglove", "/events/spans")
    odd = [each for each in troubled_events() if each["type"] not in STEPS]
    for (log_time, message), event in zip(found, odd, strict=True):
        start, end = (each.ToNanoseconds() for each in (message.start_time, message.end_time))
        assert log_time == start == event["log_time"]
        assert (end - start) / 1e9 == pytest.approx(event["duration_s"], abs=1e-8)
        details = {each.key: each.value for each in message.metadata}
        assert details["type"] == event["type"]
        assert details.get("foot") == event["foot"]
        value = float("nan") if event["value"] is None else event["value"]
        assert float(details.get("value", "nan")) == pytest.approx(value, nan_ok=True)


def test_without_spans_in_the_schemas_the_rest_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "foxglove_schemas_protobuf.Event_pb2", None)
    # Made with those schemas, not the one that other conversions share.
    monkeypatch.setattr(annotated_log, "encoding_named", lambda _: FoxgloveEncoding())
    convert(TROUBLED, tmp_path / "out.mcap", ConvertOptions(copy=False, jobs=1))
    topics = read_written(tmp_path / "out.mcap").topics
    assert "/events/spans" not in topics
    assert topics["/events"]
