"""`stats` from the file to the figures, against what the sample logs' generator knows."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from dogbot_logtool.core.metrics import WalkMetrics
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.report.documents import schema, stats_json
from tests.measured import measured
from tests.paths import ROOT, SAMPLE_LOGS

WALKS = ("dogbot_trot.bag", "dogbot_walk.mcap")


def figures(log: str, options: MeasureOptions | None = None) -> dict[str, Any]:
    done = measured(SAMPLE_LOGS / log, options or MeasureOptions())
    return stats_json(done)


def truth(log: str) -> dict[str, Any]:
    text = (SAMPLE_LOGS / f"{Path(log).stem}.truth.json").read_text(encoding="utf-8")
    known: dict[str, Any] = json.loads(text)
    return known


@pytest.fixture(scope="module", params=WALKS)
def walk(request: pytest.FixtureRequest) -> tuple[dict[str, Any], dict[str, Any]]:
    true = truth(request.param)
    origin = measured(SAMPLE_LOGS / request.param, MeasureOptions()).walk.origin
    true["log"]["start_s"] = true["log"]["start_stamp_s"] - origin / 1e9
    return figures(request.param), true


Walk = tuple[dict[str, Any], dict[str, Any]]


def test_contacts_are_true_within_one_sample(walk: Walk) -> None:
    """Also where the message after a lift-off still holds the last steps of the stance."""
    got, true = walk
    start, latest = true["log"]["start_s"], true["log"]["contact_interval_s"] + 1e-6
    for foot, known in true["feet"].items():
        found = got["feet"][foot]
        assert found["contact_fraction"] == pytest.approx(known["contact_fraction"], abs=0.0015)
        for name, expected in (("lift_off_s", "liftoff_s"), ("touchdown_s", "touchdown_s")):
            late = np.array(found[name]) - np.array(known[expected]) - start
            assert -1e-6 < late.min() <= late.max() <= latest


def test_the_gait_is_true(walk: Walk) -> None:
    got, true = walk
    gait, known = got["gait"], true["gait"]
    assert gait["name"] == known["class"]
    assert gait["stride_frequency_hz"] == pytest.approx(known["stride_frequency_hz"], rel=0.002)
    assert gait["duty_factor"] == pytest.approx(known["duty_factor"], abs=0.005)
    for foot, phase in known["phase"].items():
        off = gait["phase"][foot]["mean"] - phase
        assert abs((off + 0.5) % 1.0 - 0.5) < 0.005
        assert gait["phase"][foot]["consistency"] > 0.99
    for feet, fraction in known["support_fraction"].items():
        assert gait["support"][feet] == pytest.approx(fraction, abs=0.02)


def test_the_feet_carry_the_weight(walk: Walk) -> None:
    """In the trot the wrenches are in the links' frames, and the log's /tf turns them."""
    got, true = walk
    assert got["forces"]["vertical_impulse_over_weight"] == pytest.approx(1.0, abs=0.005)
    for foot, known in true["feet"].items():
        feet = got["feet"][foot]
        peak, vertical = feet["peak_force_n"], feet["peak_vertical_force_n"]
        assert peak["max"] == pytest.approx(known["peak_force_n"], rel=0.01)
        assert vertical["max"] == pytest.approx(known["peak_vertical_force_n"], rel=0.01)
        assert got["forces"]["load_share"]["feet"][foot] == pytest.approx(
            known["load_share"], abs=0.005
        )


def test_the_base_moves_as_it_should(walk: Walk) -> None:
    got, true = walk
    base, known = got["base"], true["base"]
    assert base["forward_speed_mps"] == pytest.approx(known["forward_speed_mps"], rel=0.002)
    assert base["path_length_m"] == pytest.approx(known["path_length_m"], rel=0.002)
    assert base["height_m"]["mean"] == pytest.approx(known["mean_height_m"], abs=1e-4)


def test_without_its_transforms_a_link_frame_log_has_no_vertical_figures(tmp_path: Path) -> None:
    # A robot whose frames the log's transforms do not name: nothing can be turned.
    robot = tmp_path / "stranger.toml"
    text = (ROOT / "dogbot_logtool/robot/known/dogbot.toml").read_text(encoding="utf-8")
    robot.write_text(text.replace('base = "base_link"', 'base = "trunk"'), encoding="utf-8")
    options = MeasureOptions(robot=str(robot))
    got = figures("dogbot_trot.bag", options)

    assert got["forces"]["vertical_impulse_over_weight"] is None
    for foot in got["feet"].values():
        assert foot["peak_vertical_force_n"] is None
        assert foot["peak_force_n"]["n"] > 0
    assert (
        got["null_because"]["feet.front_left.peak_vertical_force_n"]
        == "frame of the forces not known"
    )


def test_the_json_is_what_the_schema_says() -> None:
    Draft202012Validator.check_schema(schema(WalkMetrics))
    validator = Draft202012Validator(schema(WalkMetrics))
    for log in (*WALKS, "dogbot_troubled.bag"):
        validator.validate(json.loads(json.dumps(figures(log), allow_nan=False)))
