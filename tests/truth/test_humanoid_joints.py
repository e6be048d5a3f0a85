"""Joints of a real humanoid, compared with what its messages hold, added up one by one."""

import os
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest
from mcap.reader import make_reader
from rosbags.typesys import Stores, get_typestore

import dogbot_logtool as dl
from tests.truth.recording import Floats

FOLDER: Final = os.environ.get("LOGTOOL_LABELLED", "")
RUNS: Final = ("reemc_14_1", "reemc_24_4")
LEGS: Final = [f"leg_{side}_{row}_joint" for side in ("left", "right") for row in range(1, 7)]
MASS_KG: Final = 80.0

pytestmark = pytest.mark.skipif(not FOLDER, reason="LOGTOOL_LABELLED names no folder with logs")


def messages(path: Path) -> Iterator[tuple[float, Any]]:
    """Times in s and joint states, read by the official libraries."""
    store = get_typestore(Stores.ROS1_NOETIC)
    with path.open("rb") as stream:
        for _, _, message in make_reader(stream).iter_messages(topics=["/joint_states"]):
            told = store.deserialize_ros1(message.data, "sensor_msgs/msg/JointState")
            stamp = told.header.stamp  # type: ignore[attr-defined]
            yield stamp.sec + stamp.nanosec * 1e-9, told


@cache
def columns(run: str) -> tuple[Floats, dict[str, Floats]]:
    """Times, and position, velocity and effort of each joint, (n, 3)."""
    times, rows = [], []
    for time, told in messages(Path(FOLDER) / f"{run}.mcap"):
        times.append(time)
        names = list(told.name)
        rows.append(
            [
                (
                    told.position[names.index(joint)],
                    told.velocity[names.index(joint)],
                    told.effort[names.index(joint)],
                )
                for joint in LEGS
            ]
        )
    table = np.array(rows)
    return np.array(times), {joint: table[:, row] for row, joint in enumerate(LEGS)}


@cache
def found(run: str) -> dl.Walk:
    return dl.measure(Path(FOLDER) / f"{run}.mcap", mass=MASS_KG)


@pytest.mark.parametrize("run", RUNS)
def test_ranges_torques_and_work_of_the_whole_log(run: str) -> None:
    """As near as float32 tells, in which the columns of joints are kept."""
    time, joints = columns(run)
    told = found(run).stats["legs"]["joints"]
    for name, (position, velocity, effort) in ((name, c.T) for name, c in joints.items()):
        joint = told[name]
        assert joint["foot"] == name.split("_")[1]
        assert joint["range_of_motion"] == pytest.approx(np.ptp(position), abs=1e-6)
        assert joint["peak_effort"] == pytest.approx(np.abs(effort).max(), rel=1e-6)
        assert joint["peak_speed"] == pytest.approx(np.abs(velocity).max(), rel=1e-6)
        power = effort * velocity
        rms = np.sqrt(np.trapezoid(effort**2, time) / (time[-1] - time[0]))
        assert joint["rms_effort"] == pytest.approx(rms, rel=1e-6)
        done = np.trapezoid(np.abs(power), time)
        assert joint["absolute_work_j"] == pytest.approx(done, rel=1e-6, abs=1e-6)
