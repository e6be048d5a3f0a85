"""Feet whose messages name no frame stand where transforms place frames of their names."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.option import part_of
from dogbot_logtool.options import ConvertOptions, MeasureOptions
from tests.oracles import state_walks, walks
from tests.oracles.annotated_file import arrows
from tests.oracles.state_walks import StateWalk

FT = "pronto_msgs/msg/QuadrupedForceTorqueSensors"
TF = "tf2_msgs/msg/TFMessage"
HIPS_M = 0.1
"""Height of a hip above the base, halfway in the chain to the foot."""


def transform(walk: StateWalk, sample: int, parent: str, child: str, shift: Any) -> Any:
    header = walk.header(sample, parent)
    return {"header": header, "child_frame_id": child, "transform": [shift]}


def entries(walk: StateWalk) -> Iterator[walks.Entry]:
    """Forces of all feet, and transforms of the base, its hips and its feet."""
    for entry in walk.messages(FT):
        if entry.kind == FT:
            yield entry
    for sample in range(walks.SAMPLES):
        base = state_walks.base_position(sample)
        made = [transform(walk, sample, "odom", "base_link", base)]
        for leg, label in state_walks.LABELS.items():
            hip = [*state_walks.PLACES[leg], HIPS_M]
            foot = state_walks.foot_position(leg, sample) - base - hip
            made.append(transform(walk, sample, "base_link", f"{label[:2].lower()}_hip", hip))
            made.append(transform(walk, sample, f"{label[:2].lower()}_hip", label, foot))
        time = walks.START + sample * walks.STEP
        message = walk.make("tf2_msgs/TFMessage", transforms=made)
        yield walks.Entry("/tf", TF, time, walk.bytes_of(TF, message))


def test_arrows_start_at_the_frames_of_the_feet(tmp_path: Path) -> None:
    walk, path, target = StateWalk(2), tmp_path / "walk.mcap", tmp_path / "out.mcap"
    written = sorted(entries(walk), key=lambda entry: entry.log_time)
    walks.write_mcap(path, walk, written)
    topics = MeasureOptions(mass=walks.MASS_KG)
    convert(path, target, replace(part_of(topics, ConvertOptions), encoding="ros2", copy=False))
    drawn = 0
    for topic, log_time, marker in arrows(target):
        leg = topic.removeprefix("/marker_basic_").removesuffix("_foot")
        at = marker.pose.position
        expected = state_walks.foot_position(leg, (log_time - walks.START) // walks.STEP)
        assert (at.x, at.y, at.z) == pytest.approx(expected, abs=1e-6)
        drawn += 1
    assert drawn == sum(int(touch.sum()) for touch in walks.TOUCHES.values())
