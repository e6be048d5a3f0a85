"""`/events` and `/gait` in a converted log: what they say, and when."""

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.conversion import plan
from dogbot_logtool.options import ConvertOptions
from dogbot_logtool.report.documents import stats_json
from dogbot_logtool.writer.encodings import registry
from dogbot_logtool.writer.encodings.foxglove import FoxgloveEncoding
from tests.commands.conversions import converted
from tests.measured import measured
from tests.oracles.annotated_file import read_written
from tests.paths import TROT, TROUBLED


def messages_of(folder: Path, log: Path, encoding: str, topic: str) -> list[tuple[int, Any]]:
    return converted(folder, log, copy=False, encoding=encoding).written.decoded(topic)


@pytest.mark.parametrize(
    ("encoding", "text", "warning"),
    [("foxglove", "message", 3), ("ros1", "msg", 4), ("ros2", "msg", 30)],
)
def test_every_event_is_a_log_message_at_its_log_time(
    folder: Path, encoding: str, text: str, warning: int
) -> None:
    stats = measured(TROUBLED).walk
    events = stats_json(measured(TROUBLED))["events"]
    found = messages_of(folder, TROUBLED, encoding, "/events")
    assert len(found) == len(events)
    for (log_time, message), event in zip(found, events, strict=True):
        # The stamps of this log are zero: it is measured on log time.
        assert log_time == stats.origin + round(event["onset_s"] * 1e9)
        assert getattr(message, text).startswith(event["type"].replace("_", " "))
        assert message.name == (event["foot"] or "robot")
        is_step = event["type"] in {"touchdown", "lift_off"}
        assert (message.level >= warning) is not is_step


def test_onsets_on_stamps_are_written_at_log_times(folder: Path) -> None:
    stats = measured(TROT).walk
    record = stats.feet[0].record
    recorded = dict(zip(record.track.time.tolist(), record.track.log_time.tolist(), strict=True))
    found = [
        (log_time, message.timestamp.ToNanoseconds())
        for log_time, message in messages_of(folder, TROT, "foxglove", "/events")
    ]
    at_samples = [(log_time, stamp) for log_time, stamp in found if stamp in recorded]
    assert len(at_samples) > 20
    assert all(log_time == recorded[stamp] for log_time, stamp in at_samples)
    assert all(0 < log_time - stamp < 5e6 for log_time, stamp in found)


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
    stats = measured(TROUBLED).walk
    events = stats_json(measured(TROUBLED))["events"]
    odd = [each for each in events if each["type"] not in {"touchdown", "lift_off"}]
    found = messages_of(folder, TROUBLED, "foxglove", "/events/spans")
    assert [message.start_time.ToNanoseconds() for _, message in found] == [
        stats.origin + round(each["onset_s"] * 1e9) for each in odd
    ]
    for (log_time, message), event in zip(found, odd, strict=True):
        start, end = (each.ToNanoseconds() for each in (message.start_time, message.end_time))
        assert log_time == start
        assert (end - start) / 1e9 == pytest.approx(event["duration_s"], abs=1e-8)
        details = {each.key: each.value for each in message.metadata}
        assert details["type"] == event["type"]
        assert details.get("foot") == event["foot"]
        assert float(details.get("value", "nan")) == pytest.approx(
            float("nan") if event["value"] is None else event["value"], nan_ok=True
        )


def test_without_spans_in_the_schemas_the_rest_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "foxglove_schemas_protobuf.Event_pb2", None)
    # Made with those schemas, not the one that other conversions share.
    older = replace(registry.ENCODINGS["foxglove"], load=FoxgloveEncoding)
    monkeypatch.setattr(plan, "ENCODINGS", {"foxglove": older})
    target = tmp_path / "out.mcap"
    convert(TROUBLED, target, ConvertOptions(copy=False, jobs=1))
    written = read_written(target)
    assert written.decoded("/events/spans") == []
    assert written.decoded("/events")
