"""Options of `layout`."""

from dataclasses import dataclass
from typing import Annotated

from dogbot_logtool.option import As
from dogbot_logtool.options import OutputOptions, QuietOptions, RobotOptions


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Layout(OutputOptions, RobotOptions, QuietOptions):
    """Print a viewer's layout: the robot, its loads, its gait diagram.

    The feet are those of the robot (default: dogbot), or those found in LOG.

    Example: dogbot-logtool layout walk.bag -o walk.json
    """

    log: Annotated[str | None, As("[LOG]", is_argument=True)] = None
    viewer: Annotated[str, As(choices=("foxglove", "rviz"))] = "foxglove"
    """foxglove: Foxglove and Lichtblick; rviz: for logs converted with --encoding ros1."""
    output: Annotated[str | None, As("FILE", "-o")] = None
    """The file to write; default: stdout."""
