"""Figures of the usual forces of a foot over the gait cycle."""

from collections.abc import Callable, Sequence
from typing import Final

from dogbot_logtool.core.gait.cycle_curves import CycleCurve, ForceCurves
from dogbot_logtool.core.gait.foot_statistics import FootStatistics
from dogbot_logtool.core.geometry.arrays import Floats
from dogbot_logtool.report.figures.figure import Figure, Kind, Scope

_UNKNOWN: Final = (
    "no whole stance or stride; wrenches are not known in the world frame; forward forces also "
    "without odometry"
)


def _points(
    key: str, unit: str, of: Callable[[CycleCurve], Floats], definition: str
) -> Figure[CycleCurve]:
    return Figure(key, Kind.NUMBERS, unit, lambda curve: of(curve).tolist(), definition)


_CURVE: Final[Sequence[Figure[CycleCurve]]] = (
    Figure("n", Kind.COUNT, "", lambda curve: curve.number, "number of stances or strides"),
    _points("percent", "%", lambda curve: curve.percent, "of the stance or stride"),
    _points("median", "N", lambda curve: curve.median, "median over stances or strides"),
    _points("lower_quartile", "N", lambda curve: curve.lower, "a quarter lies below"),
    _points("upper_quartile", "N", lambda curve: curve.upper, "a quarter lies above"),
)


def _curve(key: str, of: Callable[[ForceCurves], CycleCurve | None], definition: str) -> Scope:
    return Scope(key, _CURVE, of, definition, null=_UNKNOWN)


def _of_foot(foot: FootStatistics) -> ForceCurves:
    return foot.force_curves


FORCE_CURVES: Final = Scope(
    "force_curves",
    (
        _curve(
            "vertical_over_stance_n",
            lambda curves: curves.vertical_over_stance,
            "vertical force, mean of each of 25 equal parts of the stances",
        ),
        _curve(
            "forward_over_stance_n",
            lambda curves: curves.forward_over_stance,
            "force along the base's forward axis at mid-stance, in the same parts",
        ),
        _curve(
            "vertical_over_stride_n",
            lambda curves: curves.vertical_over_stride,
            "vertical force over whole strides, 0 in swing",
        ),
        _curve(
            "forward_over_stride_n",
            lambda curves: curves.forward_over_stride,
            "forward force over whole strides, 0 in swing",
        ),
    ),
    _of_foot,
    "usual forces over the gait cycle",
)
"""Of a `FootStatistics`."""
