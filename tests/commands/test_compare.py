"""`compare` from the outside: JSON documents, updating, reports, exit codes."""

import io
import json
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pytest
from mcap.writer import Writer
from rich.console import Console

from dogbot_logtool.commands.compare import compare
from dogbot_logtool.comparison.outcome import Comparison
from dogbot_logtool.errors import CallError, LogtoolError
from dogbot_logtool.options import CompareOptions
from dogbot_logtool.report.comparison_report import (
    comparison_json,
    comparison_junit,
    show_comparison,
)
from tests.paths import SAMPLE_LOGS

WALK = SAMPLE_LOGS / "dogbot_walk.mcap"
STATS: dict[str, Any] = {
    "schema": 1,
    "tool": {"name": "dogbot-logtool", "version": "0.1.0"},
    "gait": {"name": "trot", "duty_factor": 0.714, "strides": 12},
    "feet": [
        {"name": "front_left", "peak_n": 208.5, "slip_m": None},
        {"name": "front_right", "peak_n": 201.25, "slip_m": 0.004},
    ],
}


@pytest.fixture
def expected(tmp_path: Path) -> Path:
    return tmp_path / "expected"


@pytest.fixture
def actual(tmp_path: Path) -> Path:
    return tmp_path / "actual"


def write_json(path: Path, document: object) -> None:
    path.write_text(json.dumps(document, indent=1), encoding="utf-8")


def changed(**parts: object) -> dict[str, Any]:
    return {**STATS, **parts}


def write_log(path: Path, *payloads: str, topics: tuple[str, ...] = ("/a",)) -> Path:
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start("", "a test")
        for topic in topics:
            channel = writer.register_channel(topic, "json", 0)
            for time, payload in enumerate(payloads):
                writer.add_message(channel, time, payload.encode(), time)
        writer.finish()
    return path


def lines(result: Comparison) -> list[str]:
    return [difference.line for difference in result.differences]


def shown(result: Comparison) -> str:
    console = Console(file=io.StringIO(), width=100)
    show_comparison(result, console)
    assert isinstance(console.file, io.StringIO)
    return console.file.getvalue()


def compare_json(
    expected: Path, actual: Path, document: object, options: CompareOptions | None = None
) -> Comparison:
    write_json(expected, STATS)
    write_json(actual, document)
    return compare(expected, actual, options or CompareOptions())


def test_statistics_are_compared_by_path_type_and_tolerance(expected: Path, actual: Path) -> None:
    document = changed(
        gait={"name": "walk", "duty_factor": 0.715, "strides": 12.0},
        feet=[
            {"name": "front_left", "peak_n": "208.5", "slip_m": 0.0},
            {"name": "front_right", "peak_n": 201.5, "extra": True},
        ],
    )
    result = compare_json(expected, actual, document)
    assert result.exit_code == 1
    assert lines(result) == [
        'gait.name: expected "trot", got "walk"',
        "gait.duty_factor: expected 0.714, got 0.715 (|d| 0.001)",
        'feet[0].peak_n: expected 208.5, got "208.5"',
        "feet[0].slip_m: expected null, got 0.0",
        "feet[1].peak_n: expected 201.25, got 201.5 (|d| 0.25)",
        "feet[1].slip_m: expected 0.004, got nothing",
        "feet[1].extra: expected nothing, got true",
    ]
    tallies = {tally.name: tally for tally in result.tallies}
    gait, feet = tallies["gait"], tallies["feet"]
    assert (gait.expected, gait.equal, gait.different) == (3, 1, 2)
    assert (feet.expected, feet.actual, feet.missing, feet.extra) == (6, 6, 1, 1)
    assert (feet.deviation, feet.deviation_path) == (0.25, "feet[1].peak_n")


def test_tolerances_by_quantity_and_ignored_values(
    expected: Path, actual: Path, tmp_path: Path
) -> None:
    tolerances = tmp_path / "tolerances.toml"
    tolerances.write_text('[newtons]\nrtol = 0.01\nfields = ["*_n"]\n', encoding="utf-8")
    document = changed(
        gait={"name": "trot", "duty_factor": 0.715, "strides": 12},
        feet=[
            {"name": "front_left", "peak_n": 209.0, "slip_m": None},
            {"name": "front_right", "peak_n": 201.5, "slip_m": 0.005},
        ],
    )
    options = CompareOptions(tolerances=tolerances, ignore=("gait.duty_factor",))
    result = compare_json(expected, actual, document, options)
    assert lines(result) == ["feet[1].slip_m: expected 0.004, got 0.005 (|d| 0.001)"]
    options = CompareOptions(tolerances=tolerances, atol=0.002)
    assert compare_json(expected, actual, document, options).exit_code == 0
    options = CompareOptions(topics=("gait", "tool"))
    result = compare_json(expected, actual, document, options)
    assert [tally.name for tally in result.tallies] == ["tool", "gait"]
    with pytest.raises(CallError, match="neither file has a key like nothing"):
        compare(expected, actual, CompareOptions(topics=("nothing",)))


