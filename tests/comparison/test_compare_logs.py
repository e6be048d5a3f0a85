"""Logs written by the mcap library and compared: whatever is changed is found, and nothing else."""

import json
import struct
import tracemalloc
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pytest
from mcap.writer import CompressionType, IndexType

import dogbot_logtool as dl
from tests import forked_cli
from tests.comparison.recordings import (
    JSON,
    RAW,
    SCENE,
    START,
    UNINDEXED,
    Recording,
    compared,
    counts,
    json_log,
    lines,
    load,
    odometry,
    recording,
    ros_kind,
    scene,
)
from tests.oracles.mcap_channels import SentChannel, write_channels


def mixed(count: int = 50) -> Recording:
    kinds = {"/odom": ros_kind(1), "/scene": SCENE, "/load": JSON, "/raw": RAW, "/silent": JSON}
    messages = [
        message
        for i in range(count)
        for message in (
            ("/odom", i, odometry(1, (float(i), 0.0, 0.0))),
            ("/scene", i, scene(i / 7)),
            ("/scene", i, scene(i / 9)),
            ("/load", i + 1, load(i / 3)),
            ("/raw", 2 * i, bytes(range(i % 7))),
        )
    ]
    metadata = {"dogbot_logtool": {"version": "1", "style": "force"}}
    whole = recording(kinds, *messages)
    return replace(whole, metadata=metadata, attachments={"notes": b"wet floor"})


PACKINGS: list[dict[str, Any]] = [
    {"compression": CompressionType.NONE, "chunk_size": 300},
    {"compression": CompressionType.LZ4, "chunk_size": 5000},
    {"index_types": IndexType.NONE, "chunk_size": 100_000},
    {"compression": CompressionType.LZ4, "chunk_size": 700, **UNINDEXED},
    {"use_chunking": False},
]


@pytest.mark.parametrize("packing", PACKINGS, ids=str)
def test_neither_packing_nor_order_matters(tmp_path: Path, packing: dict[str, Any]) -> None:
    whole = mixed()
    by_topic = sorted(whole.messages, key=lambda message: message[0])
    backwards = sorted(whole.messages, key=lambda message: -message[1])
    for messages in (whole.messages, by_topic, backwards):
        other = replace(whole, messages=messages).write(tmp_path / "other.mcap", **packing)
        result = compared(tmp_path, whole, other)
        assert (result.exit_code, result.difference_count, result.damage) == (0, 0, [])
        assert result.verdict == "same: 5 topics, 250 messages"
        assert counts(result, "/scene") == (100, 100, 100, 0, 0, 0, 0)
        assert counts(result, "/silent") == (0,) * 7


def test_several_senders_of_a_topic_are_one_topic(tmp_path: Path) -> None:
    def log(*encodings: str) -> Path:
        channels = (
            SentChannel(
                "/a", "Load", each, messages=[(t, b"1") for t in range(10)[n :: len(encodings)]]
            )
            for n, each in enumerate(encodings)
        )
        return write_channels(tmp_path / "-".join(encodings), channels)

    assert compared(tmp_path, log("json", "json"), log("json")).exit_code == 0
    result = compared(tmp_path, log("json"), log("json", "cbor"))
    assert lines(result) == ["/a encoding: expected json, got cbor, json"]
    assert counts(result) == (10, 10, 5, 0, 5, 0, 0)


def test_records_beside_the_messages(tmp_path: Path) -> None:
    expected = mixed()
    other_version = {"dogbot_logtool": {"version": "2", "style": "force"}}
    assert compared(tmp_path, expected, replace(expected, metadata=other_version)).same
    changed = replace(
        expected,
        metadata={"dogbot_logtool": {"style": "classic"}, "more": {"a": "b"}},
        attachments={"notes": b"dry floor"},
        profile="",
    )
    found = lines(compared(tmp_path, expected, changed))
    assert [line.partition(": ")[0] for line in found] == [
        "(records) profile",
        "(records) attachment:notes.sha256",
        "(records) metadata:dogbot_logtool.style",
        "(records) metadata:more",
    ]
    assert found[2].endswith('expected "force", got "classic"')
    ours = ("metadata:dogbot_logtool", "metadata:more")
    for everything in (("metadata:*", "profile", "attachment:notes"), ("(records)",)):
        assert compared(tmp_path, expected, changed, ignore=everything).same
    assert compared(tmp_path, expected, changed, ignore=ours).difference_count == 2
    assert compared(tmp_path, expected, changed, topics=("/*",)).same


