"""The layout names what `convert` writes, in the shape that Foxglove and Lichtblick import."""

import json
import re
from math import cos, radians, sin
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from mcap_ros2.decoder import DecoderFactory as Ros2Decoders

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.commands.layout import view_of
from dogbot_logtool.core.scene.foot_style import FOOT_COLOURS
from dogbot_logtool.errors import CallError
from dogbot_logtool.options import ConvertOptions, MeasureOptions
from dogbot_logtool.report.layouts import View, foxglove_layout, rviz_config, upper_bound
from tests.oracles.standing_log import write_standing_log
from tests.paths import SAMPLE_LOGS

TROUBLED = SAMPLE_LOGS / "dogbot_troubled.bag"
FEET = ("front_left", "front_right", "back_left", "back_right")


def foxglove_layout_of(log: Path | None, options: MeasureOptions) -> dict[str, Any]:
    return foxglove_layout(view_of(log, options))


def plots(layout: dict[str, Any]) -> list[dict[str, Any]]:
    """The one curve of each plot."""
    of_feet = [one for name, one in layout["configById"].items() if name.startswith("Plot")]
    return [path for plot in of_feet for path in plot["paths"]]


def panel(layout: dict[str, Any], kind: str) -> dict[str, Any]:
    (found,) = [config for name, config in layout["configById"].items() if name.startswith(kind)]
    assert isinstance(found, dict)
    return found


def test_every_topic_and_field_is_in_a_converted_log(tmp_path: Path) -> None:
    convert(TROUBLED, tmp_path / "out.mcap", ConvertOptions(copy=False))
    fields: dict[str, set[str]] = {}
    frames: set[tuple[str, str]] = set()
    with (tmp_path / "out.mcap").open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory(), Ros2Decoders()])
        for _, channel, _, message in reader.iter_decoded_messages():
            if channel.topic not in fields:
                described = getattr(message, "DESCRIPTOR", None)
                fields[channel.topic] = {field.name for field in getattr(described, "fields", ())}
            if channel.topic == "/tf":
                (transform,) = message.transforms
                frames.add((transform.parent_frame_id, transform.child_frame_id))
    layout = foxglove_layout_of(TROUBLED, MeasureOptions())
    drawn = {
        topic for topic in fields if not topic.startswith(("/tf", "/load/", "/events", "/gait"))
    }
    scene = panel(layout, "3D")
    # Lines for legs are written only where no transforms move them.
    assert set(scene["topics"]) == drawn | {"/legs"}
    assert frames == {(scene["layers"]["grid"]["frameId"], scene["followTf"])}
    for shown in (plots(layout), panel(layout, "StateTransitions")["paths"]):
        paths = [path["value"] for path in shown]
        assert len(paths) == len(FEET)
        for path in paths:
            topic, _, field = path.rpartition(".")
            assert field in fields[topic]


def test_the_robot_is_followed_and_its_arrows_are_visible() -> None:
    scene = panel(foxglove_layout(View(FEET, "map", "trunk")), "3D")
    assert (scene["followTf"], scene["followMode"]) == ("trunk", "follow-position")
    drawn = ["/support", "/legs", "/robot_description"]
    drawn += [name for foot in FEET for name in (f"/marker_basic_{foot}_foot", f"/label/{foot}")]
    assert scene["topics"] == {topic: {"visible": True} for topic in drawn}
    assert scene["scene"]["transforms"]["enablePreloading"] is True
    assert scene["scene"]["transforms"]["showLabel"] is False
    assert scene["scene"]["transforms"]["axisScale"] == 0
    assert scene["transforms"] == {f"frame:{name}": {"visible": False} for name in ("map", "trunk")}


@pytest.mark.parametrize(("axis", "side"), [("+x", (1, 0)), ("+y", (0, 1)), ("-x", (-1, 0))])
def test_the_camera_stands_before_the_robot(axis: str, side: tuple[int, int]) -> None:
    offset = panel(foxglove_layout(View(FEET, "world", "base", axis)), "3D")["cameraState"]
    angle = radians(-90.0 - offset["thetaOffset"])
    assert 0.2 < cos(angle) * side[0] + sin(angle) * side[1] < 0.5
    yaw = rviz_config(View(FEET, "world", "base", axis))["Visualization Manager"]["Views"]
    angle = yaw["Current"]["Yaw"]
    assert 0.2 < cos(angle) * side[0] + sin(angle) * side[1] < 0.5


