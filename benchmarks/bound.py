"""The least that `convert` could take: decompress what it reads, compress and CRC what it writes.

The chunks are in memory before the clock starts; the codecs, levels and threads are the same, and
compressors are used again. Chunks that an MCAP input hands on as they are cost nothing here.
Neither does the rest of a process: starting Python, reading and writing the files.

    python benchmarks/bound.py IN OUT JOBS      prints seconds, and seconds of processor time
"""

import sys
import threading
import time
import zlib
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


def decompress(chunk: Chunk) -> bytes:
    """Return a chunk's content."""
    data, size, compression = chunk
    target = np.empty(size, np.uint8)
    decompress_into(target, memoryview(data), compression)
    return target.tobytes()


def read(chunk: Chunk) -> None:
    """Do what reading a chunk costs at least."""
    data, size, compression = chunk
    decompress_into(np.empty(size, np.uint8), memoryview(data), compression)


class _Codecs(threading.local):
    def __init__(self) -> None:
        self.zstd = zstandard.ZstdCompressor(level=ZSTD_LEVEL)


_CODECS = _Codecs()


def write(data: bytes) -> None:
    """Do what writing a chunk costs at least."""
    zlib.crc32(data)
    _CODECS.zstd.compress(data)


def main(source: Path, target: Path, jobs: int) -> None:
    """Measure."""
    inputs = stored_chunks(open_log(source))
    handed_on = {data for data, _, _ in inputs}
    outputs = [
        decompress(chunk) for chunk in stored_chunks(open_log(target)) if chunk[0] not in handed_on
    ]
    start, start_cpu = time.perf_counter(), time.process_time()
    with ThreadPoolExecutor(jobs) as pool:
        for future in [pool.submit(read, chunk) for chunk in inputs]:
            future.result()
        for future in [pool.submit(write, data) for data in outputs]:
            future.result()
    print(f"{time.perf_counter() - start:.4f} {time.process_time() - start_cpu:.4f}")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3]))
