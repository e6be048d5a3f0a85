"""Sensors of single feet and raw counts: what is measured, said and drawn of one walk."""

import tempfile
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.commands.info import describe
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.core.checks.engine import findings_of
from dogbot_logtool.errors import CallError
from dogbot_logtool.option import part_of
from dogbot_logtool.options import ConvertOptions, InfoOptions, MeasureOptions
from dogbot_logtool.report.documents import stats_json
from tests.oracles import walks
from tests.oracles.foot_logs import WRENCH, write_log

FLAGS_ONLY = ("spot_msgs/msg/FootStateArray", "champ_msgs/msg/ContactsStamped")
RAW = tuple(kind for kind in walks.KINDS if kind.startswith("unitree"))
IN_WORLD = ("gazebo_msgs/msg/ContactsState", "ros_gz_interfaces/msg/Contacts")
WITH_FORCE = tuple(kind for kind in walks.KINDS if kind not in FLAGS_ONLY)
FORCE_FIGURES = (
    "peak_force_n",
    "peak_force_bw",
    "mean_force_n",
    "peak_vertical_force_n",
    "mean_vertical_force_n",
    "vertical_impulse_ns",
    "loading_rate_nps",
)


def options_for(folder: Path, kind: str) -> MeasureOptions:
    return MeasureOptions(robot=str(walks.robot_file(folder, kind)))


@cache
def figures(kind: str) -> dict[str, Any]:
    """Figures of the walk, measured once."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        path = walks.write_walk(folder, kind, "mcap")
        done = measure(path, options_for(folder, kind))
        return stats_json(done)


def steps(leg: str) -> tuple[list[float], list[float]]:
    """Touchdowns and lift-offs, s: the first sample in contact, and the first one not."""
    down = np.flatnonzero(np.diff(walks.TOUCHES[leg].astype(int), prepend=0))
    times = [round(float(sample) * walks.STEP / 1e9, 9) for sample in down]
    return times[0::2], times[1::2]


@pytest.mark.parametrize("kind", FLAGS_ONLY)
def test_flags_give_no_force_figures_and_say_so(kind: str) -> None:
    got = figures(kind)
    codes = {note["code"] for note in got["findings"]}
    assert "NO_FORCE" in codes
    assert "STUCK" not in codes
    for leg in walks.LEGS:
        assert [got["feet"][leg][name] for name in FORCE_FIGURES] == [None] * len(FORCE_FIGURES)
        assert got["feet"][leg]["stance_s"]["n"] > 0
    assert got["forces"]["load_share"] is None or not any(got["forces"]["load_share"].values())
    assert got["forces"]["vertical_impulse_over_weight"] is None


@pytest.mark.parametrize("kind", [k for k in walks.KINDS if k in RAW or "spot" in k])
def test_without_a_header_log_time_is_used_and_said(kind: str) -> None:
    got = figures(kind)
    assert got["settings"]["clock"] == "log"
    assert any("no header" in note["text"] for note in got["findings"])


@pytest.mark.parametrize("kind", walks.KINDS)
def test_every_source_converts(tmp_path: Path, kind: str) -> None:
    path = walks.write_walk(tmp_path, kind, "mcap")
    options = part_of(options_for(tmp_path, kind), ConvertOptions)
    done = convert(path, tmp_path / "out.mcap", options)
    assert done.damage.losses == ()
    touching = sum(int(touch.sum()) for touch in walks.TOUCHES.values())
    loads = {leg: done.annotations[f"/load/{leg}"] for leg in walks.LEGS}
    assert all(count >= 0.5 * walks.SAMPLES for count in loads.values())
    drawn = sum(done.annotations[f"/marker_basic_{leg}_foot"] for leg in walks.LEGS)
    if kind in IN_WORLD:
        assert drawn >= touching
    codes = {finding.code for finding in done.findings}
    assert "NOT_CALIBRATED" not in codes
    assert ("NO_FORCE" in codes) == (kind in FLAGS_ONLY)
    if kind != "unitree_go/msg/SportModeState":
        assert ("NOT_DRAWN" in codes) == (kind not in (*FLAGS_ONLY, *IN_WORLD))


def test_the_result_of_silent_swings_does_not_depend_on_jobs(tmp_path: Path) -> None:
    kind = "ros_gz_interfaces/msg/Contacts"
    path = walks.write_walk(tmp_path, kind, "mcap")
    outputs = []
    for jobs in (1, 4):
        target = tmp_path / f"out{jobs}.mcap"
        convert(
            path, target, replace(part_of(options_for(tmp_path, kind), ConvertOptions), jobs=jobs)
        )
        outputs.append(target.read_bytes())
    assert outputs[0] == outputs[1]


@pytest.mark.parametrize("name", ["unitree_go2", "generic"])
def test_raw_counts_are_not_passed_off_as_newtons(tmp_path: Path, name: str) -> None:
    """But two clear modes of each foot's counts tell when it touches."""
    path = walks.write_walk(tmp_path, "unitree_go/msg/LowState", "mcap")
    feet = dict.fromkeys(walks.LEGS, "/feet") if name == "unitree_go2" else None
    options = MeasureOptions(robot=name, foot=feet)
    told = describe(path, part_of(options, InfoOptions))
    assert "NOT_CALIBRATED" in {each.code for each in told.findings}
    done = measure(path, options)
    got = stats_json(done)
    (text,) = [each["text"] for each in got["findings"] if each["code"] == "NOT_CALIBRATED"]
    assert "no forces; contact from" in text
    assert "both estimated from the log" in text
    for leg in walks.LEGS:
        foot = got["feet"][leg]
        assert [foot[figure] for figure in FORCE_FIGURES] == [None] * len(FORCE_FIGURES)
        assert foot["touchdown_s"] == pytest.approx(steps(leg)[0], abs=1e-6)


