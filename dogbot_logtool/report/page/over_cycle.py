"""The figures over the gait cycle, each curve with its spread: forces, heights of feet, joints."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.legs.legs import LegFigures
from dogbot_logtool.core.records import Curve, Shape
from dogbot_logtool.core.scene.foot_style import foot_colour
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.page.chart import (
    Drawing,
    Row,
    Trace,
    area,
    extent_of,
    grid,
    label,
    line,
)

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
_LEAST_RAD: Final = 0.05
"""Span of a joint's row at least: what rests shows no noise."""
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
    vertical = [foot.vertical_over_stride for foot in walk.feet]
    forward = [foot.forward_over_stride for foot in walk.feet]
    rows = [
        _row(walk, name, "N", ".1f", _known(curves), with_zero=True)
        for name, curves in (("vertical", vertical), ("forward", forward))
        if any(curves)
    ]
    if not rows:
        return None
    shown = vertical if any(vertical) else forward
    highest = [
        f"{foot.name} {max(curve.median):.0f} N"
        for foot, curve in zip(walk.feet, shown, strict=True)
        if curve
    ]
    alt = f"The usual force of each foot over its stride. Highest median: {', '.join(highest)}."
    drawn = grid(rows, _AXIS, _FORCE_PIXELS, list(_columns(walk)))
    return Drawing("cycle", "Force over the gait cycle", alt, _FORCES, *drawn)


def legs_over_cycle(walk: Walk) -> Drawing | None:
    """Draw a panel a pair of legs and kind of joint; None where no legs are known."""
    legs = walk.legs
    if legs is None:
        return None
    heights = _known([leg.height for leg in legs.feet])
    rows = [_row(walk, "foot", "mm", ".3g", heights, scale=1e3)] if heights else []
    rows += [
        _row(walk, kind, "rad", ".3g", curves, least=_LEAST_RAD)
        for kind, curves in _joints(legs).items()
    ]
    if not rows:
        return None
    drawn = grid(rows[:_MOST_ROWS], _AXIS, _LEG_PIXELS, list(_columns(walk)))
    return Drawing("legs", "Legs over the gait cycle", _clearances(walk), _LEGS, *drawn)


def _known(curves: Sequence[Shape]) -> dict[int, Curve]:
    return {foot: curve for foot, curve in enumerate(curves) if curve}


def _columns(walk: Walk) -> dict[str, list[int]]:
    """Return the feet of each pair of legs by its heading, or all feet without one."""
    pairs: dict[str, list[int]] = {title: [] for title in _ENDS.values()}
    for foot, each in enumerate(walk.feet):
        if each.leg_position is None or each.leg_position[0] not in _ENDS:
            return {"": list(range(len(walk.feet)))}
        pairs[_ENDS[each.leg_position[0]]].append(foot)
    pairs = {title: feet for title, feet in pairs.items() if feet}
    return pairs if len(pairs) > 1 else {"": list(range(len(walk.feet)))}


def _row(
    walk: Walk,
    title: str,
    unit: str,
    hover: str,
    curves: Mapping[int, Curve],
    *,
    scale: float = 1.0,
    least: float = 0.0,
    with_zero: bool = False,
) -> Row:
    """Return the panels of one quantity, a curve a foot."""
    traces = [
        (column, trace)
        for column, feet in enumerate(_columns(walk).values())
        for foot in feet
        if foot in curves
        for trace in _band(walk, foot, curves[foot], scale, hover, unit)
    ]
    values = np.concatenate([[*each.lower, *each.upper] for each in curves.values()]) * scale
    return Row(f"{title} ({unit})", traces, extent_of(values, least, with_zero=with_zero))


def _band(
    walk: Walk, foot: int, curve: Curve, scale: float, hover: str, unit: str
) -> tuple[Trace, Trace]:
    """Return the spread and the line of a foot, dashed on the right."""
    record, colour = walk.feet[foot], foot_colour(foot)
    name, side = label(record.name), (record.leg_position or ("", record.name))[1]
    percent = np.array(curve.percent).round(3)
    lower, middle, upper = (
        scale * np.array(each) for each in (curve.lower, curve.median, curve.upper)
    )
    outline = np.concatenate([percent, percent[::-1]]), np.concatenate([upper, lower[::-1]])
    value, least, most = (f"%{{{of}:{hover}}}" for of in ("y", "customdata[0]", "customdata[1]"))
    return (
        area(*outline, f"{name} spread", colour, 0.2),
        line(
            percent,
            middle,
            name,
            {"color": colour, "width": 2, "dash": "dash" if side == "right" else "solid"},
            # The page finds the foot's stride by the index.
            {
                "meta": {"foot": foot},
                "customdata": np.stack([lower, upper], axis=1),
                "hovertemplate": f"{value} {unit} ({least} to {most})",
            },
        ),
    )


def _joints(legs: LegFigures) -> dict[str, dict[int, Curve]]:
    """Return the curves of each kind of joint, by foot: joints of different legs that are alike."""
    kinds = {}
    for pair in legs.settings.pairs:
        end, _, rest = pair.name.partition("_")
        kind = rest if end in _ENDS and rest else pair.name
        kinds[pair.left] = kinds[pair.right] = kind.removesuffix("_joint").replace("_", " ")
    numbers = {leg.name: row for row, leg in enumerate(legs.feet)}
    found: dict[str, dict[int, Curve]] = {}
    for name, joint in legs.metrics.joints.items():
        if joint.position_over_stride is not None and joint.foot is not None:
            curves = found.setdefault(kinds.get(name, name), {})
            curves[numbers[joint.foot]] = joint.position_over_stride
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
