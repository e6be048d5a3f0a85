"""When was the recording silent? A line a topic, its gaps marked."""

from typing import Final

import numpy as np

from dogbot_logtool.core.geometry import timespans
from dogbot_logtool.core.geometry.arrays import Ints
from dogbot_logtool.core.quality.quality import TopicQuality
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.report.page.charts.chart import Chart, Trace, bars
from dogbot_logtool.report.page.charts.drawing import (
    BAD,
    MARGIN,
    NEUTRAL,
    Drawing,
    label,
    seconds,
    time_axis,
)

MOST_TOPICS: Final = 24
"""Topics that have a line; those that serve for something, then those with gaps."""
MOST_GAPS: Final = 500
"""Gaps of a topic that are drawn, the longest."""
_LONGEST_NAME: Final = 48


@dataclass(frozen=True, slots=True)
class _Line:
    name: str
    span: Ints
    """(s, 2) ns, recorded; also its gaps."""
    gaps: Ints


def recording(stats: Stats) -> Drawing:
    """Draw when each topic was recorded and when it was silent."""
    lines = _lines(stats)
    figure = Chart()
    for row, line in enumerate(lines):
        figure.data.append(_bars(stats, line.span, row, NEUTRAL, "recorded", 0.28))
        figure.data.append(_bars(stats, line.gaps, row, BAD, "silent", 0.5))
    figure.layout.update(
        height=34 * max(len(lines), 1) + 60,
        margin={**MARGIN, "t": 16},
        barmode="overlay",
        showlegend=False,
        hovermode="closest",
        xaxis=time_axis(stats),
        yaxis={
            "visible": False,
            "range": [max(len(lines), 1) - 0.5, -0.7],
            "fixedrange": True,
        },
        annotations=[
            {
                "text": label(_cut(line.name)),
                "x": 0,
                "xref": "paper",
                "xanchor": "left",
                "y": row - 0.28,
                "yanchor": "bottom",
                "showarrow": False,
                "font": {"size": 11},
            }
            for row, line in enumerate(lines)
        ],
    )
    return Drawing(
        "recording",
        "Recording over time",
        _words(lines),
        "Grey: recorded; red: silent for longer than five usual intervals and 50 ms, or the robot "
        f"lies on the ground.{_left_out(stats, lines)}",
        figure,
        over_time=True,
    )


def _cut(name: str) -> str:
    return name if len(name) <= _LONGEST_NAME else f"{name[: _LONGEST_NAME - 3]}..."


def _lines(stats: Stats) -> list[_Line]:
    """Feet and base, whose gaps are all known, then other topics with gaps."""
    lines = [
        _Line(foot.topic, _extent(foot.record.start, foot.record.end), foot.record.gaps)
        for foot in stats.feet
    ]
    base = stats.base_history
    if len(base.time):
        extent = _extent(int(base.time[0]), int(base.time[-1]))
        lines.append(_Line(stats.settings.odometry_topic or "odometry", extent, base.gaps))
    if len(stats.fallen):
        lines.append(_Line("robot lies on the ground", timespans.no_spans(), stats.fallen))
    shown = {line.name for line in lines}
    lines.extend(
        _Line(topic.topic, _extent(topic.first, topic.last), _gaps(topic))
        for topic in stats.topics
        if topic.topic not in shown and topic.longest_gaps and _on_same_clock(stats, topic)
    )
    unique = {(line.name, line.gaps.tobytes()): line for line in lines}
    return list(unique.values())[:MOST_TOPICS]


def _gaps(topic: TopicQuality) -> Ints:
    """(g, 2) ns, the longest gaps of a topic in the order of time."""
    longest = topic.longest_gaps
    return np.array(
        sorted((gap.start, gap.start + round(gap.length_s * 1e9)) for gap in longest), np.int64
    )


def _on_same_clock(stats: Stats, topic: TopicQuality) -> bool:
    return topic.clock is stats.settings.clock


def _extent(start: int | None, end: int | None) -> Ints:
    if start is None or end is None:
        return timespans.no_spans()
    return np.array([[start, end]], np.int64)


def _bars(stats: Stats, spans: Ints, row: int, colour: str, what: str, width: float) -> Trace:
    longest = np.argsort(spans[:, 0] - spans[:, 1], kind="stable")[:MOST_GAPS]
    spans = spans[np.sort(longest)]
    start = seconds(stats, spans[:, 0])
    length = seconds(stats, spans[:, 1]) - start
    return bars(
        base=start,
        x=length,
        customdata=length,
        y=np.full(len(spans), row, np.int16),
        width=width,
        # An outline, so that a gap shorter than a pixel is seen.
        marker={"color": colour, "line": {"width": 1.5 if colour == BAD else 0, "color": colour}},
        hovertemplate=f"{what} for %{{customdata:.3f}} s<br>from %{{base:.3f}} s<extra></extra>",
    )


def _words(lines: list[_Line]) -> str:
    gaps = [f"{line.name} {len(line.gaps)}" for line in lines if len(line.gaps)]
    return f"Silences of each topic over time. Their number: {', '.join(gaps) or 'none'}."


def _left_out(stats: Stats, lines: list[_Line]) -> str:
    words = ""
    if any(len(line.gaps) > MOST_GAPS for line in lines):
        words += f" Of each topic the {MOST_GAPS} longest gaps are drawn."
    shown = {line.name for line in lines}
    others = [each for each in stats.topics if each.topic not in shown]
    if others:
        words += f" {len(others)} more topics stand in the table below."
    return words
