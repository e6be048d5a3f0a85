"""Figures of how the load is shared, and of stability."""

from collections.abc import Mapping, Sequence
from typing import Final

from dogbot_logtool.core.gait.foot_statistics import FootStatistics
from dogbot_logtool.core.geometry.aggregates import Aggregate
from dogbot_logtool.core.load.load_figures import (
    LoadFigures,
    grouped_shares,
    symmetry_index_percent,
)
from dogbot_logtool.core.stability.stability import Stability
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.report.figures.figure import (
    Column,
    Figure,
    Kind,
    Member,
    Scope,
    Shape,
    TableName,
    inside,
)

_SYMMETRY, _LOG_ROWS = TableName.SYMMETRY, TableName.LOG_ROWS
_NO_POSITION: Final = "the leg position of a foot is not known"
_NO_SIDE: Final = "it is not known for both feet"
WRENCH_FRAMES: Final = ("world", "link", "unknown")


@dataclass(frozen=True, slots=True)
class LoadShares:
    """Each foot's share of the load, and that of feet together."""

    feet: Mapping[str, float]
    groups: Mapping[str, float | None]
    """``fore``, ``hind``, ``left`` and ``right``."""


@dataclass(frozen=True, slots=True)
class Pair:
    """Two feet of a fore or hind pair."""

    left: FootStatistics
    right: FootStatistics

    def index_percent(self, left: Aggregate | None, right: Aggregate | None) -> float | None:
        """Return the symmetry index of two means."""
        means = [None if each is None else each.mean for each in (left, right)]
        return symmetry_index_percent(*means)


@dataclass(frozen=True, slots=True)
class LoadSource:
    """The source of figures of loads."""

    loads: LoadFigures
    """Over the whole log, or in a segment of it."""
    feet: Sequence[FootStatistics]
    """Likewise."""
    corners: tuple[int, int, int, int] | None
    """As in `Stats`."""

    @property
    def shares(self) -> LoadShares | None:
        """The shares of the load; None where they are not known."""
        shares = self.loads.shares
        if shares is None:
            return None
        names = [foot.name for foot in self.feet]
        groups = grouped_shares(shares, [foot.leg_position for foot in self.feet])
        return LoadShares(dict(zip(names, shares, strict=True)), groups)

    @property
    def pairs(self) -> "dict[str, Pair] | None":
        """The fore and the hind pair of a quadruped; None for other robots."""
        if self.corners is None:
            return None
        feet = [self.feet[foot] for foot in self.corners]
        return {"fore": Pair(feet[0], feet[1]), "hind": Pair(feet[2], feet[3])}


def load_source(stats: Stats) -> LoadSource:
    """Return what the figures of the loads over the whole log are taken from."""
    return LoadSource(stats.loads, stats.feet, stats.corners)


_INDICES: Final[Sequence[Figure[Pair]]] = (
    Figure(
        "stance_s",
        Kind.NUMBER,
        lambda pair: pair.index_percent(pair.left.stance_s, pair.right.stance_s),
        "of the mean stance durations",
        unit="%",
        null=_NO_SIDE,
        columns=(Column(_SYMMETRY, "stance %", 1, signed=True),),
    ),
    Figure(
        "duty_factor",
        Kind.NUMBER,
        lambda pair: pair.index_percent(pair.left.duty_factor, pair.right.duty_factor),
        "of the mean duty factors",
        unit="%",
        null=_NO_SIDE,
        columns=(Column(_SYMMETRY, "duty factor %", 1, signed=True),),
    ),
    Figure(
        "peak_force_n",
        Kind.NUMBER,
        lambda pair: pair.index_percent(pair.left.peak_force_n, pair.right.peak_force_n),
        "of the mean peak forces",
        unit="%",
        null=_NO_SIDE,
        columns=(Column(_SYMMETRY, "peak force %", 1, signed=True),),
    ),
)


def _share_of(group: str) -> Figure[LoadShares]:
    return Figure(
        group,
        Kind.NUMBER,
        lambda shares: shares.groups[group],
        f"sum of the {group} feet",
        null=_NO_POSITION,
    )


