"""The whole strides of a log, a row each: what CSV and Parquet hold."""

import numpy as np

from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.report.figures.document import STRIDE_FIGURES
from dogbot_logtool.report.figures.foot_source import foot_sources
from dogbot_logtool.results import StrideTable


def stride_table(stats: Stats) -> StrideTable:
    """Gather the strides of all feet."""
    feet = foot_sources(stats)
    names = [name for name, foot in feet.items() for _ in foot.foot.strides.stance]
    columns = {
        figure.key: np.concatenate([np.empty(0), *map(figure.of, feet.values())])
        for figure in STRIDE_FIGURES
    }
    return StrideTable(tuple(names), columns)
