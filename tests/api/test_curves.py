"""Curves over strides, against messages decoded one by one."""

import numpy as np
import pytest

import dogbot_logtool as dl
from tests.measured import walk_of
from tests.oracles.conversion import sample_of
from tests.oracles.recorded import contact_topic, decoded_log
from tests.paths import WALK

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
    assert curves["force_z_n"].shape == (len(rows), 101)
    assert (len(curves["start_s"]), len(curves["percent"])) == (len(rows), 101)
    for curve, row in zip(curves["force_z_n"], rows, strict=True):
        start = walk.strides["start_s"][row]
        period = walk.strides["stance_s"][row] + walk.strides["swing_s"][row]
        for percent in (0, 10, 37, 80, 95, 100):
            at = start + period * percent / 100
            assert curve[percent] == pytest.approx(np.interp(at, time, vertical), abs=1e-6)


def test_the_usual_curve_is_that_of_the_figures(walk: dl.Walk) -> None:
    figure = walk.stats["feet"][FOOT]["vertical_over_stride_n"]
    curves = walk.curves(FOOT, points=51)
    assert curves["percent"].tolist() == figure["percent"]
    difference = np.median(curves["force_z_n"], axis=0) - figure["median"]
    assert np.abs(difference).mean() < 5.0


def test_wrong_words_are_refused(walk: dl.Walk) -> None:
    with pytest.raises(dl.CallError, match="'left' is no foot of this robot"):
        walk.curves("left")
