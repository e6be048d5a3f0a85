"""One walk of the base in every type of message that can hold it."""

import json
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.Odometry_pb2 import Odometry
from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame
from mcap.writer import Writer as McapWriter
from rosbags.typesys import get_types_from_msg

from tests.oracles import walks

SAMPLES: Final = 300
YAW_RATE: Final = 0.4
"""rad/s."""
SPEED: Final = 0.5
"""m/s, along the body's own x axis, so that the base walks along an arc."""
ROLL, PITCH, HEIGHT = 0.05, -0.1, 0.45
DEFINITIONS: Final = {
    "xpp_msgs/msg/State6d": "geometry_msgs/Pose pose\ngeometry_msgs/Twist twist\n"
    "geometry_msgs/Accel accel",
    "xpp_msgs/msg/RobotStateCartesian": "builtin_interfaces/Duration time_from_start\n"
    "xpp_msgs/State6d base\nbool[] ee_contact",
    "anymal_msgs/msg/AnymalState": "std_msgs/Header header\nint8 state\n"
    "geometry_msgs/PoseStamped pose\ngeometry_msgs/TwistStamped twist",
    "quad_msgs/msg/BodyState": "geometry_msgs/Pose pose\ngeometry_msgs/Twist twist",
    "quad_msgs/msg/RobotState": "std_msgs/Header header\nuint32 traj_index\n"
    "quad_msgs/BodyState body",
    "gazebo_msgs/msg/ModelStates": "string[] name\ngeometry_msgs/Pose[] pose\n"
    "geometry_msgs/Twist[] twist",
    "gazebo_msgs/msg/LinkStates": "string[] name\ngeometry_msgs/Pose[] pose\n"
    "geometry_msgs/Twist[] twist",
    "unitree_go/msg/IMUState": "float32[4] quaternion\nfloat32[3] rpy",
    "unitree_go/msg/SportModeState": "uint32 error_code\nunitree_go/IMUState imu_state\n"
    "float32[3] position\nfloat32[3] velocity",
    "ocs2_msgs/msg/mpc_state": "float32[] value",
    "ocs2_msgs/msg/mpc_observation": "float64 time\nocs2_msgs/mpc_state state\nint8 mode",
    "dwl_msgs/msg/BaseState": "string name\nuint8 id\nfloat64 position",
    "dwl_msgs/msg/WholeBodyState": "std_msgs/Header header\ndwl_msgs/BaseState[] base",
    "tf2_msgs/msg/TFMessage": "geometry_msgs/TransformStamped[] transforms",
}
TOPICS: Final = {
    "nav_msgs/Odometry": "/odom",
    "geometry_msgs/PoseStamped": "/mocap/robot/pose",
    "geometry_msgs/PoseWithCovarianceStamped": "/state_estimator/pose",
    "geometry_msgs/Pose": "/body_pose",
    "geometry_msgs/TransformStamped": "/vicon/robot",
    "nav_msgs/Path": "/walked",
    "gazebo_msgs/ModelStates": "/gazebo/model_states",
    "gazebo_msgs/LinkStates": "/gazebo/link_states",
    "unitree_go/SportModeState": "/sportmodestate",
    "ocs2_msgs/mpc_observation": "/robot_mpc_observation",
    "xpp_msgs/RobotStateCartesian": "/xpp/state_des",
    "anymal_msgs/AnymalState": "/state_estimator/anymal_state",
    "quad_msgs/RobotState": "/robot/state/ground_truth",
    "dwl_msgs/WholeBodyState": "/hyq/robot_states",
    "tf2_msgs/TFMessage": "/tf",
    "foxglove.Odometry": "/base/odometry",
    "foxglove.PoseInFrame": "/base/pose",
    "foxglove.FrameTransforms": "/frames",
}
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


@cache
def ros() -> walks.Walk:
    walk = walks.Walk(2)
    for name, text in DEFINITIONS.items():
        if name not in walk.store.fielddefs:
            walk.store.register(get_types_from_msg(text, name))
    return walk


