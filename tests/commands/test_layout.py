"""The layout names what `convert` writes, in the shape that Foxglove and Lichtblick import."""

import json
from math import cos, radians, sin
from pathlib import Path
from typing import Any

import pytest

import dogbot_logtool as dl
from dogbot_logtool.commands.layout import view_of
from dogbot_logtool.core.scene.feet import FOOT_COLOURS
from dogbot_logtool.errors import CallError
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.report.layouts import View, foxglove_layout, rviz_config
from tests.oracles.annotated_file import read_written
from tests.oracles.small_logs import write_standing_log
from tests.paths import TROUBLED, WALK

FEET = ("front_left", "front_right", "back_left", "back_right")


def plots(layout: dict[str, Any]) -> list[dict[str, Any]]:
    """The one curve of each plot."""
    of_feet = [one for name, one in layout["configById"].items() if name.startswith("Plot")]
    return [path for plot in of_feet for path in plot["paths"]]


def panel(layout: dict[str, Any], kind: str) -> dict[str, Any]:
    (found,) = [config for name, config in layout["configById"].items() if name.startswith(kind)]
    assert isinstance(found, dict)
    return found


def test_every_topic_and_field_is_in_a_converted_log(tmp_path: Path) -> None:
    dl.convert(TROUBLED, tmp_path / "out.mcap", copy=False)
    written = read_written(tmp_path / "out.mcap")
    first = {topic: written.decoded(topic)[0][1] for topic in written.topics}
    layout = foxglove_layout(view_of(TROUBLED, MeasureOptions()))
    drawn = {
        topic for topic in first if not topic.startswith(("/tf", "/load/", "/events", "/gait"))
    }
    scene = panel(layout, "3D")
    # Lines for legs are written only where no transforms move them.
    assert set(scene["topics"]) == drawn | {"/legs"}
    (transform,) = first["/tf"].transforms
    frames = transform.parent_frame_id, transform.child_frame_id
    assert frames == (scene["layers"]["grid"]["frameId"], scene["followTf"])
    assert [path["color"] for path in plots(layout)] == list(FOOT_COLOURS[: len(FEET)])
    for shown in (plots(layout), panel(layout, "StateTransitions")["paths"]):
        assert len(shown) == len(FEET)
        for path in shown:
            topic, _, field = path["value"].rpartition(".")
            assert hasattr(first[topic], field)


@pytest.mark.parametrize(("axis", "side"), [("+x", (1, 0)), ("+y", (0, 1)), ("-x", (-1, 0))])
def test_the_camera_stands_before_the_robot(axis: str, side: tuple[int, int]) -> None:
    offset = panel(foxglove_layout(View(FEET, "world", "base", axis)), "3D")["cameraState"]
    angle = radians(-90.0 - offset["thetaOffset"])
    assert 0.2 < cos(angle) * side[0] + sin(angle) * side[1] < 0.5
    yaw = rviz_config(View(FEET, "world", "base", axis))["Visualization Manager"]["Views"]
    angle = yaw["Current"]["Yaw"]
    assert 0.2 < cos(angle) * side[0] + sin(angle) * side[1] < 0.5


def test_rviz_shows_what_is_written() -> None:
    displays = rviz_config(View(FEET, "map", "trunk"))["Visualization Manager"]["Displays"]
    topics = {each["Marker Topic"] for each in displays if "Marker Topic" in each}
    feet = {name for foot in FEET for name in (f"/marker_basic_{foot}_foot", f"/label/{foot}")}
    assert topics == feet | {"/support", "/legs"}
    assert {"rviz/RobotModel", "rviz/Grid"} < {each["Class"] for each in displays}


def test_the_tree_holds_each_panel_once() -> None:
    layout = foxglove_layout(View(FEET, "world", "base_link", "+y"))

    def leaves(node: Any) -> list[str]:
        if isinstance(node, str):
            return [node]
        assert node["direction"] in {"row", "column"}
        return [*leaves(node["first"]), *leaves(node["second"])]

    assert sorted(leaves(layout["layout"])) == sorted(layout["configById"])
    assert json.loads(json.dumps(layout, allow_nan=False)) == layout


def test_without_a_log_the_feet_are_the_robot_s() -> None:
    for options in (MeasureOptions(), MeasureOptions(robot="dogbot")):
        dogbot = view_of(None, options)
        assert (dogbot.feet, dogbot.base_frame, dogbot.forward_axis) == (FEET, "base_link", "+y")
    named = view_of(None, MeasureOptions(robot="generic", foot={"paw": "/x"}))
    assert (named.feet, named.forward_axis, named.peak_n) == (("paw",), "+x", None)
    with pytest.raises(CallError):
        view_of(None, MeasureOptions(robot="unicorn"))


@pytest.mark.parametrize(("log", "heading_rad"), [(WALK, -0.9), (TROUBLED, 0.4)])
def test_the_sample_logs_have_the_dogbot_s_layout(log: Path, heading_rad: float) -> None:
    """It is 0.46 m high, and its feet stand 0.4 to 0.6 m apart from front to back."""
    view = view_of(log, MeasureOptions())
    assert (view.feet, view.world_frame, view.base_frame) == (FEET, "world", "base_link")
    assert view.forward_axis == "+y"
    assert 0.4 <= view.size_m <= 0.6
    assert radians(view.turned_deg) == pytest.approx(heading_rad, abs=0.01)
    # Zero stamps are of one time: those read ahead would move the legs to where they will be.
    scene = panel(foxglove_layout(view), "3D")["scene"]
    assert scene["transforms"]["enablePreloading"] == (log != TROUBLED)
    # RViz's camera stands in the world, Foxglove's on the base.
    yaw = rviz_config(view)["Visualization Manager"]["Views"]["Current"]["Yaw"]
    assert cos(yaw - radians(view.camera_deg) - heading_rad) == pytest.approx(1.0, abs=1e-3)


def test_a_guessed_robot_looks_to_where_its_fore_feet_are(tmp_path: Path) -> None:
    """The guessed robot's +y is forward, but here its topics are those of another one."""
    log = write_standing_log(tmp_path / "log.mcap")
    assert view_of(log, MeasureOptions()).forward_axis == "+x"
    assert view_of(log, MeasureOptions(robot="dogbot")).forward_axis == "+y"
