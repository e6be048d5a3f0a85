"""Legs over the gait cycle: height of the feet, and motion of the joints, left over right."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.geometry.arrays import Floats
from dogbot_logtool.core.legs.leg_figures import LegFigures
from dogbot_logtool.core.scene.foot_style import foot_colour
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.page.charts.chart import Chart, Trace, scatter
from dogbot_logtool.report.page.charts.drawing import MARGIN, Drawing, label, translucent
from dogbot_logtool.report.page.charts.panels import heading, leg_columns, panel_axes, place_of

_MOST_ROWS: Final = 8
"""Panels above each other."""
_ROW_PIXELS: Final = 190


@dataclass(frozen=True, slots=True)
class _Band:
    """A curve over the stride with what lies around it."""

    percent: Floats
    lower: Floats
    middle: Floats
    upper: Floats


_Row = tuple[str, Mapping[int, _Band]]
"""What a row of panels shows, and its curve of each foot."""


def legs_over_cycle(stats: Stats) -> Drawing | None:
    """Draw a panel a pair of legs and kind of joint; None where no legs are known."""
    legs = stats.legs
    rows = [] if legs is None else [*_heights(legs), *_joints(legs)][:_MOST_ROWS]
    if not rows:
        return None
    columns = leg_columns(stats)
    figure = Chart(
        layout={"height": _ROW_PIXELS * len(rows) + 60, "margin": {**MARGIN, "l": 60, "t": 24}}
    )
    figure.layout.update(showlegend=False, hovermode="x unified", annotations=[])
    for row, (what, bands) in enumerate(rows):
        for column, (title, feet) in enumerate(columns):
            number = row * len(columns) + column + 1
            place = place_of(row, len(rows), column, len(columns))
            panel_axes(figure, number, place, (label(what), _extent(bands)))
            for foot in feet:
                if foot in bands:
                    figure.data.extend(_traces(stats, foot, bands[foot], number))
            if row == 0 and title:
                figure.layout["annotations"].append(heading(title, place))
    return Drawing("legs", "Legs over the gait cycle", _words(stats, legs), _caption(), figure)


def _heights(legs: LegFigures) -> list[_Row]:
    """Return the row of the feet's heights, if any is known."""
    bands = {
        foot: _Band(
            curve.percent, *(1e3 * each for each in (curve.lower, curve.median, curve.upper))
        )
        for foot, leg in enumerate(legs.feet)
        if (curve := leg.swings.height) is not None
    }
    return [("foot (mm)", bands)] if bands else []


def _joints(legs: LegFigures) -> list[_Row]:
    """Return a row a kind of joint: those of different legs that are alike."""
    numbers = {leg.name: row for row, leg in enumerate(legs.feet)}
    kinds = _kinds(legs)
    rows: dict[str, dict[int, _Band]] = {}
    for joint in legs.joints:
        curve = joint.curve
        if curve is None:
            continue
        low, high = curve.position - curve.position_sd, curve.position + curve.position_sd
        name = kinds.get(joint.history.name, joint.history.name)
        band = _Band(curve.percent, low, curve.position, high)
        rows.setdefault(name, {})[numbers[joint.foot]] = band
    return [(f"{name} (rad)", bands) for name, bands in rows.items()]


def _kinds(legs: LegFigures) -> dict[str, str]:
    """Return what joints of all legs that are alike are called, by their names."""
    kinds = {}
    for pair in legs.settings.pairs:
        end, _, rest = pair.name.partition("_")
        kind = rest if end in {"front", "middle", "back"} and rest else pair.name
        kinds[pair.left] = kinds[pair.right] = kind.removesuffix("_joint").replace("_", " ")
    return kinds


def _extent(bands: Mapping[int, _Band]) -> tuple[float, float]:
    low = min(float(band.lower.min()) for band in bands.values())
    high = max(float(band.upper.max()) for band in bands.values())
    pad = 0.08 * (high - low) or 1.0
    return low - pad, high + pad


def _traces(stats: Stats, foot: int, band: _Band, number: int) -> Sequence[Trace]:
    end = "" if number == 1 else str(number)
    axes = {"xaxis": f"x{end}", "yaxis": f"y{end}"}
    record = stats.feet[foot]
    colour, name = foot_colour(foot), label(record.name)
    is_right = record.place is not None and record.place[1] == "right"
    percent, lower, middle, upper = (
        each.astype(np.float32) for each in (band.percent, band.lower, band.middle, band.upper)
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
            hovertemplate="%{y:.3g}",
            **axes,
        ),
    )


def _words(stats: Stats, legs: LegFigures | None) -> str:
    known = [] if legs is None else [leg for leg in legs.feet if leg.swings.height is not None]
    clear = ", ".join(
        f"{printable(leg.name)} {1e3 * float(np.nanmedian(leg.swings.clearance_m)):.0f} mm"
        for leg in known
    )
    joints = 0 if legs is None else sum(joint.curve is not None for joint in legs.joints)
    text = f"Motion of {joints} joints over the stride of their {len(stats.feet)} feet."
    return f"{text} Clearance of the feet: {clear}." if clear else text


def _caption() -> str:
    return (
        "0 % is the foot's own touchdown; dashed: legs on the right. Foot: height above the line "
        "between its footfalls, median and quartiles. Joints: position, mean and standard "
        "deviation over whole strides."
    )