@cache
def ros_of(kind: str) -> walks.Walk:
    """Return a store in which a type has the definition of this module."""
    walk = ros()
    if kind == "unitree_go/msg/SportModeState":
        walk = walks.Walk(2)
        walk.store.fielddefs.pop(kind)
        for name in ("unitree_go/msg/IMUState", kind):
            walk.store.register(get_types_from_msg(DEFINITIONS[name], name))
    return walk


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


def _pose(walk: walks.Walk, sample: int) -> Any:
    position, quaternion, _ = pose(sample)
    return walk.make(
        "geometry_msgs/Pose",
        position=walk.vector(position, "geometry_msgs/Point"),
        orientation=walk.make(
            "geometry_msgs/Quaternion",
            **dict(zip("xyzw", map(float, quaternion), strict=True)),
        ),
    )


def _still(walk: walks.Walk) -> Any:
    return walk.make(
        "geometry_msgs/Pose",
        position=walk.vector((7.0, 7.0, 7.0), "geometry_msgs/Point"),
        orientation=walk.make("geometry_msgs/Quaternion", x=0.0, y=0.0, z=0.0, w=1.0),
    )


def _twist(walk: walks.Walk) -> Any:
    zero = walk.vector((0.0, 0.0, 0.0))
    return walk.make("geometry_msgs/Twist", linear=zero, angular=zero)


def _stamped(walk: walks.Walk, sample: int) -> Any:
    return walk.make(
        "geometry_msgs/PoseStamped", header=walk.header(sample, "odom"), pose=_pose(walk, sample)
    )


def _transform(walk: walks.Walk, sample: int, parent: str, child: str) -> Any:
    at = _pose(walk, sample)
    return walk.make(
        "geometry_msgs/TransformStamped",
        header=walk.header(sample, parent),
        child_frame_id=child,
        transform=walk.make(
            "geometry_msgs/Transform",
            translation=walk.vector([at.position.x, at.position.y, at.position.z]),
            rotation=at.orientation,
        ),
    )


def _listed(walk: walks.Walk, kind: str, sample: int) -> Any:
    """Return a list in which the robot stands elsewhere in each message."""
    name = ELEMENTS[kind]
    others = ["ground_plane::link" if "::" in name else "ground_plane", "box::lid"]
    if "::" not in name:
        others = others[:1]
    index = sample % (len(others) + 1)
    names, poses = list(others), [_still(walk) for _ in others]
    names.insert(index, name)
    poses.insert(index, _pose(walk, sample))
    return walk.make(kind, name=names, pose=poses, twist=[_twist(walk) for _ in names])


def models(walk: walks.Walk, places: Mapping[str, float]) -> bytes:
    """Return a message of models, each at its x in metres."""
    poses = [
        walk.make(
            "geometry_msgs/Pose",
            position=walk.vector((x, 0.0, HEIGHT), "geometry_msgs/Point"),
            orientation=walk.make("geometry_msgs/Quaternion", x=0.0, y=0.0, z=0.0, w=1.0),
        )
        for x in places.values()
    ]
    kind = "gazebo_msgs/msg/ModelStates"
    twists = [_twist(walk) for _ in places]
    return walk.bytes_of(kind, walk.make(kind, name=[*places], pose=poses, twist=twists))


def message(kind: str, sample: int) -> bytes:
    """Return the serialised message of a sample."""
    if kind.startswith("foxglove."):
        return foxglove(kind, sample).SerializeToString()  # type: ignore[no-any-return]
    package, _, name = kind.partition("/")
    full = f"{package}/msg/{name}"
    walk = ros_of(full)
    return walk.bytes_of(full, _MAKERS[kind](walk, sample))


def definition(kind: str) -> str:
    package, _, name = kind.partition("/")
    full = f"{package}/msg/{name}"
    return ros_of(full).definition(full)


