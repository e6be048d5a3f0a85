"""Support, legs, topics, transforms and events of a converted log."""

import sys
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest

import dogbot_logtool as dl
from dogbot_logtool.conversion import annotated_log
from dogbot_logtool.core.scene.feet import colour_parts, foot_colour
from dogbot_logtool.core.scene.support_scene import margin_colour
from dogbot_logtool.writer.encodings.foxglove import FoxgloveEncoding
from tests.commands.test_convert import codes, converted
from tests.measured import walk_of
from tests.oracles import recorded, walks
from tests.oracles.annotated_file import Written, read_written, written_transforms
from tests.oracles.conversion import xyz
from tests.oracles.frames import Frames, turn_of
from tests.oracles.recorded import S
from tests.oracles.small_logs import (
    BASE,
    CONTACTS,
    FEET,
    LIFTED,
    LIFTED_S,
    START,
    first_seconds,
    small_walk,
    text,
    transform,
    write_bag,
    write_log,
    write_standing_log,
)
from tests.oracles.walks import Entry
from tests.paths import TROT, TROUBLED
from tests.truth import physics
from tests.truth.free_walker import trot
from tests.truth.geometry import hull, margin
from tests.truth.parts import urdf
from tests.truth.physics import KEPT_S

# --- Support --------------------------------------------------------------------------------------


PLACES: Final = {
    foot: tuple(a + b for a, b in zip(BASE, offset, strict=True)) for foot, offset in FEET.items()
}
LEANING: Final = (1.06, 2.02, 0.5)
"""m, the base over feet that stand about `BASE`."""
NEWTONS: Final = {"front_left": 40.0, "front_right": 50.0, "back_left": 60.0, "back_right": 70.0}
SILENT_S: Final = 0.86
"""When a sensor falls silent; contact is not known 60 ms later."""
Vector = tuple[float, float, float]


@pytest.mark.parametrize(
    ("base", "given"), [(LEANING, {}), (BASE, {"com_offset_m": "[0.06, 0.02, 0.0]"})]
)
def test_support_is_that_of_the_feet_that_stand(
    tmp_path: Path, base: Vector, given: dict[str, str]
) -> None:
    log = write_standing_log(tmp_path / "log.mcap", base, NEWTONS, {"back_left": SILENT_S})
    done = converted(log, encoding="ros2", copy=False, set=given)
    found = done.written.decoded("/support")
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
    assert done.conversion.counts["support_unknown"] == unknown > 2


def assert_standing(feet: Sequence[str], outline: Sequence[Vector], colour: Any) -> None:
    """Check that an outline leads round all feet, in the colour of the base's margin in it."""
    corners = hull([(x, y) for x, y, _ in map(PLACES.__getitem__, feet)])
    assert outline == [(*corner, 0.0) for corner in (*corners, corners[0])]
    wanted = margin_colour(np.array([margin(corners, LEANING[:2])]))[0]
    found = colour.r, colour.g, colour.b, colour.a
    np.testing.assert_allclose(found, wanted, atol=1e-6)


@pytest.mark.parametrize("cause", ["contact points", "17 feet"])
def test_some_feet_have_no_support(tmp_path: Path, cause: str) -> None:
    log: Path = tmp_path / "walk.mcap"
    options: dict[str, Any] = {}
    if cause == "17 feet":
        feet = {f"foot_{number}": f"/leg/{number}" for number in range(17)}
        write_log(log, dict.fromkeys(feet.values(), CONTACTS), odometry=["/odom"])
        options = {"robot": "generic", "foot": feet}
    else:
        log = walks.write_walk(tmp_path, "geometry_msgs/msg/WrenchStamped", "bag")
    done = converted(log, **options).conversion
    assert "/support" not in done.annotations
    (finding,) = [one for one in done.findings if one.code == "NO_SUPPORT_DRAWN"]
    assert cause in finding.text


def test_it_lasts_until_it_is_drawn_anew() -> None:
    log = first_seconds(TROT)
    for _, message in converted(log, copy=False, tf_rate=1.0).written.decoded("/support"):
        assert message.entities[0].lifetime.ToNanoseconds() == 2 * S


# --- Links that joint states move -----------------------------------------------------------------


