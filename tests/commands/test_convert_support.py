"""`/support` in converted logs: in closed form, and where it is not known or not written."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.core.scene.support_scene import margin_colour
from dogbot_logtool.options.convert import ConvertOptions
from tests.commands.conversions import converted
from tests.oracles import walks
from tests.oracles.annotated_file import ENCODED, annotations, read_written
from tests.oracles.conversion import xyz
from tests.oracles.foot_logs import CONTACTS, write_log
from tests.oracles.recorded import S
from tests.oracles.ros1_logs import BASE, FEET, LIFTED, LIFTED_S, START, write_standing_log
from tests.oracles.small_logs import first_seconds
from tests.paths import ROOT, TROT, TROUBLED
from tests.truth.margins import hull, margin

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


def shown(message: Any) -> tuple[Any, list[list[Vector]]]:
    """The outline's colour, and the points of outline, pressure, projection and touchdowns."""
    if hasattr(message, "markers"):
        outline = message.markers[0]
        return outline.color, [[xyz(each) for each in one.points] for one in message.markers]
    (entity,) = message.entities
    line = entity.lines[0] if entity.lines else None
    places: list[list[Vector]] = [[xyz(point) for point in line.points] if line else [], [], [], []]
    # Touchdowns have the colours of their feet.
    kinds = {0.8: places[1], 0.337: places[2]}
    for ball in entity.spheres:
        kinds.get(round(ball.color.r, 3), places[3]).append(xyz(ball.pose.position))
    return line.color if line else None, places


@pytest.mark.parametrize("encoding", ENCODED)
def test_support_is_that_of_the_feet_that_stand(tmp_path: Path, encoding: str) -> None:
    log = write_standing_log(tmp_path / "log.mcap", LEANING, NEWTONS, {"back_left": SILENT_S})
    done = convert(log, tmp_path / "out.mcap", ConvertOptions(encoding=encoding, copy=False))
    is_ros = encoding != "foxglove"
    kind = "visualization_msgs/MarkerArray" if is_ros else "foxglove.SceneUpdate"
    found = list(annotations(read_written(tmp_path / "out.mcap"), "/support", encoding, kind))
    assert [message.log_time for message, _ in found] == [START + n * S // 50 for n in range(50)]
    unknown = 0
    for message, scene in found:
        seconds, (colour, places) = (message.log_time - START) / S, shown(scene)
        outline, pressure, projection, touchdowns = places
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


# --- When it is written ---------------------------------------------------------------------------


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


def centipede(folder: Path) -> tuple[Path, ConvertOptions]:
    feet = {f"foot_{number}": f"/leg/{number}" for number in range(17)}
    topics = dict.fromkeys(feet.values(), CONTACTS)
    log = write_log(folder / "walk.mcap", topics, odometry=["/odom"])
    return log, ConvertOptions(robot="generic", foot=feet)


@pytest.mark.parametrize(
    ("what", "cause"),
    [
        ("geometry_msgs/msg/WrenchStamped", "contact points"),
        ("centipede", "17 feet"),
    ],
)
def test_some_feet_have_no_support(tmp_path: Path, what: str, cause: str) -> None:
    if what == "centipede":
        log, options = centipede(tmp_path)
    else:
        log, options = walks.write_walk(tmp_path, what, "bag"), ConvertOptions()
    done = convert(log, tmp_path / "out.mcap", options)
    assert "/support" not in done.annotations
    (finding,) = [one for one in done.findings if one.code == "NO_SUPPORT_DRAWN"]
    assert cause in finding.text


def test_it_lasts_until_it_is_drawn_anew(tmp_path: Path) -> None:
    log = first_seconds(TROT)
    convert(log, tmp_path / "out.mcap", ConvertOptions(copy=False, tf_rate=1.0))
    for _, message in read_written(tmp_path / "out.mcap").decoded("/support"):
        assert message.entities[0].lifetime.ToNanoseconds() == 2 * S
