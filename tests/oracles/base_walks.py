"""One walk of the base in every type of message that can hold it."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.Odometry_pb2 import Odometry
from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame

from tests.oracles import walks
from tests.oracles.mcap_channels import SentChannel, write_channels

WALK: Final = walks.Walk(2)
SAMPLES: Final = 300
YAW_RATE: Final = 0.4
"""rad/s."""
SPEED: Final = 0.5
"""m/s, along the body's own x axis, so that the base walks along an arc."""
ROLL, PITCH, HEIGHT = 0.05, -0.1, 0.45
ON_REQUEST: Final = ("geometry_msgs/Pose", "nav_msgs/Path")
PLANNED: Final = ("ocs2_msgs/mpc_observation", "xpp_msgs/RobotStateCartesian")
WITHOUT_HEADER: Final = (
    "geometry_msgs/Pose",
    "gazebo_msgs/ModelStates",
    "gazebo_msgs/LinkStates",
    "unitree_go/SportModeState",
    *PLANNED,
)
ELEMENTS: Final = {
    "gazebo_msgs/ModelStates": "anymal",
    "gazebo_msgs/LinkStates": "anymal::base_link",
    "tf2_msgs/TFMessage": "odom/base_link",
    "foxglove.FrameTransforms": "odom/base_link",
}


def pose(sample: int) -> tuple[tuple[float, ...], tuple[float, ...], tuple[float, ...]]:
    """Return position, quaternion x, y, z, w, and roll, pitch, yaw, all in closed form."""
    time = sample * walks.STEP / 1e9
    yaw, radius = YAW_RATE * time, SPEED / YAW_RATE
    position = (radius * np.sin(yaw), radius * (1.0 - np.cos(yaw)), HEIGHT)
    (sr, sp, sy), (cr, cp, cy) = (f(np.array([ROLL, PITCH, yaw]) / 2) for f in (np.sin, np.cos))
    quaternion = (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )
    return position, quaternion, (ROLL, PITCH, yaw)


Fields = dict[str, Any]


def _pose(sample: int) -> Fields:
    position, quaternion, _ = pose(sample)
    return {"position": position, "orientation": quaternion}


def _transform(
    walk: walks.Walk, sample: int, parent: str = "odom", child: str = "base_link"
) -> Fields:
    translation, rotation, _ = pose(sample)
    return {
        "header": walk.header(sample, parent),
        "child_frame_id": child,
        "transform": {"translation": translation, "rotation": rotation},
    }


def _models(_walk: walks.Walk, sample: int) -> Fields:
    return _listed(ELEMENTS["gazebo_msgs/ModelStates"], ["ground_plane"], sample)


def _links(_walk: walks.Walk, sample: int) -> Fields:
    others = ["ground_plane::link", "box::lid"]
    return _listed(ELEMENTS["gazebo_msgs/LinkStates"], others, sample)


def _listed(name: str, names: list[str], sample: int) -> Fields:
    """Return a list in which the robot stands elsewhere in each message."""
    poses: list[Fields] = [{"position": (7.0, 7.0, 7.0)} for _ in names]
    index = sample % (len(names) + 1)
    names.insert(index, name)
    poses.insert(index, _pose(sample))
    return {"name": names, "pose": poses, "twist": [None] * len(names)}


def models(walk: walks.Walk, places: Mapping[str, float]) -> bytes:
    """Return a message of models, each at its x in metres."""
    poses = [{"position": (x, 0.0, HEIGHT)} for x in places.values()]
    kind = "gazebo_msgs/msg/ModelStates"
    listed = walk.make(kind, name=[*places], pose=poses, twist=[None] * len(places))
    return walk.bytes_of(kind, listed)


def message(kind: str, sample: int) -> bytes:
    """Return the serialised message of a sample."""
    if kind.startswith("foxglove."):
        made: Any = _FOXGLOVE[kind][1](**_foxglove(kind, sample))
        return bytes(made.SerializeToString())
    full = kind.replace("/", "/msg/")
    fields = _KINDS[kind][1] if kind in _KINDS else _array
    return WALK.bytes_of(full, WALK.make(full, **fields(WALK, sample)))


def definition(kind: str) -> str:
    full = kind.replace("/", "/msg/")
    return WALK.definition(full)


def _odometry(walk: walks.Walk, sample: int) -> Fields:
    return {**_with_covariance(walk, sample), "child_frame_id": "base_link"}


def _stamped(walk: walks.Walk, sample: int) -> Fields:
    return {"header": walk.header(sample, "odom"), "pose": _pose(sample)}


def _with_covariance(walk: walks.Walk, sample: int) -> Fields:
    return {"header": walk.header(sample, "odom"), "pose": [_pose(sample)]}


def _path(walk: walks.Walk, sample: int) -> Fields:
    poses = [_stamped(walk, each) for each in range(max(sample - 2, 0), sample + 1)]
    return {"header": walk.header(sample, "odom"), "poses": poses}


def _array(_walk: walks.Walk, sample: int) -> Fields:
    position, quaternion, _ = pose(sample)
    return {"data": [9.0, 9.0, *position, *quaternion]}


