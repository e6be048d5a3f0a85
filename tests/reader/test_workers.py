"""Workers that read parts of a log: they end at once, however they or the reading end."""

import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import closing
from multiprocessing.sharedctypes import Synchronized
from pathlib import Path

import pytest

from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.opening import open_log
from dogbot_logtool.reader.workers import in_order
from tests.paths import TROT

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes are not forked here")
LARGE = 8 << 20
"""Bytes of a result that no pipe holds."""


@pytest.fixture
def log() -> Iterator[Log]:
    with closing(open_log(Path(TROT))) as opened:
        yield opened


@pytest.mark.parametrize("size", [0, LARGE], ids=["at work", "sending"])
def test_a_process_that_dies_is_told(log: Log, size: int) -> None:
    second: Synchronized[int] = multiprocessing.get_context("fork").Value("i", 0)

    def work(_log: Log, item: int) -> bytes:
        if item == 1:
            second.value = os.getpid()
            time.sleep(0.0 if size else 60.0)
        elif item > 1:
            # Else the other process may do all that is left before the death is seen.
            time.sleep(0.2)
        return bytes(item * size)

    with closing(in_order(work, log, range(8), 2)) as results:
        next(results)
        while not second.value:
            time.sleep(0.01)
        time.sleep(0.2)
        os.kill(second.value, signal.SIGKILL)
        with pytest.raises(LogtoolError, match=r"a process that worked on it died"):
            list(results)
    assert not multiprocessing.active_children()


def test_what_is_under_way_is_given_up(log: Log) -> None:
    def work(_log: Log, item: int) -> int:
        time.sleep(60.0 * item)
        return item

    with closing(in_order(work, log, range(8), 2)) as results:
        assert next(results) == 0
    assert not multiprocessing.active_children()
