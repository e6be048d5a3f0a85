"""The least that `convert` could take: decompress what it reads, compress and CRC what it writes.

The codecs, levels and threads are those of `convert`, and compressors are used again. Each piece is
brought into the processor's cache before its clock starts, as it is there when `convert` comes to
it; the threads are taken to share the work evenly. Chunks that an MCAP input hands on as they are
cost nothing here.

    python benchmarks/bound.py codecs IN OUT JOBS
    python benchmarks/bound.py process IN OUT JOBS

print seconds, and seconds of processor time: of the codecs alone, or with what no process is
without that does it in Python, to start with numpy and the codecs, and to read the input's chunks.
To find these chunks and to write anything is left out of both.
"""

import subprocess
import sys
import threading
import time
import zlib
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import zstandard

from dogbot_logtool.reader.compression import decompress_into
from dogbot_logtool.reader.log import Log
from dogbot_logtool.reader.opening import open_log
from dogbot_logtool.writer.chunks import ZSTD_LEVEL

Chunk = tuple[bytes, int, str]
"""Stored bytes, size when decompressed, compression."""


def stored_chunks(log: Log) -> list[Chunk]:
    """Read all chunks as they are stored."""
    return [
        (log.source.read(chunk.data_offset, chunk.data_size), chunk.size, chunk.compression)
        for chunk in log.chunks
    ]


class _Codecs(threading.local):
    def __init__(self) -> None:
        self.zstd = zstandard.ZstdCompressor(level=ZSTD_LEVEL)
        self.target = np.empty(0, np.uint8)

    def room(self, size: int) -> np.ndarray:
        """Return memory that was used before, as an allocator would."""
        if len(self.target) < size:
            self.target = np.zeros(size, np.uint8)
        return self.target[:size]


_CODECS = _Codecs()


def timed(work: Callable[[], object]) -> float:
    """Return the seconds that some work takes."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def read(chunk: Chunk) -> float:
    """Do what reading a chunk costs at least; return the seconds."""
    data, size, compression = chunk
    hot, target = memoryview(bytes(bytearray(data))), _CODECS.room(size)
    return timed(lambda: decompress_into(target, hot, compression))


def write(chunk: Chunk) -> float:
    """Do what writing a chunk costs at least; return the seconds."""
    data, size, compression = chunk
    content = _CODECS.room(size)
    decompress_into(content, memoryview(data), compression)

    def pack() -> None:
        zlib.crc32(content.data)
        _CODECS.zstd.compress(content.data)

    return timed(pack)


def start_python() -> None:
    """Start a process that could do it, and let it end."""
    libraries = "import numpy, zstandard, lz4.block, lz4.frame, xxhash"
    subprocess.run([sys.executable, "-c", libraries], check=True)


def main(what: str, source: Path, target: Path, jobs: int) -> None:
    """Measure."""
    log = open_log(source)
    inputs = stored_chunks(log)
    handed_on = {data for data, _, _ in inputs}
    outputs = [chunk for chunk in stored_chunks(open_log(target)) if chunk[0] not in handed_on]
    with ThreadPoolExecutor(jobs) as pool:
        codecs = sum(pool.map(read, inputs)) + sum(pool.map(write, outputs))
    besides = 0.0
    if what == "process":
        besides = timed(start_python) + timed(lambda: stored_chunks(log))
    print(f"{besides + codecs / jobs:.4f} {besides + codecs:.4f}")


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]), int(sys.argv[4]))
