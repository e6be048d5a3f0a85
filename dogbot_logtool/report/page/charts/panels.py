"""Panels of figures over the gait cycle: one a pair of legs."""

from typing import Any, Final

from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.report.page.charts.chart import Chart

_ENDS: Final = {"front": "fore feet", "middle": "middle feet", "back": "hind feet"}
_BETWEEN: Final = 0.06
"""Of the width, between two panels; also of the height, doubled."""


def leg_columns(stats: Stats) -> list[tuple[str, list[int]]]:
    """Return the panels: the feet of each pair of legs, or all of them."""
    places = [foot.place for foot in stats.feet]
    if any(place is None for place in places):
        return [("", list(range(len(places))))]
    ends = dict.fromkeys(place[0] for place in places if place)
    named = [end for end in _ENDS if end in ends]
    if len(named) < 2:
        return [("", list(range(len(places))))]
    return [
        (_ENDS[end], [foot for foot, place in enumerate(places) if place and place[0] == end])
        for end in named
    ]


def place_of(row: int, rows: int, column: int, columns: int) -> dict[str, list[float]]:
    """Return where a panel lies, as shares of width and height."""
    width, height = 1.0 / columns, 1.0 / rows
    across = 0.5 * _BETWEEN if columns > 1 else 0.0
    down = 0.5 * _BETWEEN * min(1.0, 2.0 / rows) if rows > 1 else 0.0
    return {
        "x": [
            column * width + across * (column > 0),
            (column + 1) * width - across * (column < columns - 1),
        ],
        "y": [
            1.0 - (row + 1) * height + 2.0 * down * (row < rows - 1),
            1.0 - row * height - 2.0 * down * (row > 0),
        ],
    }


def panel_axes(
    figure: Chart,
    number: int,
    place: dict[str, list[float]],
    what: tuple[str, tuple[float, float]],
) -> None:
    """Add the axes of a panel.

    Args:
        figure: it is added to.
        number: of the panel, from 1.
        place: of the panel.
        what: title and extent of the upright axis.
    """
    end = "" if number == 1 else str(number)
    title, extent = what
    figure.layout[f"xaxis{end}"] = {
        "domain": place["x"],
        "anchor": f"y{end}",
        "range": [0, 100],
        "fixedrange": True,
        "tickvals": [0, 25, 50, 75, 100],
        "tickangle": 0,
        "title": {"text": "% of the stride" if place["y"][0] == 0.0 else "", "standoff": 6},
        "zeroline": False,
        "hoverformat": ".0f",
    }
    figure.layout[f"yaxis{end}"] = {
        "domain": place["y"],
        "anchor": f"x{end}",
        "range": list(extent),
        "fixedrange": True,
        "zeroline": True,
        "nticks": 6,
        "title": {"text": title if place["x"][0] == 0.0 else "", "standoff": 2},
        "showticklabels": place["x"][0] == 0.0,
    }


def heading(title: str, place: dict[str, list[float]]) -> dict[str, Any]:
    """Return a heading above a column of panels."""
    return {
        "text": title,
        "x": sum(place["x"]) / 2.0,
        "y": 1.0,
        "xref": "paper",
        "yref": "paper",
        "yanchor": "bottom",
        "showarrow": False,
    }
