"""Topics that we write."""

from typing import Final

TF_TOPIC: Final = "/tf"
ROBOT_DESCRIPTION_TOPIC: Final = "/robot_description"
SUPPORT_TOPIC: Final = "/support"
LEGS_TOPIC: Final = "/legs"
EVENTS_TOPIC: Final = "/events"
SPANS_TOPIC: Final = "/events/spans"
GAIT_TOPIC: Final = "/gait"
FALLBACK_PREFIX: Final = "/dogbot_logtool"
"""Before a topic that the log has with another type."""


def arrow_topic(foot: str) -> str:
    """Return the topic of a foot's arrows."""
    return f"/marker_basic_{foot}_foot"


def load_topic(foot: str) -> str:
    """Return the topic of a foot's load."""
    return f"/load/{foot}"


def label_topic(foot: str) -> str:
    """Return the topic of the label beside a foot."""
    return f"/label/{foot}"