def test_the_ground_stays_in_the_world() -> None:
    scene = panel(foxglove_layout(View(FEET, "map", "trunk")), "3D")
    (grid,) = scene["layers"].values()
    assert (grid["layerId"], grid["frameId"]) == ("foxglove.Grid", "map")


def test_loads_and_gait() -> None:
    layout = foxglove_layout(View(FEET, "world", "base_link"))
    curves, gait = plots(layout), panel(layout, "StateTransitions")
    assert [path["value"] for path in curves] == [f"/load/{foot}.force" for foot in FEET]
    assert [path["value"] for path in gait["paths"]] == [f"/load/{f}.state" for f in FEET]
    for path in (*curves, *gait["paths"]):
        assert path["timestampMethod"] == "receiveTime"
        assert path["enabled"] is True
    assert [path["label"] for path in gait["paths"]] == list(FEET)
    assert [path["color"] for path in curves] == list(FOOT_COLOURS[: len(FEET)])
    assert panel(layout, "RosOut")["topicToRender"] == "/events"


def test_loads_and_gait_share_one_time_axis() -> None:
    layout = foxglove_layout(View(FEET, "world", "base_link"))
    panels = [one for name, one in layout["configById"].items() if name[:4] in {"Plot", "Stat"}]
    assert len(panels) == len(FEET) + 1
    own_axes = {"minXValue", "maxXValue", "followingViewWidth", "xAxisRange"}
    for each in panels:
        assert each["isSynced"] is True
        assert not own_axes & each.keys()


def test_every_panel_has_a_title_where_viewers_look_for_it() -> None:
    layout = foxglove_layout(View(FEET, "world", "base_link"))
    titles = {"Robot", *(f"{foot}  [N]" for foot in FEET), "Gait diagram", "Events"}
    for key in ("foxglovePanelTitle", "lichtblickPanelTitle"):
        assert {config[key] for config in layout["configById"].values()} == titles


def column(node: Any, height: float) -> dict[str, float]:
    """The heights of panels that stand one below the other."""
    if isinstance(node, str):
        return {node: height}
    assert node["direction"] == "column"
    first = height * node["splitPercentage"] / 100.0
    return {node["first"]: first, **column(node["second"], height - first)}


@pytest.mark.parametrize(("feet", "most"), [(2, 2), (4, 4), (6, 3), (8, 4)])
def test_all_rows_are_high_enough_to_read(feet: int, most: int) -> None:
    """On a screen of 1280 x 720, of which the viewer's own bars take 107."""
    names = tuple(f"foot_{number}" for number in range(feet))
    layout = foxglove_layout(View(names, "w", "b"))["layout"]
    heights = column(layout["second"], 613.0)
    assert sum(heights.values()) == pytest.approx(613.0)
    *curves, gait = heights.values()
    assert len(curves) == most
    assert min(curves) > 68.0
    # Rows of 64 pixels, a title and a time axis; more rows are scrolled.
    assert gait >= min(61.0 + 64.0 * feet, 330.0)
    assert column(layout["first"], 613.0)["RosOut!events"] > 100.0


def test_a_robot_without_feet_has_no_curves() -> None:
    layout = foxglove_layout(View((), "w", "b"))
    assert sorted(layout["configById"]) == ["3D!robot", "RosOut!events", "StateTransitions!gait"]
    assert layout["layout"]["second"] == "StateTransitions!gait"


def test_curves_have_one_scale_and_no_labels_that_would_shift_their_time_axes() -> None:
    """Loads of the trot reach 122 N, as the simulator knows; the walk's weight is 208 N."""
    for log, bound in ((SAMPLE_LOGS / "dogbot_trot.bag", 150.0), (None, 250.0)):
        configs = foxglove_layout_of(log, MeasureOptions())["configById"].values()
        curves = [config for config in configs if "minYValue" in config]
        assert [(c["minYValue"], c["maxYValue"]) for c in curves] == [(0, bound)] * len(FEET)
        assert not any(c["showYAxisLabels"] or c["showXAxisLabels"] for c in curves)
        assert all(f"0 to {bound:g} N" in c["foxglovePanelTitle"] for c in curves)


@pytest.mark.parametrize(
    ("value", "bound"), [(1.0, 1.0), (1.01, 1.5), (208.6, 250.0), (850.0, 1000.0), (0.03, 0.03)]
)
def test_bounds_are_round_and_hardly_more(value: float, bound: float) -> None:
    assert upper_bound(value) == pytest.approx(bound)


