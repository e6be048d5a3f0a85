"""`/events` and `/gait` in a converted log: what they say, and when."""

import sys
from pathlib import Path
from typing import Any

import pytest

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.conversion import annotated_log
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.report.documents import stats_json
from dogbot_logtool.writer.encodings.foxglove import FoxgloveEncoding
from tests.commands.conversions import converted
from tests.measured import measured
from tests.oracles.annotated_file import read_written
from tests.paths import TROT, TROUBLED

STEPS = {"touchdown", "lift_off"}


def messages_of(folder: Path, log: Path, encoding: str, topic: str) -> list[tuple[int, Any]]:
    return converted(folder, log, copy=False, encoding=encoding).written.decoded(topic)


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
    folder: Path, encoding: str, text: str, warning: int
) -> None:
    found = messages_of(folder, TROUBLED, encoding, "/events")
    for (log_time, message), event in zip(found, troubled_events(), strict=True):
        assert log_time == event["log_time"]
        assert getattr(message, text) == log_line(event)
        assert message.name == (event["foot"] or "robot")
        assert (message.level >= warning) is (event["type"] not in STEPS)


def test_onsets_on_stamps_are_written_at_log_times(folder: Path) -> None:
    track = measured(TROT).walk.feet[0].record.track
    recorded = dict(zip(track.time.tolist(), track.log_time.tolist(), strict=True))
    found = [
        (message.timestamp.ToNanoseconds(), log_time)
        for log_time, message in messages_of(folder, TROT, "foxglove", "/events")
    ]
    at_samples = [each for each in found if each[0] in recorded]
    assert len(at_samples) > 20
    assert set(at_samples) <= recorded.items()
    assert all(0 < log_time - stamp < 5e6 for stamp, log_time in found)


@pytest.mark.parametrize("encoding", ["foxglove", "ros1", "ros2"])
def test_the_gait_is_written_where_it_changes_and_ends(folder: Path, encoding: str) -> None:
    (_, begins), (_, ends) = messages_of(folder, TROT, encoding, "/gait")
    assert begins.gait == "trot"
    assert begins.duty_factor == pytest.approx(0.714, abs=0.01)
    assert begins.stride_frequency_hz == pytest.approx(1.0 / 1.142, abs=0.01)
    assert list(begins.phases) == pytest.approx([0.0, 0.5, 0.5, 0.0], abs=0.02)
    assert ends.gait == "unknown"
    assert ends.duty_factor != ends.duty_factor


def test_events_are_spans_where_the_schemas_have_them(folder: Path) -> None:
    pytest.importorskip("foxglove_schemas_protobuf.Event_pb2")
    found = messages_of(folder, TROUBLED, "foxglove", "/events/spans")
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
