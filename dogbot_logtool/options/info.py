"""Options of `info`."""

from dataclasses import dataclass

from dogbot_logtool.options import (
    ClusterOptions,
    CommonOptions,
    Flag,
    JobOptions,
    JoinOptions,
    LogOptions,
    RobotOptions,
)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class InfoOptions(JobOptions, JoinOptions, RobotOptions):
    """Options of `info`."""

    frames: Flag = False
    """Read every transform: rate, gaps and senders of each frame, and what breaks the tree."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Info(LogOptions, ClusterOptions, InfoOptions, CommonOptions):
    """Show what is in a log, what is used of it, and what is wrong.

    Example: dogbot-logtool info walk.bag
    """
