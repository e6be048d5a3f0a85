"""The truth of walks holds for their sensors, and each kind of log has its row in the table."""

import csv

import numpy as np
import pytest

from tests.truth import gaits
from tests.truth.cases import all_cases
from tests.truth.robots import biped, hexapod
from tests.truth.validate import TABLE
from tests.truth.walking import Walk


def test_the_table_has_every_kind() -> None:
    with TABLE.open(encoding="utf-8") as file:
        names = {row["log"] for row in csv.DictReader(file)}
    missing = [case.name for case in all_cases() if case.name not in names]
    assert missing == [], "run: make validate"


WALKS = {
    "trot": Walk(),
    "gallop": Walk(gait=gaits.ROTARY_GALLOP, period_s=0.5, speed_mps=2.0),
    "slope": Walk(slope_rad=0.3, heading_rad=1.0, traction=0.0),
    "biped": Walk(gait=gaits.BIPED_WALK, robot=biped()),
    "hexapod": Walk(gait=gaits.WAVE, robot=hexapod(), shares=(0.1, 0.2, 0.1, 0.2, 0.1, 0.3)),
    "slipping": Walk(slip_m=0.03),
}


@pytest.mark.parametrize("walk", WALKS.values(), ids=WALKS)
def test_the_truth_holds_for_the_sensors(walk: Walk) -> None:
    recording, rate = walk.recorded(2000.0), 2000.0
    strides = round(5 * walk.period_s * rate)
    total = np.zeros(3)
    for foot, (sensor, true) in enumerate(zip(recording.feet, recording.truth.feet, strict=True)):
        begins = sensor.time[np.flatnonzero(np.diff(sensor.touching.astype(int)) == 1)]
        ends = sensor.time[np.flatnonzero(np.diff(sensor.touching.astype(int)) == -1)]
        assert begins == pytest.approx(true.touchdown_s, abs=1.01 / rate)
        assert ends == pytest.approx(true.liftoff_s, abs=1.01 / rate)
        assert sensor.touching.mean() == pytest.approx(true.contact_fraction, abs=2e-3)
        mean = sensor.force[:strides].mean(axis=0)
        assert mean[2] == pytest.approx(walk.share(foot) * walk.robot.weight_n, rel=1e-4)
        assert mean[2] * walk.period_s == pytest.approx(
            walk.mean_vertical_n(foot) * walk.stance_s, rel=1e-4
        )
        if true.peak_vertical_force_n is not None:
            assert sensor.force[:, 2].max() == pytest.approx(true.peak_vertical_force_n, rel=1e-4)
        assert not sensor.force[~sensor.touching].any()
        total += mean
    weight = np.array([0.0, 0.0, walk.robot.weight_n])
    assert total == pytest.approx(weight, abs=1e-4 * walk.robot.weight_n)
