"""Which chunks of a log are looked at before it is read through."""

import math
from collections.abc import Set as AbstractSet
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import distinct
from dogbot_logtool.reader.containers.log import Chunk, Log

_LOOKS: Final = 8
"""Chunks that are looked at, besides those with static transforms."""
_LEAST_SIZE: Final = 1 << 20
"""Bytes that are looked at at least, as they are stored: small chunks show little each."""


def spread_chunks(log: Log, channels: AbstractSet[int]) -> list[Chunk]:
    """Choose a few chunks, evenly spaced among those that hold some channels."""
    useful = [c for c in log.chunks if c.counts is None or not channels.isdisjoint(c.counts)]
    size = sum(chunk.data_size for chunk in useful)
    looks = max(_LOOKS, math.ceil(len(useful) * min(_LEAST_SIZE / max(size, 1), 1.0)))
    indices = distinct(np.linspace(0, max(len(useful) - 1, 0), looks).round().astype(int))
    return [useful[index] for index in indices.tolist() if useful]