def _odometry(walk: walks.Walk, sample: int) -> Any:
    none = np.zeros(36)
    return walk.make(
        "nav_msgs/Odometry",
        header=walk.header(sample, "odom"),
        child_frame_id="base_link",
        pose=walk.make(
            "geometry_msgs/PoseWithCovariance", pose=_pose(walk, sample), covariance=none
        ),
        twist=walk.make("geometry_msgs/TwistWithCovariance", twist=_twist(walk), covariance=none),
    )


def _xpp(walk: walks.Walk, sample: int) -> Any:
    zero = walk.vector((0.0, 0.0, 0.0))
    return walk.make(
        "xpp_msgs/RobotStateCartesian",
        time_from_start=walk.make("builtin_interfaces/Duration", sec=0, nanosec=sample),
        base=walk.make(
            "xpp_msgs/State6d",
            pose=_pose(walk, sample),
            twist=_twist(walk),
            accel=walk.make("geometry_msgs/Accel", linear=zero, angular=zero),
        ),
        ee_contact=np.ones(4, np.bool_),
    )


def _sport(walk: walks.Walk, sample: int) -> Any:
    position, (x, y, z, w), angles = pose(sample)
    return walk.make(
        "unitree_go/SportModeState",
        error_code=100,
        imu_state=walk.make(
            "unitree_go/IMUState",
            quaternion=np.array([w, x, y, z], np.float32),
            rpy=np.array(angles, np.float32),
        ),
        position=np.array(position, np.float32),
        velocity=np.zeros(3, np.float32),
    )


def _ocs2(walk: walks.Walk, sample: int) -> Any:
    position, _, angles = pose(sample)
    value = np.array([*[9.0] * 6, *position, *angles[::-1], *[5.0] * 12], np.float32)
    return walk.make(
        "ocs2_msgs/mpc_observation",
        time=0.0,
        state=walk.make("ocs2_msgs/mpc_state", value=value),
        mode=15,
    )


def _dwl(walk: walks.Walk, sample: int) -> Any:
    """The joints of the base, by numbers: roll, pitch, yaw, x, y, z."""
    position, _, angles = pose(sample)
    joints = [
        walk.make("dwl_msgs/BaseState", name="", id=number, position=float(value))
        for number, value in enumerate((*angles, *position))
    ]
    return walk.make(
        "dwl_msgs/WholeBodyState", header=walk.header(sample, "world"), base=joints[::-1]
    )


def _array(walk: walks.Walk, sample: int) -> Any:
    position, quaternion, _ = pose(sample)
    return walk.make(
        "std_msgs/Float64MultiArray",
        layout=walk.make("std_msgs/MultiArrayLayout", dim=[], data_offset=0),
        data=np.array([9.0, 9.0, *position, *quaternion]),
    )


_MAKERS: Final[Mapping[str, Callable[[walks.Walk, int], Any]]] = {
    "nav_msgs/Odometry": _odometry,
    "geometry_msgs/PoseStamped": _stamped,
    "geometry_msgs/Pose": _pose,
    "geometry_msgs/PoseWithCovarianceStamped": lambda walk, sample: walk.make(
        "geometry_msgs/PoseWithCovarianceStamped",
        header=walk.header(sample, "odom"),
        pose=walk.make(
            "geometry_msgs/PoseWithCovariance", pose=_pose(walk, sample), covariance=np.zeros(36)
        ),
    ),
    "geometry_msgs/TransformStamped": lambda walk, sample: _transform(
        walk, sample, "odom", "base_link"
    ),
    "nav_msgs/Path": lambda walk, sample: walk.make(
        "nav_msgs/Path",
        header=walk.header(sample, "odom"),
        poses=[_stamped(walk, each) for each in range(max(sample - 2, 0), sample + 1)],
    ),
    "gazebo_msgs/ModelStates": lambda walk, sample: _listed(
        walk, "gazebo_msgs/ModelStates", sample
    ),
    "gazebo_msgs/LinkStates": lambda walk, sample: _listed(walk, "gazebo_msgs/LinkStates", sample),
    "std_msgs/Float64MultiArray": _array,
    "unitree_go/SportModeState": _sport,
    "ocs2_msgs/mpc_observation": _ocs2,
    "xpp_msgs/RobotStateCartesian": _xpp,
    "anymal_msgs/AnymalState": lambda walk, sample: walk.make(
        "anymal_msgs/AnymalState",
        header=walk.header(sample, "odom"),
        state=0,
        pose=_stamped(walk, sample),
        twist=walk.make(
            "geometry_msgs/TwistStamped", header=walk.header(sample, "base"), twist=_twist(walk)
        ),
    ),
    "quad_msgs/RobotState": lambda walk, sample: walk.make(
        "quad_msgs/RobotState",
        header=walk.header(sample, "map"),
        traj_index=0,
        body=walk.make("quad_msgs/BodyState", pose=_pose(walk, sample), twist=_twist(walk)),
    ),
    "dwl_msgs/WholeBodyState": _dwl,
    "tf2_msgs/TFMessage": lambda walk, sample: walk.make(
        "tf2_msgs/TFMessage",
        transforms=[
            _transform(walk, 0, "map", "odom"),
            _transform(walk, sample, "odom", "base_link"),
            _transform(walk, 2 * sample, "base_link", "leg"),
        ],
    ),
}


