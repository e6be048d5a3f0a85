"""Options of `export`."""

from dataclasses import dataclass
from typing import Annotated, Literal

from dogbot_logtool.option import As
from dogbot_logtool.options import ClusterOptions, Flag, LogOptions, MeasureOptions, OutputOptions


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Export(LogOptions, ClusterOptions, OutputOptions, MeasureOptions):
    """Write a table of strides, stances, events, poses or samples.

    The tables are those of a walk in Python, behind a column with the log's name. Several logs
    make one table. A dataset has tables of the metrics of many logs, to which later calls add.

    Examples:
      dogbot-logtool export walk.bag > strides.csv
      dogbot-logtool export walk.bag --table samples -o samples.parquet
      dogbot-logtool export recordings/ --dataset walks
    """

    table: Annotated[
        Literal["strides", "stances", "joints", "events", "base", "commands", "samples"] | None,
        As(),
    ] = None
    """What a row is; samples are all messages of all feet; default: strides."""
    output: Annotated[str | None, As("FILE", "-o")] = None
    """File that ends in .csv, .parquet, .arrow or .feather; default: CSV on stdout."""
    dataset: Annotated[str | None, As("DIR|URL")] = None
    """Keep the metrics of many logs there, for SQL; logs that are there unchanged are skipped."""
    label: Annotated[tuple[str, ...], As("NAME=VALUE")] = ()
    """With --dataset: a label for the logs of this call, such as firmware=3.2; repeatable."""
    prune: Flag = False
    """With --dataset: remove logs from there that are gone from where they were."""
