"""Curves over the gait cycle, each with a band around it: forces, heights of the feet, joints."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.legs.legs import LegFigures
from dogbot_logtool.core.records import Curve, Shape
from dogbot_logtool.core.scene.foot_style import foot_colour
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.page.charts.drawing import (
    MARGIN,
    Chart,
    Drawing,
    Trace,
    label,
    scatter,
    translucent,
)

_ENDS: Final = {"front": "fore feet", "middle": "middle feet", "back": "hind feet"}
_BETWEEN: Final = 0.06
"""Share of the width between two panels; doubled, also of the height."""


@dataclass(frozen=True, slots=True)
class Band:
    """A curve over the stride, (p,), with what lies around it."""

    percent: Floats
    lower: Floats
    middle: Floats
    upper: Floats


@dataclass(frozen=True, slots=True)
class PanelRow:
    """Panels beside each other, of one unit."""

    title: str
    unit: str
    bands: Mapping[int, Band]
    """By foot; those without a curve are missing."""
    hover: str = ".3g"
    """How numbers are shown."""
    with_zero: bool = False
    """Whether 0 is shown, wherever the curves lie."""
    least: float = 0.0
    """Span that is shown at least."""

    @property
    def extent(self) -> tuple[float, float]:
        """Extent of the upright axis."""
        low = min(float(band.lower.min()) for band in self.bands.values())
        high = max(float(band.upper.max()) for band in self.bands.values())
        pad = max(0.06 * (high - low), (self.least - (high - low)) / 2.0) or 1.0
        if self.with_zero:
            low, high = min(low, 0.0), max(high, 0.0)
        return low - pad, high + pad


def over_cycle(stats: Walk, rows: Sequence[PanelRow], row_pixels: int) -> Chart:
    """Draw rows of panels, one above the other."""
    columns = leg_columns(stats)
    margin = {**MARGIN, "l": 60, "r": 20, "t": 24}
    figure = Chart(layout={"height": row_pixels * len(rows) + 50, "margin": margin})
    figure.layout.update(showlegend=False, hovermode="x unified", annotations=[])
    for number, row in enumerate(rows):
        for column, (title, feet) in enumerate(columns):
            panel = number * len(columns) + column + 1
            domain = panel_domain(number, len(rows), column, len(columns))
            panel_axes(figure, panel, domain, row)
            for foot in feet:
                if foot in row.bands:
                    figure.data.extend(_traces(stats, foot, row, panel))
            if number == 0 and title:
                figure.layout["annotations"].append(heading(title, domain))
    return figure


def _traces(stats: Walk, foot: int, row: PanelRow, panel: int) -> Sequence[Trace]:
    """Return the band and the line of a foot, dashed on the right."""
    end = "" if panel == 1 else str(panel)
    axes = {"xaxis": f"x{end}", "yaxis": f"y{end}"}
    record, band = stats.feet[foot], row.bands[foot]
    colour, name = foot_colour(foot), label(record.name)
    is_right = (record.name if record.leg_position is None else record.leg_position[1]) == "right"
    percent, lower, middle, upper = (
        each.astype(np.float32) for each in (band.percent, band.lower, band.middle, band.upper)
    )
    value, least, most = (
        f"%{{{of}:{row.hover}}}" for of in ("y", "customdata[0]", "customdata[1]")
    )
    return (
        scatter(
            x=np.concatenate([percent, percent[::-1]]),
            y=np.concatenate([upper, lower[::-1]]),
            mode="lines",
            line={"width": 0},
            fill="toself",
            fillcolor=translucent(colour, 0.2),
            hoverinfo="skip",
            name=f"{name} spread",
            **axes,
        ),
        scatter(
            x=percent,
            y=middle,
            mode="lines",
            line={"color": colour, "width": 2, "dash": "dash" if is_right else "solid"},
            name=name,
            # The page finds the foot's stride by it.
            meta={"foot": foot},
            customdata=np.stack([lower, upper], axis=1),
            hovertemplate=f"{value} {row.unit} ({least} to {most})",
            **axes,
        ),
    )


def leg_columns(stats: Walk) -> list[tuple[str, list[int]]]:
    """Return the panels: the feet of each pair of legs, or all of them."""
    leg_positions = [foot.leg_position for foot in stats.feet]
    if None in leg_positions:
        return [("", list(range(len(leg_positions))))]
    ends = dict.fromkeys(each[0] for each in leg_positions if each)
    named = [end for end in _ENDS if end in ends]
    if len(named) < 2:
        return [("", list(range(len(leg_positions))))]
    return [
        (_ENDS[end], [foot for foot, each in enumerate(leg_positions) if each and each[0] == end])
        for end in named
    ]


def panel_domain(row: int, rows: int, column: int, columns: int) -> dict[str, list[float]]:
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


def panel_axes(figure: Chart, number: int, domain: dict[str, list[float]], row: PanelRow) -> None:
    """Add the axes of a panel.

    Args:
        figure: it is added to.
        number: of the panel, from 1.
        domain: of the panel.
        row: what it shows.
    """
    end = "" if number == 1 else str(number)
    title = f"{label(row.title)} ({row.unit})"
    figure.layout[f"xaxis{end}"] = {
        "domain": domain["x"],
        "anchor": f"y{end}",
        "range": [0, 100],
        "fixedrange": True,
        "tickvals": [0, 25, 50, 75, 100],
        "tickangle": 0,
        "title": {"text": "% of the stride" if domain["y"][0] == 0.0 else "", "standoff": 6},
        "zeroline": False,
        "hoverformat": ".0f",
    }
    figure.layout[f"yaxis{end}"] = {
        "domain": domain["y"],
        "anchor": f"x{end}",
        "range": list(row.extent),
        "fixedrange": True,
        "zeroline": True,
        "nticks": 6,
        "title": {"text": title if domain["x"][0] == 0.0 else "", "standoff": 2},
        "showticklabels": domain["x"][0] == 0.0,
    }


def heading(title: str, domain: dict[str, list[float]]) -> dict[str, Any]:
    """Return a heading above a column of panels."""
    return {
        "text": title,
        "x": sum(domain["x"]) / 2.0,
        "y": 1.0,
        "xref": "paper",
        "yref": "paper",
        "yanchor": "bottom",
        "showarrow": False,
    }


_FORCE_PIXELS = 250
_FORCES: Final = (
    "0 % is the foot's own touchdown. Line: median over whole strides, dashed for feet on the "
    "right; band: from the lower to the upper quartile."
)


def force_over_cycle(stats: Walk) -> Drawing | None:
    """Draw a panel a pair of legs; None where no force over a stride is known."""
    vertical = [foot.vertical_over_stride for foot in stats.feet]
    forward = [foot.forward_over_stride for foot in stats.feet]
    known = [
        (name, each) for name, each in (("vertical", vertical), ("forward", forward)) if any(each)
    ]
    if not known:
        return None
    rows = [PanelRow(name, "N", _bands(curves), ".1f", with_zero=True) for name, curves in known]
    chart = over_cycle(stats, rows, _FORCE_PIXELS)
    return Drawing(
        "cycle", "Force over the gait cycle", _highest(stats, known[0][1]), _FORCES, chart
    )


def _band(curve: Curve, scale: float = 1.0, step: int = 1) -> Band:
    parts = (np.array(each)[::step] for each in (curve.lower, curve.median, curve.upper))
    return Band(np.array(curve.percent)[::step], *(scale * each for each in parts))


def _bands(curves: Sequence[Shape], scale: float = 1.0) -> dict[int, Band]:
    return {foot: _band(curve, scale) for foot, curve in enumerate(curves) if curve}


def _highest(stats: Walk, curves: Sequence[Shape]) -> str:
    highest = ", ".join(
        f"{foot.name} {max(curve.median):.0f} N"
        for foot, curve in zip(stats.feet, curves, strict=True)
        if curve
    )
    return f"The usual force of each foot over its stride. Highest median: {highest}."


_MOST_ROWS: Final = 8
"""Panels above each other."""
_ROW_PIXELS: Final = 190
_LEAST_RAD: Final = 0.05
"""Span of a joint's row at least: what rests shows no noise."""
_LEGS: Final = (
    "0 % is the foot's own touchdown; dashed: legs on the right. Foot: height above the line "
    "between its footfalls. Joints: position. Median and quartiles over whole strides."
)


