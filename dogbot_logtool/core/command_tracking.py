"""How the base follows its commands, in logs that have any: loaded for those only."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.base.poses import BaseHistory, PoseJumps
from dogbot_logtool.core.gait.segments import Segment

if TYPE_CHECKING:
    from dogbot_logtool.core.commands.tracking import CommandTrack, Tracking
    from dogbot_logtool.core.recorded.vectors import VectorHistory


def command_track(
    commands: "VectorHistory | None",
    base: BaseHistory,
    jumps: PoseJumps,
    forward_axis: str,
    segments: Sequence[Segment],
    period_s: float | None,
) -> "CommandTrack | None":
    """Compare commands with the base's velocity over time.

    Args:
        commands: None: the log has none.
        base: poses without jumps.
        jumps: where these were.
        forward_axis: the body's axis that points forward.
        segments: of the gait; in those with strides the robot steps.
        period_s: s, the usual stride; None: there are none.
    """
    if commands is None:
        return None
    from dogbot_logtool.core.commands.tracking import follow_commands  # noqa: PLC0415

    steps = [each.spans for each in segments if each.strides]
    stepping = timespans.merge(np.concatenate([timespans.no_spans(), *steps]))
    return follow_commands(commands, base, jumps.spans, forward_axis, stepping, period_s)


def tracking_in(track: "CommandTrack | None", within: Ints | None) -> "Tracking | None":
    """Measure how the base follows commands in some spans, (w, 2) ns, or in the whole log."""
    if track is None:
        return None
    from dogbot_logtool.core.commands.tracking import tracking  # noqa: PLC0415

    return tracking(track, within)
