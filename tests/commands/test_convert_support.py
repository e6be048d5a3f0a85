"""`/support` in converted logs, against one message at a time and against `stats`."""

import math
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.core.scene.styles import ARROW_STYLES
from dogbot_logtool.core.scene.support_scene import margin_colour
from dogbot_logtool.options import ConvertOptions
from tests.commands.conversions import converted
from tests.measured import measured_contact
from tests.oracles import walks
from tests.oracles.annotated_file import Written, annotations, read_written, written_arrows
from tests.oracles.conversion import expected_poses, norm, sample_of, xyz
from tests.oracles.foot_logs import CONTACTS, write_log
from tests.oracles.recorded import (
    FEET,
    contact_topic,
    decoded_log,
)
from tests.paths import ROOT, TROT, TROUBLED, WALK

DOGBOT = ROOT / "dogbot_logtool/robot/known/dogbot.toml"
MS = 1_000_000
NEAR_MS = 60
VERTICAL_KNOWN = {TROT: False, WALK: True, TROUBLED: False}
Vector = tuple[float, float, float]


class Shown:
    """What a message of any encoding shows, and when it was recorded."""

    def __init__(self, log_time: int, message: Any) -> None:
        self.log_time = log_time
        self.colour: Sequence[float] = ()
        places: list[list[Vector]] = []
        if hasattr(message, "markers"):
            places = [[xyz(point) for point in marker.points] for marker in message.markers]
            line = message.markers[0]
        else:
            (entity,) = message.entities
            (line,) = entity.lines or (None,)
            touchdowns: list[Vector] = []
            # Touchdowns have the colours of their feet.
            kinds: dict[float, list[Vector]] = {0.8: [], 0.337: []}
            for ball in entity.spheres:
                kinds.get(round(ball.color.r, 3), touchdowns).append(xyz(ball.pose.position))
            outline = [xyz(point) for point in line.points] if line else []
            places = [outline, *kinds.values(), touchdowns]
        self.outline, self.pressure, self.projection, self.touchdowns = places
        if self.outline:
            self.colour = line.color.r, line.color.g, line.color.b, line.color.a


def shown_in(written: Written, encoding: str, *, with_first: bool = False) -> list[Shown]:
    """Return what is shown, with or without what stands at the file's first time."""
    ros = "visualization_msgs/MarkerArray"
    type_name = "foxglove.SceneUpdate" if encoding == "foxglove" else ros
    first, *others = annotations(written, "/support", encoding, type_name)
    opening = min(message.log_time for message in written.messages)
    assert first[0].log_time == opening
    shown = [first, *others] if with_first else others
    return [Shown(message.log_time, decoded) for message, decoded in shown]


def turned_forces(folder: Path, log: Path) -> dict[tuple[str, int], float]:
    """Vertical forces of arrows along the force, which test_world_frames.py holds to the truth."""
    written = converted(folder, log, style="force", encoding="ros2", copy=False).written
    found = {}
    for foot in FEET if log == TROT else ():
        for arrow in written_arrows(written, foot, "ros2", "force"):
            if arrow.position:
                x, y, z, w = arrow.orientation
                found[foot, arrow.log_time] = 100.0 * arrow.length * 2.0 * (x * z - w * y)
    return found


# --- A message at a time --------------------------------------------------------------------------


class Foot:
    """A foot that is listened to, one message after the other."""

    def __init__(self, log: Path, name: str, turned: Mapping[tuple[str, int], float]) -> None:
        self.messages: list[tuple[int, bool, Vector | None, float]] = []
        contact = measured_contact(log, name)
        self.works = contact is not None
        told = sorted(decoded_log(log)[contact_topic(name)], key=lambda one: one.log_time)
        for one in told:
            sample = sample_of(one.message, name)
            force = norm(sample.force)
            if math.isfinite(force):
                on = contact is not None and contact[one.log_time]
                known = sample.in_world or VERTICAL_KNOWN[log] or force == 0.0
                other = turned.get((name, one.log_time), math.nan)
                vertical = sample.force[2] if known else other
                self.messages.append((one.log_time, on, sample.position, vertical))

    def at(self, time: int) -> tuple[bool, Vector | None, float] | None:
        """Return the newest message's contact, point and vertical force; None: not known."""
        heard = bisect_right(self.messages, time, key=lambda message: message[0])
        if not heard or not self.works:
            return None
        since, on, point, vertical = self.messages[heard - 1]
        return None if time - since > NEAR_MS * MS else (on, point, vertical)


def left_of(begin: Vector, end: Vector, point: Vector) -> float:
    along, to = [[b - a for a, b in zip(begin, one, strict=True)] for one in (end, point)]
    return along[0] * to[1] - along[1] * to[0]


def margin_of(outline: Sequence[Vector], body: Vector) -> float:
    """Return the signed distance to the nearest side of a closed polygon."""
    reach = math.inf
    for begin, end in pairwise(outline):
        length = math.dist(begin[:2], end[:2])
        share = sum((e - b) * (p - b) for b, e, p in zip(begin[:2], end[:2], body[:2], strict=True))
        share = min(max(share / length**2, 0.0), 1.0)
        foot = [b + share * (e - b) for b, e in zip(begin[:2], end[:2], strict=True)]
        reach = min(reach, math.dist(foot, body[:2]))
    inside = all(left_of(*side, body) >= 0.0 for side in pairwise(outline))
    return reach if inside else -reach


