"""Support messages that are stamped out are what the libraries read, shape by shape."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mcap import records
from mcap_protobuf.decoder import DecoderFactory as ProtobufDecoders
from mcap_ros1.decoder import DecoderFactory as Ros1Decoders
from mcap_ros2.decoder import DecoderFactory as Ros2Decoders

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.scene.foot_style import colour_parts, foot_colour
from dogbot_logtool.core.scene.support_scene import SupportScene
from dogbot_logtool.writer.encodings.encoding import Encoding, SupportLook
from dogbot_logtool.writer.encodings.foxglove import FoxgloveEncoding
from dogbot_logtool.writer.encodings.ros1 import Ros1Encoding
from dogbot_logtool.writer.encodings.ros2 import Ros2Encoding
from dogbot_logtool.writer.message_records import MESSAGE_HEAD
from dogbot_logtool.writer.messages.support import SupportWriter

STYLE = SupportLook(line_m=0.02, mark_m=0.04, lifetime_s=0.5)
FEET, TRAIL = 3, 4
S = 1_000_000_000
FOXGLOVE = FoxgloveEncoding()
COLOUR = (0.5, 0.25, 0.125, 1.0)


def scene_of(counts: list[tuple[int, bool, bool, int]]) -> SupportScene:
    """Return a scene with numbers of points; no two numbers in it are the same."""
    count = len(counts)
    numbers = iter(np.arange(1.0, 1000.0 * count + 1000.0).tolist())

    def points(number: int, most: int) -> Floats:
        told = [[next(numbers) for _ in "xyz"] for _ in range(number)]
        return np.array(told + [[np.nan] * 3] * (most - number)).reshape(most, 3)

    log_time = np.arange(count) * 7 + 20 * S
    return SupportScene(
        log_time=log_time,
        stamp=log_time + 3,
        outline=np.array([points(line, FEET + 1) for line, *_ in counts]),
        margin=np.zeros(count),
        colour=np.tile(np.array(COLOUR, np.float32), (count, 1)),
        pressure=np.array([points(int(has), 1)[0] for _, has, *_ in counts]),
        projection=np.array([points(int(has), 1)[0] for *_, has, _ in counts]),
        touchdowns=np.array([points(marks, TRAIL) for *_, marks in counts]),
        touchdown_feet=np.arange(count * TRAIL).reshape(count, TRAIL) % FEET,
        unknown=0,
        unweighed=0,
    )


def stamped(encoding: Encoding, scene: SupportScene) -> list[bytes]:
    """Return the payloads in the order of time."""
    found: dict[int, bytes] = {}
    writer = SupportWriter(9, encoding, "world", STYLE)
    for stamped_out in writer.records(scene, encoding.load("stance").stamps("stamp", scene.stamp)):
        assert set(stamped_out["channel"].tolist()) == {9}
        for time, record in zip(stamped_out["log_time"].tolist(), stamped_out, strict=True):
            found[time] = record.tobytes()[MESSAGE_HEAD.itemsize :]
    assert sorted(found) == scene.log_time.tolist()
    return [found[time] for time in sorted(found)]


def decoded(encoding: Encoding, payloads: list[bytes]) -> list[Any]:
    kind = encoding.support_type
    schema = records.Schema(id=1, data=kind.schema, encoding=kind.schema_encoding, name=kind.name)
    factories = {"protobuf": ProtobufDecoders, "ros1": Ros1Decoders, "cdr": Ros2Decoders}
    decode = factories[kind.message_encoding]().decoder_for(kind.message_encoding, schema)
    assert decode is not None
    return [decode(payload) for payload in payloads]


def known(points: Floats) -> list[list[float]]:
    told: list[list[float]] = points.reshape(-1, 3).tolist()
    return [point for point in told if not np.isnan(point[0])]


def at(places: Any) -> list[list[float]]:
    return [[place.x, place.y, place.z] for place in places]


shapes = st.lists(
    st.tuples(
        st.sampled_from([0, 2, FEET, FEET + 1]), st.booleans(), st.booleans(), st.integers(0, TRAIL)
    ),
    min_size=1,
    max_size=12,
)


@given(shapes)
def test_foxglove(counts: list[tuple[int, bool, bool, int]]) -> None:
    scene, encoding = scene_of(counts), FOXGLOVE
    for row, message in enumerate(decoded(encoding, stamped(encoding, scene))):
        (entity,) = message.entities
        assert (entity.id, entity.frame_id, len(message.deletions)) == ("support", "world", 0)
        assert entity.timestamp.ToNanoseconds() == scene.stamp[row]
        assert entity.lifetime.ToNanoseconds() == S // 2
        outline = known(scene.outline[row])
        assert len(entity.lines) == bool(outline)
        for line in entity.lines:
            assert at(line.points) == outline
            assert (line.type, line.thickness, line.pose.orientation.w) == (0, 0.02, 1.0)
            assert (line.color.r, line.color.g, line.color.b, line.color.a) == COLOUR
            assert not line.scale_invariant
        balls = (scene.pressure[row], scene.projection[row], scene.touchdowns[row])
        assert at(ball.pose.position for ball in entity.spheres) == [
            place for points in balls for place in known(points)
        ]
        assert all(ball.pose.orientation.w == 1.0 for ball in entity.spheres)
        assert all(min(b.size.x, b.size.y, b.size.z, b.color.a) > 0.0 for b in entity.spheres)
        if known(scene.pressure[row]):
            assert entity.spheres[0].size.z == entity.spheres[0].size.x


@pytest.mark.parametrize("encoding", [Ros1Encoding(), Ros2Encoding()], ids=["ros1", "ros2"])
@pytest.mark.parametrize("line", [0, 2, FEET + 1])
def test_markers(encoding: Encoding, line: int) -> None:
    """All combinations of what there is, as markers that are added or deleted."""
    scene = scene_of(
        [(line, a, b, n) for a in (False, True) for b in (False, True) for n in (0, 3)]
    )
    columns = scene.outline, scene.pressure, scene.projection, scene.touchdowns
    for row, message in enumerate(decoded(encoding, stamped(encoding, scene))):
        assert [(marker.ns, marker.id) for marker in message.markers] == [
            ("support", number) for number in range(4)
        ]
        for marker, column, kind in zip(message.markers, columns, (4, 7, 7, 7), strict=True):
            stamp = marker.header.stamp
            seconds = stamp.sec if hasattr(stamp, "nanosec") else stamp.secs
            nanoseconds = stamp.nanosec if hasattr(stamp, "nanosec") else stamp.nsecs
            assert seconds * S + nanoseconds == scene.stamp[row]
            assert marker.header.frame_id == "world"
            points = known(column[row])
            assert marker.action == (0 if points else 2)
            assert at(marker.points) == points
            assert marker.pose.orientation.w == 1.0
            if points:
                assert (marker.type, marker.color.a) == (kind, 1.0)
                assert marker.scale.x > 0.0
                # Only touchdowns have a colour each, their feet's.
                feet = scene.touchdown_feet[row].tolist()[: len(points) if marker.id == 3 else 0]
                wanted = [(*colour_parts(foot_colour(foot)), 1.0) for foot in feet]
                told = [(one.r, one.g, one.b, one.a) for one in marker.colors]
                assert told == [pytest.approx(each, abs=1e-6) for each in wanted]
        if line:
            colour = message.markers[0].color
            assert (colour.r, colour.g, colour.b, colour.a) == COLOUR
