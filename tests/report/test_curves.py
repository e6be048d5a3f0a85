"""Curves for drawing: every peak and every trough survives."""

import numpy as np
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
def test_every_peak_and_trough_is_kept_in_few_samples(
    signal: tuple[Ints, Floats], most: int
) -> None:
    time, value = signal
    result = curve_of(time, value, NO_BREAKS, most)
    samples = dict(zip(time.tolist(), value.tolist(), strict=True))
    if result is None:
        assert np.isnan(value).all()
        return
    kept = ~np.isnan(result.value)
    assert kept.sum() <= max(2 * most, 0)
    assert [samples[at] for at in result.time[kept].tolist()] == result.value[kept].tolist()
    assert (np.diff(result.time) > 0).all() or np.isnan(value).any()
    for extreme in (np.nanmin, np.nanmax):
        assert extreme(result.value) == extreme(value)
    # Wherever something is known, a sample of the same bin is drawn.
    known = time[~np.isnan(value)]
    away = np.abs(known[:, None] - result.time[kept]).min(axis=1)
    assert (away <= result.bin_s * 1e9 + 1e3).all()


def test_a_span_has_every_sample() -> None:
    time = np.arange(100_000, dtype=np.int64) * 1_000_000
    span = (40_000 * 1_000_000, 40_500 * 1_000_000)
    result = curve_of(time, np.sin(time / 1e9), NO_BREAKS, 600, span)
    assert result is not None
    assert len(result.time) < 2 * 600 + 501
    inside = result.time[(result.time >= span[0]) & (result.time <= span[1])]
    assert inside.tolist() == time[40_000:40_501].tolist()
