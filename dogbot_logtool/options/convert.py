"""Options of `convert`."""

from dataclasses import dataclass
from typing import Annotated, Literal

from dogbot_logtool.option import As, Range
from dogbot_logtool.options import (
    ClusterOptions,
    CommonOptions,
    Flag,
    Globs,
    LogOptions,
    MeasureOptions,
    OutputOptions,
)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class ConvertOptions(MeasureOptions):
    """Options of `convert`."""

    style: Annotated[str, As(choices=("pressure", "force", "classic"))] = "pressure"
    """Arrows: the load straight up, the force itself, or as arrows_rviz.py drew them."""
    encoding: Annotated[str, As(choices=("foxglove", "ros1", "ros2"))] = "foxglove"
    """Messages that are added: protobuf for Foxglove and Lichtblick, ROS 1 (RViz), or CDR."""
    copy: Flag = True
    """Copy the recorded messages too."""
    topics: Globs = ()
    """Copy only these recorded topics, or all but '!/camera/*'; repeatable. Annotations stay."""
    tf: Annotated[Literal["auto", "always", "never"], As()] = "auto"
    """Write /tf; auto: unless the log places the base otherwise."""
    tf_rate: Annotated[float, As("HZ", range=Range(1e-3, 1e6, or_zero=True))] = 50.0
    """Transforms a second; 0: every pose."""
    compression: Annotated[Literal["zstd", "lz4", "none"] | None, As()] = None
    """Of the output; default: zstd, and chunks copied from an MCAP as they are."""
    overwrite: Flag = False
    """Replace the output if it exists."""

    @property
    def copied_topics(self) -> tuple[str, ...]:
        """Globs of the topics that are copied; none: all."""
        return tuple(glob for glob in self.topics if not glob.startswith("!"))

    @property
    def topics_left_out(self) -> tuple[str, ...]:
        """Globs of the topics that are not copied."""
        return tuple(glob[1:] for glob in self.topics if glob.startswith("!"))


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Convert(LogOptions, ClusterOptions, OutputOptions, ConvertOptions, CommonOptions):
    """Write an annotated MCAP: the log, arrows, loads and events.

    The topics that are added: /tf, an arrow, a label and /load for each foot, /support, /legs,
    /events, /gait and /robot_description.

    Examples:
      dogbot-logtool convert walk.bag -o walk.mcap
      dogbot-logtool convert logs/*.bag -o annotated/
      dogbot-logtool convert walk.bag --topics '!/camera/*'
    """
