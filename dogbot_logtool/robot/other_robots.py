"""Which of a log's poses are another robot's than that of the feet, by the names of topics."""

import re
from collections.abc import Collection, Sequence
from typing import Final

from dogbot_logtool.finding import Finding
from dogbot_logtool.io.printable import listed

_SHARED: Final = frozenset(
    {"ground", "truth", "gazebo", "gz", "sim", "simulation", "mocap", "vicon", "optitrack", "vrpn"}
    | {"node", "odom", "odometry", "state", "states", "estimator", "estimation", "estimate"}
    | {
        "localization",
        "localisation",
        "slam",
        "lio",
        "camera",
        "imu",
        "visual",
        "sensor",
        "sensors",
    }
    | {"feet", "foot", "contact", "contacts", "robot", "hardware", "base", "body", "pose", "status"}
    | {"tf", "leg", "legs", "map", "world", "fast", "lidar", "wheel", "raw", "filtered", "ekf"}
    | {"ukf", "kf", "highstate", "lowstate", "sport", "control", "controller", "front", "left"}
    | {"right", "back", "hind", "fore", "rear", "fl", "fr", "rl", "rr", "lf", "rf", "lh", "rh"}
    | {"hl", "hr", "bl", "br"}
)
"""Words at the beginning of topics that are no robot's name."""


def is_of_another_robot(name: str, feet: Collection[str]) -> bool:
    """Tell whether a topic's namespace is the name of another robot than that of the feet."""
    own = {_namespace(each) for each in feet}
    other = _namespace(name)
    return len(own) == 1 and bool(other) and own.isdisjoint((other, ""))


def _namespace(topic: str) -> str:
    """Return the first part of a topic if it may be a robot's name; else nothing."""
    first, *rest = topic.strip("/").lower().split("/")
    words = frozenset(re.findall(r"[a-z]+", first))
    return first if rest and (words - _SHARED or re.search(r"\d", first)) else ""


def of_another_robot(others: Sequence[str], own: Sequence[str], feet: Collection[str]) -> Finding:
    """Say which poses are another robot's."""
    robot = _namespace(next(iter(feet)))
    text = f"{listed(others)}: poses of another robot than that of the feet ({robot}), not used"
    text += f"; {listed(own)} would be its own" if own else "; the log has none of its own"
    return Finding("POSE_OTHER_ROBOT", text, others[0], cases=() if own else ("alone",))
