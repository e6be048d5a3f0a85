from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dogbot_logtool.commands.load_detail import load_curves_within, with_detail
from dogbot_logtool.core.contact.curves import CurveDetail
from dogbot_logtool.pipeline.options import StatsOptions
from dogbot_logtool.results import Measurement
from tests.measured import measured
from tests.paths import SAMPLE_LOGS

TROT = SAMPLE_LOGS / "dogbot_trot.bag"


def detail(bins: int) -> StatsOptions:
    return StatsOptions(curves=CurveDetail(most_bins=bins))


def with_curves(log: Path, bins: int) -> Measurement:
    """Measure a log, with curves of so many bins."""
    return measured(log, detail(bins))


def test_curves_cost_and_change_nothing_unless_asked_for() -> None:
    plain = measured(TROT)
    drawn = measured(TROT, StatsOptions(curves=CurveDetail()))
    assert all(foot.record.curves is None for foot in plain.stats.feet)
    for one, other in zip(plain.stats.feet, drawn.stats.feet, strict=True):
        assert replace(one.record, curves=None).median_interval_s == other.record.median_interval_s
        assert one.peak_force_n == other.peak_force_n


def test_the_highest_point_of_a_curve_is_the_highest_peak() -> None:
    for foot in with_curves(TROT, 16).stats.feet:
        curves = foot.record.curves
        assert curves is not None
        assert curves.force is not None
        assert foot.peak_force_n is not None
        assert len(curves.force.high) <= 16
        assert curves.force.high.max() == foot.record.stances.figures.peak_n.max()


@pytest.mark.parametrize("bins", [16, 100_000])
def test_a_short_window_is_seen_sample_by_sample(bins: int) -> None:
    seen_first, whole = with_curves(TROT, bins), with_curves(TROT, 100_000)
    start, end = (whole.stats.origin + each * 1_000_000_000 for each in (2, 3))
    closer = load_curves_within(TROT, detail(bins), seen_first, (2.0, 3.0))
    for seen, foot in zip(closer, whole.stats.feet, strict=True):
        every = foot.record.curves
        assert seen is not None
        assert every is not None
        assert seen.force is not None
        assert every.force is not None
        inside = (every.force.low_time >= start) & (every.force.low_time <= end)
        rows = np.isin(seen.force.low_time, every.force.low_time[inside])
        assert rows.sum() == inside.sum() > 200
        assert (seen.force.low[rows] == every.force.low[inside]).all()


@pytest.mark.parametrize("log", ["dogbot_trot.bag", "dogbot_walk.mcap", "dogbot_troubled.bag"])
def test_a_curve_with_detail_has_every_sample_there_and_every_peak_elsewhere(log: str) -> None:
    path = TROT.with_name(log)
    coarse, whole = with_curves(path, 40), with_curves(path, 100_000)
    fine = with_detail(path, detail(40), coarse, (2.0, 2.6))
    start, end = (coarse.stats.origin + each for each in (2_000_000_000, 2_600_000_000))
    for one, seen, every in zip(coarse.stats.feet, fine.stats.feet, whole.stats.feet, strict=True):
        curves = [foot.record.curves for foot in (one, seen, every)]
        before, after, full = (each.force if each else None for each in curves)
        assert before
        assert after
        assert full
        inside = (full.low_time >= start) & (full.low_time <= end)
        assert set(full.low_time[inside].tolist()) <= set(after.low_time.tolist())
        assert set(before.high_time.tolist()) <= set(after.high_time.tolist())
        time, _ = after.line(np.empty((0, 2), np.int64))
        assert (np.diff(time) > 0).all()
        assert len(time) < len(full.low)


def test_a_log_seen_whole_is_not_read_again() -> None:
    whole, gone = with_curves(TROT, 100_000), TROT.with_name("no_such_log.bag")
    assert with_detail(gone, detail(100_000), whole, (2.0, 2.6)) is whole
