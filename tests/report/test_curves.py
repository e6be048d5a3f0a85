"""Curves for drawing: every peak and every trough survives."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.report.curves import curve_of

START = 1_700_000_000_000_000_000
NO_BREAKS = np.empty((0, 2), np.int64)


@st.composite
def signals(draw: st.DrawFn) -> tuple[Ints, Floats]:
    """Samples at uneven times, dense and with long silences, with equal values among them."""
    steps = draw(st.lists(st.sampled_from((1, 7, 1000, 10**6, 10**9, 10**13)), max_size=120))
    values = st.sampled_from((0.0, 1.0, -2.5, 80.0, float("nan"), 1e300))
    value = draw(st.lists(values, min_size=len(steps), max_size=len(steps)))
    first = draw(st.sampled_from((START, 0, -(10**9))))
    return first + np.cumsum(np.array(steps, np.int64)), np.array(value, np.float64)


@settings(max_examples=75)
@given(signals(), st.integers(2, 40))
def test_each_bin_keeps_its_lowest_and_its_highest_sample(
    signal: tuple[Ints, Floats], most: int
) -> None:
    time, value = signal
    result = curve_of(time, value, most)
    bins: dict[int, list[tuple[int, float]]] = {}
    if result is None:
        assert np.isnan(value).all()
        return
    for at, each in zip(time.tolist(), value.tolist(), strict=True):
        if each == each:  # noqa: PLR0124 - not NaN
            bins.setdefault(at // result.bin_ns, []).append((at, each))
    lowest = [min(bins[each], key=lambda sample: (sample[1], sample[0])) for each in sorted(bins)]
    highest = [min(bins[each], key=lambda sample: (-sample[1], sample[0])) for each in sorted(bins)]
    kept = zip(result.time.tolist(), result.value.tolist(), strict=True)
    assert list(kept) == sorted({*lowest, *highest})
    # No more bins than asked for, and none wider than needed.
    assert len(bins) <= most
    if result.bin_ns > 1:
        narrower = {at // (result.bin_ns // 2) for each in bins.values() for at, _ in each}
        assert len(narrower) > most


def test_no_line_leads_over_a_break() -> None:
    time = np.array([10, 20, 30, 1000, 1010], np.int64)
    result = curve_of(time, np.arange(5.0))
    assert result is not None
    breaks = np.array([[0, 4], [30, 1000], [1020, 1030]], np.int64)
    drawn_time, drawn = result.line(breaks)
    assert drawn_time.tolist() == [10, 20, 30, 515, 1000, 1010]
    assert drawn.tolist() == [0.0, 1.0, 2.0, pytest.approx(np.nan, nan_ok=True), 3.0, 4.0]


def test_a_window_has_its_own_detail() -> None:
    time = np.arange(100_000, dtype=np.int64) * 1_000_000
    value = np.sin(time / 1e9)
    window = (40_000 * 1_000_000, 40_500 * 1_000_000)
    result = curve_of(time, value, 600, window)
    assert result is not None
    assert result.bin_ns == 1
    assert result.time.tolist() == time[40_000:40_501].tolist()
