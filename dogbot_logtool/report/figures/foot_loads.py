"""Figures of the load on each foot."""

from collections.abc import Callable, Sequence
from typing import Final

from dogbot_logtool.core.gait.foot_statistics import FootStatistics
from dogbot_logtool.core.geometry.aggregates import Aggregate
from dogbot_logtool.report.figures.figure import Column, Figure, Kind, TableName, scaled
from dogbot_logtool.report.figures.foot_source import FootSource

_LOADS, _PAGE_LOADS = TableName.LOADS, TableName.PAGE_LOADS
_NO_STANCE: Final = "no stance is seen from touchdown to lift-off"
_NO_FORCE: Final = f"{_NO_STANCE}; the sensor gives no force, or not in N"
_NO_VERTICAL: Final = f"{_NO_FORCE}; its wrenches are not known in the world frame"
_NO_BRAKING: Final = (
    f"{_NO_VERTICAL}; no odometry around the stances; the feet's vertical impulse misses "
    "the weight by more than 5 % (an assumed one: 20 %); forces lean, and neither transforms "
    "nor the weight tell that they are in the world frame"
)
_NO_SLIP: Final = f"{_NO_STANCE}; no contact points there; `settings.foot_rolling_m` is not known"
_NO_MASS: Final = "`forces.weight_n` is not known"


def _force(
    key: str,
    of: Callable[[FootStatistics], Aggregate | None],
    texts: tuple[str, str],
    in_newtons: tuple[Column, ...] = (),
    in_weights: tuple[Column, ...] = (),
) -> tuple[Figure[FootSource], Figure[FootSource]]:
    """Return a force in newtons and in body weights.

    Args:
        key: of both, without the unit.
        of: takes it, N.
        texts: the definition, and when it is not known.
        in_newtons: tables that show newtons.
        in_weights: tables that show body weights.
    """
    definition, null = texts
    return (
        Figure(
            f"{key}_n",
            Kind.AGGREGATE,
            lambda source: of(source.foot),
            definition,
            null,
            columns=in_newtons,
        ),
        Figure(
            f"{key}_bw",
            Kind.AGGREGATE,
            lambda source: scaled(of(source.foot), source.per_weight),
            f"`{key}_n` / `forces.weight_n`",
            f"{null}; {_NO_MASS}",
            columns=in_weights,
        ),
    )


