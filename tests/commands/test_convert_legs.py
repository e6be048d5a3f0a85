"""`/legs`: lines from the body to the feet that stand, where no transforms move the legs."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pytest

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.core.scene.foot_style import colour_parts, foot_colour
from dogbot_logtool.options import ConvertOptions
from tests.oracles.annotated_file import annotations, read_written
from tests.oracles.ros1_logs import (
    BASE,
    FEET,
    LIFTED,
    LIFTED_S,
    START,
    write_standing_log,
)
from tests.paths import TROUBLED

NAMES = tuple(FEET)


def lines(message: Any) -> tuple[Sequence[Any], Sequence[Any]]:
    """Points and colours of a message of any encoding."""
    if hasattr(message, "deletions"):
        drawn = [line for entity in message.entities for line in entity.lines]
        return (drawn[0].points, drawn[0].colors) if drawn else ((), ())
    return message.points, message.colors


def place(point: Any) -> tuple[float, float, float]:
    return point.x, point.y, point.z


@pytest.mark.parametrize("encoding", ["foxglove", "ros1", "ros2"])
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


def test_legs_that_transforms_move_need_no_lines(tmp_path: Path) -> None:
    convert(TROUBLED, tmp_path / "out.mcap", ConvertOptions(copy=False))
    written = read_written(tmp_path / "out.mcap")
    assert "/legs" not in {channel.topic for channel in written.channels.values()}
