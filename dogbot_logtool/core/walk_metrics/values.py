"""Values of metrics from the arrays of the core."""

from dogbot_logtool.core.arrays import Aggregate, Floats, Ints
from dogbot_logtool.core.gait.cycle_curves import CycleCurve
from dogbot_logtool.core.records import Curve, Shape, Spread


def scaled(value: Aggregate | None, factor: float | None) -> Spread:
    """Return an aggregate in another unit; None where the factor is not known."""
    if value is None or factor is None:
        return None
    return Aggregate(
        n=value.n,
        mean=value.mean * factor,
        std=None if value.std is None else value.std * factor,
        median=value.median * factor,
        min=value.min * factor,
        max=value.max * factor,
    )


def curve_of(curve: CycleCurve | None) -> Shape:
    """Return a curve over the gait cycle."""
    if curve is None:
        return None
    parts = (curve.percent, curve.lower, curve.median, curve.upper)
    return Curve(*(_numbers(each) for each in parts))


def seconds(time: Ints, origin: int) -> tuple[float, ...]:
    """Return times as seconds since the log's start, to the nanosecond."""
    return tuple(each / 1e9 for each in (time - origin).tolist())


def _numbers(values: Floats) -> tuple[float, ...]:
    return tuple(values.tolist())