_SHARES: Final[Sequence[Figure[LoadShares]]] = (
    Figure(
        "feet",
        Kind.NUMBERS_BY_NAME,
        lambda shares: dict(shares.feet),
        "share of each foot; they add up to 1",
        columns=(
            Column(TableName.LOADS, "share", rank=10, percent=True),
            Column(TableName.PAGE_LOADS, "share", rank=10, percent=True),
        ),
    ),
    *(_share_of(group) for group in ("fore", "hind", "left", "right")),
)
FORCES_OF_SEGMENT: Final[Sequence[Member]] = (
    Figure[LoadSource](
        "vertical_impulse_over_weight",
        Kind.NUMBER,
        lambda source: source.loads.vertical_impulse_over_weight,
        "sum over the feet of the integral of the vertical force / (m g t), over the time t of "
        "`known_s`: 1 for a sound recording",
        null="the mass is not known, or assumed and refuted by the forces; a sensor gives no "
        "force; wrenches are not known in the world frame; no contact at all; no time is known to "
        "all feet",
        columns=(
            Column(TableName.SUMMARY, "impulse/weight", 4, rank=50),
            Column(TableName.INDEX, "impulse/weight", 3, rank=60),
            Column(_LOG_ROWS, "vertical_impulse_over_weight", rank=70),
        ),
    ),
    Figure[LoadSource](
        "known_s",
        Kind.AMOUNT,
        lambda source: source.loads.known_s,
        "time that these figures are over: whole strides of one foot in which all feet are known, "
        "or all time known to all feet where there are no such strides",
    ),
    Figure[LoadSource](
        "over_strides",
        Kind.FLAG,
        lambda source: source.loads.over_strides,
        "whether `known_s` is whole strides",
    ),
    Figure[LoadSource](
        "mean_vertical_n",
        Kind.NUMBER,
        lambda source: source.loads.mean_vertical_n,
        "mean of the feet's summed vertical force over `known_s`",
        null="a sensor gives no force; wrenches are not known in the world frame; no contact",
    ),
    Figure[LoadSource](
        "weight_n",
        Kind.NUMBER,
        lambda source: source.loads.weight_n,
        "weight that figures in body weights rest on: m g, else `mean_vertical_n` over strides",
        null="neither is known; the feet's forces miss m g by more than 20 %",
    ),
    Figure[LoadSource](
        "weight_source",
        Kind.TEXT,
        lambda source: source.loads.weight_source,
        "where `weight_n` comes from",
        null="there is none",
        choices=("mass", "estimated"),
    ),
    Figure[LoadSource](
        "load_share_of",
        Kind.TEXT,
        lambda source: source.loads.share_of,
        "what the shares are of: the vertical impulse, or the integral of |F| where the direction "
        "of the force is not known",
        null="there are no shares",
        choices=("vertical_impulse", "force_impulse"),
    ),
    Scope(
        "load_share",
        _SHARES,
        lambda source: source.shares,
        "share of the impulse over `known_s`",
        null="a foot's load is not known, or there is none; the feet's forces miss m g; no whole "
        "stride of feet that step",
    ),
    Scope(
        "symmetry_index_percent",
        _INDICES,
        lambda source: source.pairs,
        "of the fore and the hind pair: 100 (R - L) / ((R + L) / 2), 0 where right and left are "
        "equal (Robinson, Herzog and Nigg 1987)",
        null="not four feet whose leg positions are known",
        shape=Shape.BY_NAME,
    ),
)
"""Figures of a `LoadSource`."""

FORCES: Final[Sequence[Member]] = (
    *inside(FORCES_OF_SEGMENT, load_source),
    Figure[Stats](
        "wrench_frame",
        Kind.TEXT,
        lambda stats: str(stats.settings.wrench_frame),
        "as in `settings`",
        choices=WRENCH_FRAMES,
    ),
)
"""Figures of the loads of all feet, from `Stats`."""

_NO_PRESSURE: Final = "the vertical forces are not known; no foot with a contact point is loaded"
STABILITY: Final[Sequence[Figure[Stability]]] = (
    Figure(
        "static_margin_m",
        Kind.AGGREGATE,
        lambda found: found.static_margin_m,
        "signed distance of the ground projection of the base, or of the centre of mass that "
        "`settings.com_offset_m` gives, to the edge of the support polygon, positive inside "
        "(McGhee and Frank 1968)",
        null="there are never three feet with a contact point down at once",
    ),
    Figure(
        "energy_margin_m",
        Kind.AGGREGATE,
        lambda found: found.energy_margin_m,
        "by how much the same point must rise to tip over an edge of the support polygon, on a "
        "slope, too, where it is inside: the energy stability margin over the weight (Messuri and "
        "Klein 1985)",
        null="there are never three feet with a contact point down at once; the base's height over "
        "the feet is not known",
    ),
    Figure(
        "unknown_fraction",
        Kind.FRACTION,
        lambda found: found.unknown_fraction,
        "share of the time in which the base, or whether and where a foot stands, is not known",
    ),
    Figure(
        "undefined_fraction",
        Kind.FRACTION,
        lambda found: found.undefined_fraction,
        "share of the time with fewer than three feet down: no polygon",
        null="the base and the feet are never known together",
    ),
    Figure(
        "unstable_fraction",
        Kind.FRACTION,
        lambda found: found.unstable_fraction,
        "share of the time with a polygon whose margin is negative; what is left of 1 is stable",
        null="there is never a polygon",
    ),
    Figure(
        "centre_of_pressure_forward_m",
        Kind.AGGREGATE,
        lambda found: found.pressure_forward_m,
        "centre of pressure ahead of the base: mean of the contact points, weighted by vertical "
        "force",
        null=_NO_PRESSURE,
    ),
    Figure(
        "centre_of_pressure_left_m",
        Kind.AGGREGATE,
        lambda found: found.pressure_left_m,
        "the same to the left of the base",
        null=_NO_PRESSURE,
    ),
)
"""Figures of stability, at up to 100 Hz over the time known to all feet and the base."""
