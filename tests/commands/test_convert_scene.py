"""Support and legs in converted logs."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Final
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.core.scene.feet import colour_parts, foot_colour
from dogbot_logtool.core.scene.support_scene import margin_colour
from dogbot_logtool.options.convert import ConvertOptions
from tests.commands.test_convert import codes
from tests.oracles import walks
from tests.oracles.annotated_file import (
    Written,
    read_written,
    written_transforms,
)
from tests.oracles.conversion import xyz
from tests.oracles.frames import Frames, turn_of
from tests.oracles.recorded import S
from tests.oracles.ros1_logs import BASE, FEET, LIFTED, LIFTED_S, START, write_standing_log
from tests.oracles.small_logs import CONTACTS, first_seconds, write_log
from tests.paths import ROOT, TROT
from tests.truth import physics
from tests.truth.free_walker import trot
from tests.truth.parts import urdf
from tests.truth.physics import KEPT_S
from tests.truth.recording import hull, margin

# --- Support --------------------------------------------------------------------------------------


DOGBOT = ROOT / "dogbot_logtool/robot/known/dogbot.toml"
PLACES: Final = {
    foot: tuple(a + b for a, b in zip(BASE, offset, strict=True)) for foot, offset in FEET.items()
}
LEANING: Final = (1.06, 2.02, 0.5)
"""m, the base over feet that stand about `BASE`."""
NEWTONS: Final = {"front_left": 40.0, "front_right": 50.0, "back_left": 60.0, "back_right": 70.0}
SILENT_S: Final = 0.86
"""When a sensor falls silent; contact is not known 60 ms later."""
Vector = tuple[float, float, float]


def test_support_is_that_of_the_feet_that_stand(tmp_path: Path) -> None:
    log = write_standing_log(tmp_path / "log.mcap", LEANING, NEWTONS, {"back_left": SILENT_S})
    done = convert(log, tmp_path / "out.mcap", ConvertOptions(encoding="ros2", copy=False))
    found = read_written(tmp_path / "out.mcap").decoded("/support")
    assert [log_time for log_time, _ in found] == [START + n * S // 50 for n in range(50)]
    unknown = 0
    for log_time, scene in found:
        seconds, colour = (log_time - START) / S, scene.markers[0].color
        parts = [[xyz(each) for each in one.points] for one in scene.markers]
        outline, pressure, projection, touchdowns = parts
        landed = [PLACES[LIFTED]] * (seconds >= LIFTED_S[1])
        assert sorted(touchdowns) == sorted([*PLACES.values(), *landed])
        if seconds > SILENT_S + 0.05:
            unknown += 1
            assert (outline, pressure) == ([], [])
            continue
        lifted = LIFTED_S[0] <= seconds < LIFTED_S[1]
        down = [foot for foot in FEET if not (lifted and foot == LIFTED)]
        assert_standing(down, outline, colour)
        weights = [NEWTONS[foot] for foot in down]
        centre = np.average([PLACES[foot] for foot in down], axis=0, weights=weights)
        np.testing.assert_allclose(pressure, [centre], atol=1e-6)
        np.testing.assert_allclose(projection, [(*LEANING[:2], 0.0)], atol=1e-12)
    assert done.counts["support_unknown"] == unknown > 2


def assert_standing(feet: Sequence[str], outline: Sequence[Vector], colour: Any) -> None:
    """Check that an outline leads round all feet, in the colour of the base's margin in it."""
    corners = hull([(x, y) for x, y, _ in map(PLACES.__getitem__, feet)])
    assert outline == [(*corner, 0.0) for corner in (*corners, corners[0])]
    wanted = margin_colour(np.array([margin(corners, LEANING[:2])]))[0]
    found = colour.r, colour.g, colour.b, colour.a
    np.testing.assert_allclose(found, wanted, atol=1e-6)


