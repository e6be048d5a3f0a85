"""A log file as bytes by place."""

import os
from pathlib import Path

import pytest

from dogbot_logtool.errors import CallError
from dogbot_logtool.reader.containers.sources.source import ByteSource


def test_reads_what_is_there_and_never_more(tmp_path: Path) -> None:
    path = tmp_path / "log"
    path.write_bytes(b"0123456789")
    with ByteSource(path) as source:
        assert source.size == 10
        assert source.read(2, 3) == b"234"
        assert source.read(8, 1 << 40) == b"89"
        assert source.read(10, 1) == b""
        assert source.read(-1, 5) == b""
        assert source.read(1 << 70, 5) == b""
        assert source.read(0, -1) == b""


def test_a_missing_file_is_a_wrong_call(tmp_path: Path) -> None:
    with pytest.raises(CallError, match="no such file"):
        ByteSource(tmp_path / "absent")


def test_a_folder_is_a_wrong_call(tmp_path: Path) -> None:
    with pytest.raises(CallError, match="is a directory"):
        ByteSource(tmp_path)


def test_a_pipe_is_a_wrong_call(tmp_path: Path) -> None:
    path = tmp_path / "pipe"
    os.mkfifo(path)
    with pytest.raises(CallError, match="not a regular file"):
        ByteSource(path)


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
def test_a_forbidden_file_is_a_wrong_call(tmp_path: Path) -> None:
    path = tmp_path / "secret"
    path.write_bytes(b"x")
    path.chmod(0)
    with pytest.raises(CallError, match="cannot be opened"):
        ByteSource(path)


def test_a_file_that_shrinks_gives_less(tmp_path: Path) -> None:
    path = tmp_path / "log"
    path.write_bytes(b"0123456789")
    with ByteSource(path) as source:
        os.truncate(path, 4)
        assert source.read(2, 8) == b"23"
