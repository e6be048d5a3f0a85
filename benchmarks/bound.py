"""The least that `convert` could take: decompress what it reads, compress and CRC what it writes.

The codecs and levels are those of `convert`, in as many processes, and all memory is used again.
Each piece is brought into the processor's cache before its clock starts, as it is there when
`convert` comes to it; the processes are taken to share the work evenly. Chunks that an MCAP input
hands on as they are cost nothing here. Neither does the rest of a process: starting Python, reading
and writing files.

    python benchmarks/bound.py IN OUT JOBS      prints seconds, and seconds of processor time
"""

import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import zstandard
from zlib_ng.zlib_ng import crc32

from dogbot_logtool.reader.containers.compression import decompress_into
from dogbot_logtool.reader.containers.log import Chunk, Log
from dogbot_logtool.reader.opening import open_log
from dogbot_logtool.reader.workers import in_order
from dogbot_logtool.writer.chunks import ZSTD

_CODEC = zstandard.ZstdCompressor(compression_params=ZSTD)


class _Room:
    """Memory that is used again and again."""

    def __init__(self) -> None:
        self._bytes = np.empty(0, np.uint8)

    def of(self, size: int) -> np.ndarray:
        if len(self._bytes) < size:
            self._bytes = np.zeros(size, np.uint8)
        return self._bytes[:size]


_ROOM = _Room()


def stored(log: Log, chunk: Chunk) -> bytes:
    """Read a chunk as it is stored."""
    return log.source.read(chunk.data_offset, chunk.data_size)


def timed(work: Callable[[], object]) -> float:
    """Return the seconds that some work takes."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def read(log: Log, chunk: Chunk) -> float:
    """Do what reading a chunk costs at least; return the seconds."""
    data, target = memoryview(stored(log, chunk)), _ROOM.of(chunk.size)
    return timed(lambda: decompress_into(target, data, chunk.compression))


def write(log: Log, chunk: Chunk) -> float:
    """Do what writing a chunk costs at least; return the seconds."""
    content = _ROOM.of(chunk.size)
    decompress_into(content, memoryview(stored(log, chunk)), chunk.compression)

    def pack() -> None:
        crc32(content.data)
        _CODEC.compress(content.data)

    return timed(pack)


def packed_anew(source: Log, target: Log) -> Iterator[Chunk]:
    """Yield the chunks of the output that are none of the input's."""
    handed_on = {crc32(stored(source, chunk)) for chunk in source.chunks}
    for chunk in target.chunks:
        if crc32(stored(target, chunk)) not in handed_on:
            yield chunk


def main(source: Log, target: Log, jobs: int) -> None:
    """Measure."""
    seconds = sum(in_order(read, source, source.chunks, jobs))
    anew = list(packed_anew(source, target))
    seconds += sum(in_order(write, target, anew, jobs))
    print(f"{seconds / jobs:.4f} {seconds:.4f}")


if __name__ == "__main__":
    main(open_log(Path(sys.argv[1])), open_log(Path(sys.argv[2])), int(sys.argv[3]))