def test_counts_of_a_robot_that_stands_tell_nothing(tmp_path: Path) -> None:
    kind, walk = "unitree_go/msg/LowState", walks.Walk(2)
    counts = np.random.default_rng(1).normal(120.0, 4.0, (400, 4))
    entries = []
    for sample, values in enumerate(counts):
        message = walk.make(kind, foot_force=values, tick=sample)
        time = walks.START + sample * walks.STEP
        entries.append(walks.Entry("/feet", kind, time, walk.bytes_of(kind, message)))
    path = tmp_path / "stand.mcap"
    walks.write_mcap(path, walk, entries)
    done = measure(path, MeasureOptions(robot="generic"))
    got = stats_json(done)
    for leg in walks.LEGS:
        foot = got["feet"][leg]
        assert (foot["contact_fraction"], foot["touchdown_s"]) == (None, None)
    told = {finding["code"]: finding["text"] for finding in got["findings"]}
    assert "without contact.on_counts no contact either" in told["NOT_CALIBRATED"]


@pytest.mark.parametrize("kind", RAW)
def test_counts_without_a_scale_give_a_gait_and_no_forces(tmp_path: Path, kind: str) -> None:
    path = walks.write_walk(tmp_path, kind, "mcap")
    robot = walks.robot_file(tmp_path, kind)
    lines = robot.read_text(encoding="utf-8").splitlines()
    kept = [line for line in lines if not line.startswith("newtons_per_count")]
    robot.write_text("\n".join(["contact.on_counts = 30", *kept]), encoding="utf-8")
    options = MeasureOptions(robot=str(robot))

    done = measure(path, options)
    got = stats_json(done)
    assert got["gait"]["name"] == "trot"
    assert got["forces"]["vertical_impulse_over_weight"] is None
    for leg in walks.LEGS:
        assert got["feet"][leg]["touchdown_s"] == pytest.approx(steps(leg)[0], abs=1e-6)
        assert [got["feet"][leg][name] for name in FORCE_FIGURES] == [None] * len(FORCE_FIGURES)
    told = {finding["code"]: finding["text"] for finding in got["findings"]}
    assert "contact from 30 counts above a foot's offset on" in told["NOT_CALIBRATED"]
    assert "WRENCH_FRAME" not in told

    target = tmp_path / "out.mcap"
    converted = convert(
        path, target, replace(part_of(options, ConvertOptions), encoding="ros2", copy=False)
    )
    assert "NOT_FINITE" not in {finding.code for finding in converted.findings}
    assert not any(n for topic, n in converted.annotations.items() if "marker" in topic)
    loads = 0
    with target.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for _, channel, message, load in reader.iter_decoded_messages():
            leg = channel.topic.removeprefix("/load/")
            if leg in walks.LEGS:
                sample = (message.log_time - walks.START) // walks.STEP
                assert load.in_contact == walks.TOUCHES[leg][sample]
                assert np.isnan(load.force) == load.in_contact
                loads += 1
    assert loads == 4 * walks.SAMPLES


