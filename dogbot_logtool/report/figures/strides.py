"""Figures of each whole stride of a foot: the columns of CSV and Parquet."""

from collections.abc import Sequence
from typing import Final

from dogbot_logtool.report.figures.figure import Column, Figure, Kind, TableName
from dogbot_logtool.report.figures.foot_source import FootSource

_STRIDES: Final = TableName.PAGE_STRIDES

STRIDES: Final[Sequence[Figure[FootSource]]] = (
    Figure(
        "start_s",
        Kind.COLUMN,
        lambda source: (source.foot.strides.touchdown - source.stats.origin) / 1e9,
        "touchdown, since the log's start",
    ),
    Figure(
        "stance_s",
        Kind.COLUMN,
        lambda source: source.foot.strides.stance_s,
        "lift-off minus touchdown",
        columns=(Column(_STRIDES, "stance s", 3),),
    ),
    Figure(
        "swing_s",
        Kind.COLUMN,
        lambda source: source.foot.strides.swing_s,
        "next touchdown minus lift-off",
        columns=(Column(_STRIDES, "swing s", 3),),
    ),
    Figure(
        "duty_factor",
        Kind.COLUMN,
        lambda source: source.foot.strides.duty_factor,
        "stance / stride period (Hildebrand 1965; Alexander 1984)",
        columns=(Column(_STRIDES, "duty", 3),),
    ),
    Figure(
        "length_m",
        Kind.COLUMN,
        lambda source: source.foot.length_m,
        "horizontal distance of the base between touchdown and next touchdown",
        null="no odometry around the touchdowns",
        columns=(Column(_STRIDES, "length m", 3),),
    ),
    Figure(
        "peak_force_n",
        Kind.COLUMN,
        lambda source: source.foot.stances.figures.peak_n[source.foot.strides.stance],
        "highest |F| of the stance",
        null="the sensor gives no force",
        columns=(Column(_STRIDES, "peak N", 1),),
    ),
    Figure(
        "vertical_impulse_ns",
        Kind.COLUMN,
        lambda source: source.foot.stances.figures.vertical_impulse_ns[source.foot.strides.stance],
        "integral of the vertical force over the stance (trapezoid)",
        null="the sensor gives no force; its wrenches are not known in the world frame",
    ),
    Figure(
        "slip_m",
        Kind.COLUMN,
        lambda source: source.foot.slip_m[source.foot.strides.stance],
        "slip of the stance; see `slip_m` and `slip_source` of the foot",
        null="neither the foot's frame nor contact points at 10 % and 90 % of the stance",
        columns=(Column(_STRIDES, "slip mm", 1, scale=1e3),),
    ),
)
"""Figures of the strides of a `FootSource`: (strides,) each, NaN where not known."""
