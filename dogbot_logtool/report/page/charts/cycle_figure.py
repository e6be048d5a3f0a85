"""Force over the gait cycle: the median and the quartiles of each foot, left over right."""

from collections.abc import Sequence
from typing import Final

from dogbot_logtool.core.gait.cycle_curves import CycleCurve
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.report.page.charts.drawing import Drawing
from dogbot_logtool.report.page.charts.panels import Band, PanelRow, over_cycle

_ROW_PIXELS = 250
_CAPTION: Final = (
    "0 % is the foot's own touchdown. Line: median over whole strides, dashed for feet on the "
    "right; band: from the lower to the upper quartile."
)


def force_over_cycle(stats: Stats) -> Drawing | None:
    """Draw a panel a pair of legs; None where no force over a stride is known."""
    vertical = [foot.vertical_over_stride for foot in stats.feet]
    forward = [foot.forward_over_stride for foot in stats.feet]
    known = [
        (name, each) for name, each in (("vertical", vertical), ("forward", forward)) if any(each)
    ]
    if not known:
        return None
    rows = [PanelRow(name, "N", _bands(curves), ".1f", with_zero=True) for name, curves in known]
    chart = over_cycle(stats, rows, _ROW_PIXELS)
    return Drawing(
        "cycle", "Force over the gait cycle", _words(stats, known[0][1]), _CAPTION, chart
    )


def _bands(curves: Sequence[CycleCurve | None]) -> dict[int, Band]:
    return {
        foot: Band(curve.percent, curve.lower, curve.median, curve.upper)
        for foot, curve in enumerate(curves)
        if curve
    }


def _words(stats: Stats, curves: Sequence[CycleCurve | None]) -> str:
    highest = ", ".join(
        f"{foot.name} {curve.median.max():.0f} N over {curve.number} strides"
        for foot, curve in zip(stats.feet, curves, strict=True)
        if curve
    )
    return f"The usual force of each foot over its stride. Highest median: {highest}."
