"""Which logs are gone for certain."""

import os
from pathlib import Path

import pytest
from upath import UPath

from dogbot_logtool.io import storage
from dogbot_logtool.report.dataset.dataset import gone_logs, key_of
from dogbot_logtool.report.dataset.parts import Part, StoredLog


def stored(location: storage.Location) -> StoredLog:
    name = storage.shown(storage.from_root(location))
    return StoredLog(Part("p", 0), key_of(location), name, "", None, None, {})


def is_gone(location: storage.Location) -> bool:
    return bool(gone_logs([stored(location)]))


@pytest.mark.parametrize("name", [b"walk.bag", b"\xff.bag", b"\\xff.bag", "é \\x41.bag".encode()])
def test_a_file_of_any_name(tmp_path: Path, name: bytes) -> None:
    file = Path(os.fsdecode(os.fsencode(tmp_path) + b"/" + name))
    file.write_bytes(b"")
    assert not is_gone(file)
    file.unlink()
    assert is_gone(file)
    assert is_gone(file / "below")


def test_an_object_in_a_store() -> None:
    path = UPath("memory://gone/walk.bag")
    path.write_bytes(b"")
    assert not is_gone(path)
    path.unlink()
    assert is_gone(path)


def test_a_url_that_is_not_kept_whole_cannot_be_looked_for() -> None:
    assert not is_gone(UPath("http://127.0.0.1:1/log.bag?token=secret"))
