"""Options of `report`."""

from dataclasses import dataclass
from typing import Annotated

from dogbot_logtool.option import As
from dogbot_logtool.options import CommonOptions, Flag, LogOptions, MeasureOptions, OutputOptions


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Report(LogOptions, OutputOptions, MeasureOptions, CommonOptions):
    """Write a page: the walk in 3D, gait, loads, and what to doubt.

    One HTML file a log, which opens from disk and loads nothing; several logs also give an
    index.html. With --against, one page says whether two runs, or two groups of runs, can be
    compared, and which metrics differ. Needs the extra `report`.

    Examples:
      dogbot-logtool report walk.bag
      dogbot-logtool report walk.bag --against yesterday.bag
    """

    against: Annotated[tuple[str, ...], As("LOG")] = ()
    """Other logs (directory, glob, @LIST): one page shows both sides and what differs."""
    replay: Flag = True
    """Show the walk in 3D, which takes up to a megabyte."""
