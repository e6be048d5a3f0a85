"""The registry of encodings: profiles, late imports, and that a row is all that one needs."""

import subprocess
import sys
from pathlib import Path

import pytest
from mcap.reader import make_reader

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.options import ConvertOptions
from dogbot_logtool.writer.encodings.registry import (
    ENCODINGS,
    OutputEncoding,
)
from dogbot_logtool.writer.encodings.ros import Ros1Encoding
from tests.paths import SAMPLE_LOGS

TROT = SAMPLE_LOGS / "dogbot_trot.bag"


def header_profile(path: Path) -> str:
    with path.open("rb") as file:
        return make_reader(file).get_header().profile


def test_a_row_is_all_that_an_encoding_needs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = OutputEncoding("other", "ROS 1 by another name", profile="other", load=Ros1Encoding)
    monkeypatch.setitem(ENCODINGS, "other", other)
    target = tmp_path / "out.mcap"
    done = convert(TROT, target, ConvertOptions(encoding="other", copy=False, end=0.1))
    assert sum(done.annotations.values()) > 0
    assert header_profile(target) == "other"


def test_the_registry_loads_no_message_library() -> None:
    script = (
        "import sys, dogbot_logtool.writer.encodings.registry\n"
        "print({'numpy', 'rosbags', 'google.protobuf', 'mcap'} & set(sys.modules))"
    )
    words = [sys.executable, "-c", script]
    done = subprocess.run(words, capture_output=True, text=True, check=True)  # noqa: S603
    assert done.stdout.strip() == "set()"
