"""Force over the gait cycle: the median and the quartiles of each foot, left over right."""

from collections.abc import Sequence

import numpy as np

from dogbot_logtool.core.gait.cycle_curves import CycleCurve
from dogbot_logtool.core.scene.foot_style import foot_colour
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.report.page.charts.chart import Chart, Trace, scatter
from dogbot_logtool.report.page.charts.drawing import MARGIN, Drawing, label, translucent
from dogbot_logtool.report.page.charts.panels import heading, leg_columns, panel_axes, place_of

Curves = Sequence[CycleCurve | None]
"""Of each foot."""


def force_over_cycle(stats: Stats) -> Drawing | None:
    """Draw a panel a pair of legs; None where no force over a stride is known."""
    vertical = [foot.force_curves.vertical_over_stride for foot in stats.feet]
    forward = [foot.force_curves.forward_over_stride for foot in stats.feet]
    rows = [
        (name, curves)
        for name, curves in (("vertical", vertical), ("forward", forward))
        if any(curves)
    ]
    if not rows:
        return None
    columns = leg_columns(stats)
    figure = Chart(layout={"height": 250 * len(rows) + 40, "margin": {**MARGIN, "t": 24}})
    figure.layout.update(showlegend=False, hovermode="x unified", annotations=[])
    for row, (force, curves) in enumerate(rows):
        for column, (title, feet) in enumerate(columns):
            number = row * len(columns) + column + 1
            place = place_of(row, len(rows), column, len(columns))
            panel_axes(figure, number, place, (f"{force} (N)", _extent(curves)))
            for foot in feet:
                figure.data.extend(_traces(stats, foot, curves[foot], number))
            if row == 0 and title:
                figure.layout["annotations"].append(heading(title, place))
    return Drawing(
        "cycle", "Force over the gait cycle", _words(stats, rows[0][1]), _caption(), figure
    )


def _extent(curves: Curves) -> tuple[float, float]:
    known = [curve for curve in curves if curve]
    low = min(float(curve.lower.min()) for curve in known)
    high = max(float(curve.upper.max()) for curve in known)
    pad = 0.05 * (high - low) or 1.0
    return min(low, 0.0) - pad, max(high, 0.0) + pad


def _traces(stats: Stats, foot: int, curve: CycleCurve | None, number: int) -> list[Trace]:
    if curve is None:
        return []
    end = "" if number == 1 else str(number)
    axes = {"xaxis": f"x{end}", "yaxis": f"y{end}"}
    record = stats.feet[foot]
    colour, name = foot_colour(foot), label(record.name)
    is_right = record.place is not None and record.place[1] == "right"
    percent, lower, median, upper = (
        each.astype(np.float32) for each in (curve.percent, curve.lower, curve.median, curve.upper)
    )
    return [
        scatter(
            x=np.concatenate([percent, percent[::-1]]),
            y=np.concatenate([upper, lower[::-1]]),
            mode="lines",
            line={"width": 0},
            fill="toself",
            fillcolor=translucent(colour, 0.2),
            hoverinfo="skip",
            name=f"{name} quartiles",
            **axes,
        ),
        scatter(
            x=percent,
            y=median,
            mode="lines",
            line={"color": colour, "width": 2, "dash": "dash" if is_right else "solid"},
            name=name,
            # The page finds the foot's stride by it.
            meta={"foot": foot},
            customdata=np.stack([lower, upper], axis=1),
            hovertemplate="%{y:.1f} N (%{customdata[0]:.1f} to %{customdata[1]:.1f})",
            **axes,
        ),
    ]


def _words(stats: Stats, curves: Curves) -> str:
    highest = ", ".join(
        f"{foot.name} {curve.median.max():.0f} N over {curve.number} strides"
        for foot, curve in zip(stats.feet, curves, strict=True)
        if curve
    )
    return f"The usual force of each foot over its stride. Highest median: {highest}."


def _caption() -> str:
    return (
        "0 % is the foot's own touchdown. Line: median over whole strides, dashed for feet on the "
        "right; band: from the lower to the upper quartile."
    )
