"""The bytes of a log that lies in a store, read by range: only what is asked for is fetched."""

import shutil
import tempfile
import threading
from collections import OrderedDict
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from dogbot_logtool.errors import CallError, LogError
from dogbot_logtool.io import storage
from dogbot_logtool.io.scratch import scratch_folder
from dogbot_logtool.reader.containers.sources.source import ByteSource

if TYPE_CHECKING:
    from upath import UPath

_BLOCK: Final = 64 << 10
"""Smaller reads fetch blocks of this size and keep them, since their neighbours follow."""
_BLOCKS: Final = 64
_NEAR: Final = 16 << 10
"""Ranges with a smaller gap between them are fetched as one."""
_AT_ONCE: Final = 16
"""Requests to a web server; a bucket's store takes more."""


class RemoteSource(ByteSource):
    """An object read by ranges; safe to share among threads."""

    can_fork = False
    """Stores are asked by threads of their own, which copies of this process have not."""
    has_cheap_seeks = False
    cheap_size = 1 << 20

    def __init__(self, url: "UPath", facts: storage.Facts) -> None:
        """Take an object.

        Args:
            url: the object.
            facts: what the store says about it.

        Raises:
            CallError: it is a directory.
            LogError: the store does not give its size.
        """
        self.path = url
        self._url = url
        if facts.is_folder:
            raise CallError(f"{storage.shown(url)}: is a directory, not a log file")
        if facts.size is None:
            raise LogError(
                f"{storage.shown(url)}: its server does not tell its size, so that it cannot be "
                "read by parts; download it first"
            )
        self.size = facts.size
        # A small object is fetched as a whole: each request takes longer than its bytes.
        self._block_size = self.size if self.size <= self.cheap_size else _BLOCK
        self._blocks: OrderedDict[int, bytes] = OrderedDict()
        self._lock = threading.Lock()

    def read(self, offset: int, size: int) -> bytes:
        """See `ByteSource.read`.

        Raises:
            StoreError: the store fails.
        """
        size = min(size, self.size - offset)
        if offset < 0 or size <= 0:
            return b""
        block = self._block_size
        if size > block:
            return self._fetch([(offset, offset + size)])[0]
        first, last = offset // block, (offset + size - 1) // block
        data = b"".join(self._block(number) for number in range(first, last + 1))
        return data[offset - first * block :][:size]

    def read_many(self, ranges: Sequence[tuple[int, int]]) -> list[bytes]:
        """See `ByteSource.read_many`; neighbours are fetched as one, and all at once."""
        if self.size <= self._block_size:
            return [self.read(offset, size) for offset, size in ranges]
        wanted = [(start, min(start + size, self.size)) for start, size in ranges]
        whole: list[tuple[int, int]] = []
        for start, end in sorted(wanted):
            if whole and start <= whole[-1][1] + _NEAR:
                whole[-1] = whole[-1][0], max(whole[-1][1], end)
            elif start < end:
                whole.append((start, end))
        data = dict(zip(whole, self._fetch(whole), strict=True))
        return [
            next(
                (data[run][start - run[0] : end - run[0]] for run in whole if _covers(run, start)),
                b"",
            )
            for start, end in wanted
        ]

    def nearby(self) -> ByteSource:
        """See `ByteSource.nearby`: a copy on the disk without a name, gone when it is closed."""
        with scratch_folder() as folder:
            self._copy_to(folder / "copy")
            copy = ByteSource(folder / "copy")
        copy.path = self.path
        return copy

    def _copy_to(self, target: Path) -> None:
        """Write all of it to a file.

        Raises:
            LogError: there is no room.
        """
        folder = tempfile.gettempdir()
        room = shutil.disk_usage(folder).free
        if self.size > room:
            raise LogError(
                f"{storage.shown(self.path)}: is not read by parts, so that all its "
                f"{self.size} bytes are needed on a disk; {folder} has room for {room} "
                "(TMPDIR names another)"
            )
        with target.open("wb") as file:
            for start in range(0, self.size, _PIECE):
                file.write(self._fetch([(start, min(start + _PIECE, self.size))])[0])

    def close(self) -> None:
        """Forget what was read."""
        self._blocks.clear()

    def _block(self, number: int) -> bytes:
        with self._lock:
            if number in self._blocks:
                self._blocks.move_to_end(number)
                return self._blocks[number]
        start = number * self._block_size
        data = self._fetch([(start, min(start + self._block_size, self.size))])[0]
        with self._lock:
            self._blocks[number] = data
            if len(self._blocks) > _BLOCKS:
                self._blocks.popitem(last=False)
        return data

    def _fetch(self, ranges: Sequence[tuple[int, int]]) -> list[bytes]:
        """Fetch bytes from starts to ends."""
        found: dict[int, bytes] = {}

        def missing() -> list[bytes]:
            left = [run for run in ranges if run[0] not in found]
            answers = _cat(self._url, left)
            for (start, end), answer in zip(left, answers, strict=True):
                if not isinstance(answer, BaseException) and len(answer) > end - start:
                    raise LogError(
                        f"{storage.shown(self.path)}: its server sends more than the parts that "
                        "are asked for; download it first"
                    )
                if not isinstance(answer, BaseException) and len(answer) == end - start:
                    found[start] = answer
            failed = [answer for answer in answers if isinstance(answer, BaseException)]
            if failed:
                raise failed[0]
            if len(found) < len({start for start, _ in ranges}):
                raise OSError("it sends less than was asked for")
            return [found[start] for start, _ in ranges]

        return storage.asked(self.path, missing) if ranges else []


def _covers(run: tuple[int, int], offset: int) -> bool:
    return run[0] <= offset < run[1]


def _cat(url: "UPath", ranges: Sequence[tuple[int, int]]) -> list[Any]:
    """Return bytes, or the error, for each range; a stall is an error."""
    from fsspec.asyn import AsyncFileSystem, sync  # noqa: PLC0415 - only URLs need it

    names = [url.path] * len(ranges)
    starts, ends = [run[0] for run in ranges], [run[1] for run in ranges]
    fs = url.fs
    if isinstance(fs, AsyncFileSystem):
        # A small server has no room for a hundred connections at once, and leaves some waiting.
        options = {"batch_size": _AT_ONCE} if url.protocol in {"http", "https"} else {}
        within = storage.ANSWER_WITHIN_S
        answers = sync(fs.loop, fs._cat_ranges, names, starts, ends, timeout=within, **options)  # noqa: SLF001 - the only call with a timeout
    else:
        answers = fs.cat_ranges(names, starts, ends)
    return list(answers)


_PIECE: Final = 8 << 20