@pytest.mark.parametrize("cause", ["contact points", "17 feet"])
def test_some_feet_have_no_support(tmp_path: Path, cause: str) -> None:
    log, options = tmp_path / "walk.mcap", ConvertOptions()
    if cause == "17 feet":
        feet = {f"foot_{number}": f"/leg/{number}" for number in range(17)}
        write_log(log, dict.fromkeys(feet.values(), CONTACTS), odometry=["/odom"])
        options = ConvertOptions(robot="generic", foot=feet)
    else:
        log = walks.write_walk(tmp_path, "geometry_msgs/msg/WrenchStamped", "bag")
    done = convert(log, tmp_path / "out.mcap", options)
    assert "/support" not in done.annotations
    (finding,) = [one for one in done.findings if one.code == "NO_SUPPORT_DRAWN"]
    assert cause in finding.text


def test_it_lasts_until_it_is_drawn_anew(tmp_path: Path) -> None:
    log = first_seconds(TROT)
    convert(log, tmp_path / "out.mcap", ConvertOptions(copy=False, tf_rate=1.0))
    for _, message in read_written(tmp_path / "out.mcap").decoded("/support"):
        assert message.entities[0].lifetime.ToNanoseconds() == 2 * S


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


@pytest.fixture(scope="module")
def standing(tmp_path_factory: pytest.TempPathFactory) -> Written:
    folder = tmp_path_factory.mktemp("standing")
    log = write_standing_log(folder / "log.mcap")
    convert(log, folder / "out.mcap", ConvertOptions(encoding="ros2", copy=False))
    return read_written(folder / "out.mcap")


def test_lines_lead_to_the_feet_that_stand(standing: Written) -> None:
    legs = standing.decoded("/legs")
    assert legs[0][0] == START
    assert len(legs) == 50
    for log_time, message in legs:
        up = LIFTED_S[0] <= (log_time - START) / S < LIFTED_S[1]
        down = [foot for foot in FEET if not (up and foot == LIFTED)]
        assert len(message.points) == 2 * len(down)
        for number, foot in enumerate(down):
            hip, end = map(xyz, message.points[2 * number : 2 * number + 2])
            expected = [a + b for a, b in zip(BASE, FEET[foot], strict=True)]
            assert end == pytest.approx(expected)
            # The hip is at the base's height, on the foot's side, inside of it.
            assert hip[2] == pytest.approx(BASE[2])
            for axis in range(2):
                share = (hip[axis] - BASE[axis]) / FEET[foot][axis]
                assert 0.5 < share < 1.0
            colour = message.colors[2 * number + 1]
            own = colour_parts(foot_colour([*FEET].index(foot)))
            assert (colour.r, colour.g, colour.b) == pytest.approx(own, abs=1e-6)


def test_labels_stand_at_the_feet(standing: Written) -> None:
    for foot, offset in FEET.items():
        messages = [message for _, message in standing.decoded(f"/label/{foot}")]
        shown = [message for message in messages if message.action != 2]
        assert shown
        # Viewers know what to remove by its name.
        assert {(message.ns, message.id) for message in messages} == {("label", 0)}
        for message in shown:
            assert message.text.strip().endswith(" N")
            expected = [a + b for a, b in zip(BASE, offset, strict=True)]
            assert xyz(message.pose.position)[:2] == pytest.approx(expected[:2], abs=0.1)


def test_the_body_spans_the_hips_and_its_nose_is_between_the_fore_feet(standing: Written) -> None:
    """The robot is guessed to be one whose +y is forward; its feet say otherwise."""
    ((_, text),) = standing.decoded("/robot_description")
    body, nose = ET.fromstring(text.data).findall(".//visual")  # noqa: S314
    length, width, _ = map(float, body.find("geometry/box").get("size").split())  # type: ignore[union-attr]
    x, y, _ = map(float, nose.find("origin").get("xyz").split())  # type: ignore[union-attr]
    assert 0.3 < length < 0.6
    assert 0.2 <= width < 0.4
    assert x > length / 2.0
    assert y == pytest.approx(0.0)