def test_two_feet_are_not_one_element(tmp_path: Path) -> None:
    path = walks.write_walk(tmp_path, "spot_msgs/msg/FootStateArray", "mcap")
    options = MeasureOptions(robot="generic", foot={"fl": "/feet", "front_left": "/feet"})
    with pytest.raises(CallError, match="front_left: fl is the same foot"):
        describe(path, part_of(options, InfoOptions))


def test_robots_with_other_numbers_of_feet(tmp_path: Path) -> None:
    four = walks.write_walk(tmp_path, "geometry_msgs/msg/WrenchStamped", "mcap")
    path = tmp_path / "two.mcap"
    convert(four, path, ConvertOptions(topics=("!/back_*/contact",)))
    feet = {"left": "/front_left/contact", "right": "/front_right/contact"}
    options = MeasureOptions(robot="generic", foot=feet)
    done = measure(path, options)
    got = stats_json(done)
    # One foot of each diagonal, half a cycle apart.
    assert got["gait"]["name"] == "walk"
    for name, leg in (("left", "front_left"), ("right", "front_right")):
        assert got["feet"][name]["touchdown_s"] == pytest.approx(steps(leg)[0], abs=1e-6)
    six = {f"foot_{number}": f"/some/{number}" for number in range(6)}
    path = write_log(tmp_path / "six.mcap", dict.fromkeys(six.values(), WRENCH))
    told = describe(path, InfoOptions(robot="generic", foot=six))
    assert {topic.use for topic in told.topics} == {f"foot {name}" for name in six}
    assert not told.damage.losses


class TurnedSensors(walks.Walk):
    """Sensors that hang upside down: what is up in the world is down in their frames."""

    def wrench(self, values: Any) -> Any:
        return super().wrench(np.array(values) * (1.0, -1.0, -1.0))

    def frames(self) -> walks.Entry:
        transforms = [
            {
                "header": self.header(0, "base"),
                "child_frame_id": f"{leg}_sensor",
                "transform": {"rotation": (1.0, 0.0, 0.0, 0.0)},
            }
            for leg in walks.LEGS
        ]
        kind = "tf2_msgs/msg/TFMessage"
        data = self.bytes_of(kind, self.make(kind, transforms=transforms))
        return walks.Entry("/tf_static", kind, walks.START, data)


def test_a_force_sensor_s_frame_is_turned_into_the_world(tmp_path: Path) -> None:
    kind = "geometry_msgs/msg/WrenchStamped"
    walk = TurnedSensors(2)
    path = tmp_path / "walk.mcap"
    walks.write_mcap(path, walk, [walk.frames(), *walk.messages(kind)])
    done = measure(path, options_for(tmp_path, kind))
    got = stats_json(done)
    times = np.arange(walks.SAMPLES) * walks.STEP / 1e9
    for leg in walks.LEGS:
        vertical = walks.FORCES[leg][:, 2]
        assert got["feet"][leg]["peak_vertical_force_n"]["mean"] == pytest.approx(vertical.max())
        impulse = got["feet"][leg]["vertical_impulse_ns"]
        assert impulse == pytest.approx(np.trapezoid(vertical, times), rel=1e-9)


def test_swings_of_sensors_that_are_silent_in_swing_are_no_gaps(tmp_path: Path) -> None:
    """But a silence that no swing lasts is one, and only of its own topic."""
    kind, walk = "ros_gz_interfaces/msg/Contacts", walks.Walk(2)
    entries = list(walk.messages(kind))
    walks.write_mcap(tmp_path / "whole.mcap", walk, entries)
    topics = {walks.foot_topic(kind, leg) for leg in walks.LEGS}
    stats = measure(tmp_path / "whole.mcap", MeasureOptions()).walk
    assert {topic.topic: topic.gaps for topic in stats.topics if topic.topic in topics} == (
        dict.fromkeys(topics, 0)
    )
    assert not [each for each in findings_of(stats) if each.code == "GAPS"]

    silent = walks.foot_topic(kind, walks.LEGS[0])
    start, end = walks.START + 1_000_000_000, walks.START + 4_800_000_000
    kept = [e for e in entries if e.topic != silent or not start < e.log_time < end]
    walks.write_mcap(tmp_path / "gap.mcap", walk, kept)
    stats = measure(tmp_path / "gap.mcap", MeasureOptions()).walk
    found = {topic.topic: topic for topic in stats.topics if topic.gaps}
    assert list(found) == [silent]
    assert found[silent].gaps == 1
    assert found[silent].longest_gap_s == pytest.approx(3.8, abs=0.5)
