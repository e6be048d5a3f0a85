"""The layout names what `convert` writes, in the shape that Foxglove and Lichtblick import."""

import json
import re
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.commands.layout import foxglove_layout, layout_for
from dogbot_logtool.errors import CallError
from dogbot_logtool.pipeline.options import ConvertOptions, TopicOptions
from dogbot_logtool.report.foot_pens import FOOT_COLOURS
from tests.paths import SAMPLE_LOGS

TROUBLED = SAMPLE_LOGS / "dogbot_troubled.bag"
FEET = ("front_left", "front_right", "back_left", "back_right")


def panel(layout: dict[str, Any], kind: str) -> dict[str, Any]:
    (found,) = [config for name, config in layout["configById"].items() if name.startswith(kind)]
    assert isinstance(found, dict)
    return found


def test_every_topic_and_field_is_in_a_converted_log(tmp_path: Path) -> None:
    convert(TROUBLED, tmp_path / "out.mcap", ConvertOptions(copy=False))
    fields: dict[str, set[str]] = {}
    frames: set[tuple[str, str]] = set()
    with (tmp_path / "out.mcap").open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for _, channel, _, message in reader.iter_decoded_messages():
            if channel.topic not in fields:
                fields[channel.topic] = {field.name for field in message.DESCRIPTOR.fields}
            if channel.topic == "/tf":
                (transform,) = message.transforms
                frames.add((transform.parent_frame_id, transform.child_frame_id))
    layout = layout_for(TROUBLED, TopicOptions())
    drawn = {topic for topic in fields if "marker" in topic or topic == "/support"}
    scene = panel(layout, "3D")
    assert set(scene["topics"]) == drawn
    assert frames == {(scene["layers"]["grid"]["frameId"], scene["followTf"])}
    for kind in ("Plot", "StateTransitions"):
        paths = [path["value"] for path in panel(layout, kind)["paths"]]
        assert len(paths) == len(FEET)
        for path in paths:
            topic, _, field = path.rpartition(".")
            assert field in fields[topic]


def test_the_robot_is_followed_and_its_arrows_are_visible() -> None:
    scene = panel(foxglove_layout(FEET, "map", "trunk"), "3D")
    assert (scene["followTf"], scene["followMode"]) == ("trunk", "follow-position")
    drawn = ["/support", *(f"/marker_basic_{foot}_foot" for foot in FEET)]
    assert scene["topics"] == {topic: {"visible": True} for topic in drawn}
    assert scene["scene"]["transforms"]["enablePreloading"] is True
    assert scene["scene"]["transforms"]["showLabel"] is False


def test_the_ground_stays_in_the_world() -> None:
    scene = panel(foxglove_layout(FEET, "map", "trunk"), "3D")
    (grid,) = scene["layers"].values()
    assert (grid["layerId"], grid["frameId"]) == ("foxglove.Grid", "map")


def test_loads_and_gait() -> None:
    layout = foxglove_layout(FEET, "world", "base_link")
    plot, gait = panel(layout, "Plot"), panel(layout, "StateTransitions")
    assert [path["value"] for path in plot["paths"]] == [f"/load/{foot}.force" for foot in FEET]
    assert [path["value"] for path in gait["paths"]] == [f"/load/{f}.in_contact" for f in FEET]
    for path in (*plot["paths"], *gait["paths"]):
        assert path["timestampMethod"] == "receiveTime"
        assert path["enabled"] is True
    assert [path["label"] for path in gait["paths"]] == list(FEET)
    assert len({path["color"] for path in plot["paths"]}) == len(FEET)


def test_loads_and_gait_share_one_time_axis() -> None:
    layout = foxglove_layout(FEET, "world", "base_link")
    plot, gait = panel(layout, "Plot"), panel(layout, "StateTransitions")
    assert plot["isSynced"] is gait["isSynced"] is True
    own_axes = {"minXValue", "maxXValue", "followingViewWidth", "xAxisRange"}
    assert not own_axes & (plot.keys() | gait.keys())


def test_every_panel_has_a_title_where_viewers_look_for_it() -> None:
    layout = foxglove_layout(FEET, "world", "base_link")
    titles = {config["foxglovePanelTitle"] for config in layout["configById"].values()}
    assert titles == {"Robot", "Load [N]", "Gait diagram"}


def test_the_shape_is_what_viewers_import() -> None:
    layout = foxglove_layout(FEET, "world", "base_link")
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
    paths = panel(foxglove_layout(feet, "world", "base"), "Plot")["paths"]
    assert len(paths) == len(feet)
    assert paths[0]["color"] == paths[len(FOOT_COLOURS)]["color"]


def test_without_a_log_the_feet_are_the_robot_s() -> None:
    dogbot = foxglove_layout(FEET, "world", "base_link")
    assert layout_for(None, TopicOptions()) == dogbot
    assert layout_for(None, TopicOptions(robot="dogbot")) == dogbot
    named = layout_for(None, TopicOptions(robot="generic", foot_topics={"paw": "/x"}))
    assert named == foxglove_layout(["paw"], "world", "base_link")
    with pytest.raises(CallError):
        layout_for(None, TopicOptions(robot="unicorn"))


@pytest.mark.parametrize("log", ["dogbot_trot.bag", "dogbot_walk.mcap", "dogbot_troubled.bag"])
def test_the_sample_logs_have_the_dogbot_s_layout(log: str) -> None:
    found = layout_for(SAMPLE_LOGS / log, TopicOptions())
    assert found == foxglove_layout(FEET, "world", "base_link")
