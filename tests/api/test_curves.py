"""Curves over strides, against messages decoded one by one."""

import numpy as np
import pytest

import dogbot_logtool as dl
from dogbot_logtool.api.table import Table, curves_of
from tests.measured import walk_of
from tests.oracles.conversion import sample_of
from tests.oracles.recorded import contact_topic, decoded_log
from tests.paths import TROUBLED, WALK

FOOT = "front_left"


@pytest.fixture(scope="module")
def walk() -> dl.Walk:
    return walk_of(WALK)


def test_curves_pass_through_what_was_recorded(walk: dl.Walk) -> None:
    messages = [each.message for each in decoded_log(WALK)[contact_topic(FOOT)]]
    stamps = [each.header.stamp for each in messages]
    time = [(each.sec * 1_000_000_000 + each.nanosec - walk.start_ns) / 1e9 for each in stamps]
    vertical = [sample_of(each, FOOT).force[2] for each in messages]
    curves = walk.curves(FOOT)
    rows = np.flatnonzero(walk.strides["foot"] == FOOT)
    assert curves["force_z_n"].shape == (len(rows), 101) == (len(curves), len(curves.percent))
    for curve, row in zip(curves["force_z_n"], rows, strict=True):
        start = walk.strides["start_s"][row]
        period = walk.strides["stance_s"][row] + walk.strides["swing_s"][row]
        for percent in (0, 10, 37, 80, 95, 100):
            at = start + period * percent / 100
            assert curve[percent] == pytest.approx(np.interp(at, time, vertical), abs=1e-6)


def test_the_usual_curve_is_that_of_the_figures(walk: dl.Walk) -> None:
    figure = walk.stats["feet"][FOOT]["vertical_over_stride_n"]
    curves = walk.curves(FOOT, points=51)
    assert curves.percent.tolist() == figure["percent"]
    difference = np.median(curves["force_z_n"], axis=0) - figure["median"]
    assert np.abs(difference).mean() < 5.0


def test_a_foot_without_strides_has_no_curves() -> None:
    curves = walk_of(TROUBLED).curves("back_left")
    assert curves["force_n"].shape == (0, 101)


def test_samples_that_step_back_and_unknown_ones_are_left_out() -> None:
    force = np.array([0.0, 9.0, 10.0, 20.0, np.nan])
    columns = dict.fromkeys(("force_n", "force_x_n", "force_y_n", "force_z_n"), force)
    samples = Table({"time_s": np.array([0.0, -1.0, 1.0, 2.0, 3.0]), **columns})
    curves = curves_of(FOOT, samples, np.array([0.5]), np.array([2.0]), 5)
    assert curves.percent.tolist() == [0.0, 25.0, 50.0, 75.0, 100.0]
    assert curves["force_n"][0, :4].tolist() == [5.0, 10.0, 15.0, 20.0]
    assert np.isnan(curves["force_n"][0, 4])


def test_wrong_words_are_refused(walk: dl.Walk) -> None:
    with pytest.raises(dl.CallError, match="'left' is no foot of this robot"):
        walk.curves("left")
    with pytest.raises(dl.CallError, match="points=1: a curve has at least 2"):
        walk.curves(FOOT, points=1)
    curves = walk.curves(FOOT, points=2)
    with pytest.raises(KeyError, match="there are force_n, force_x_n, force_y_n, force_z_n"):
        curves["force"]
