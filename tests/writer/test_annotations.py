"""Which channels annotations have, and what goes where."""

import numpy as np
import pytest
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate

from dogbot_logtool.core.base.poses import Transforms
from dogbot_logtool.writer.annotations import (
    AnnotationColumns,
)
from dogbot_logtool.writer.encodings.encoding import Encoding
from dogbot_logtool.writer.topics import arrow_topic, load_topic
from tests.writer.annotated import (
    ENCODINGS,
    FEET,
    arrows,
    declared,
    loads,
    messages_of,
    no_transforms,
)


@pytest.mark.parametrize("encoding", ENCODINGS, ids=lambda one: type(one).__name__)
def test_channels(encoding: Encoding) -> None:
    annotations = declared(encoding)
    topics = {channel.topic for channel in annotations.added.channels}
    wanted = {"/tf", *(f"/marker_basic_{foot}_foot" for foot in FEET)}
    wanted |= {f"/{kind}/{foot}" for kind in ("load", "label") for foot in FEET}
    wanted |= {"/events", "/gait"} | ({"/events/spans"} if encoding.span_type else set())
    assert topics == wanted
    assert len(annotations.added.schemas) == (6 if encoding.span_type else 5)
    names = {schema.id: schema.name for schema in annotations.added.schemas}
    types = {channel.topic: names[channel.schema_id] for channel in annotations.added.channels}
    assert types["/tf"] == encoding.transform_type.name
    assert types[arrow_topic("left")] == types[arrow_topic("right")] == encoding.arrow_type.name
    assert types[load_topic("left")] == encoding.load_type.name
    assert annotations.added.topics() == {c.id: c.topic for c in annotations.added.channels}
    assert len(annotations.added.topics()) == len(wanted)


def test_without_tf_and_feet_there_are_events_only() -> None:
    annotations = declared(ENCODINGS[0], (), with_tf=False)
    topics = {channel.topic for channel in annotations.added.channels}
    assert {"/events", "/gait"} <= topics <= {"/events", "/events/spans", "/gait"}
    assert list(annotations.messages(AnnotationColumns(no_transforms(), [], []))) == []


def test_messages_go_to_their_foot_in_the_order_of_time() -> None:
    annotations = declared(ENCODINGS[0])
    times = np.array([15], np.int64)
    transforms = Transforms(times, times, np.zeros((1, 3)), np.array([[0.0, 0.0, 0.0, 1.0]]))
    columns = AnnotationColumns(
        transforms,
        [arrows([0, 1, 0], [10, 20, 30], [True, True, False]), arrows([1], [12], [True])],
        [loads([0, 1, 0], [10, 20, 30])],
    )
    found = messages_of(annotations, columns)
    assert [(message.log_time, topic) for topic, message in found] == [
        (10, arrow_topic("left")),
        (10, load_topic("left")),
        (12, arrow_topic("right")),
        (15, "/tf"),
        (20, arrow_topic("right")),
        (20, load_topic("right")),
        (30, arrow_topic("left")),
        (30, load_topic("left")),
    ]
    assert all(message.publish_time == message.log_time for _, message in found)
    scenes = [SceneUpdate.FromString(m.data) for topic, m in found if "marker" in topic]
    assert [len(scene.entities) for scene in scenes] == [1, 1, 1, 0]
    assert scenes[3].deletions[0].id == "left"
    assert [scene.entities[0].id for scene in scenes[:3]] == ["left", "right", "right"]
    assert scenes[2].entities[0].timestamp.nanos == 25
    arrow = scenes[2].entities[0].arrows[0]
    assert (arrow.pose.position.x, arrow.pose.position.z) == (3.0, 5.0)
    np.testing.assert_allclose(arrow.shaft_length + arrow.head_length, 2.0)
    assert (arrow.color.r, arrow.color.g, arrow.color.b, arrow.color.a) == (1.0, 0.5, 0.25, 1.0)
