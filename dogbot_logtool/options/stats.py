"""Options of `stats`."""

from dataclasses import dataclass

from dogbot_logtool.options import (
    ClusterOptions,
    CommonOptions,
    Flag,
    LogOptions,
    MeasureOptions,
    Target,
)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Stats(LogOptions, ClusterOptions, MeasureOptions, CommonOptions):
    """Measure a walk: gait, loads, and whether to trust the log.

    Examples:
      dogbot-logtool stats walk.bag
      dogbot-logtool stats logs/*.bag              a row each
      dogbot-logtool stats walk.bag --figure walk.pdf
      dogbot-logtool stats walk.bag --set contact_on_n=20
    """

    figure: Target = None
    """Draw gait diagram and load curves as .pdf, .svg or .png, for a paper."""
    overwrite: Flag = False
    """Replace the figure if it exists."""
