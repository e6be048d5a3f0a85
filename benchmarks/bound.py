"""The least that `convert` could take: decompress what was read, compress and CRC what was written.

The chunks are in memory before the clock starts; the codecs, levels and threads are the same. Chunks
that an MCAP input hands on as they are cost nothing here but their CRC.

    python benchmarks/bound.py IN OUT JOBS      prints seconds
"""

import sys
import time
import zlib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import zstandard

from dogbot_logtool.reader.compression import decompress_into
from dogbot_logtool.reader.log import Log
from dogbot_logtool.reader.opening import open_log

Chunk = tuple[bytes, int, str]
"""Stored bytes, size when decompressed, compression."""


def stored_chunks(log: Log) -> list[Chunk]:
    return [
        (log.source.read(chunk.data_offset, chunk.data_size), chunk.size, chunk.compression)
        for chunk in log.chunks
    ]


def decompress(chunk: Chunk) -> bytes:
    data, size, compression = chunk
    target = np.empty(size, np.uint8)
    decompress_into(target, memoryview(data), compression)
    return target.tobytes()


def read(chunk: Chunk) -> None:
    data, size, compression = chunk
    decompress_into(np.empty(size, np.uint8), memoryview(data), compression)


def write(data: bytes) -> None:
    zlib.crc32(data)
    zstandard.ZstdCompressor(level=1).compress(data)


def main(source: Path, target: Path, jobs: int) -> None:
    inputs = stored_chunks(open_log(source))
    handed_on = {data for data, _, _ in inputs}
    outputs = [
        decompress(chunk) for chunk in stored_chunks(open_log(target)) if chunk[0] not in handed_on
    ]
    start = time.perf_counter()
    with ThreadPoolExecutor(jobs) as pool:
        for future in [pool.submit(read, chunk) for chunk in inputs]:
            future.result()
        for future in [pool.submit(write, data) for data in outputs]:
            future.result()
    print(f"{time.perf_counter() - start:.4f}")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3]))
