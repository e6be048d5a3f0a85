"""Vectors of one topic at a bounded rate, and their times on the clock that is measured on.

Which clock a topic's times are on is only known at the end of the log, so both are kept. Header
stamps are used where they are of the base's clock. Times of messages without such stamps are their
log times, put on the clock of the base by how far the base's stamps lie behind log time: a delay
then is also that of the recorder, and is said to be.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.geometry.aggregates import IntervalHistogram
from dogbot_logtool.core.geometry.arrays import Flags, Floats, Ints, all_finite
from dogbot_logtool.core.geometry.blocks import BLOCK_ROWS, Blocks, GrowingTable
from dogbot_logtool.core.geometry.clock import (
    TimeSource,
    absolute_time,
    advancing,
    first_at_each_tick,
)
from dogbot_logtool.core.quality.clocks import (
    WINDOW_NS,
    OffsetTrack,
    clock_differences,
    too_far_apart,
)
from dogbot_logtool.core.quality.quality import TopicWatch, steady_rhythm
from dogbot_logtool.dataclass import dataclass

RATE_HZ: Final = 100.0
"""A day at this rate is half a gigabyte."""
MOST: Final = 1e6
"""m/s, rad/s or m/s^2; no robot reaches more."""
_SINCE, _BEHIND, _VECTOR = 0, 1, 2


@dataclass(frozen=True, slots=True)
class VectorSamples:
    """Vectors that messages of one topic hold, in the order of the log."""

    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns, header stamp as recorded; 0: none."""
    vector: Floats
    """(n, 3), as recorded."""

    def pick(self, rows: Flags | Ints) -> "VectorSamples":
        """Return the chosen rows (a mask or row numbers)."""
        return VectorSamples(self.log_time[rows], self.stamp[rows], self.vector[rows])


@dataclass(frozen=True, slots=True)
class VectorHistory:
    """Vectors of one topic at up to 100 Hz."""

    topic: str
    frames: tuple[str, ...]
    """Header frame ids that were seen, sorted."""
    messages: int
    refused: int
    """Messages with a number that is not finite, or that no robot reaches; left out."""
    not_advancing: int
    """Messages that repeat a log time or step back; left out."""
    time: Ints
    """(n,) ns on the clock that is measured on, strictly increasing."""
    vector: Floats
    """(n, 3)"""
    gap_ns: float
    """ns: a longer silence is a gap."""
    on_log_time: bool
    """Whether the times are log times, put on the clock that is measured on."""


class VectorRecorder:
    """Makes a `VectorHistory` of vectors, fed batch by batch; the same however it is split.

    Args:
        topic: its name.
        averages: whether all vectors of 10 ms are averaged; else the first of them is kept.
    """

    def __init__(self, topic: str, *, averages: bool, block_rows: int = BLOCK_ROWS) -> None:
        self._topic = topic
        self._averages = averages
        self._blocks: Blocks[VectorSamples] = Blocks(block_rows)
        self._watch = TopicWatch(topic)
        self._intervals = IntervalHistogram()
        self._table = GrowingTable(5)
        self._frames: set[str] = set()
        self._origins = (0, 0)
        self._end: int | None = None
        self._messages = self._refused = self._not_advancing = 0

    def add(self, samples: VectorSamples, frames: Sequence[str] = ()) -> None:
        """Take in messages, in the order of the log.

        Args:
            samples: their columns.
            frames: header frame ids among them.
        """
        self._frames.update(frames)
        for block in self._blocks.add(samples):
            self._add_block(block)

    def finish(self, clock: TimeSource, base: OffsetTrack | None) -> VectorHistory:
        """End the log.

        Args:
            clock: what is measured on.
            base: how far the stamps of the base lie behind log time; None: it has none.
        """
        for block in self._blocks.rest():
            self._add_block(block)
        self._watch.end()
        table = self._table.stacked()
        log_time = absolute_time(table[:, _SINCE], self._origins[0])
        time, on_log_time = log_time, clock is TimeSource.LOG
        if clock is TimeSource.HEADER and self._is_stamped_like(base):
            time = log_time - table[:, _BEHIND].astype(np.int64) - self._origins[1]
        elif clock is TimeSource.HEADER:
            time, on_log_time = log_time - _behind(base, log_time), True
        goes_on = advancing(time, None)
        return VectorHistory(
            topic=self._topic,
            frames=tuple(sorted(self._frames)),
            messages=self._messages,
            refused=self._refused,
            not_advancing=self._not_advancing,
            time=time[goes_on],
            vector=table[goes_on, _VECTOR:],
            gap_ns=steady_rhythm(self._intervals).gap_ns,
            on_log_time=on_log_time,
        )

    def _is_stamped_like(self, base: OffsetTrack | None) -> bool:
        """Tell whether the messages have stamps, of the same clock as the base's."""
        if not self._watch.has_stamps:
            return False
        if base is None:
            return True
        tracks = {self._topic: self._watch.offset_track(), "": base}
        return self._topic not in too_far_apart(clock_differences(tracks, ("",)), None)

    def _add_block(self, samples: VectorSamples) -> None:
        usable = all_finite(samples.vector)
        usable[usable] = (np.abs(samples.vector[usable]) <= MOST).all(axis=1)
        self._messages += len(usable)
        self._refused += int((~usable).sum())
        self._watch.add(samples.log_time, samples.stamp)
        good = usable.copy()
        good[good] = advancing(samples.log_time[good], self._end)
        self._not_advancing += int((usable & ~good).sum())
        samples = samples.pick(good)
        log_time = samples.log_time
        if len(log_time) == 0:
            return
        if self._end is None:
            self._origins = int(log_time[0]), int(log_time[0] - samples.stamp[0])
        first = log_time[:1] if self._end is None else np.array([self._end])
        self._intervals.add(np.diff(log_time, prepend=first))
        behind = log_time - samples.stamp - self._origins[1]
        rows = np.column_stack([log_time - self._origins[0], behind, samples.vector])
        # A tick that a block's end cuts gives two rows; blocks end where they end in any batches.
        previous = None if self._averages else self._end
        chosen = np.flatnonzero(first_at_each_tick(log_time, RATE_HZ, previous))
        self._end = int(log_time[-1])
        if self._averages:
            counts = np.diff(chosen, append=len(rows))
            self._table.append(np.add.reduceat(rows, chosen, axis=0) / counts[:, None])
        else:
            self._table.append(rows[chosen])


def _behind(base: OffsetTrack | None, log_time: Ints) -> Ints:
    """(n,) ns by which the base's stamps lie behind log time; zeros where that is not known."""
    if base is None or len(base.window) == 0 or len(log_time) == 0:
        return np.zeros(len(log_time), np.int64)
    middle = (base.window - base.window[0]) * WINDOW_NS + WINDOW_NS // 2
    since = log_time - base.window[0] * WINDOW_NS
    growth = np.interp(since, middle, base.least_ns - base.least_ns[0])
    behind: Ints = growth.astype(np.int64) + base.least_ns[0]
    return behind