def moved(written: Written, encoding: str) -> Frames:
    """The links of a converted log; all of them at every time, and at its first time."""
    frames = Frames()
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
    log = physics.write_log(tmp_path / "log.mcap", described)
    given = None if is_own else file
    done = converted(log, encoding=encoding, urdf=given)
    assert "ROBOT_DESCRIPTION" in codes(done.conversion)
    ((_, written),) = done.written.decoded("/robot_description")
    assert written.data == file.read_text()
    frames = moved(done.written, encoding)
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
    log = physics.write_log(tmp_path / "log.mcap", replace(trot(), parts=()))
    own = physics.write_log(tmp_path / "own.mcap", trot(), by_transforms=True)
    whole = urdf(trot().parts)
    for source, description, said in (
        (log, CALF, [""]),
        (own, CALF, []),
        (log, whole.replace("_joint", "_other"), []),
        (log, whole.replace("base_link", "trunk"), [""]),
        (
            log,
            whole.replace('xyz="0 1 0"', 'xyz="0 nan 0"', 1),
            ["has a joint that cannot be used"],
        ),
    ):
        file.write_text(description)
        done = dl.convert(source, target, urdf=file, end=0.5, overwrite=True)
        found = [each.text for each in done.findings if each.code == "ROBOT_DESCRIPTION"]
        assert bool(found) == bool(said)
        assert all(each in " ".join(found) for each in said)


def test_feet_that_tell_contact_only_have_loads_that_say_stance_and_swing(tmp_path: Path) -> None:
    log = walks.write_walk(tmp_path, "champ_msgs/msg/ContactsStamped", "mcap")
    loads = converted(log, copy=False).written.decoded("/load/front_left")
    found: Counter[tuple[str, bool]] = Counter()
    for log_time, load in loads:
        down = walks.TOUCHES["front_left"][(log_time - walks.START) // walks.STEP]
        found[load.state, bool(down)] += 1
    assert found["stance", True] == int(walks.TOUCHES["front_left"].sum())
    assert not found["swing", True]
    assert not found["stance", False]


# --- Lines from the body to the feet --------------------------------------------------------------


def test_lines_lead_to_the_feet_that_stand(tmp_path: Path) -> None:
    log = write_standing_log(tmp_path / "log.mcap")
    legs = converted(log, encoding="ros2", copy=False).written.decoded("/legs")
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


# --- Topics and transforms ------------------------------------------------------------------------


def test_a_topic_that_is_taken_twice_is_moved_twice(tmp_path: Path) -> None:
    taken = (
        recorded.load_topic("front_left"),
        f"/dogbot_logtool{recorded.load_topic('front_left')}",
    )
    entries = [Entry(topic, recorded.TEXT_TYPE, 10 * S, text("mine")) for topic in taken]
    log = write_bag(tmp_path / "log.bag", [*entries, *small_walk(0.2)])
    done = converted(log)
    conversion = done.conversion
    topic = "/dogbot_logtool/dogbot_logtool/load/front_left"
    assert conversion.annotations[topic] == 51  # with the first time's
    loads = done.written.decoded(topic)
    assert {load.in_contact for _, load in loads} == {True, False}
    (moved,) = [finding for finding in conversion.findings if finding.code == "TOPIC_MOVED"]
    assert moved.where == topic
    assert "/load/front_left" in moved.text


@pytest.mark.parametrize(
    ("options", "topic"),
    [({}, ""), ({"tf": "always"}, "/dogbot_logtool/tf"), ({"copy": False}, "/tf")],
)
def test_a_second_parent_is_noticed_where_it_is_copied(
    tmp_path: Path, options: dict[str, Any], topic: str
) -> None:
    """A transform, too, says once where the base is; with --tf always ours are written anyway."""
    time = 10 * S + 100_000_000
    sent = Entry("/tf", recorded.TF_TYPE, time, transform(time, "/map", "base_link"))
    entries = sorted([*small_walk(), sent], key=lambda entry: entry.log_time)
    conversion = converted(write_bag(tmp_path / "log.bag", entries), **options).conversion
    written = {name: n for name, n in conversion.annotations.items() if name.endswith("/tf")}
    assert written == ({topic: 50} if topic else {})
    told = [finding.text for finding in conversion.findings if finding.code == "TF_NOT_WRITTEN"]
    assert ["base_link a parent (map)" in text for text in told] == [True] * (not topic)
    assert conversion.annotations[recorded.arrow_topic("front_left")] == 250


# --- Events ---------------------------------------------------------------------------------------


def test_events_are_log_messages_of_ros_2_too() -> None:
    """Of the other encodings the golden files have them."""
    stats, found = walk_of(TROUBLED).stats, converted(TROUBLED, copy=False, encoding="ros2")
    told = [(one.name, one.level) for _, one in found.written.decoded("/events")]
    steps = {"touchdown", "lift_off"}
    levels = [10 if each["type"] in steps else 30 for each in stats["events"]]
    assert told == [(e["foot"] or "robot", n) for e, n in zip(stats["events"], levels, strict=True)]


def test_without_spans_in_the_schemas_the_rest_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "foxglove_schemas_protobuf.Event_pb2", None)
    # Made with those schemas, not the one that other conversions share.
    monkeypatch.setattr(annotated_log, "encoding_named", lambda _: FoxgloveEncoding())
    dl.convert(TROUBLED, tmp_path / "out.mcap", copy=False, jobs=1)
    topics = read_written(tmp_path / "out.mcap").topics
    assert "/events/spans" not in topics
    assert topics["/events"]
