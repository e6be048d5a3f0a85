"""Findings about the base: causes that the log cannot tell apart are both named."""

from dataclasses import replace

import numpy as np
import pytest

from dogbot_logtool.core.checks.engine import findings_of
from tests.core.checks.measured_walk import WALK, feet, measure
from tests.core.checks.voided import metrics


@pytest.mark.parametrize(("speed", "legs"), [(0.02, "stretches"), (-0.02, "bends")])
def test_a_steady_rise_is_not_blamed_on_odometry_alone(speed: float, legs: str) -> None:
    odometry = WALK.odometry()
    seconds = (odometry.log_time - odometry.log_time[0]) / 1e9
    risen = odometry.position + np.outer(speed * seconds, (0.0, 0.0, 1.0))
    stats = measure(feet(), replace(odometry, position=risen))
    (finding,) = [each for each in findings_of(stats) if each.code == "HEIGHT_DRIFTS"]
    assert "z of the odometry or of the contact points drifts" in finding.text
    assert f"the robot {legs} its legs" in finding.text
    walk = metrics(stats)
    assert (walk.base.height_m, walk.base.climb_m, walk.base.froude) == (None, None, None)
    assert walk.null_because["base.height_m"] == "HEIGHT_DRIFTS"
    assert walk.base.path_length_m is not None