@pytest.mark.parametrize("indexed", [True, False])
def test_memory_does_not_grow_with_the_file(tmp_path: Path, *, indexed: bool) -> None:
    """Times lie as far apart as they can, and some of them hold more than is read at once."""
    payloads = [struct.pack("<Q", number) * 12_500 for number in range(400)]
    times = [0, START, 2**61, 2**63 - 2, 2**63 - 1]
    messages = [("/a", times[n // 80], data) for n, data in enumerate(payloads)]
    whole = Recording({"/a": RAW}, sorted(messages, key=lambda message: -message[1]))
    packing = {} if indexed else UNINDEXED
    expected = whole.write(tmp_path / "expected.mcap", chunk_size=300_000, **packing)
    messages[399] = ("/a", times[4], payloads[399] + b"x")
    other = replace(whole, messages=messages)
    actual = other.write(tmp_path / "actual.mcap", chunk_size=300_000)
    tracemalloc.start()
    result = compared(tmp_path, expected, actual)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert [each.index for each in result.differences] == [399]
    assert counts(result) == (400, 400, 399, 0, 1, 0, 0)
    assert peak < 35_000_000


# --- What is printed ------------------------------------------------------------------------------


DOCUMENT = '{"gait": {"name": "trot"}}'


run = partial(forked_cli.run, "compare")


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path]:
    return tmp_path / "expected", tmp_path / "actual"


def test_files_that_do_not_go_together(files: tuple[Path, Path]) -> None:
    expected, actual = files

    json_log((0, "1")).write(expected)
    with pytest.raises(dl.CallError, match=f"^{actual}: no such file"):
        dl.compare(expected, actual)
    with pytest.raises(dl.CallError, match=f"^{actual}: no such file"):
        dl.compare(actual, expected)
    actual.write_text(DOCUMENT)
    with pytest.raises(dl.CallError, match=f"{actual} is JSON, but {expected} is not: they cannot"):
        dl.compare(expected, actual)


@pytest.fixture
def different(files: tuple[Path, Path]) -> tuple[object, ...]:
    odd = "/b /<&>\x1b[31m\x00"
    json_log((0, "1"), (1, '"x"'), (2, "3"), topics=f"/a {odd}").write(files[0])
    json_log((0, "2"), (1, '"x\\u0000<"'), topics=odd).write(files[1])
    return (*files, "--max-differences", 3)


def test_the_text_report(different: tuple[object, ...]) -> None:
    done = run(*different)
    assert (done.returncode, done.stderr) == (1, "")
    first, heading, *rest = done.stdout.splitlines()
    assert first == (
        "different: 4 different, 5 missing, 1 described differently, of 3 topics and 9 messages"
    )
    assert heading.split()[:3] == ["topic", "messages", "equal"]
    assert not {"\x1b", "\x00"} & set(done.stdout)
    assert [line.split()[0] for line in rest[:3]] == ["/<&>\\x1b[31m\\x00", "/a", "/b"]
    assert rest[-4] == "/a: the topic is missing (3 messages)"
    assert rest[-2:] == ["/b[0] t=0.000 s: expected 1, got 2", "... and 4 more"]


def test_the_json_and_the_junit_report(different: tuple[object, ...], tmp_path: Path) -> None:
    report = tmp_path / "report.xml"
    report.write_text("old")
    done = run(*different, "--json", "--junit", report, "--overwrite")
    document: dict[str, Any] = json.loads(done.stdout)
    told = {key: document[key] for key in ("same", "exit_code", "difference_count")}
    assert told == {"same": False, "exit_code": 1, "difference_count": 7}
    assert len(document["differences"]) == 3
    assert document["differences"][0]["kind"] == "topic"
    topic = next(one for one in document["topics"] if one["name"] == "/b")
    counts = [topic[key] for key in ("expected", "actual", "different", "missing")]
    assert counts == [3, 2, 2, 1]
    (suite,) = ET.parse(report).getroot()  # noqa: S314 - our own
    assert suite.attrib["tests"] == str(len(suite.findall("testcase"))) == "5"
    assert (suite.attrib["failures"], suite.attrib["errors"]) == ("3", "0")
    cases = {case.attrib["name"]: case.find("failure") for case in suite}
    failed = {"/<&>\\x1b[31m\\x00", "/a", "/b"}
    assert set(cases) == {"files can be read", "(records)", *failed}
    assert {name for name, failure in cases.items() if failure is not None} == failed
    failure = cases["/b"]
    assert failure is not None
    assert failure.attrib["message"] == "2 different, 1 missing, of 3 messages"
    assert failure.text == "/b[0] t=0.000 s: expected 1, got 2"


def test_warnings_go_to_stderr_and_change_no_exit_code(files: tuple[Path, Path]) -> None:
    path, link = files
    path.write_text(DOCUMENT)
    link.symlink_to(path)
    done = run(path, link)
    assert (done.returncode, done.stdout[:6]) == (0, "same: ")
    warning = f"{path} and {link} are the same file, so nothing can differ"
    assert done.stderr == f"warning: {warning}\n"
    assert json.loads(run(path, link, "--json").stdout)["warnings"] == [warning]


def test_a_table_of_very_many_parts_has_those_that_differ(files: tuple[Path, Path]) -> None:
    many = {f"k{number}": 0 for number in range(50_000)}
    for path, document in zip(files, (many, many | {"k7": 1, "k30000": 1}), strict=True):
        path.write_text(json.dumps(document))
    done = run(*files, timeout=60)
    assert done.returncode == 1
    lines = done.stdout.splitlines()
    assert [line.split()[0] for line in lines[1:4]] == ["part", "k7", "k30000"]
    assert lines[4] == "... and 49998 more, 0 of them different"
