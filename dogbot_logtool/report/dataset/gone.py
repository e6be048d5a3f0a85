"""Which logs of a dataset are no longer where they were."""

import os
import re
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Final

from dogbot_logtool.errors import CallError, LogtoolError
from dogbot_logtool.io import storage
from dogbot_logtool.report.dataset.log_state import key_of
from dogbot_logtool.report.dataset.parts import StoredLog

_ASKED_AT_ONCE: Final = 16
_ESCAPED: Final = re.compile(rb"\\x([89a-f][0-9a-f])")
"""How a byte of a name that is not UTF-8 is shown."""


def gone_logs(logs: Sequence[StoredLog]) -> list[StoredLog]:
    """Return the logs that are gone for certain; one that cannot be looked for is kept.

    Raises:
        StoreError: a store fails.
    """
    with ThreadPoolExecutor(_ASKED_AT_ONCE) as pool:
        return [log for log, gone in zip(logs, pool.map(_is_gone, logs), strict=True) if gone]


def _is_gone(log: StoredLog) -> bool:
    try:
        location = storage.location(log.name)
    except LogtoolError:
        return False
    if isinstance(location, Path):
        names = os.fsencode(log.name), _ESCAPED.sub(_byte, os.fsencode(log.name))
        return not any(map(_may_be_there, names))
    if key_of(location) != log.key:
        return False  # a part of the URL is not kept, since it may hold secrets
    try:
        return not storage.asked(location, lambda: location.fs.exists(location.path))
    except CallError:
        return False


def _byte(escaped: re.Match[bytes]) -> bytes:
    return bytes.fromhex(escaped[1].decode())


def _may_be_there(name: bytes) -> bool:
    try:
        os.stat(name)  # noqa: PTH116 - a name of any bytes
    except (FileNotFoundError, NotADirectoryError):
        return False
    except (OSError, ValueError):
        return True
    return True
