"""The processes that a call has started, and those that go on when it has ended."""

import contextlib
import os
import signal
import time
from collections.abc import Iterator
from typing import Final

import psutil

PATIENCE_S: Final = 60.0
"""Nothing takes longer on the slowest of machines."""


def members(session: int) -> list[int]:
    """Return the processes of a session that still run."""
    return [each.pid for each in psutil.process_iter() if is_member(each, session)]


def is_member(process: psutil.Process, session: int) -> bool:
    with contextlib.suppress(psutil.Error, ProcessLookupError):
        ended = process.status() in {psutil.STATUS_ZOMBIE, psutil.STATUS_DEAD}
        return not ended and os.getsid(process.pid) == session
    return False


def survivors_of(session: int) -> Iterator[str]:
    """End the processes of a session that go on; yield a sentence for each."""
    end = time.monotonic() + PATIENCE_S
    while (alive := members(session)) and time.monotonic() < end:
        time.sleep(0.01)
    for survivor in alive:
        yield f"process {survivor} goes on"
        os.kill(survivor, signal.SIGKILL)
