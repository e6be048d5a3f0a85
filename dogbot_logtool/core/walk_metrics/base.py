"""Metrics of the base's motion."""

from dogbot_logtool.core.metrics import Base
from dogbot_logtool.core.records import unknown
from dogbot_logtool.core.walk_metrics.span import Span


def base_metrics(span: Span) -> Base:
    """Return the motion of the base over a span."""
    base = span.base
    if base is None:
        return unknown(Base)
    return Base(
        duration_s=base.duration_s,
        path_length_m=base.path_length_m,
        net_displacement_m=base.net_displacement_m,
        forward_speed_mps=base.forward_speed_mps,
        lateral_speed_mps=base.lateral_speed_mps,
        yaw_change_rad=base.yaw_change_rad,
        yaw_rate_radps=base.yaw_rate_radps,
        height_m=base.height_m,
        climb_m=base.climb_m,
        slope_rad=base.slope_rad,
        roll_rad=base.roll_rad,
        pitch_rad=base.pitch_rad,
        froude=base.froude,
    )
