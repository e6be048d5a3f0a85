"""Runs of messages that stand outside of chunks."""

from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Bytes
from dogbot_logtool.reader.containers.salvage.records import RecordFormat
from dogbot_logtool.reader.containers.sources.source import ByteSource

_REGION_SIZE: Final = 1 << 20
"""Messages are read in runs of about this many bytes."""
_REGION_RECORDS: Final = 1 << 16
_FIRST_RECORDS: Final = 16
_NO_ACCIDENT: Final = 4
_READ_AT_ONCE: Final = 4 << 20


class Runs:
    """Finds runs of messages; those that follow each other share what was read."""

    def __init__(self, source: ByteSource, fmt: RecordFormat) -> None:
        self._source = source
        self._format = fmt
        self._offset, self._read = 0, b""
        """What was read last, and where it stands."""

    def at(self, offset: int, end: int) -> tuple[Bytes, int, list[int]]:
        """Return bytes, how many messages they begin with, and where their records begin and end.

        More and more records are looked at: where runs of messages are short, looking at all that
        follows each of them would take the square of the time.

        Args:
            offset: where the first message begins.
            end: where it ends.
        """
        window = self._window(offset, end - offset)
        limit = _FIRST_RECORDS
        while True:
            bounds = self._format.chain(window.data, 0, len(window), limit)
            found = self._format.decode(window, np.array(bounds[:-1], np.int64))
            others = np.flatnonzero(found.op != self._format.message)
            if len(others):
                return window, int(others[0]), bounds
            if len(found) < limit or limit == _REGION_RECORDS:
                return window, len(found), bounds
            limit = min(limit * 8, _REGION_RECORDS)

    def begins(self, offset: int, end: int) -> bool:
        """Tell whether so many messages follow each other that they are no accident; see `at`."""
        return self.at(offset, end)[1] >= _NO_ACCIDENT

    def forget(self) -> None:
        """Forget what was read."""
        self._offset, self._read = 0, b""

    def _window(self, offset: int, least: int) -> Bytes:
        size = max(_REGION_SIZE, least)
        end = min(offset + size, self._source.size)
        if not (self._offset <= offset and end <= self._offset + len(self._read)):
            self._offset = offset
            self._read = self._source.read(offset, max(size, _READ_AT_ONCE))
        return np.frombuffer(memoryview(self._read)[offset - self._offset :][:size], np.uint8)
