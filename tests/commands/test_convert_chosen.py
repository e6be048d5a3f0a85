"""`convert --topics` and `--without`: what is copied, what stays, what is said."""

from pathlib import Path

import pytest

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.errors import CallError
from dogbot_logtool.options import ConvertOptions
from tests.oracles import base_walks
from tests.oracles.annotated_file import read_written
from tests.oracles.foot_logs import CONTACTS, write_log

FEET = {"/feet/left/contact": CONTACTS, "/feet/right/contact": CONTACTS}


@pytest.fixture
def log(tmp_path: Path) -> Path:
    return write_log(tmp_path / "walk.mcap", FEET, odometry=["/odom"], samples=200)


def test_topics_are_left_out_and_annotations_stay(log: Path, tmp_path: Path) -> None:
    whole, part = tmp_path / "whole.mcap", tmp_path / "part.mcap"
    convert(log, whole, ConvertOptions())
    done = convert(log, part, ConvertOptions(topics=("!/feet/*",)))
    expected = read_written(whole).topics
    for topic in FEET:
        del expected[topic]
    found = read_written(part).topics
    assert (found, found.keys()) == (expected, expected.keys())
    assert done.copied == 200
    (said,) = [finding for finding in done.findings if finding.code == "COPY"]
    assert said.text.startswith("400 messages of topics left out of the copy: /feet/left/contact")


def test_only_some_topics_are_copied(log: Path, tmp_path: Path) -> None:
    target = tmp_path / "part.mcap"
    options = ConvertOptions(topics=("/odom", "/feet/*", "!*/right/*"))
    done = convert(log, target, options)
    assert done.copied == 400
    written = read_written(target)
    assert written.topics.keys() >= {"/odom", "/feet/left/contact", "/tf"}
    assert "/feet/right/contact" not in written.topics
    (record,) = [each for each in written.metadata if "style" in each.metadata]
    assert record.metadata["topics"] == "/odom /feet/*"
    assert record.metadata["without"] == "*/right/*"


def test_a_pattern_that_fits_nothing_is_a_warning(log: Path, tmp_path: Path) -> None:
    target = tmp_path / "part.mcap"
    done = convert(log, target, ConvertOptions(topics=("!/camera/*",)))
    (said,) = [finding for finding in done.findings if finding.code == "COPY"]
    assert said.text == "--topics !/camera/* fits no topic of the log"
    assert done.copied == 600


def test_nothing_is_chosen_of_no_copy(log: Path, tmp_path: Path) -> None:
    options = ConvertOptions(copy=False, topics=("/odom",))
    with pytest.raises(CallError, match="--no-copy"):
        convert(log, tmp_path / "part.mcap", options)


def test_transforms_that_are_left_out_are_written_anew(tmp_path: Path) -> None:
    path = base_walks.write(tmp_path / "walk.mcap", "tf2_msgs/TFMessage", "/tf")
    done = convert(path, tmp_path / "part.mcap", ConvertOptions(topics=("!/tf",)))
    assert done.annotations["/tf"] > 100
