"""The figures over the gait cycle, each curve with its spread: forces, heights of feet, joints."""

from collections.abc import Callable, Mapping
from typing import Final

import numpy as np

from dogbot_logtool.core.legs.joints import LegFigures
from dogbot_logtool.core.metrics import Foot
from dogbot_logtool.core.records import Curve, Shape
from dogbot_logtool.core.scene.feet import foot_colour
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.page.chart import Drawing, Row, Trace, area, extent_of, grid, label, line

_ENDS: Final = {"front": "fore feet", "middle": "middle feet", "back": "hind feet"}
_AXIS: Final = {
    "range": [0, 100],
    "fixedrange": True,
    "tickvals": [0, 25, 50, 75, 100],
    "tickangle": 0,
    "title": {"text": "% of the stride", "standoff": 6},
    "zeroline": False,
    "hoverformat": ".0f",
}
_FORCE_PIXELS: Final = 250
_MOST_ROWS: Final = 8
"""Panels above each other."""
_LEG_PIXELS: Final = 190
_LEAST: Final = 0.05
"""Span of a row at least: a joint that rests shows no noise."""
_FORCES: Final = (
    "0 % is the foot's own touchdown. Line: median over whole strides, dashed for feet on the "
    "right; band: from the lower to the upper quartile."
)
_LEGS: Final = (
    "0 % is the foot's own touchdown; dashed: legs on the right. Foot: height above the line "
    "between its footfalls. Joints: position. Median and quartiles over whole strides."
)


def force_over_cycle(walk: Walk) -> Drawing | None:
    """Draw a panel a pair of legs; None where no force over a stride is known."""
    curves = {
        "vertical": _of_feet(walk, lambda foot: foot.vertical_over_stride_n),
        "forward": _of_feet(walk, lambda foot: foot.forward_over_stride_n),
    }
    rows = [_row(walk, name, "N", each) for name, each in curves.items() if each]
    if not rows:
        return None
    known = curves["vertical"] or curves["forward"]
    highest = ", ".join(f"{foot} {max(curve.median):.0f} N" for foot, curve in known.items())
    alt = f"The usual force of each foot over its stride. Highest median: {highest}."
    drawn = grid(rows, _AXIS, _FORCE_PIXELS, list(_columns(walk)))
    return Drawing("cycle", "Force over the gait cycle", alt, _FORCES, *drawn)


def legs_over_cycle(walk: Walk) -> Drawing | None:
    """Draw a panel a pair of legs and kind of joint; None where no legs are known."""
    if walk.legs is None:
        return None
    heights = _of_feet(walk, lambda foot: foot.height_over_stride_m)
    rows = [_row(walk, "foot", "mm", heights, 1e3)] if heights else []
    rows += [_row(walk, kind, "rad", curves) for kind, curves in _joints(walk.legs).items()]
    if not rows:
        return None
    drawn = grid(rows[:_MOST_ROWS], _AXIS, _LEG_PIXELS, list(_columns(walk)))
    return Drawing("legs", "Legs over the gait cycle", _clearances(walk), _LEGS, *drawn)


def _of_feet(walk: Walk, of: Callable[[Foot], Shape]) -> dict[str, Curve]:
    curves = {name: of(foot) for name, foot in walk.metrics.feet.items()}
    return {name: curve for name, curve in curves.items() if curve}


def _columns(walk: Walk) -> dict[str, list[int]]:
    """Return the feet of each pair of legs by its heading, or all feet without one."""
    ends = [foot.leg_position and _ENDS.get(foot.leg_position[0]) for foot in walk.feet]
    titles = [title for title in _ENDS.values() if title in ends]
    if len(titles) < 2 or None in ends:
        return {"": list(range(len(ends)))}
    return {title: [foot for foot, end in enumerate(ends) if end == title] for title in titles}


def _row(walk: Walk, title: str, unit: str, curves: Mapping[str, Curve], scale: float = 1.0) -> Row:
    """Return the panels of one quantity, a curve a foot by its name."""
    traces = [
        (column, trace)
        for column, feet in enumerate(_columns(walk).values())
        for foot in feet
        if walk.feet[foot].name in curves
        for trace in _band(walk, foot, curves[walk.feet[foot].name], scale, unit)
    ]
    values = np.concatenate([[*each.lower, *each.upper] for each in curves.values()]) * scale
    extent = extent_of(values, _LEAST, with_zero=unit != "rad")
    return Row(f"{title} ({unit})", traces, extent)


def _band(walk: Walk, foot: int, curve: Curve, scale: float, unit: str) -> tuple[Trace, Trace]:
    """Return the spread and the line of a foot, dashed on the right."""
    record, colour = walk.feet[foot], foot_colour(foot)
    name, side = label(record.name), (record.leg_position or ("", record.name))[1]
    percent = np.array(curve.percent).round(3)
    quartiles = scale * np.array([curve.lower, curve.median, curve.upper])
    outline = np.append(quartiles[2], quartiles[0][::-1])
    value, least, most = (f"%{{{of}:.4g}}" for of in ("y", "customdata[0]", "customdata[1]"))
    more = {
        "meta": {"foot": foot},  # the page finds the foot's stride by it
        "customdata": quartiles[[0, 2]].T,
        "hovertemplate": f"{value} {unit} ({least} to {most})",
    }
    style = {"color": colour, "width": 2, "dash": "dash" if side == "right" else "solid"}
    return (
        area(np.append(percent, percent[::-1]), outline, f"{name} spread", colour, 0.2),
        line(percent, quartiles[1], name, style, more),
    )


def _joints(legs: LegFigures) -> dict[str, dict[str, Curve]]:
    """Return the curves of each kind of joint, by foot: joints of different legs that are alike."""
    kinds = {}
    for name, pair in legs.settings.pairs.items():
        end, _, rest = name.partition("_")
        kind = rest if end in _ENDS and rest else name
        kinds[pair[0]] = kinds[pair[1]] = kind.removesuffix("_joint").replace("_", " ")
    found: dict[str, dict[str, Curve]] = {}
    for name, joint in legs.metrics.joints.items():
        if joint.position_over_stride is not None and joint.foot is not None:
            curves = found.setdefault(kinds.get(name, name), {})
            curves[joint.foot] = joint.position_over_stride
    return found


def _clearances(walk: Walk) -> str:
    metrics = walk.metrics
    clear = ", ".join(
        f"{printable(name)} {1e3 * foot.clearance_m.median:.0f} mm"
        for name, foot in metrics.feet.items()
        if foot.clearance_m is not None
    )
    joints = metrics.legs.joints.values()
    moving = sum(joint.position_over_stride is not None for joint in joints)
    text = f"Motion of {moving} joints over the stride of their {len(metrics.feet)} feet."
    return f"{text} Clearance of the feet: {clear}." if clear else text