def foxglove(kind: str, sample: int) -> Any:
    """Return a protobuf message of one of Foxglove's types."""
    position, quaternion, _ = pose(sample)
    seconds, nanoseconds = divmod(walks.START + sample * walks.STEP, 1_000_000_000)
    if kind.endswith("FrameTransforms"):
        made: Any = FrameTransforms()
        one = made.transforms.add(parent_frame_id="odom", child_frame_id="base_link")
        at, turned = one.translation, one.rotation
        stamp = one.timestamp
    else:
        made = Odometry(body_frame_id="base_link") if kind.endswith("Odometry") else PoseInFrame()
        made.frame_id = "odom"
        at, turned, stamp = made.pose.position, made.pose.orientation, made.timestamp
    at.x, at.y, at.z = position
    turned.x, turned.y, turned.z, turned.w = quaternion
    stamp.seconds, stamp.nanos = seconds, nanoseconds
    return made


def as_json(kind: str, sample: int) -> bytes:
    """Return the same message as Foxglove writes it in JSON."""
    position, quaternion, _ = pose(sample)
    seconds, nanoseconds = divmod(walks.START + sample * walks.STEP, 1_000_000_000)
    stamp = {"sec": seconds, "nsec": nanoseconds}
    at = dict(zip("xyz", map(float, position), strict=True))
    turned = dict(zip("xyzw", map(float, quaternion), strict=True))
    if kind.endswith("FrameTransforms"):
        one = {"timestamp": stamp, "parent_frame_id": "odom", "child_frame_id": "base_link"}
        return json.dumps({"transforms": [one | {"translation": at, "rotation": turned}]}).encode()
    zero = {"x": 0.0, "y": 0.0, "z": 0.0}
    whole = {
        "timestamp": stamp,
        "frame_id": "odom",
        "body_frame_id": "base_link",
        "pose": {"position": at, "orientation": turned},
        "linear_velocity": zero,
        "angular_velocity": zero,
    }
    return json.dumps(whole).encode()


def write(path: Path, kind: str, *topics: str, encoding: str = "") -> Path:
    """Write the walk of the base in one type of message."""
    with path.open("wb") as stream:
        writer = McapWriter(stream, chunk_size=1 << 14)
        writer.start(profile="ros2")
        if kind.startswith("foxglove."):
            encoding = encoding or "protobuf"
            schema_encoding = "protobuf" if encoding == "protobuf" else "jsonschema"
            schema = writer.register_schema(kind, schema_encoding, b"{}")
        else:
            encoding = "cdr"
            schema = writer.register_schema(kind, "ros2msg", definition(kind).encode())
        channels = [writer.register_channel(topic, encoding, schema) for topic in topics]
        for sample in range(SAMPLES):
            data = as_json(kind, sample) if encoding == "json" else message(kind, sample)
            time = walks.START + sample * walks.STEP
            for channel in channels:
                writer.add_message(channel, time, data, time)
        writer.finish()
    return path
