"""The stride as a clock: when in the reference foot's stride each foot is down."""

from typing import Any, Final

import numpy as np

from dogbot_logtool.core.gait.foot_statistics import FootStatistics
from dogbot_logtool.core.gait.phases import phases_in
from dogbot_logtool.core.gait.segments import Segment
from dogbot_logtool.core.geometry.arrays import Floats
from dogbot_logtool.core.scene.foot_style import foot_colour, short_names
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.report.page.charts.chart import Chart, Trace, scatter
from dogbot_logtool.report.page.charts.drawing import NEUTRAL, Drawing, foot_marker, label, thinned

MOST_DOTS: Final = 200
"""Touchdowns of a foot that are drawn."""
_LABEL: Final = 0.25
"""Cycles times radius by which a foot's name stands before its touchdown."""
_BESIDE: Final = 0.33
"""Distance of the touchdowns from their ring, in distances between rings."""
_INNER: Final = 2.0
"""Radius of the innermost ring, in distances between rings."""


def phase_clock(stats: Stats) -> Drawing | None:
    """Draw a ring a foot: an arc while the foot is down, a dot for each touchdown.

    None where no gait has phases.
    """
    main = stats.main
    if main is None or not any(main.phases):
        return None
    short = short_names([foot.name for foot in stats.feet])
    rings = len(stats.feet)
    figure = Chart()
    for row, foot in enumerate(stats.feet):
        radius = _INNER + rings - row
        figure.data.extend(_ring(stats, main, foot, row, radius, label(short[row])))
    figure.layout.update(_face(_INNER + rings + 0.6))
    reference = stats.feet[stats.reference].name
    phases = ", ".join(
        f"{foot.name} {phase.mean:.2f}"
        for foot, phase in zip(stats.feet, main.phases, strict=True)
        if phase
    )
    return Drawing(
        "clock",
        "Phase clock",
        f"Phases of the touchdowns in the stride of {reference}, in cycles: {phases}.",
        f"One turn is a stride of {reference}, clockwise from its touchdown. Arc: mean stance; "
        "marks: each touchdown of the longest segment.",
        figure,
    )


def _face(radius: float) -> dict[str, Any]:
    """Return the layout of a clock: a circle with its quarters."""
    reach = radius * 1.15
    axis = {"visible": False, "range": [-reach, reach], "fixedrange": True}
    quarters = zip(("0", "0.25", "0.5", "0.75"), (0.0, 0.25, 0.5, 0.75), strict=True)
    marks = [
        (text, *(float(each[0]) for each in _on_ring(np.array([phase]), radius * 1.07)))
        for text, phase in quarters
    ]
    return {
        "height": 480,
        "margin": {"l": 8, "r": 8, "t": 8, "b": 8},
        "showlegend": False,
        "hovermode": "closest",
        "dragmode": False,
        "xaxis": axis,
        "yaxis": {**axis, "scaleanchor": "x", "scaleratio": 1},
        "shapes": [
            {
                "type": "circle",
                "xref": "x",
                "yref": "y",
                "x0": -radius,
                "x1": radius,
                "y0": -radius,
                "y1": radius,
                "line": {"color": NEUTRAL, "width": 1},
                "layer": "below",
            }
        ],
        "annotations": [{"text": text, "x": x, "y": y, "showarrow": False} for text, x, y in marks],
    }


def _on_ring(phase: Floats, radius: float) -> tuple[Floats, Floats]:
    """Return x and y of phases, clockwise from the top."""
    turn = 2.0 * np.pi * phase
    return np.round(radius * np.sin(turn), 4), np.round(radius * np.cos(turn), 4)


def _ring(
    stats: Stats, main: Segment, foot: FootStatistics, row: int, radius: float, short: str
) -> list[Trace]:
    phase = main.phases[row]
    if phase is None:
        return []
    reference = stats.feet[stats.reference].strides.within(main.spans)
    phases = phases_in(reference, foot.touchdown)
    phases = phases[thinned(len(phases), MOST_DOTS)]
    strides = foot.strides.within(main.spans)
    name, colour = label(foot.name), foot_colour(row)
    traces = []
    words = f"touchdown at phase {phase.mean:.3f}, R {phase.consistency:.3f}"
    if len(strides.stance):
        duty = float(strides.duty_factor.mean())
        x, y = _on_ring(phase.mean + np.linspace(0.0, duty, 60), radius)
        line = {"color": colour, "width": 9}
        hover = f"{words}<br>duty factor {duty:.3f}"
        traces.append(scatter(x=x, y=y, mode="lines", line=line, name=name, hovertemplate=hover))
    x, y = _on_ring(phases, radius + _BESIDE)
    marker = foot_marker(stats, row)
    traces.append(
        scatter(
            x=x,
            y=y,
            mode="markers",
            marker=marker,
            customdata=phases,
            name=name,
            hovertemplate="touchdown at phase %{customdata:.3f}",
        )
    )
    x, y = _on_ring(np.array([phase.mean - _LABEL / radius]), radius)
    traces.append(scatter(x=x, y=y, mode="text", text=[f"<b>{short}</b>"], hoverinfo="skip"))
    return traces
