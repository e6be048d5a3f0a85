"""The page that shows two sides side by side: can they be compared, and what differs?

It needs no script: curves and bars are drawn as SVG, in pixels from its upper left corner.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from statistics import median
from typing import Any, Final, NamedTuple

import numpy as np

from dogbot_logtool.comparison.walks import CONFIDENCE, GaitComparison, MetricDifference
from dogbot_logtool.core.arrays import Floats, median_of
from dogbot_logtool.core.events import STEPS
from dogbot_logtool.core.records import METRICS, MetricPath
from dogbot_logtool.io.printable import listed
from dogbot_logtool.report.page.assets import rendered
from dogbot_logtool.report.page.chart import extent_of
from dogbot_logtool.report.tables import NOTHING, nice_step

Json = Mapping[str, Any]
Sides = tuple[Sequence[Json], Sequence[Json]]
"""``stats --json`` of the logs of either side."""
MOST_NAMES: Final = 6
"""Logs of a side that are named."""
COLUMNS: Final = (
    "first", "second", "difference", "in %", f"{CONFIDENCE:.0%} from", "to", "effect", "strides",
)  # fmt: skip
_CURVES: Final = {
    "vertical": METRICS.vertical_over_stride_n,
    "forward": METRICS.forward_over_stride_n,
}
_PANEL: Final = {"width": 300, "height": 170, "left": 46, "right": 294, "top": 22, "bottom": 148}
"""Sizes of a panel, and edges of what is drawn in it."""
_STANCES: Final = {"name": 110, "row": 34, "bar": 9, "cycle": 640}
"""Sizes of the drawing of stances: width of the names, heights, and width of a stride."""


def comparison_page(found: GaitComparison, sides: Sides) -> bytes:
    """Return the HTML page.

    Args:
        found: how both sides walk.
        sides: ``stats --json`` of the logs of either side, in the order of `found.sides`.
    """
    first, second = (side[0]["feet"] for side in sides)
    feet = [foot for foot in first if foot in second]
    return rendered(
        "comparison.html.j2",
        names=[_names(side) for side in found.sides],
        found=found,
        confidence=f"{CONFIDENCE:.0%}",
        columns=COLUMNS,
        rows=[(each, _cells(each)) for each in found.differences],
        sides=list(_side_rows(sides)),
        panels={name: each for name, of in _CURVES.items() if (each := _panels(sides, feet, of))},
        panel=_PANEL,
        stances=_stances(sides, feet),
        sizes=_STANCES,
    )


def _names(logs: Sequence[str]) -> str:
    return logs[0] if len(logs) == 1 else f"{len(logs)} logs: {listed(logs, MOST_NAMES)}"


def _cells(each: MetricDifference) -> list[str]:
    share = each.difference / abs(each.medians[0]) if each.medians[0] else None
    return [
        *(f"{number:.4g}" for number in (*each.medians, each.difference)),
        NOTHING if share is None else f"{share * 100.0:+.1f}",
        *(f"{number:.4g}" for number in each.interval),
        f"{each.effect:+.1f}",
        f"{each.strides[0]} / {each.strides[1]}",
    ]


class Panel(NamedTuple):
    """The curves of one foot, of both sides."""

    title: str
    curves: list[tuple[str, str] | None]
    """Of either side the median and the outline between the quartiles, as points of SVG."""
    ticks: list[tuple[float, str]]
    """y and text of each tick of the force."""


def _panels(sides: Sides, feet: Sequence[str], of: MetricPath) -> list[Panel]:
    """Lay the curves over the gait cycle of both sides over each other, a panel a foot.

    All are on one scale; there are none where neither side knows the curve.
    """
    found = {foot: [_median_curve(side, foot, of) for side in sides] for foot in feet}
    known = [each for pair in found.values() for each in pair if each is not None]
    if not known:
        return []
    low, high = extent_of(np.concatenate([each[1:].ravel() for each in known]), with_zero=True)
    per_unit = (_PANEL["bottom"] - _PANEL["top"]) / (high - low)

    def points(percent: Floats, value: Floats) -> str:
        x = _PANEL["left"] + percent / 100.0 * (_PANEL["right"] - _PANEL["left"])
        y = _PANEL["top"] + (high - value) * per_unit
        return " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x.tolist(), y.tolist(), strict=True))

    def drawn(curve: Floats | None) -> tuple[str, str] | None:
        if curve is None:
            return None
        percent, lower, middle, upper = curve
        there_and_back = np.append(percent, percent[::-1])
        return points(percent, middle), points(there_and_back, np.append(lower, upper[::-1]))

    step = nice_step((high - low) / 4.0)
    values = step * np.arange(np.ceil(low / step), np.floor(high / step) + 1.0)
    ticks = [(_PANEL["top"] + (high - each) * per_unit, f"{each:zg}") for each in values.tolist()]
    return [Panel(foot, [drawn(each) for each in pair], ticks) for foot, pair in found.items()]


def _median_curve(side: Sequence[Json], foot: str, of: MetricPath) -> Floats | None:
    """(4, n) percent, lower quartile, median and upper quartile: the medians over the logs."""
    curves = [of.value_in(document["feet"].get(foot, {})) for document in side]
    parts = ("percent", "lower", "median", "upper")
    known = [[curve[part] for part in parts] for curve in curves if curve]
    return median_of(np.array(known, np.float64), axis=0) if known else None


def _stances(sides: Sides, feet: Sequence[str]) -> dict[str, list[list[tuple[float, float]]]]:
    """Return x and width of the bars of either side, by foot; none where phases are unknown."""
    bars = {foot: [_bars(side, foot) for side in sides] for foot in feet}
    return bars if any(any(pair) for pair in bars.values()) else {}


def _bars(side: Sequence[Json], foot: str) -> list[tuple[float, float]]:
    """Return the stance of a foot in a stride, in two where it goes over the stride's end.

    Of several logs it is the mean of the phases, with the median of the duty factors.
    """
    phase_of, duty_of = METRICS.gait.phase[foot], METRICS.feet[foot].duty_factor
    pairs = [(phase_of.value_in(each), duty_of.value_in(each)) for each in side]
    known = [
        (phase["mean"], duty["median"])
        for phase, duty in pairs
        if phase and duty and phase["mean"] is not None
    ]
    if not known:
        return []
    phases, duties = np.array(known).T
    begin = float(np.angle(np.exp(2j * np.pi * phases).mean()) / (2.0 * np.pi)) % 1.0
    begin, duty = 0.0 if begin > 0.9995 else begin, float(median_of(duties))
    parts = [(begin, min(begin + duty, 1.0)), (0.0, begin + duty - 1.0)]
    name, cycle = _STANCES["name"], _STANCES["cycle"]
    return [(name + start * cycle, (end - start) * cycle) for start, end in parts if end > start]


def _side_rows(sides: Sides) -> Iterator[tuple[str, str, str]]:
    """Yield what is known of whole sides: of several logs the classes, sums and medians."""
    for name, words in _OF_A_SIDE.items():
        yield name, words(sides[0]), words(sides[1])
    first, second = (
        Counter(each["type"] for document in side for each in document["events"]) for side in sides
    )
    for kind in sorted((first | second).keys() - STEPS):
        yield f"events: {kind.replace('_', ' ')}", str(first[kind]), str(second[kind])


def _listed(words: Iterator[str], otherwise: str) -> str:
    return ", ".join(dict.fromkeys(words)) or otherwise


def _classes(side: Sequence[Json]) -> str:
    return _listed((each["gait"]["name"] or "not known" for each in side), "")


def _strides(side: Sequence[Json]) -> str:
    return str(sum(foot["strides"] or 0 for each in side for foot in each["feet"].values()))


def _seconds(side: Sequence[Json]) -> str:
    return f"{sum(METRICS.log.duration_s.value_in(document) or 0.0 for document in side):.1f} s"


def _failed(side: Sequence[Json]) -> str:
    """Name the checks of the recordings that failed."""
    checks = (check for document in side for check in document["quality"]["checks"])
    return _listed((each["name"] for each in checks if each["outcome"] == "failed"), "none")


def _middle(path: MetricPath, unit: str, decimals: int) -> Callable[[Sequence[Json]], str]:
    """Return what words the median of a metric over the logs of a side."""

    def words(side: Sequence[Json]) -> str:
        known = [
            each for each in (path.value_in(document) for document in side) if each is not None
        ]
        return f"{median(known):.{decimals}f}{unit}" if known else NOTHING

    return words


_OF_A_SIDE: Final[Mapping[str, Callable[[Sequence[Json]], str]]] = {
    "gait": _classes,
    "strides of all feet": _strides,
    "time": _seconds,
    "stride frequency": _middle(METRICS.gait.stride_frequency_hz, " Hz", 3),
    "duty factor": _middle(METRICS.gait.duty_factor, "", 3),
    "forward speed": _middle(METRICS.base.forward_speed_mps, " m/s", 3),
    "vertical impulse over weight": _middle(METRICS.forces.vertical_impulse_over_weight, "", 3),
    "static margin": _middle(METRICS.stability.static_margin_m.median, " m", 3),
    "mass": _middle(METRICS.settings.mass_kg, " kg", 2),
    "checks of the recording that failed": _failed,
}
