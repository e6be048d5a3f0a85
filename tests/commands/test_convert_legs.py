"""Legs in converted logs: links that joints move, frames of feet, lines to feet that stand."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Final
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.core.scene.feet import colour_parts, foot_colour
from dogbot_logtool.options.convert import ConvertOptions
from tests.commands.conversions import codes
from tests.oracles import state_walks, walks
from tests.oracles.annotated_file import annotations, arrows, read_written, written_transforms
from tests.oracles.frames import Frames, turn_of
from tests.oracles.recorded import TF_TYPE
from tests.oracles.ros1_logs import BASE, FEET, LIFTED, LIFTED_S, START, write_standing_log
from tests.oracles.state_walks import StateWalk
from tests.truth import physics
from tests.truth.free_walker import trot
from tests.truth.parts import urdf
from tests.truth.physics import KEPT_S

NAMES = tuple(FEET)

# --- Links that joint states move -----------------------------------------------------------------


def moved(path: Path, encoding: str) -> Frames:
    """The links of a converted log; all of them at every time, and at its first time."""
    frames, written = Frames(), read_written(path)
    for names, poses in written_transforms(written, "/tf", encoding):
        if len(poses) > 1:
            for (parent, child), pose in zip(names, poses, strict=True):
                frames.add(parent, child, pose.stamp, pose.numbers)
    assert {len(times) for times in frames.times.values()} == {len(frames.times["FL_calf"])}
    assert frames.times["FL_calf"][0] == min(message.log_time for message in written.messages)
    return frames


@pytest.mark.parametrize(("encoding", "is_own"), [("foxglove", False), ("ros1", True)])
def test_links_are_where_the_engine_has_them(
    tmp_path: Path, encoding: str, *, is_own: bool
) -> None:
    """By the description in the log, or by one that is given instead of it."""
    file, truth = tmp_path / "dog.urdf", trot()
    file.write_text(urdf(trot().parts))
    described = truth if is_own else replace(truth, parts=())
    log = physics.write_log(tmp_path / "log.mcap", described, by_transforms=False)
    given = None if is_own else file
    done = convert(log, tmp_path / "out.mcap", ConvertOptions(encoding=encoding, urdf=given))
    assert "ROBOT_DESCRIPTION" in codes(done)
    frames = moved(tmp_path / "out.mcap", encoding)
    assert len(frames.parents) == 16
    assert len(frames.times["FL_calf"]) == 175
    for time in frames.times["FL_calf"][::10]:
        row = round((time - physics.ORIGIN_NS) / 1e9 / KEPT_S)
        for foot, calf in zip(physics.FEET, truth.calf[row], strict=True):
            found = frames.in_world(f"{foot}_calf", time, "base_link")
            assert found is not None
            np.testing.assert_allclose(found[0], calf[:3], atol=5e-8)
            np.testing.assert_allclose(found[1], turn_of(calf[3:]), atol=5e-7)


CALF: Final = (
    '<robot name="calf"><link name="base_link"/><link name="FL_calf"/>'
    '<joint name="FL_calf_joint" type="revolute"><parent link="base_link"/>'
    '<child link="FL_calf"/><axis xyz="0 1 0"/></joint></robot>'
)
"""The one link of a leg of which transforms tell."""


def test_only_joints_of_the_base_s_links_move_a_description(tmp_path: Path) -> None:
    """Nor do any, where the log has transforms of the links or joints that it does not name."""
    file, target = tmp_path / "dog.urdf", tmp_path / "out.mcap"
    log = physics.write_log(tmp_path / "log.mcap", replace(trot(), parts=()), by_transforms=False)
    own = physics.write_log(tmp_path / "own.mcap", trot(), by_transforms=True)
    for source, text, is_said in (
        (log, CALF, True),
        (own, CALF, False),
        (log, urdf(trot().parts).replace("_joint", "_other"), False),
        (log, urdf(trot().parts).replace("base_link", "trunk"), True),
    ):
        file.write_text(text)
        done = convert(source, target, ConvertOptions(urdf=file, end=0.5, overwrite=True))
        assert ("ROBOT_DESCRIPTION" in codes(done)) == is_said


def test_joints_that_are_left_out_are_counted(tmp_path: Path) -> None:
    file = tmp_path / "dog.urdf"
    file.write_text(urdf(trot().parts).replace('axis xyz="0 1 0"', 'axis xyz="0 nan 0"', 1))
    log = physics.write_log(tmp_path / "log.mcap", replace(trot(), parts=()), by_transforms=False)
    done = convert(log, tmp_path / "out.mcap", ConvertOptions(urdf=file))
    said = [each.text for each in done.findings if each.code == "ROBOT_DESCRIPTION"]
    assert any("joints left out of the robot description: 1 (" in each for each in said)


# --- Feet whose messages name no frame ------------------------------------------------------------

FT = "pronto_msgs/msg/QuadrupedForceTorqueSensors"
HIPS_M = 0.1
"""Height of a hip above the base, halfway in the chain to the foot."""


def foot_entries(walk: StateWalk) -> Iterator[walks.Entry]:
    """Forces of all feet, and transforms of the base, its hips and its feet."""
    yield from (entry for entry in walk.messages(FT) if entry.kind == FT)
    for sample in range(walks.SAMPLES):
        base = state_walks.base_position(sample)
        rows = [("odom", "base_link", base)]
        for leg, label in state_walks.LABELS.items():
            hip, name = [*state_walks.PLACES[leg], HIPS_M], f"{label[:2].lower()}_hip"
            foot = state_walks.foot_position(leg, sample) - base - hip
            rows += [("base_link", name, hip), (name, label, foot)]
        made = [
            {"header": walk.header(sample, parent), "child_frame_id": child, "transform": [shift]}
            for parent, child, shift in rows
        ]
        message = walk.bytes_of(TF_TYPE, walk.make(TF_TYPE, transforms=made))
        yield walks.Entry("/tf", TF_TYPE, walks.START + sample * walks.STEP, message)


def test_arrows_start_at_the_frames_of_the_feet(tmp_path: Path) -> None:
    walk, path, target = StateWalk(2), tmp_path / "walk.mcap", tmp_path / "out.mcap"
    walks.write_mcap(path, walk, sorted(foot_entries(walk), key=lambda entry: entry.log_time))
    convert(path, target, ConvertOptions(mass=walks.MASS_KG, encoding="ros2", copy=False))
    drawn = 0
    for topic, log_time, marker in arrows(target):
        leg = topic.removeprefix("/marker_basic_").removesuffix("_foot")
        at = marker.pose.position
        expected = state_walks.foot_position(leg, (log_time - walks.START) // walks.STEP)
        assert (at.x, at.y, at.z) == pytest.approx(expected, abs=1e-6)
        drawn += 1
    assert drawn == sum(int(touch.sum()) for touch in walks.TOUCHES.values())


def test_feet_that_tell_contact_only_have_loads_that_say_stance_and_swing(tmp_path: Path) -> None:
    log = walks.write_walk(tmp_path, "champ_msgs/msg/ContactsStamped", "mcap")
    convert(log, tmp_path / "out.mcap", ConvertOptions(copy=False))
    found: Counter[tuple[str, bool]] = Counter()
    for log_time, load in read_written(tmp_path / "out.mcap").decoded("/load/front_left"):
        down = walks.TOUCHES["front_left"][(log_time - walks.START) // walks.STEP]
        found[load.state, bool(down)] += 1
    assert found["stance", True] == int(walks.TOUCHES["front_left"].sum())
    assert not found["swing", True]
    assert not found["stance", False]


# --- Lines from the body to the feet --------------------------------------------------------------


def lines(message: Any) -> tuple[Sequence[Any], Sequence[Any]]:
    """Points and colours of a message of any encoding."""
    if hasattr(message, "deletions"):
        drawn = [line for entity in message.entities for line in entity.lines]
        return (drawn[0].points, drawn[0].colors) if drawn else ((), ())
    return message.points, message.colors


def place(point: Any) -> tuple[float, float, float]:
    return point.x, point.y, point.z


@pytest.mark.parametrize("encoding", ["foxglove", "ros2"])
def test_lines_lead_to_the_feet_that_stand(tmp_path: Path, encoding: str) -> None:
    log = write_standing_log(tmp_path / "log.mcap")
    convert(log, tmp_path / "out.mcap", ConvertOptions(encoding=encoding, copy=False))
    written = read_written(tmp_path / "out.mcap")
    kind = "foxglove.SceneUpdate" if encoding == "foxglove" else "visualization_msgs/Marker"
    legs = list(annotations(written, "/legs", encoding, kind))
    assert legs[0][0].log_time == START
    assert len(legs) == 50
    for record, message in legs:
        seconds = (record.log_time - START) / 1e9
        up = LIFTED_S[0] <= seconds < LIFTED_S[1]
        standing = [foot for foot in NAMES if not (up and foot == LIFTED)]
        points, colours = lines(message)
        assert len(points) == 2 * len(standing)
        for number, foot in enumerate(standing):
            hip, end = place(points[2 * number]), place(points[2 * number + 1])
            expected = [a + b for a, b in zip(BASE, FEET[foot], strict=True)]
            assert end == pytest.approx(expected)
            # The hip is at the base's height, on the foot's side, inside of it.
            assert hip[2] == pytest.approx(BASE[2])
            for axis in range(2):
                share = (hip[axis] - BASE[axis]) / FEET[foot][axis]
                assert 0.5 < share < 1.0
            colour = colours[2 * number + 1]
            own = colour_parts(foot_colour(NAMES.index(foot)))
            assert (colour.r, colour.g, colour.b) == pytest.approx(own, abs=1e-6)


def test_the_body_spans_the_hips_and_its_nose_is_between_the_fore_feet(tmp_path: Path) -> None:
    """The robot is guessed to be one whose +y is forward; its feet say otherwise."""
    convert(write_standing_log(tmp_path / "log.mcap"), tmp_path / "out.mcap", ConvertOptions())
    written = read_written(tmp_path / "out.mcap")
    ((_, text),) = annotations(written, "/robot_description", "ros1", "std_msgs/String")
    body, nose = ET.fromstring(text.data).findall(".//visual")  # noqa: S314
    length, width, _ = map(float, body.find("geometry/box").get("size").split())  # type: ignore[union-attr]
    x, y, _ = map(float, nose.find("origin").get("xyz").split())  # type: ignore[union-attr]
    assert 0.3 < length < 0.6
    assert 0.2 <= width < 0.4
    assert x > length / 2.0
    assert y == pytest.approx(0.0)
