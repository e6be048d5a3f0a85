"""Times in which all feet's sensors are silent although the log goes on: a bridge that hung."""

from collections.abc import Sequence

from dogbot_logtool.core.base.base_history import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.geometry import timespans
from dogbot_logtool.core.geometry.arrays import Ints


def all_silent(feet: Sequence[FootHistory], base: BaseHistory) -> Ints:
    """Return the spans in which all feet have a gap and the base has none.

    Args:
        feet: records of all feet; those without usable messages do not count.
        base: poses.

    Returns:
        (s, 2) ns; none with fewer than two feet.
    """
    speaking = [
        timespans.subtract(foot.gaps, foot.stopped) for foot in feet if foot.start is not None
    ]
    if len(speaking) < 2:
        return timespans.no_spans()
    return timespans.intersect([*speaking, base.known])
