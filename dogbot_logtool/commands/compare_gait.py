"""The story of `compare --gait`: do two runs, or two groups of runs, walk alike?"""

from collections.abc import Sequence

from dogbot_logtool.comparison.walks import (
    GaitComparison,
    RunStrides,
    doubts,
    metric_differences,
    why_not_comparable,
)
from dogbot_logtool.errors import LogError
from dogbot_logtool.results import Figures


def compare_gait(first: Sequence[Figures], second: Sequence[Figures]) -> GaitComparison:
    """Compare how two sides walk.

    Args:
        first: what `stats` of each log of one side comes to.
        second: of the other.

    Raises:
        LogError: nothing of a side could be measured.
    """
    if not first or not second:
        raise LogError("nothing is left to compare: no log of one side could be measured")
    documents = [[figures.json for figures in side] for side in (first, second)]
    reasons = why_not_comparable(*documents)
    runs = [[_strides(figures) for figures in side] for side in (first, second)]
    names = [tuple(run.name for run in side) for side in runs]
    return GaitComparison(
        sides=(names[0], names[1]),
        damage=tuple(each.damage for each in (*first, *second) if each.damage.losses),
        reasons=tuple(reasons),
        doubts=tuple(doubts([*documents[0], *documents[1]])),
        differences=() if reasons else tuple(metric_differences(*runs)),
    )


def _strides(figures: Figures) -> RunStrides:
    strides = figures.strides
    return RunStrides(
        figures.json["log"]["path"], strides.foot, strides.columns, figures.interval_s
    )
