"""Vectors of one topic, and their times on the clock that is measured on.

Header stamps are used where they are of the base's clock. Times of messages without such stamps are
their log times, put on the clock of the base by how far the base's stamps lie behind log time: a
delay then includes that of the recorder, and a finding says so.
"""

from collections.abc import Iterable
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, picked
from dogbot_logtool.core.corrections.clock import (
    WINDOW_NS,
    OffsetTrack,
    StampCheck,
    TimeSource,
    advancing,
    check_stamps,
    clock_at,
    clock_differences,
    offset_track,
    too_far_apart,
)
from dogbot_logtool.core.quality import steady_gap_ns
from dogbot_logtool.core.recording import VectorSamples

MOST: Final = 1e6
"""m/s, rad/s or m/s^2; no robot reaches more."""


class VectorHistory(NamedTuple):
    """Vectors of one topic that can be used."""

    topic: str
    frames: tuple[str, ...]
    """Header frame ids that were seen, sorted."""
    messages: int
    refused: int
    """Messages with a number that is not finite, or that no robot reaches; left out."""
    time: Ints
    """(n,) ns on the clock that is measured on, strictly increasing."""
    vector: Floats
    """(n, 3)"""
    turn_rate: Floats
    """(n, 3) rad/s; NaN: not recorded."""
    gap_ns: float
    """ns: a longer silence is a gap."""
    on_log_time: bool
    """Whether the times are log times, put on the clock that is measured on."""


def vector_history(
    topic: str,
    samples: VectorSamples,
    frames: Iterable[str],
    clock: TimeSource,
    base: OffsetTrack | None,
) -> VectorHistory:
    """Return the vectors of a topic.

    Args:
        topic: its name.
        samples: in the order of the log.
        frames: header frame ids among them.
        clock: what is measured on.
        base: how far the stamps of the base lie behind log time; None: it has none.
    """
    # A number that is not finite is not below any bound.
    usable = np.asarray((np.abs(samples.vector) <= MOST).all(axis=1))
    check = check_stamps(topic, samples.stamp, samples.log_time)
    by_stamps = clock is TimeSource.HEADER and _is_stamped_like(samples, check, base)
    kept = picked(samples, usable & check.usable if by_stamps else usable)
    time = kept.stamp if by_stamps else kept.log_time
    if clock is TimeSource.HEADER and not by_stamps and base is not None and len(base[0]):
        middle = base[0] * WINDOW_NS + WINDOW_NS // 2
        time = clock_at(time, middle, middle - base[1])
    goes_on = advancing(time)
    return VectorHistory(
        topic=topic,
        frames=tuple(sorted(set(frames))),
        messages=len(usable),
        refused=int((~usable).sum()),
        time=time[goes_on],
        vector=kept.vector[goes_on],
        turn_rate=kept.turn_rate[goes_on],
        gap_ns=steady_gap_ns(np.diff(time[goes_on])),
        on_log_time=not by_stamps,
    )


def _is_stamped_like(samples: VectorSamples, check: StampCheck, base: OffsetTrack | None) -> bool:
    """Tell whether messages have stamps, of the same clock as the base's."""
    if not check.mostly_usable:
        return False
    if base is None:
        return True
    own = offset_track(samples.log_time[check.usable], samples.stamp[check.usable])
    tracks = {check.topic: own, "": base}
    return check.topic not in too_far_apart(clock_differences(tracks, ("",)), None)
