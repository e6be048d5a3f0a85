"""The stride as a clock: when in the reference foot's stride each foot is down."""

from typing import Any, Final

import numpy as np
import plotly.graph_objects as go

from dogbot_logtool.core.gait.foot_statistics import FootStatistics
from dogbot_logtool.core.gait.phases import phases_in
from dogbot_logtool.core.gait.segments import Segment
from dogbot_logtool.core.scene.foot_style import foot_colour, short_names
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.report.page.drawing import SYMBOLS, Drawing, label, thinned

MOST_DOTS: Final = 200
"""Touchdowns of a foot that are drawn."""
_LABEL: Final = 90.0
"""Degrees times radius by which a foot's name stands before its touchdown."""
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
    figure = go.Figure()
    for row, foot in enumerate(stats.feet):
        radius = _INNER + rings - row
        for trace in _ring(stats, main, foot, row, radius, label(short[row])):
            figure.add_trace(trace)
    figure.update_layout(
        height=480,
        margin={"l": 36, "r": 36, "t": 28, "b": 28},
        showlegend=False,
        polar={
            "bgcolor": "rgba(0,0,0,0)",
            "radialaxis": {"visible": False, "range": [0, _INNER + rings + 0.6]},
            "angularaxis": {
                "direction": "clockwise",
                "rotation": 90,
                "tickvals": [0, 90, 180, 270],
                "ticktext": ["0", "0.25", "0.5", "0.75"],
            },
        },
    )
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


def _ring(
    stats: Stats, main: Segment, foot: FootStatistics, row: int, radius: float, short: str
) -> list[go.Scatterpolar]:
    phase = main.phases[row]
    if phase is None:
        return []
    reference = stats.feet[stats.reference].strides.within(main.spans)
    phases = phases_in(reference, foot.touchdown)
    phases = phases[thinned(len(phases), MOST_DOTS)]
    strides = foot.strides.within(main.spans)
    colour = foot_colour(row)
    shared: dict[str, Any] = {"name": label(foot.name)}
    traces = []
    words = f"touchdown at phase {phase.mean:.3f}, R {phase.consistency:.3f}"
    if len(strides.stance):
        duty = float(strides.duty_factor.mean())
        arc = 360.0 * (phase.mean + np.linspace(0.0, duty, 60))
        traces.append(
            go.Scatterpolar(
                theta=np.round(arc, 3),
                r=np.full(len(arc), radius, np.float32),
                mode="lines",
                line={"color": colour, "width": 9},
                opacity=0.75,
                hovertemplate=f"{words}<br>duty factor {duty:.3f}",
                **shared,
            )
        )
    traces.append(
        go.Scatterpolar(
            theta=np.round(360.0 * phases, 3),
            r=np.full(len(phases), radius, np.float32),
            mode="markers",
            marker={
                "color": colour,
                "symbol": SYMBOLS[row % len(SYMBOLS)],
                "size": 9,
                "line": {"color": "#ffffff", "width": 1},
            },
            customdata=phases,
            hovertemplate="touchdown at phase %{customdata:.3f}",
            **shared,
        )
    )
    traces.append(
        go.Scatterpolar(
            theta=[round(360.0 * phase.mean - _LABEL / radius, 3)],
            r=[radius],
            mode="text",
            text=[f"<b>{short}</b>"],
            hoverinfo="skip",
        )
    )
    return traces
