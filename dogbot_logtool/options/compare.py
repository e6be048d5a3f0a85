"""Options of `compare`."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from dogbot_logtool.option import As, Range
from dogbot_logtool.options import CommonOptions, Flag, JobOptions, RobotOptions
from dogbot_logtool.options.check import JunitOptions


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class CompareOptions:
    """Options of `compare` without --gait."""

    atol: Annotated[float | None, As("NUMBER", range=Range(0.0, 1e300))] = None
    """Absolute tolerance, in each field's own unit; default: 0."""
    rtol: Annotated[float | None, As("NUMBER", range=Range(0.0, 1.0))] = None
    """Relative tolerance; default: 0."""
    tolerances: Annotated[Path | None, As("FILE.toml")] = None
    """Tolerances by quantity: metres, radians, newtons ..."""
    ignore: Annotated[Sequence[str], As("TOPIC|FIELD")] = ()
    """Glob of what may differ: topics, fields, TOPIC:FIELD, metadata:NAME, attachment:NAME."""
    topics: Annotated[Sequence[str], As("TOPIC")] = ()
    """Glob of the topics to compare; of JSON, of paths (gait, feet.*.duty_factor.median)."""
    max_differences: Annotated[int, As("N", range=Range(0, 1e9, is_whole=True))] = 20
    """Differences that are printed one by one."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Compare(JunitOptions, JobOptions, RobotOptions, CompareOptions, CommonOptions):
    """Compare two logs, or two `stats --json` files, with tolerances.

    A field is named by its path without positions: pose.position.x, feet.front_left.slip_m. A
    glob's * stands for dots and slashes, too. Integers are
    exact unless a tolerance names them. That nothing is left to compare is a wrong call.

    With --gait, either side is a log, a directory, a glob or @LIST; its strides are compared metric
    by metric, with intervals. Exit code 0: the same; 1: different, not comparable, or a file
    cannot be read; 2: the call is wrong; 3: the same as far as can be read, but a file is damaged.

    Examples:
      dogbot-logtool compare expected.mcap actual.mcap --atol 1e-6
      dogbot-logtool compare --gait yesterday.bag today.bag
    """

    expected: Annotated[str, As("EXPECTED", is_argument=True, is_required=True)] = ""
    actual: Annotated[str, As("ACTUAL", is_argument=True, is_required=True)] = ""
    gait: Flag = False
    """Compare how the robot walks in two logs, or groups of logs: which metrics differ?"""
