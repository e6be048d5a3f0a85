"""The whole strides of a log, a row each: what CSV and Parquet hold."""

import numpy as np

from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.report.figures.figure import TableName
from dogbot_logtool.report.figures.foot_source import foot_sources
from dogbot_logtool.report.figures.tables import columns_of
from dogbot_logtool.results import StrideTable


def stride_table(stats: Stats) -> StrideTable:
    """Gather the strides of all feet."""
    feet = foot_sources(stats)
    names = [name for name, foot in feet.items() for _ in foot.foot.strides.stance]
    columns = {
        each.column.header: np.concatenate(
            [np.empty(0), *(each.figure.of(foot) for foot in feet.values())]
        )
        for each in columns_of(TableName.STRIDE_ROWS)
    }
    return StrideTable(tuple(names), columns)
