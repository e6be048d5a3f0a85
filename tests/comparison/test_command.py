"""`compare` from the outside: what goes together, patterns on logs, reports, exit codes."""

import json
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pytest

import dogbot_logtool as dl
from tests.comparison.recordings import JSON, recording
from tests.forked_cli import Ended
from tests.forked_cli import run as run_command

DOCUMENT = '{"gait": {"name": "trot"}}'
TOPICS = ("/a", "/b", "/<&>\x1b[31m\x00")


def run(*words: object, timeout: float = 120.0) -> Ended:
    return run_command("compare", *words, timeout=timeout)


def write_log(path: Path, *payloads: str, topics: tuple[str, ...] = ("/a",)) -> Path:
    messages = (
        (topic, time, each.encode()) for topic in topics for time, each in enumerate(payloads)
    )
    return recording(dict.fromkeys(topics, JSON), *messages).write(path)


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path]:
    return tmp_path / "expected", tmp_path / "actual"


def test_files_that_do_not_go_together(files: tuple[Path, Path]) -> None:
    expected, actual = files

    def refused(exit_code: int) -> str:
        with pytest.raises(dl.LogtoolError) as error:
            dl.compare(expected, actual)
        assert error.value.exit_code == exit_code
        return str(error.value)

    assert refused(2) == f"{expected}: no such file"
    write_log(expected, "1")
    assert refused(2) == f"{actual}: no such file"
    actual.write_text(DOCUMENT)
    assert refused(2) == f"{actual} is JSON, but {expected} is not: they cannot be compared"
    actual.write_bytes(b"rubbish")
    assert "is neither a ROS 1 bag" in refused(1)
    actual.write_bytes(b"")
    assert "is empty" in refused(1)
    actual.unlink()
    actual.mkdir()
    assert refused(2) == f"{actual}: is a directory, not a log file, and holds no ROS 2 bag"


@pytest.fixture
def different(files: tuple[Path, Path]) -> tuple[object, ...]:
    write_log(files[0], "1", '"x"', "3", topics=TOPICS)
    write_log(files[1], "2", '"x\\u0000<"', topics=TOPICS[1:])
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
    done = run(*different, "--json", "--junit", report)
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


def test_a_report_replaces_nothing_unasked(files: tuple[Path, Path], tmp_path: Path) -> None:
    for path in files:
        path.write_text(DOCUMENT)
    report = tmp_path / "report.xml"
    report.write_text("mine")
    done = run(*files, "--junit", report)
    assert (done.returncode, done.stdout, report.read_text()) == (2, "", "mine")
    assert "exists already; --overwrite replaces it" in done.stderr
    assert run(*files, "--junit", report, "--overwrite").returncode == 0
    assert report.read_bytes().startswith(b"<?xml")
    for path in files:
        assert run(*files, "--junit", path, "--overwrite").returncode == 2
        assert path.read_text() == DOCUMENT


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


@pytest.mark.parametrize("count", [2_000, pytest.param(16_000, marks=pytest.mark.slow)])
def test_very_many_topics_take_no_longer_than_their_number(
    files: tuple[Path, Path], count: int
) -> None:
    kinds = {f"/t{number}": JSON for number in range(count)}
    for path, left_out in zip(files, ("", "/t77"), strict=True):
        recording(kinds, *((t, 0, b"1") for t in kinds if t != left_out)).write(path)
    done = run(*files, "--ignore", "/nothing", timeout=60)
    assert done.returncode == 1
    assert "/t77[0] t=0.000 s: missing" in done.stdout