@pytest.mark.parametrize(
    ("log", "encoding"),
    [(TROT, "foxglove"), (WALK, "ros2"), (TROUBLED, "ros1")],
    ids=lambda one: one.stem if isinstance(one, Path) else one,
)
def test_support_is_what_message_by_message_listening_gives(
    folder: Path, log: Path, encoding: str
) -> None:
    done = converted(folder, log, encoding=encoding, copy=False)
    conversion, written = done.conversion, done.written
    turned = turned_forces(folder, log)
    feet = [Foot(log, name, turned) for name in FEET]
    # Before all feet have sent a message, the file's first time says what they do at once.
    heard = max(foot.messages[0][0] for foot in feet)
    first, *others = expected_poses(log, at_ticks=True)
    poses = [one for one in (first, *others) if one.log_time >= heard]
    messages = shown_in(written, encoding, with_first=True)
    assert [one.log_time for one in messages[1:]] == [pose.log_time for pose in poses]
    times = [max(heard, first.log_time), *(pose.log_time for pose in poses)]
    unknown = 0
    for message, pose, time in zip(messages, [first, *poses], times, strict=True):
        states = [foot.at(time) for foot in feet]
        down = [state[1:] for state in states if state is not None and state[0]]
        if None in states or any(point is None for point, _ in down):
            unknown += 1
            assert not message.outline
            assert not message.pressure
            continue
        points = [point for point, _ in down if point is not None]
        assert_outline(message, points, (pose.numbers[0], pose.numbers[1], 0.0))
        weights = [vertical for _, vertical in down]
        assert bool(message.pressure) == (sum(weights) > 0.0)
        for place in message.pressure:
            told = zip(weights, points, strict=True)
            wanted = np.sum([w * np.array(p) for w, p in told], axis=0) / sum(weights)
            # Forces are kept with 24 bits.
            np.testing.assert_allclose(place, wanted, rtol=1e-6, atol=1e-6)
        if points:
            height = sum(point[2] for point in points) / len(points)
            (place,) = message.projection
            np.testing.assert_allclose(place, (*pose.numbers[:2], height), atol=1e-12)
    assert conversion.counts["support_unknown"] == unknown


def assert_outline(message: Shown, points: list[Vector], body: Vector) -> None:
    """Check the corners: of the feet, all others to their left, and coloured by the margin."""
    outline = message.outline
    for corner in outline:
        assert min(math.dist(corner, point) for point in points) < 1e-12
    assert len(outline) == {0: 0, 1: 0, 2: 2}.get(len(points), len(outline))
    margin = math.nan
    if len(points) > 2:
        assert outline[0] == outline[-1]
        assert len(outline) > 3
        assert min(left_of(*side, point) for side in pairwise(outline) for point in points) > -1e-9
        margin = margin_of(outline, body)
    if outline:
        wanted = margin_colour(np.array([margin]))[0]
        np.testing.assert_allclose(message.colour, wanted, atol=1e-6)


# --- When it is written ---------------------------------------------------------------------------


@pytest.mark.parametrize("style", ARROW_STYLES)
def test_it_is_written_whatever_the_style(tmp_path: Path, style: str) -> None:
    options = ConvertOptions(style=style, copy=False, end=0.2)
    done = convert(TROUBLED, tmp_path / "out.mcap", options)
    assert done.annotations["/support"] > 0


def test_what_is_not_known_is_told(folder: Path) -> None:
    done = converted(folder, TROUBLED, encoding="ros1", copy=False).conversion
    told = {each.code: each.text for each in done.findings}
    # One of its sensors is dead, and `stats` gives no margins either.
    assert "back_left" in told["DEAD"]
    assert "contact of some foot unknown" in told["NO_SUPPORT_DRAWN"]
    # Of this base the log's own transforms know nothing.
    robot = folder / "robot.toml"
    robot.write_text(DOGBOT.read_text().replace("base_link", "trunk"))
    options = ConvertOptions(robot=str(robot), copy=False, end=2.0)
    done = convert(TROT, folder / "link.mcap", options)
    assert "NO_SUPPORT_DRAWN" in {finding.code for finding in done.findings}


@pytest.mark.parametrize(
    "kind", ["champ_msgs/msg/ContactsStamped", "geometry_msgs/msg/WrenchStamped"]
)
def test_feet_without_points_have_no_support(tmp_path: Path, kind: str) -> None:
    log = walks.write_walk(tmp_path, kind, "bag")
    done = convert(log, tmp_path / "out.mcap", ConvertOptions())
    assert "/support" not in done.annotations
    (finding,) = [one for one in done.findings if one.code == "NO_SUPPORT_DRAWN"]
    assert "contact points" in finding.text


def test_a_centipede_has_no_support(tmp_path: Path) -> None:
    feet = {f"foot_{number}": f"/leg/{number}" for number in range(17)}
    topics = dict.fromkeys(feet.values(), CONTACTS)
    log = write_log(tmp_path / "walk.mcap", topics, odometry=["/odom"])
    options = ConvertOptions(robot="generic", foot=feet)
    done = convert(log, tmp_path / "out.mcap", options)
    assert "/support" not in done.annotations
    (finding,) = [one for one in done.findings if one.code == "NO_SUPPORT_DRAWN"]
    assert "17 feet" in finding.text


def test_it_lasts_until_it_is_drawn_anew(tmp_path: Path) -> None:
    convert(TROUBLED, tmp_path / "out.mcap", ConvertOptions(copy=False, tf_rate=1.0))
    written = read_written(tmp_path / "out.mcap")
    for _, message in annotations(written, "/support", "foxglove", "foxglove.SceneUpdate"):
        assert message.entities[0].lifetime.ToNanoseconds() == 2_000 * MS