def legs_over_cycle(stats: Walk) -> Drawing | None:
    """Draw a panel a pair of legs and kind of joint; None where no legs are known."""
    legs = stats.legs
    rows = [] if legs is None else [*_heights(legs), *_joints(legs)][:_MOST_ROWS]
    if not rows:
        return None
    chart = over_cycle(stats, rows, _ROW_PIXELS)
    return Drawing("legs", "Legs over the gait cycle", _clearances(stats, legs), _LEGS, chart)


def _heights(legs: LegFigures) -> list[PanelRow]:
    """Return the row of the feet's heights, if any is known."""
    bands = _bands([leg.height for leg in legs.feet], 1e3)
    return [PanelRow("foot", "mm", bands)] if bands else []


def _joints(legs: LegFigures) -> list[PanelRow]:
    """Return a row a kind of joint: those of different legs that are alike."""
    numbers = {leg.name: row for row, leg in enumerate(legs.feet)}
    kinds = _kinds(legs)
    rows: dict[str, dict[int, Band]] = {}
    for name, joint in legs.metrics.joints.items():
        curve = joint.position_over_stride
        if curve is None or joint.foot is None:
            continue
        # Every second percent is as smooth as the eye can tell.
        band = _band(curve, step=2)
        rows.setdefault(kinds.get(name, name), {})[numbers[joint.foot]] = band
    return [PanelRow(name, "rad", bands, least=_LEAST_RAD) for name, bands in rows.items()]


def _kinds(legs: LegFigures) -> dict[str, str]:
    """Return what joints of all legs that are alike are called, by their names."""
    kinds = {}
    for pair in legs.settings.pairs:
        end, _, rest = pair.name.partition("_")
        kind = rest if end in {"front", "middle", "back"} and rest else pair.name
        kinds[pair.left] = kinds[pair.right] = kind.removesuffix("_joint").replace("_", " ")
    return kinds


def _clearances(stats: Walk, legs: LegFigures | None) -> str:
    known = [] if legs is None else [leg for leg in legs.feet if leg.height is not None]
    medians = (1e3 * float(np.nanmedian(leg.strides["clearance_m"])) for leg in known)
    clear = ", ".join(
        f"{printable(leg.name)} {median:.0f} mm" for leg, median in zip(known, medians, strict=True)
    )
    joints = [] if legs is None else list(legs.metrics.joints.values())
    moving = sum(joint.position_over_stride is not None for joint in joints)
    text = f"Motion of {moving} joints over the stride of their {len(stats.feet)} feet."
    return f"{text} Clearance of the feet: {clear}." if clear else text
