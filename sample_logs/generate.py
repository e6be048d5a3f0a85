"""Write the sample logs and their truth: ``python sample_logs/generate.py [OUTDIR]``.

The same bytes come out of every run. README.md says what each log is and what the truth holds.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from gait_model import Gait
from log_files import write_bag, write_mcap
from recording import record
from ros_messages import NS_PER_S, MessageFactory
from scenario import Damage, Scenario, Silence
from truth_record import truth_of

_NS_PER_MS = 1_000_000

_TROT = Gait(
    gait_class="trot",
    sequence=("front_left", "back_right", "front_right", "back_left"),
    period_s=1.142,
    duty_factor=0.714,
    phases={"front_left": 0.0, "front_right": 0.5, "back_left": 0.5, "back_right": 0.0},
    first_touchdown_s=0.3012,
    speed_mps=0.25,
    heading_rad=0.4,
)
_WALK = Gait(
    gait_class="walk",
    sequence=("front_left", "back_right", "front_right", "back_left"),
    period_s=1.142,
    duty_factor=0.833,
    phases={"front_left": 0.0, "front_right": 0.5, "back_left": 0.75, "back_right": 0.25},
    first_touchdown_s=0.4013,
    speed_mps=0.25,
    heading_rad=-0.9,
)

TROT = Scenario(
    name="dogbot_trot",
    gait=_TROT,
    ros_version=1,
    compression="lz4",
    start_ns=12 * NS_PER_S,
    duration_ns=8 * NS_PER_S,
    physics_step_ns=_NS_PER_MS,
    steps_per_contact_message=4,
    odometry_interval_ns=4 * _NS_PER_MS,
    world_frame_id="world",
    base_frame_id="base_link",
    contact_frame_id="world",
    wrench_frame="link",
    second_body_foot=None,
    pad_foot="back_right",
    seed=1,
)
WALK = Scenario(
    name="dogbot_walk",
    gait=_WALK,
    ros_version=2,
    compression="zstd",
    start_ns=5 * NS_PER_S,
    duration_ns=9 * NS_PER_S,
    physics_step_ns=2 * _NS_PER_MS,
    steps_per_contact_message=1,
    odometry_interval_ns=4 * _NS_PER_MS,
    world_frame_id="world",
    base_frame_id="base_link",
    contact_frame_id="world",
    wrench_frame="world",
    second_body_foot="front_right",
    pad_foot=None,
    seed=2,
)
TROUBLED = Scenario(
    name="dogbot_troubled",
    gait=_TROT,
    ros_version=1,
    compression="bz2",
    start_ns=30 * NS_PER_S,
    duration_ns=5 * NS_PER_S,
    physics_step_ns=_NS_PER_MS,
    steps_per_contact_message=10,
    odometry_interval_ns=10 * _NS_PER_MS,
    world_frame_id="/world",
    base_frame_id="",
    contact_frame_id="/world",
    wrench_frame="link",
    second_body_foot=None,
    pad_foot=None,
    seed=3,
    damage=Damage(
        dead_foot="back_left",
        silence=Silence("front_right", start_s=2.3, duration_s=1.0),
        zero_stamps=True,
        nan_force={"front_left": (60, 61, 290)},
        infinite_position={"back_right": (160, 400)},
        zero_quaternion=(250,),
        duplicate_log_time=(120, 121, 333),
        backward_log_time={"front_left": (201, 380)},
        backward_step_ns=15 * _NS_PER_MS,
    ),
)


def write_sample(scenario: Scenario, directory: Path) -> None:
    """Write a scenario's log and its truth into a directory."""
    messages = record(scenario)
    typestore = MessageFactory(scenario.ros_version).typestore
    if scenario.compression == "zstd":
        write_mcap(directory / f"{scenario.name}.mcap", messages, typestore)
    else:
        write_bag(directory / f"{scenario.name}.bag", messages, typestore, scenario.compression)
    truth = json.dumps(truth_of(scenario, messages), indent=1)
    (directory / f"{scenario.name}.truth.json").write_text(truth + "\n", encoding="utf-8")


def main() -> None:
    """Write all samples into the given directory, or beside this file."""
    directory = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent
    directory.mkdir(parents=True, exist_ok=True)
    for scenario in (TROT, WALK, TROUBLED):
        write_sample(scenario, directory)


if __name__ == "__main__":
    main()
