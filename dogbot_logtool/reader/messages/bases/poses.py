"""Messages that are one pose: odometry, stamped poses of ROS and of Foxglove, bare poses."""

from collections.abc import Iterator
from typing import Final

from dogbot_logtool.reader.messages.bases.source import BaseSource, pose_source

ODOMETRY_TYPE: Final = "nav_msgs/Odometry"


def _foxglove() -> Iterator[BaseSource]:
    """Yield Foxglove's types, as its own schemas and as ROS messages name them."""
    for package in ("foxglove.", "foxglove_msgs/"):
        yield pose_source(
            f"{package}Odometry",
            "pose",
            twist=("linear_velocity", "angular_velocity"),
            stamp="timestamp",
            world="frame_id",
            base="body_frame_id",
        )
        yield pose_source(
            f"{package}PoseInFrame", "pose", stamp="timestamp", world="frame_id", anything=True
        )


ODOMETRY: Final = pose_source(
    ODOMETRY_TYPE,
    "pose.pose",
    twist=("twist.twist.linear", "twist.twist.angular"),
    base="child_frame_id",
)
SOURCES: Final = (
    ODOMETRY,
    *_foxglove(),
    pose_source("geometry_msgs/PoseWithCovarianceStamped", "pose.pose", anything=True),
    pose_source("geometry_msgs/PoseStamped", "pose", anything=True),
    pose_source(
        "geometry_msgs/TransformStamped",
        "transform",
        position="translation",
        orientation="rotation",
        base="child_frame_id",
        anything=True,
    ),
    # A bare pose is mostly a command.
    pose_source("geometry_msgs/Pose", stamp="", world="", on_request=True),
    # States of whole robots, of which the base is a part.
    pose_source(
        "anymal_msgs/AnymalState",
        "pose.pose",
        world="pose.header.frame_id",
        any_package=True,
    ),
    pose_source(
        "quad_msgs/RobotState",
        "body.pose",
        any_package=True,
    ),
    # Log time is their only time: `time_from_start` counts from the start of a plan.
    *(
        pose_source(
            "xpp_msgs/RobotStateCartesian",
            f"{base}.pose",
            stamp="",
            world="",
            any_package=True,
            is_planned=True,
        )
        # Today's definition, and the one before it.
        for base in ("base", "common.base")
    ),
)
