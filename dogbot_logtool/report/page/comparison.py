"""The page that shows two sides side by side: can they be compared, and what differs?"""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any, Final

from markupsafe import Markup

from dogbot_logtool import __version__
from dogbot_logtool.comparison.walks import CONFIDENCE, FigureDifference, GaitComparison
from dogbot_logtool.report.numbers import NOTHING
from dogbot_logtool.report.page.assets import own, rendered
from dogbot_logtool.report.page.charts.comparison_figures import (
    PANEL,
    STANCES,
    Json,
    Sides,
    cycle_panels,
    stance_bars,
)

MOST_NAMES: Final = 6
"""Logs of a side that are named."""
_CURVES: Final = (("vertical_over_stride_n", "vertical"), ("forward_over_stride_n", "forward"))
_STEPS: Final = frozenset({"touchdown", "lift_off"})


@dataclass(frozen=True, slots=True)
class SideRow:
    """A figure of a whole side, beside the other side's."""

    name: str
    first: str
    second: str


@dataclass(frozen=True, slots=True)
class DifferenceRow:
    """A figure of one foot, with its difference."""

    name: str
    cells: tuple[str, ...]
    """The numbers of `COLUMNS`."""
    mark: str
    """``more``, ``less``, or nothing where it does not differ."""


COLUMNS: Final = (
    "first", "second", "difference", "in %", f"{CONFIDENCE:.0%} from", "to", "effect", "strides",
)  # fmt: skip


def comparison_page(found: GaitComparison, sides: Sides) -> bytes:
    """Return the HTML page.

    Args:
        found: how both sides walk.
        sides: ``stats --json`` of the logs of either side, in the order of `found.sides`.
    """
    panels = [(name, cycle_panels(sides, curve)) for curve, name in _CURVES]
    return rendered(
        "comparison.html.j2",
        version=__version__,
        css=Markup(own("page.css")),  # noqa: S704 - our own file
        names=[_names(side) for side in found.sides],
        found=found,
        confidence=f"{CONFIDENCE:.0%}",
        columns=COLUMNS,
        rows=[_row(each) for each in found.differences],
        sides=list(_side_rows(sides)),
        panels=[(name, each) for name, each in panels if each],
        panel=PANEL,
        stances=stance_bars(sides),
        sizes=STANCES,
    )


def _names(logs: Sequence[str]) -> str:
    shown = ", ".join(logs[:MOST_NAMES])
    if len(logs) == 1:
        return shown
    more = len(logs) - MOST_NAMES
    return f"{len(logs)} logs: {shown}" + (f" and {more} more" if more > 0 else "")


def _row(each: FigureDifference) -> DifferenceRow:
    low, high = each.interval
    share = each.difference / abs(each.medians[0]) * 100.0 if each.medians[0] else None
    numbers = [f"{number:.4g}" for number in (*each.medians, each.difference)]
    cells = (
        *numbers,
        NOTHING if share is None else f"{share:+.1f}",
        f"{low:.4g}",
        f"{high:.4g}",
        f"{each.effect:+.1f}",
        f"{each.counts[0]} / {each.counts[1]}",
    )
    mark = ("more" if each.difference > 0.0 else "less") if each.differs else ""
    return DifferenceRow(f"{each.foot} {each.figure}", cells, mark)


def _side_rows(sides: Sides) -> Iterator[SideRow]:
    """Yield what is known of whole sides: of several logs the classes, sums and medians."""
    for name, value in _OF_A_SIDE:
        yield SideRow(name, *(value(side) for side in sides))
    events = [Counter(_events(side)) for side in sides]
    for kind in sorted(events[0] | events[1]):
        yield SideRow(f"events: {kind.replace('_', ' ')}", *(str(each[kind]) for each in events))


def _events(side: Sequence[Json]) -> Iterator[str]:
    for document in side:
        yield from (each["type"] for each in document["events"] if each["type"] not in _STEPS)


def _classes(side: Sequence[Json]) -> str:
    return ", ".join(dict.fromkeys(d["gait"]["name"] or "not known" for d in side))


def _strides(side: Sequence[Json]) -> str:
    return str(sum(foot["strides"] or 0 for document in side for foot in document["feet"].values()))


def _seconds(side: Sequence[Json]) -> str:
    known = [document["log"]["duration_s"] for document in side]
    return f"{sum(each for each in known if each is not None):.1f} s"


def _failed(side: Sequence[Json]) -> str:
    """Name the checks of the recordings that failed."""
    names = [
        check["name"]
        for document in side
        for check in document["quality"]["checks"]
        if check["outcome"] == "failed"
    ]
    return ", ".join(dict.fromkeys(names)) or "none"


def _middle(path: str, unit: str, decimals: int) -> Callable[[Sequence[Json]], str]:
    """Return what words the median of a figure over the logs of a side."""

    def words(side: Sequence[Json]) -> str:
        known = [each for each in (_at(document, path) for document in side) if each is not None]
        return f"{median(known):.{decimals}f}{unit}" if known else NOTHING

    return words


def _at(document: Json, path: str) -> Any:  # noqa: ANN401 - any value of JSON
    value: Any = document
    for key in path.split("."):
        value = None if value is None else value[key]
    return value


_OF_A_SIDE: Final[tuple[tuple[str, Callable[[Sequence[Json]], str]], ...]] = (
    ("gait", _classes),
    ("strides of all feet", _strides),
    ("time", _seconds),
    ("stride frequency", _middle("gait.stride_frequency_hz", " Hz", 3)),
    ("duty factor", _middle("gait.duty_factor", "", 3)),
    ("forward speed", _middle("base.forward_speed_mps", " m/s", 3)),
    ("vertical impulse over weight", _middle("forces.vertical_impulse_over_weight", "", 3)),
    ("static margin", _middle("stability.static_margin_m.median", " m", 3)),
    ("mass", _middle("settings.mass_kg", " kg", 2)),
    ("checks of the recording that failed", _failed),
)
