"""Options of `check`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from dogbot_logtool.option import As
from dogbot_logtool.options import (
    ClusterOptions,
    CommonOptions,
    Flag,
    LogOptions,
    MeasureOptions,
    Target,
)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class JunitOptions:
    """A report for CI."""

    junit: Target = None
    """Write JUnit XML as well, to a new file."""
    overwrite: Flag = False
    """Replace the file of --junit if it exists."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class BaselineOptions(MeasureOptions):
    """Options of `check` beside its limits."""

    baseline: Annotated[Path | None, As("FILE.json")] = None
    """`stats --json` of the run that rules with `baseline` compare with."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Check(LogOptions, ClusterOptions, JunitOptions, BaselineOptions, CommonOptions):
    """Judge logs by rules: each is GOOD, WARN, FAIL or UNKNOWN.

    A rule names a metric of `stats --json`, a finding or an event, by a pattern, and what is
    demanded of it.

    Exit code 0: all rules are kept; 1: one is broken, or a metric is unknown where its rule does
    not allow that; 2: the call or the limits are wrong; 3: kept, but a log is damaged.

    Examples:
      dogbot-logtool check good/*.bag --suggest > limits.toml
      dogbot-logtool check walk.bag --limits limits.toml
    """

    limits: Annotated[Path | None, As("FILE.toml")] = None
    """Rules on metrics, findings and events."""
    suggest: Flag = False
    """Print limits that these runs pass, as a file to edit."""
