"""The registry of containers, and what a new entry in it brings."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest

from dogbot_logtool.errors import LogError
from dogbot_logtool.reader import not_a_log, opening
from dogbot_logtool.reader.containers.batch import Batch
from dogbot_logtool.reader.containers.contents import Contents
from dogbot_logtool.reader.containers.log import Log, Span
from dogbot_logtool.reader.containers.sources.source import ByteSource
from dogbot_logtool.reader.decode.message_table import no_messages
from dogbot_logtool.reader.opening import open_log
from dogbot_logtool.reader.registry import CONTAINERS, ROSBAG2_SUFFIXES, Container

MAGIC = b"EXAMPLE1"


class ExampleLog(Log):
    container = "example"

    def _read(self, span: Span) -> Batch:
        del span
        return Batch(np.zeros(1, np.uint8), no_messages(), ())


def open_example(source: ByteSource, distribution: str) -> Log:
    del distribution
    return ExampleLog(source, Contents({}, [], {}, None, None))


def register(monkeypatch: pytest.MonkeyPatch, *, scanned: bool) -> None:
    entry = Container("example", MAGIC, ".example", open_example, is_scanned=scanned)
    for module in (opening, not_a_log):
        monkeypatch.setattr(module, "CONTAINERS", (*CONTAINERS, entry))


def opened(path: Path, data: bytes) -> tuple[str, list[str]]:
    path.write_bytes(data)
    log = open_log(path)
    log.close()
    return log.container, [loss.what for loss in log.losses]


def test_suffixes_and_magics_tell_containers_apart() -> None:
    def unlike(values: Iterable[object]) -> bool:
        listed = list(values)
        return len(listed) == len(set(listed))

    assert unlike(each.suffix for each in CONTAINERS)
    assert unlike(each.magic for each in CONTAINERS)
    assert unlike(each.name for each in CONTAINERS)
    # As many bytes of a file are read to recognise it.
    assert all(len(each.magic) <= 16 for each in CONTAINERS)
    assert set(ROSBAG2_SUFFIXES) == {".db3", ".mcap"}


@pytest.mark.parametrize("scanned", [True, False])
def test_an_entry_is_all_that_opening_needs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, scanned: bool
) -> None:
    path = tmp_path / "log.example"
    with pytest.raises(LogError, match="is neither a ROS 1 bag"):
        opened(path, MAGIC + b"data")
    register(monkeypatch, scanned=scanned)
    assert opened(path, MAGIC + b"data") == ("example", [])
    with pytest.raises(LogError, match="breaks off after 4 bytes"):
        opened(path, MAGIC[:4])


def test_a_file_without_an_index_is_scanned(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    register(monkeypatch, scanned=True)
    path = tmp_path / "log.example"
    damaged = b"EXAMPLE2data"
    assert opened(path, damaged) == ("example", ["the file's first bytes are damaged"])


def test_a_container_that_cannot_be_scanned_needs_its_magic(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    register(monkeypatch, scanned=False)
    path = tmp_path / "log.example"
    with pytest.raises(LogError, match="is neither a ROS 1 bag"):
        opened(path, b"EXAMPLE2data")