def test_what_cannot_be_compared_is_said(expected: Path, actual: Path) -> None:
    options = CompareOptions()

    def refused(exit_code: int) -> str:
        with pytest.raises(LogtoolError) as error:
            compare(expected, actual, options)
        assert error.value.exit_code == exit_code
        return str(error.value)

    assert refused(2) == f"{expected}: no such file"
    write_log(expected, "1")
    assert refused(2) == f"{actual}: no such file"
    write_json(actual, STATS)
    assert refused(2) == f"{actual} is JSON, but {expected} is not: they cannot be compared"
    write_json(expected, STATS)
    actual.write_text('{"a": ', encoding="utf-8")
    assert "is not JSON" in refused(1)
    actual.write_text("[" * 100_000, encoding="utf-8")
    assert "is nested too deeply" in refused(1)
    for path in (expected, actual):
        path.write_text(f'{"[" * 990}"{path.name}"{"]" * 990}', encoding="utf-8")
    assert "is nested too deeply" in refused(1)
    write_log(expected, "1")
    actual.write_bytes(b"rubbish")
    assert "is neither a ROS 1 bag" in refused(1)
    actual.write_bytes(b"")
    assert "is empty" in refused(1)
    actual.unlink()
    actual.mkdir()
    assert refused(2) == f"{actual}: is a directory, not a log file, and holds no ROS 2 bag"


@pytest.fixture
def different(expected: Path, actual: Path) -> Comparison:
    topics = ("/a", "/b", "/<&>\x1b[31m\x00")
    write_log(expected, "1", '"x"', "3", topics=topics)
    write_log(actual, "2", '"x\\u0000<"', topics=topics[1:])
    return compare(expected, actual, CompareOptions(max_differences=3))


def test_the_text_report(different: Comparison) -> None:
    text = shown(different)
    first, heading, *rest = text.splitlines()
    assert first == (
        "different: 4 different, 5 missing, 1 described differently, of 3 topics and 9 messages"
    )
    assert heading.split()[:3] == ["topic", "messages", "equal"]
    assert "\x1b" not in text
    assert "\x00" not in text
    assert [line.split()[:3] for line in rest[:3]] == [
        ["/<&>\\x1b[31m\\x00", "3", "/"],
        ["/a", "3", "/"],
        ["/b", "3", "/"],
    ]
    assert rest[-4] == "/a: the topic is missing (3 messages)"
    assert rest[-2] == "/b[0] t=0.000 s: expected 1, got 2"
    assert rest[-1] == "... and 4 more"


def test_the_json_report(different: Comparison) -> None:
    document = json.loads(comparison_json(different))
    assert document["same"] is False
    assert document["exit_code"] == 1
    assert document["difference_count"] == 7
    assert [one["line"] for one in document["differences"]] == lines(different)
    topic = next(one for one in document["topics"] if one["name"] == "/b")
    assert (topic["expected"], topic["actual"], topic["different"], topic["missing"]) == (
        (3, 2, 2, 1)
    )
    assert document["differences"][0]["kind"] == "topic"


def test_the_junit_report(different: Comparison) -> None:
    (suite,) = ET.fromstring(comparison_junit(different))  # noqa: S314 - our own
    assert suite.attrib["tests"] == str(len(suite.findall("testcase"))) == "5"
    assert (suite.attrib["failures"], suite.attrib["errors"]) == ("3", "0")
    cases = {case.attrib["name"]: case for case in suite}
    assert set(cases) == {
        "files can be read",
        "/<&>\\x1b[31m\\x00",
        "/a",
        "/b",
        "(records)",
    }
    failure = cases["/b"].find("failure")
    assert failure is not None
    assert failure.attrib["message"] == "/b: 2 of 3 messages different, 1 missing"
    assert failure.text == "/b[0] t=0.000 s: expected 1, got 2"
    assert cases["(records)"].find("failure") is None
