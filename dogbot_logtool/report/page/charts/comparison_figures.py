"""The figures of a page that compares two sides, as lines and bars that need no script.

Coordinates are those of the drawing: pixels from its upper left corner.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, median_of

WIDTH, HEIGHT = 300.0, 170.0
"""Size of a panel."""
LEFT, RIGHT, TOP, BOTTOM = 46.0, 6.0, 22.0, 22.0
"""Margins of a panel."""
_TICKS: Final = 4
_BAR: Final = 9.0
"""Height of a bar of a stance."""
_ROW: Final = 34.0
"""Height of a foot's two bars, and what separates them from the next foot's."""
_NAME: Final = 110.0
"""Width of the names beside them."""
_CYCLE: Final = 640.0
"""Width of a stride."""

Json = Mapping[str, Any]
Sides = tuple[Sequence[Json], Sequence[Json]]
"""``stats --json`` of the logs of either side."""


@dataclass(frozen=True, slots=True)
class SideCurve:
    """A curve of one side, as points of SVG."""

    line: str
    """The median."""
    band: str
    """Outline between the quartiles."""


@dataclass(frozen=True, slots=True)
class Panel:
    """The curves of one foot, of both sides."""

    title: str
    curves: tuple[SideCurve | None, SideCurve | None]
    ticks: tuple[tuple[float, str], ...]
    """y and text of each tick of the force."""
    percents: tuple[tuple[float, str], ...]
    """x and text of each tick of the stride."""


@dataclass(frozen=True, slots=True)
class StanceBars:
    """When a foot is down in the stride of the reference foot, on both sides."""

    foot: str
    y: float
    bars: tuple[tuple[tuple[float, float], ...], tuple[tuple[float, float], ...]]
    """x and width of each bar, of either side; a stance over the end of the stride is two."""


def cycle_panels(sides: Sides, curve: str) -> list[Panel]:
    """Lay the force over the gait cycle of both sides over each other, a panel a foot.

    Args:
        sides: figures of both sides.
        curve: key of a curve of a foot.

    Returns:
        panels on one scale; none where neither side knows the force.
    """
    feet = [foot for foot in sides[0][0]["feet"] if all(foot in side[0]["feet"] for side in sides)]
    known = {foot: [_of_side(side, foot, curve) for side in sides] for foot in feet}
    every = [each for pair in known.values() for each in pair if each is not None]
    if not every:
        return []
    low, high = _extent(every)
    ticks = tuple((_y(value, low, high), f"{value:g}") for value in _nice(low, high))
    percents = tuple((_x(value), f"{value:.0f} %") for value in (0.0, 50.0, 100.0))
    return [
        Panel(foot, (_points(one, low, high), _points(other, low, high)), ticks, percents)
        for foot, (one, other) in known.items()
    ]


def _of_side(side: Sequence[Json], foot: str, curve: str) -> Floats | None:
    """(4, n) percent, lower quartile, median and upper quartile: the medians over the logs."""
    found = [_curve(document, foot, curve) for document in side]
    known = [each for each in found if each is not None]
    return median_of(np.stack(known), axis=0) if known else None


def _curve(document: Json, foot: str, curve: str) -> Floats | None:
    found = document["feet"].get(foot, {}).get(curve)
    if not found:
        return None
    keys = ("percent", "lower", "median", "upper")
    return np.array([found[key] for key in keys], np.float64)


def _extent(curves: Sequence[Floats]) -> tuple[float, float]:
    """Return the lowest and the highest force of the panels, 0 among them."""
    low = min(0.0, *(float(each[1:].min()) for each in curves))
    high = max(0.0, *(float(each[1:].max()) for each in curves))
    pad = 0.04 * (high - low) or 1.0
    return low - pad * (low < 0.0), high + pad


def _points(curve: Floats | None, low: float, high: float) -> SideCurve | None:
    if curve is None:
        return None
    x = _x(curve[0])
    lower, median, upper = (_y(each, low, high) for each in curve[1:])
    band = np.concatenate([x, x[::-1]]), np.concatenate([lower, upper[::-1]])
    return SideCurve(_joined(x, median), _joined(*band))


def _x(percent: Any) -> Any:  # noqa: ANN401 - a number or an array of them
    return LEFT + percent / 100.0 * (WIDTH - LEFT - RIGHT)


def _y(force: Any, low: float, high: float) -> Any:  # noqa: ANN401 - a number or an array of them
    return TOP + (high - force) / (high - low) * (HEIGHT - TOP - BOTTOM)


def _joined(x: Floats, y: Floats) -> str:
    return " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x.tolist(), y.tolist(), strict=True))


def _nice(low: float, high: float) -> Iterator[float]:
    """Yield round numbers from the lowest to the highest."""
    rough = (high - low) / _TICKS
    unit = 10.0 ** math.floor(math.log10(rough))
    step = next(each * unit for each in (1.0, 2.0, 5.0, 10.0) if each * unit >= rough)
    for number in range(math.ceil(low / step), math.floor(high / step) + 1):
        yield number * step


def stance_bars(sides: Sides) -> list[StanceBars]:
    """Return when each foot is down in a stride, on both sides; none where phases are unknown."""
    feet = [foot for foot in sides[0][0]["feet"] if all(foot in side[0]["feet"] for side in sides)]
    found = [(foot, tuple(_bars(side, foot) for side in sides)) for foot in feet]
    if not any(bars for _, pair in found for bars in pair):
        return []
    return [
        StanceBars(foot, row * _ROW, (pair[0], pair[1])) for row, (foot, pair) in enumerate(found)
    ]


def _bars(side: Sequence[Json], foot: str) -> tuple[tuple[float, float], ...]:
    """Return x and width of the stances of a foot in a stride: means over the logs."""
    stances = [_stance(document, foot) for document in side]
    known = [each for each in stances if each is not None]
    if not known:
        return ()
    phases, duties = np.array(known).T
    turn = np.exp(2j * np.pi * phases).mean()
    begin, duty = float(np.angle(turn) / (2.0 * np.pi)) % 1.0, float(median_of(duties))
    begin = 0.0 if begin > 0.9995 else begin
    parts = [(begin, min(begin + duty, 1.0))]
    if begin + duty > 1.0:
        parts.append((0.0, begin + duty - 1.0))
    return tuple((_NAME + start * _CYCLE, (end - start) * _CYCLE) for start, end in parts)


def _stance(document: Json, foot: str) -> tuple[float, float] | None:
    """Return phase and duty factor of a foot; None where one is not known."""
    phase = (document["gait"]["phase"] or {}).get(foot)
    duty = document["feet"][foot]["duty_factor"]
    if not phase or not duty or phase["mean"] is None:
        return None
    return phase["mean"], duty["median"]


STANCES: Final = {"name": _NAME, "row": _ROW, "bar": _BAR, "cycle": _CYCLE}
"""Sizes of the drawing of stances."""
PANEL: Final = {"width": WIDTH, "height": HEIGHT, "left": LEFT, "right": WIDTH - RIGHT,
                "top": TOP, "bottom": HEIGHT - BOTTOM}  # fmt: skip
"""Sizes of a panel."""