def test_rviz_shows_what_is_written() -> None:
    displays = rviz_config(View(FEET, "map", "trunk"))["Visualization Manager"]["Displays"]
    topics = {each["Marker Topic"] for each in displays if "Marker Topic" in each}
    feet = {name for foot in FEET for name in (f"/marker_basic_{foot}_foot", f"/label/{foot}")}
    assert topics == feet | {"/support", "/legs"}
    assert {"rviz/RobotModel", "rviz/Grid"} < {each["Class"] for each in displays}


def test_rviz_opens_a_window_of_a_screen_s_size() -> None:
    view = rviz_config(View(FEET, "map", "trunk"))
    assert (view["Window Geometry"]["Width"], view["Window Geometry"]["Height"]) == (1280, 720)
    assert "rviz/Displays" in {each["Class"] for each in view["Panels"]}


def test_the_shape_is_what_viewers_import() -> None:
    layout = foxglove_layout(View(FEET, "world", "base_link", "+y"))
    assert set(layout) == {"configById", "globalVariables", "userNodes", "playbackConfig", "layout"}

    def leaves(node: Any) -> list[str]:
        if isinstance(node, str):
            return [node]
        assert node["direction"] in {"row", "column"}
        assert 0 < node["splitPercentage"] < 100
        return [*leaves(node["first"]), *leaves(node["second"])]

    assert sorted(leaves(layout["layout"])) == sorted(layout["configById"])
    assert all(re.fullmatch(r"\w+!\w+", name) for name in layout["configById"])
    assert json.loads(json.dumps(layout, allow_nan=False)) == layout


def test_more_feet_than_colours() -> None:
    feet = [f"foot_{number}" for number in range(len(FOOT_COLOURS) + 2)]
    paths = plots(foxglove_layout(View(tuple(feet), "world", "base")))
    assert len(paths) == len(feet)
    assert paths[0]["color"] == paths[len(FOOT_COLOURS)]["color"]


def test_without_a_log_the_feet_are_the_robot_s() -> None:
    for options in (MeasureOptions(), MeasureOptions(robot="dogbot")):
        dogbot = view_of(None, options)
        assert (dogbot.feet, dogbot.base_frame, dogbot.forward_axis) == (FEET, "base_link", "+y")
    named = view_of(None, MeasureOptions(robot="generic", foot={"paw": "/x"}))
    assert (named.feet, named.forward_axis, named.peak_n) == (("paw",), "+x", None)
    with pytest.raises(CallError):
        foxglove_layout_of(None, MeasureOptions(robot="unicorn"))


@pytest.mark.parametrize(
    ("log", "heading_rad"),
    [("dogbot_trot.bag", 0.4), ("dogbot_walk.mcap", -0.9), ("dogbot_troubled.bag", 0.4)],
)
def test_the_sample_logs_have_the_dogbot_s_layout(log: str, heading_rad: float) -> None:
    """It is 0.46 m high, and its feet stand 0.4 to 0.6 m apart from front to back."""
    view = view_of(SAMPLE_LOGS / log, MeasureOptions())
    assert (view.feet, view.world_frame, view.base_frame) == (FEET, "world", "base_link")
    assert view.forward_axis == "+y"
    assert 0.4 <= view.size_m <= 0.6
    assert radians(view.turned_deg) == pytest.approx(heading_rad, abs=0.01)
    # Zero stamps are of one time: those read ahead would move the legs to where they will be.
    scene = panel(foxglove_layout(view), "3D")["scene"]
    assert scene["transforms"]["enablePreloading"] == ("troubled" not in log)
    # RViz's camera stands in the world, Foxglove's on the base.
    yaw = rviz_config(view)["Visualization Manager"]["Views"]["Current"]["Yaw"]
    assert cos(yaw - radians(view.camera_deg) - heading_rad) == pytest.approx(1.0, abs=1e-3)


def test_a_guessed_robot_looks_to_where_its_fore_feet_are(tmp_path: Path) -> None:
    """The guessed robot's +y is forward, but here its topics are those of another one."""
    log = write_standing_log(tmp_path / "log.mcap")
    assert view_of(log, MeasureOptions()).forward_axis == "+x"
    assert view_of(log, MeasureOptions(robot="dogbot")).forward_axis == "+y"
