"""Options of `robots`."""

from dataclasses import dataclass
from typing import Annotated

from dogbot_logtool.option import As
from dogbot_logtool.options import CommonOptions, JoinOptions, OutputOptions, RobotOptions


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Robots(OutputOptions, JoinOptions, RobotOptions, CommonOptions):
    """List the known robots, or print one's file to copy and edit.

    `robots new LOG` writes a robot's file from a log, with the evidence as comments. Feet are
    looked for in messages of any type.

    Examples:
      dogbot-logtool robots dogbot > mine.toml
      dogbot-logtool robots new walk.bag -o mine.toml
    """

    words: Annotated[tuple[str, ...], As("[NAME | new LOG...]", is_argument=True)] = ()
    output: Annotated[str | None, As("FILE.toml", "-o")] = None
    """Of new; default: stdout."""
