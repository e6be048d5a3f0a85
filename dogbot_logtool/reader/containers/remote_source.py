"""The bytes of a log that lies in a store, read by range: only what is asked for is fetched."""

from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Final

from dogbot_logtool.errors import CallError, LogError
from dogbot_logtool.io import storage
from dogbot_logtool.reader.containers.source import ByteSource, copied

if TYPE_CHECKING:
    from upath import UPath

_BLOCK: Final = 64 << 10
"""Smaller reads fetch blocks of this size and keep them, since their neighbours follow."""
_BLOCKS: Final = 64
_AT_ONCE: Final = 16
"""Requests to a web server; a bucket's store takes more."""
_PIECE: Final = 8 << 20

_Run = tuple[int, int]
"""First byte and the first behind."""


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
            raise CallError(f"{storage.name_of(url)}: is a directory, not a log file")
        if facts.size is None:
            raise LogError(
                f"{storage.name_of(url)}: its server does not tell its size, so that it cannot be "
                "read by parts; download it first"
            )
        self.size = facts.size
        # A small object is fetched as a whole: each request takes longer than its bytes.
        self._block_size = self.size if self.size <= self.cheap_size else _BLOCK
        self._block = lru_cache(_BLOCKS)(self._fetch_block)

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
        data = b"".join(map(self._block, range(first, last + 1)))
        return data[offset - first * block :][:size]

    def read_many(self, ranges: Sequence[tuple[int, int]]) -> list[bytes]:
        """See `ByteSource.read_many`; all are fetched at once."""
        if self.size <= self._block_size:
            return [self.read(offset, size) for offset, size in ranges]
        ends = [min(start + size, self.size) for start, size in ranges]
        runs = [(start, max(start, end)) for (start, _), end in zip(ranges, ends, strict=True)]
        fetched = iter(self._fetch([run for run in runs if run[0] < run[1]]))
        return [next(fetched) if start < end else b"" for start, end in runs]

    def nearby(self) -> ByteSource:
        """See `ByteSource.nearby`: a copy on the disk without a name, gone when it is closed.

        Raises:
            LogError: there is no room.
        """
        runs = [(start, min(start + _PIECE, self.size)) for start in range(0, self.size, _PIECE)]
        return copied(self.path, self.size, ((run[0], self._fetch([run])[0]) for run in runs))

    def close(self) -> None:
        """Forget what was read."""
        self._block.cache_clear()

    def _fetch_block(self, number: int) -> bytes:
        start = number * self._block_size
        return self._fetch([(start, min(start + self._block_size, self.size))])[0]

    def _fetch(self, runs: Sequence[_Run]) -> list[bytes]:
        def answers() -> list[bytes]:
            found = _cat(self._url, runs)
            for (start, end), answer in zip(runs, found, strict=True):
                if isinstance(answer, BaseException):
                    raise answer
                if len(answer) > end - start:
                    raise LogError(
                        f"{storage.name_of(self.path)}: its server sends more than the parts that "
                        "are asked for; download it first"
                    )
                if len(answer) < end - start:
                    raise OSError("it sends less than was asked for")
            return found

        return storage.asked(self.path, answers) if runs else []


def _cat(url: "UPath", runs: Sequence[_Run]) -> list[Any]:
    """Return bytes, or the error, for each run; a stall is an error."""
    from fsspec.asyn import AsyncFileSystem, sync  # noqa: PLC0415 - only URLs need it

    names, starts, ends = [url.path] * len(runs), [run[0] for run in runs], [run[1] for run in runs]
    fs = url.fs
    if not isinstance(fs, AsyncFileSystem):
        return list(fs.cat_ranges(names, starts, ends))
    # A small server has no room for a hundred connections at once, and leaves some waiting.
    options = {"batch_size": _AT_ONCE} if url.protocol in {"http", "https"} else {}
    within = storage.ANSWER_WITHIN_S
    answers = sync(fs.loop, fs._cat_ranges, names, starts, ends, timeout=within, **options)  # noqa: SLF001 - the only call with a timeout
    return list(answers)
