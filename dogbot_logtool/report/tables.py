"""Tables of metrics: which column shows what, and how."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Generic, TypeVar

from dogbot_logtool.core.arrays import Aggregate
from dogbot_logtool.core.metrics import (
    Foot,
    Joint,
    LoadShare,
    Phase,
    Symmetry,
    TopicQuality,
    WalkMetrics,
)
from dogbot_logtool.core.records import Number
from dogbot_logtool.report.numbers import NOTHING, decimal, percent

if TYPE_CHECKING:
    from dogbot_logtool.core.legs.legs import LegFoot
    from dogbot_logtool.core.walk import Walk

S = TypeVar("S")


# Without slots, which `Column[...](...)` cannot be called with before Python 3.12.
@dataclass(frozen=True)
class Column(Generic[S]):
    """A column of a table."""

    header: str
    of: Callable[[S], Any]
    """Takes its value from the source of a row: a number, a text or an aggregate; None: none."""
    decimals: int | None = None
    """None: as it is."""
    scale: float = 1.0
    """Multiplies the value, for a unit that is easier to read."""
    statistic: str = "median"
    """Member of an aggregate that is shown."""
    is_share: bool = False
    """Whether it is shown in percent."""
    is_signed: bool = False
    """Whether it is shown with its sign, also above 0."""


@dataclass(frozen=True, slots=True)
class FootRow:
    """The source of a foot's row."""

    foot: Foot
    phase: Phase
    share: Number
    """Of the load."""
    leg: "LegFoot | None"
    """What else is known of its leg."""


def foot_rows(walk: WalkMetrics, stats: "Walk") -> dict[str, FootRow]:
    """Return the source of each foot's row, by its name."""
    shares = walk.forces.load_share.feet or {}
    legs = {} if stats.legs is None else {leg.name: leg for leg in stats.legs.feet}
    return {
        name: FootRow(foot, walk.gait.phase[name], shares.get(name), legs.get(name))
        for name, foot in walk.feet.items()
    }


def grouped_load(share: LoadShare) -> list[tuple[str, float]]:
    """Return the share of the load of groups of feet, by name, where it is known."""
    pairs = (("fore", "hind", share.fore), ("left", "right", share.left))
    return [
        named
        for name, other, part in pairs
        if part is not None
        for named in ((name, part), (other, 1.0 - part))
    ]


def headers(columns: Sequence[Column[S]]) -> tuple[str, ...]:
    """Return the headings of a table, each once."""
    return tuple(dict.fromkeys(each.header for each in columns))


def cells_of(columns: Sequence[Column[S]], source: S) -> list[str]:
    """Return the cells of a row, one for each of the `headers`.

    Of columns under the same heading the last that is known is shown: body weights where the mass
    is known, else newtons.
    """
    cells = dict.fromkeys(headers(columns), NOTHING)
    for each in columns:
        value = each.of(source)
        if value is not None:
            cells[each.header] = cell(each, value)
    return list(cells.values())


def cell(column: Column[S], value: Any) -> str:  # noqa: ANN401 - any value
    """Write a value, or a statistic of it, as a column shows it."""
    if isinstance(value, Aggregate):
        value = getattr(value, column.statistic)
    if column.is_share:
        return percent(value)
    if column.decimals is None:
        return f"{value:,}" if isinstance(value, int) else str(value)
    if column.is_signed:
        return f"{round(value * column.scale, column.decimals) + 0.0:+.{column.decimals}f}"
    return decimal(value * column.scale, column.decimals)


STEPS: Final[Sequence[Column[FootRow]]] = (
    Column("contact", lambda row: row.foot.contact_fraction, is_share=True),
    Column("strides", lambda row: row.foot.strides),
    Column("stance s", lambda row: row.foot.stance_s, 3),
    Column("swing s", lambda row: row.foot.swing_s, 3),
    Column("duty", lambda row: row.foot.duty_factor, 3),
    Column("phase", lambda row: row.phase.mean, 3),
    Column("R", lambda row: row.phase.consistency, 2),
    Column("length m", lambda row: row.foot.stride_length_m, 3),
)
"""Steps of each foot."""
PAGE_LOADS: Final[Sequence[Column[FootRow]]] = (
    Column("share", lambda row: row.share, is_share=True),
    Column("highest N", lambda row: row.foot.peak_force_n, 1, statistic="max"),
    Column("peak N", lambda row: row.foot.peak_force_n, 1),
    Column("peak BW", lambda row: row.foot.peak_force_bw, 2),
    Column("mean N", lambda row: row.foot.mean_force_n, 1),
    Column("peak Fz N", lambda row: row.foot.peak_vertical_force_n, 1),
    Column("impact", lambda row: row.foot.impact_ratio, 2),
    Column("rate N/s", lambda row: row.foot.loading_rate_nps, 0),
    Column("friction", lambda row: row.foot.friction_use, 2),
    Column("slip mm", lambda row: row.foot.slip_m, 1, 1e3),
)
"""Loads of each foot."""
LEGS: Final[Sequence[Column[FootRow]]] = (
    Column("clearance", lambda row: row.foot.clearance_m, 1, 1e3),
    Column("swing m", lambda row: row.foot.swing_length_m, 3),
    Column("step m", lambda row: row.foot.step_length_m, 3),
    Column("width m", lambda row: row.foot.step_width_m, 3),
    Column("down m/s", lambda row: row.foot.touchdown_down_mps, 3),
    Column("along m/s", lambda row: row.foot.touchdown_along_mps, 3),
)
"""Swings of each foot."""
JOINTS: Final[Sequence[Column[Joint]]] = (
    Column("range", lambda joint: joint.range_of_motion, 3),
    Column("peak speed", lambda joint: joint.peak_speed, 2),
    Column("peak N m", lambda joint: joint.peak_effort, 2),
    Column("RMS N m", lambda joint: joint.rms_effort, 2),
    Column("|work| J", lambda joint: joint.absolute_work_j, 2),
    Column("near limit", lambda joint: joint.near_limit_fraction, is_share=True),
)
TOPICS: Final[Sequence[Column[TopicQuality]]] = (
    Column("messages", lambda topic: topic.messages),
    Column("Hz", lambda topic: topic.rate_hz, 1),
    Column("gaps", lambda topic: topic.gaps),
    Column("gaps s", lambda topic: topic.gaps_total_s, 2),
    Column("longest s", lambda topic: topic.interval_max_s, 2),
    Column("log - stamp s", lambda topic: topic.clock_offset_s, 3),
)
"""Timing of each topic."""
SYMMETRY: Final[Sequence[Column[Symmetry]]] = (
    Column("stance %", lambda pair: pair.stance_s, 1, is_signed=True),
    Column("duty factor %", lambda pair: pair.duty_factor, 1, is_signed=True),
    Column("peak force %", lambda pair: pair.peak_force_n, 1, is_signed=True),
)
"""Right against left of each pair of feet."""
INDEX: Final[Sequence[Column[WalkMetrics]]] = (
    Column("duration s", lambda walk: walk.log.duration_s, 2),
    Column("duty", lambda walk: walk.gait.duty_factor, 3),
    Column("strides/s", lambda walk: walk.gait.stride_frequency_hz, 3),
    Column("distance m", lambda walk: walk.base.path_length_m, 2),
    Column("m/s forward", lambda walk: walk.base.forward_speed_mps, 3),
    Column("impulse/weight", lambda walk: walk.forces.vertical_impulse_over_weight, 3),
)
"""Several logs on the page."""
