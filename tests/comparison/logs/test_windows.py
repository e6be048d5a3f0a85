"""Time is cut to the nanosecond, wherever on its axis a log lies."""

from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from dogbot_logtool.comparison.logs.windows import Track, plan_windows

LEAST, MOST = -(2**63), 2**63 - 1


def track(start: list[int], length_ns: int, size: int) -> Track:
    log: Any = SimpleNamespace()
    chunks: Any = [SimpleNamespace(size=size)] * len(start)
    first = np.array(start, np.int64)
    return Track(log, chunks, first, first + length_ns, {})


@pytest.mark.parametrize("origin", [0, 1_700_000_000 * 10**9, LEAST, MOST - 100])
def test_large_chunks_a_nanosecond_apart_are_parted(origin: int) -> None:
    windows = list(plan_windows([track([origin + ns for ns in range(12)], 0, 31 << 20)]))
    assert len(windows) == 6
    assert (windows[0].first, windows[-1].last) == (LEAST, MOST)
    assert all(after.first == before.last + 1 for before, after in pairwise(windows))
    assert [window.last - origin for window in windows[:-1]] == [1, 3, 5, 7, 9]


def test_times_may_be_as_far_apart_as_they_can() -> None:
    windows = list(plan_windows([track([LEAST, MOST - 1], 1, 20 << 20)], 1 << 20))
    assert (windows[0].first, windows[-1].last) == (LEAST, MOST)
