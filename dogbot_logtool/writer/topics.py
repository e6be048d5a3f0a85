"""Topics that we write."""

from typing import Final

TF: Final = "/tf"
ROBOT_DESCRIPTION: Final = "/robot_description"
SUPPORT: Final = "/support"
LEGS: Final = "/legs"
EVENTS: Final = "/events"
SPANS: Final = "/events/spans"
GAIT: Final = "/gait"
FALLBACK_PREFIX: Final = "/dogbot_logtool"
"""Before a topic that the log has with another type."""


def arrow(foot: str) -> str:
    """Return the topic of a foot's arrows."""
    return f"/marker_basic_{foot}_foot"


def load(foot: str) -> str:
    """Return the topic of a foot's load."""
    return f"/load/{foot}"


def label(foot: str) -> str:
    """Return the topic of the label beside a foot."""
    return f"/label/{foot}"
