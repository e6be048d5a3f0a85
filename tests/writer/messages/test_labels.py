"""Labels as messages."""

import numpy as np
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate

from dogbot_logtool.core.scene.labels import Labels
from dogbot_logtool.writer.annotations import (
    AnnotationColumns,
)
from tests.writer.annotated import ENCODINGS, declared, messages_of, no_transforms


def test_labels_are_written_and_removed() -> None:
    feet = ("front_left", "front_right")
    annotations = declared(ENCODINGS[0], feet, with_tf=False)
    times = np.array([1, 2, 3], np.int64)
    labels = Labels(
        foot=np.array([0, 1, 1]),
        log_time=times,
        stamp=times,
        shown=np.array([True, True, False]),
        position=np.arange(9.0).reshape(3, 3),
        force=np.array([94.4, 1e300, 0.0]),
    )
    columns = AnnotationColumns(no_transforms(), [], [], labels=[labels])
    found = [
        (topic, SceneUpdate.FromString(message.data))
        for topic, message in messages_of(annotations, columns)
    ]
    assert [topic for topic, _ in found] == ["/label/front_left", *["/label/front_right"] * 2]
    (text,) = found[0][1].entities[0].texts
    assert text.text.split() == ["FL", "94", "N"]
    assert (text.pose.position.x, text.pose.position.z) == (0.0, 2.0)
    assert found[1][1].entities[0].texts[0].text == "FR >10 kN"
    assert [deletion.id for deletion in found[2][1].deletions] == ["front_right"]
