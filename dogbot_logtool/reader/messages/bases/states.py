"""States of whole robots, of which the base is a part."""

from typing import Final

from dogbot_logtool.reader.messages.bases.source import pose_source

_XPP: Final = "xpp_msgs/RobotStateCartesian"
SOURCES: Final = (
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
            _XPP,
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