def _sport(_walk: walks.Walk, sample: int) -> Fields:
    position, (x, y, z, w), angles = pose(sample)
    return {"error_code": 100, "imu_state": [(w, x, y, z), angles], "position": position}


def _ocs2(_walk: walks.Walk, sample: int) -> Fields:
    position, _, angles = pose(sample)
    return {"state": [[*[9.0] * 6, *position, *angles[::-1], *[5.0] * 12]], "mode": 15}


def _xpp(_walk: walks.Walk, sample: int) -> Fields:
    base = {"pose": _pose(sample)}
    return {"time_from_start": (0, sample), "base": base, "ee_contact": np.ones(4)}


def _anymal(walk: walks.Walk, sample: int) -> Fields:
    twist = {"header": walk.header(sample, "base")}
    return {
        "header": walk.header(sample, "odom"),
        "pose": _stamped(walk, sample),
        "twist": twist,
    }


def _quad(walk: walks.Walk, sample: int) -> Fields:
    return {"header": walk.header(sample, "map"), "body": {"pose": _pose(sample)}}


def _dwl(walk: walks.Walk, sample: int) -> Fields:
    """The joints of the base, by numbers: roll, pitch, yaw, x, y, z."""
    position, _, angles = pose(sample)
    joints = [{"id": n, "position": float(at)} for n, at in enumerate((*angles, *position))]
    return {"header": walk.header(sample, "world"), "base": joints[::-1]}


def _tf(walk: walks.Walk, sample: int) -> Fields:
    rows = (0, "map", "odom"), (sample, "odom", "base_link"), (2 * sample, "base_link", "leg")
    return {"transforms": [_transform(walk, *row) for row in rows]}


_KINDS: Final[Mapping[str, tuple[str, Callable[[walks.Walk, int], Fields]]]] = {
    "nav_msgs/Odometry": ("/odom", _odometry),
    "geometry_msgs/PoseStamped": ("/mocap/robot/pose", _stamped),
    "geometry_msgs/PoseWithCovarianceStamped": ("/state_estimator/pose", _with_covariance),
    "geometry_msgs/Pose": ("/body_pose", lambda _, sample: _pose(sample)),
    "geometry_msgs/TransformStamped": ("/vicon/robot", _transform),
    "nav_msgs/Path": ("/walked", _path),
    "gazebo_msgs/ModelStates": ("/gazebo/model_states", _models),
    "gazebo_msgs/LinkStates": ("/gazebo/link_states", _links),
    "unitree_go/SportModeState": ("/sportmodestate", _sport),
    "ocs2_msgs/mpc_observation": ("/robot_mpc_observation", _ocs2),
    "xpp_msgs/RobotStateCartesian": ("/xpp/state_des", _xpp),
    "anymal_msgs/AnymalState": ("/state_estimator/anymal_state", _anymal),
    "quad_msgs/RobotState": ("/robot/state/ground_truth", _quad),
    "dwl_msgs/WholeBodyState": ("/hyq/robot_states", _dwl),
    "tf2_msgs/TFMessage": ("/tf", _tf),
}
"""Topics, and the fields of messages."""
_FOXGLOVE: Final[Mapping[str, tuple[str, Any]]] = {
    "foxglove.Odometry": ("/base/odometry", Odometry),
    "foxglove.PoseInFrame": ("/base/pose", PoseInFrame),
    "foxglove.FrameTransforms": ("/frames", FrameTransforms),
}
TOPICS: Final = {kind: topic for kind, (topic, _) in [*_KINDS.items(), *_FOXGLOVE.items()]}


def _foxglove(kind: str, sample: int) -> Fields:
    """Return the fields of a message of one of Foxglove's types."""
    position, quaternion, _ = pose(sample)
    time = divmod(walks.START + sample * walks.STEP, 1_000_000_000)
    stamp = {"timestamp": dict(zip(("seconds", "nanos"), time, strict=True))}
    at = dict(zip("xyz", map(float, position), strict=True))
    turned = dict(zip("xyzw", map(float, quaternion), strict=True))
    if kind.endswith("FrameTransforms"):
        frames = {"parent_frame_id": "odom", "child_frame_id": "base_link"}
        return {"transforms": [{**stamp, **frames, "translation": at, "rotation": turned}]}
    fields = {**stamp, "frame_id": "odom", "pose": {"position": at, "orientation": turned}}
    if kind.endswith("Odometry"):
        zero = {"x": 0.0, "y": 0.0, "z": 0.0}
        fields |= {"body_frame_id": "base_link", "linear_velocity": zero, "angular_velocity": zero}
    return fields


def write(path: Path, kind: str, *topics: str) -> Path:
    """Write the walk of the base in one type of message."""
    encodings, described = ("protobuf", "protobuf"), b"{}"
    if kind not in _FOXGLOVE:
        encodings, described = ("cdr", "ros2msg"), definition(kind).encode()
    times = (walks.START + sample * walks.STEP for sample in range(SAMPLES))
    sent = [(time, message(kind, sample)) for sample, time in enumerate(times)]
    channels = (SentChannel(topic, kind, *encodings, described, sent) for topic in topics)
    return write_channels(path, channels)
