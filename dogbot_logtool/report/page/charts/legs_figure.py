"""Legs over the gait cycle: height of the feet, and motion of the joints, left over right."""

from typing import Final

import numpy as np

from dogbot_logtool.core.legs.legs import LegFigures
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.page.charts.drawing import Drawing
from dogbot_logtool.report.page.charts.panels import Band, PanelRow, over_cycle

_MOST_ROWS: Final = 8
"""Panels above each other."""
_ROW_PIXELS: Final = 190
_LEAST_RAD: Final = 0.05
"""Span of a joint's row at least: what rests shows no noise."""
_CAPTION: Final = (
    "0 % is the foot's own touchdown; dashed: legs on the right. Foot: height above the line "
    "between its footfalls. Joints: position. Median and quartiles over whole strides."
)


def legs_over_cycle(stats: Stats) -> Drawing | None:
    """Draw a panel a pair of legs and kind of joint; None where no legs are known."""
    legs = stats.legs
    rows = [] if legs is None else [*_heights(legs), *_joints(legs)][:_MOST_ROWS]
    if not rows:
        return None
    chart = over_cycle(stats, rows, _ROW_PIXELS)
    return Drawing("legs", "Legs over the gait cycle", _words(stats, legs), _CAPTION, chart)


def _heights(legs: LegFigures) -> list[PanelRow]:
    """Return the row of the feet's heights, if any is known."""
    bands = {
        foot: Band(
            curve.percent, *(1e3 * each for each in (curve.lower, curve.median, curve.upper))
        )
        for foot, leg in enumerate(legs.feet)
        if (curve := leg.height) is not None
    }
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
        parts = (curve.percent, curve.lower, curve.median, curve.upper)
        band = Band(*(np.array(each) for each in parts))
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


def _words(stats: Stats, legs: LegFigures | None) -> str:
    known = [] if legs is None else [leg for leg in legs.feet if leg.height is not None]
    medians = (1e3 * float(np.nanmedian(leg.strides["clearance_m"])) for leg in known)
    clear = ", ".join(
        f"{printable(leg.name)} {median:.0f} mm" for leg, median in zip(known, medians, strict=True)
    )
    joints = [] if legs is None else list(legs.metrics.joints.values())
    moving = sum(joint.position_over_stride is not None for joint in joints)
    text = f"Motion of {moving} joints over the stride of their {len(stats.feet)} feet."
    return f"{text} Clearance of the feet: {clear}." if clear else text
