"""Legs of the sample logs against the truth that is written beside them."""

import json
from pathlib import Path

import numpy as np
import pytest

import dogbot_logtool as dl
from dogbot_logtool.core.metrics import NEEDS
from tests.paths import SAMPLE_LOGS, TROT, WALK


@pytest.mark.parametrize("log", [TROT, WALK], ids=lambda path: path.stem)
def test_legs_are_what_their_truth_says(log: Path) -> None:
    truth = json.loads((SAMPLE_LOGS / f"{log.stem}.truth.json").read_text(encoding="utf-8"))
    walk = dl.measure(log)
    strides = walk.strides
    for foot, true in truth["legs"]["feet"].items():
        found = walk.feet[foot]
        assert found.clearance_m is not None
        assert found.clearance_m.median == pytest.approx(true["clearance_m"], abs=0.002)
        for key in ("absolute_work_j", "positive_work_j"):
            done = np.median(strides[key][strides["foot"] == foot])
            assert done == pytest.approx(true[key], rel=0.03), (foot, key)
        for joint, torque in true["peak_torque_nm"].items():
            peak = walk.legs.joints[f"{foot}_{joint}"].peak_effort
            assert peak == pytest.approx(torque, rel=0.05)
        assert found.touchdown_down_mps is None
        because = walk.metrics.null_because[f"feet.{foot}.touchdown_down_mps"]
        assert because == NEEDS["leg rate"]