FOOT_FORCES: Final[Sequence[Figure[FootSource]]] = (
    *_force(
        "peak_force",
        lambda foot: foot.peak_force_n,
        (
            "highest force |F| of a stance, lone spikes left out",
            f"{_NO_FORCE}; the sensor is cut off at a limit",
        ),
        (
            Column(_LOADS, "peak |F|", 1, rank=20),
            Column(_PAGE_LOADS, "highest N", 1, rank=20, statistic="max"),
            Column(_PAGE_LOADS, "peak N", 1, rank=30),
        ),
        (Column(_LOADS, "peak |F|", 2, rank=20), Column(_PAGE_LOADS, "peak BW", 2, rank=40)),
    ),
    *_force(
        "mean_force",
        lambda foot: foot.mean_force_n,
        ("mean of |F| over the samples of a stance", _NO_FORCE),
        (Column(_LOADS, "mean |F|", 1, rank=30), Column(_PAGE_LOADS, "mean N", 1, rank=50)),
        (Column(_LOADS, "mean |F|", 2, rank=30),),
    ),
    *_force(
        "peak_vertical_force",
        lambda foot: foot.peak_vertical_force_n,
        (
            "highest vertical force of a stance, upwards in the world, lone spikes left out",
            _NO_VERTICAL,
        ),
        (Column(_LOADS, "peak Fz", 1, rank=40), Column(_PAGE_LOADS, "peak Fz N", 1, rank=60)),
        (Column(_LOADS, "peak Fz", 2, rank=40),),
    ),
    *_force(
        "mean_vertical_force",
        lambda foot: foot.mean_vertical_force_n,
        ("mean vertical force over the samples of a stance", _NO_VERTICAL),
    ),
)
FOOT_LOADING: Final[Sequence[Figure[FootStatistics]]] = (
    Figure(
        "vertical_impulse_ns",
        Kind.NUMBER,
        lambda foot: foot.vertical_impulse_ns,
        "integral of the vertical force over all time known (trapezoid), gaps left out",
        null="nothing is known of the foot; the sensor gives no force, or seems dead; its wrenches "
        "are not known in the world frame",
    ),
    Figure(
        "spikes",
        Kind.COUNT,
        lambda foot: foot.spikes,
        "samples of whole stances, not their first ones, at least twice as high as their "
        "neighbours and the rest of the stance, unless a fifth of the stances have one at the same "
        "phase (an impact); left out of the peaks",
    ),
    Figure(
        "braking_impulse_ns",
        Kind.AGGREGATE,
        lambda foot: foot.braking_impulse_ns,
        "size of the impulse of a stance against the base's forward axis at mid-stance",
        null=_NO_BRAKING,
    ),
    Figure(
        "propulsive_impulse_ns",
        Kind.AGGREGATE,
        lambda foot: foot.propulsive_impulse_ns,
        "impulse of a stance along the base's forward axis at mid-stance",
        null=_NO_BRAKING,
    ),
    Figure(
        "loading_rate_nps",
        Kind.AGGREGATE,
        lambda foot: foot.loading_rate_nps,
        "slope of |F| from 20 % to 80 % of the rise to the first peak of a stance",
        null=f"{_NO_FORCE}; the rise takes less than one sampling interval",
        columns=(Column(_PAGE_LOADS, "rate N/s", 0, rank=80),),
    ),
    Figure(
        "impact_ratio",
        Kind.AGGREGATE,
        lambda foot: foot.impact_ratio,
        "highest |F| in the first 50 ms of a stance / median of |F| over the stance",
        null=_NO_FORCE,
        columns=(
            Column(_LOADS, "impact", 2, rank=50),
            Column(_PAGE_LOADS, "impact", 2, rank=70),
        ),
    ),
    Figure(
        "contact_travel_m",
        Kind.AGGREGATE,
        lambda foot: foot.contact_travel_m,
        "horizontal distance of the contact points at 10 % and 90 % of a stance",
        null=f"{_NO_STANCE}; no contact points there",
        columns=(Column(_LOADS, "travel", 1, rank=70, scale=1e3),),
    ),
    Figure(
        "slip_m",
        Kind.AGGREGATE,
        lambda foot: foot.slip_distance_m,
        "way of the foot on the ground between 20 % and 80 % of a stance, by its frame, where "
        "`slip_source` is `foot_frame`; else by how much `contact_travel_m` exceeds "
        "`settings.foot_rolling_m`, at least 0",
        null=_NO_SLIP,
        columns=(
            Column(_LOADS, "slip", 1, rank=80, scale=1e3),
            Column(_PAGE_LOADS, "slip mm", 1, rank=100, scale=1e3),
        ),
    ),
    Figure(
        "slip_largest_m",
        Kind.AGGREGATE,
        lambda foot: foot.largest_slip_m,
        "the same of the largest horizontal distance from where the foot is at 20 % of a stance, "
        "up to 80 %, or the contact point at 10 %, up to 90 %",
        null=_NO_SLIP,
    ),
    Figure(
        "slip_source",
        Kind.TEXT,
        lambda foot: foot.slip_source,
        "what `slip_m` is told by: the foot's frame (see `legs`) or contact points",
        null=_NO_SLIP,
        choices=("foot_frame", "contact_points"),
    ),
    Figure(
        "friction_use",
        Kind.AGGREGATE,
        lambda foot: foot.friction_use,
        "tangential / normal force, 95th percentile over a stance",
        null=f"{_NO_VERTICAL}; no contact normals",
        columns=(
            Column(_LOADS, "friction", 2, rank=60),
            Column(_PAGE_LOADS, "friction", 2, rank=90),
        ),
    ),
)
